// All levels brought back to the resolutions at which they are looked at, a thread a sample: the twin of `bring_back`.

/// All levels, the coarsest first, then what they are brought back to.
@group(0) @binding(0) var<storage, read> grids: array<Grid>;
/// The finest level.
@group(0) @binding(1) var<storage, read> heights: array<f32>;
/// The others.
@group(0) @binding(2) var<storage, read> levels: array<f32>;
@group(0) @binding(3) var<storage, read_write> back: array<f32>;

/// Whether it is of the finest level that samples are asked.
var<private> finest: bool;

fn stored(grid: Grid, sample: vec2i) -> f32 {
    let at = number(grid, sample);
    if finest {
        return heights[at];
    }
    return levels[at];
}

/// The level whose sample has this number.
fn level_of(index: u32, count: u32) -> u32 {
    var level = 0u;
    var beyond = count;
    while beyond - level > 1u {
        let middle = (level + beyond) / 2u;
        if index >= grids[count + middle].first {
            level = middle;
        } else {
            beyond = middle;
        }
    }
    return level;
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + place;
    if index >= arrayLength(&back) {
        return;
    }
    let count = arrayLength(&grids) / 2u;
    let level = level_of(index, count);
    let level_grid = grids[level];
    let to = grids[count + level];
    let field = grids[count - 1u].size;
    finest = level + 1u == count;
    let within = i32(index - to.first);
    let sample = vec2i(within % to.size.x, within / to.size.x);
    // Where it lies among the level's samples, in parts of which there are `width` from one to the next: exact. It may lie before the
    // first of them.
    let width = 2 * field;
    let middle = (2 * sample + 1 - to.size) * (vec2i(1) << to.halvings) + field;
    let at = middle * level_grid.size - field;
    let before = (at + width) / width - 1;
    back[index] = height(level_grid, Among(before, vec2f(at - before * width) / vec2f(width)));
}
