// The traversal's stack, its latest groups in registers, the others in the memory of the workgroup: neighbouring lanes'
// entries are neighbours.
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

fn stack_read(level: u32) -> Group {
  return Group(stack_get(3u * level), stack_get(3u * level + 1u), stack_get(3u * level + 2u));
}

// The groups that were put aside: the last three in registers, the last one first, where those that are taken up have no
// slots; those before them on the stack. Most are taken up before they get there.
struct Aside {
  first: Group,
  second: Group,
  third: Group,
  // On the stack.
  levels: u32,
}

fn nothing_aside() -> Aside {
  let none = Group(0u, 0u, 0u);
  return Aside(none, none, none, 0u);
}

// Nothing if asked.
fn emptied(so_far: Aside, is_asked: bool) -> Aside {
  var aside = so_far;
  aside.first.slots = select(aside.first.slots, 0u, is_asked);
  aside.second.slots = select(aside.second.slots, 0u, is_asked);
  aside.third.slots = select(aside.third.slots, 0u, is_asked);
  aside.levels = select(aside.levels, 0u, is_asked);
  return aside;
}

// How many there are.
fn aside_count(aside: Aside) -> u32 {
  let slots = vec3u(aside.first.slots, aside.second.slots, aside.third.slots);
  let is_there = select(vec3u(0u), vec3u(1u), slots != vec3u(0u));
  return aside.levels + is_there.x + is_there.y + is_there.z;
}

// Puts a group aside if asked.
fn put_aside(so_far: Aside, group: Group, is_asked: bool) -> Aside {
  var aside = so_far;
  if (is_asked && aside.third.slots != 0u) {
    stack_write(aside.levels, aside.third);
    aside.levels += 1u;
  }
  aside.third = select_group(aside.third, aside.second, is_asked);
  aside.second = select_group(aside.second, aside.first, is_asked);
  aside.first = select_group(aside.first, group, is_asked);
  return aside;
}

// The same with the last group, of which there must be one, in `first`.
fn with_first(so_far: Aside) -> Aside {
  var aside = so_far;
  if (aside.first.slots == 0u) {
    aside.levels -= 1u;
    aside.first = stack_read(aside.levels);
  }
  return aside;
}

// What is left when `first` is taken up.
fn without_first(aside: Aside) -> Aside {
  return Aside(aside.second, aside.third, Group(0u, 0u, 0u), aside.levels);
}
