// No blocker is known before.

fn resume(index: u32) {}
