// Blockers that never move, accumulated by the CPU once for where a receiver is: the twin of `bake.rs`.

struct Baked {
    circles: u32,
    sum: Vector,
}
@group(0) @binding(BAKED) var<storage, read> baked: array<Baked>;

/// Sets what is known of a receiver.
fn resume(index: u32) {
    work.kept = baked[index].circles;
    set_kept(baked[index].sum);
}
