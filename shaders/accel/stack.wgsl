// The traversal's stack, in the memory of the workgroup: neighbouring lanes' entries are neighbours.
// Needs const STACK_SIZE (levels), STACK_IN_WORKGROUP.

// Children that are hit and wait: a node's last header word, their slots + 1 in 4 bits each with
// the next one lowest, and the bits of a t that none of them is entered before.
struct Group {
  header: u32,
  slots: u32,
  entry: u32,
}

// One of two groups.
fn select_group(if_false: Group, if_true: Group, condition: bool) -> Group {
  return Group(
    select(if_false.header, if_true.header, condition),
    select(if_false.slots, if_true.slots, condition),
    select(if_false.entry, if_true.entry, condition),
  );
}

const STACK_LANES: u32 = 64u;

// Of these two the one that is used is compiled: that of the workgroup unless STACK_SIZE levels for
// all lanes are more than the device has (program.rs).
var<workgroup> workgroup_stack: array<u32, STACK_SIZE * 3u * STACK_LANES>;
var<private> private_stack: array<u32, STACK_SIZE * 3u>;

// This invocation's place in its workgroup; set by the entry point.
var<private> stack_lane: u32;

fn stack_set(word: u32, value: u32) {
  if (STACK_IN_WORKGROUP) {
    workgroup_stack[word * STACK_LANES + stack_lane] = value;
  } else {
    private_stack[word] = value;
  }
}

fn stack_get(word: u32) -> u32 {
  var value: u32;
  if (STACK_IN_WORKGROUP) {
    value = workgroup_stack[word * STACK_LANES + stack_lane];
  } else {
    value = private_stack[word];
  }
  return value;
}

fn stack_write(level: u32, group: Group) {
  stack_set(3u * level, group.header);
  stack_set(3u * level + 1u, group.slots);
  stack_set(3u * level + 2u, group.entry);
}

fn stack_read_entry(level: u32) -> u32 {
  return stack_get(3u * level + 2u);
}

fn stack_read(level: u32) -> Group {
  return Group(stack_get(3u * level), stack_get(3u * level + 1u), stack_read_entry(level));
}
