// The traversal's stack, in the memory of the workgroup: neighbouring lanes' entries are neighbours.

// Children that are hit and wait: a node's last header word, their slots + 1 in 4 bits each with
// the next one lowest, and the bits of a t that none of them is entered before.
struct Group {
  header: u32,
  slots: u32,
  entry: u32,
}

const STACK_LANES: u32 = 64u;

var<workgroup> traversal_stack: array<u32, STACK_SIZE * 3u * STACK_LANES>;

// This invocation's place in its workgroup; set by the entry point.
var<private> stack_lane: u32;

fn stack_write(level: u32, group: Group) {
  let place = level * 3u * STACK_LANES + stack_lane;
  traversal_stack[place] = group.header;
  traversal_stack[place + STACK_LANES] = group.slots;
  traversal_stack[place + 2u * STACK_LANES] = group.entry;
}

fn stack_read_entry(level: u32) -> u32 {
  return traversal_stack[level * 3u * STACK_LANES + stack_lane + 2u * STACK_LANES];
}

fn stack_read(level: u32) -> Group {
  let place = level * 3u * STACK_LANES + stack_lane;
  return Group(
    traversal_stack[place],
    traversal_stack[place + STACK_LANES],
    traversal_stack[place + 2u * STACK_LANES],
  );
}
