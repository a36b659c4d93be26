// A level out of the next finer one by bilinear interpolation at its samples' centres, a thread a sample: the twin of `Level::decimate`.

/// All levels, the coarsest first, then what they are brought back to.
@group(0) @binding(0) var<storage, read> grids: array<Grid>;
/// The number of the level to make.
@group(0) @binding(1) var<storage, read> level: u32;
/// The finest level.
@group(0) @binding(2) var<storage, read> heights: array<f32>;
/// The others.
@group(0) @binding(3) var<storage, read_write> levels: array<f32>;

fn stored(grid: Grid, sample: vec2i) -> f32 {
    let at = number(grid, sample);
    if level + 2u == arrayLength(&grids) / 2u {
        return heights[at];
    }
    return levels[at];
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = i32((group.y * groups.x + group.x) * 64u + place);
    let to = grids[level];
    if index >= to.size.x * to.size.y {
        return;
    }
    let finer = grids[level + 1u];
    // The centre among the finer level's samples, in parts of which there are `width` from one to the next: exact.
    let width = 2 * to.size;
    let sample = vec2i(index % to.size.x, index / to.size.x);
    let centre = (2 * sample + 1) * finer.size - to.size;
    let before = centre / width;
    levels[to.first + u32(index)] = height(finer, Among(before, vec2f(centre - before * width) / vec2f(width)));
}
