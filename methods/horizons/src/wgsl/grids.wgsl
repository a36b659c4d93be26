// Samples on grids over a field, and heights between them. Before it stands `TAPS` and `shares`; who includes it says what is `stored`.

/// Centres of rectangles that cover the field.
struct Grid {
    size: vec2i,
    /// A rectangle is 2 to this as wide as one of the field's, where it is a power of two.
    halvings: vec2u,
    /// 1 over that.
    scale: vec2f,
    /// By how many samples it begins before the field.
    shift: vec2f,
    /// The number of its first sample.
    first: u32,
}

/// A place among samples: after one of them, by a share of the way to the next.
struct Among {
    sample: vec2i,
    share: vec2f,
}

/// The number of a sample, or of the border's nearest.
fn number(grid: Grid, sample: vec2i) -> u32 {
    let inside = clamp(sample, vec2i(), grid.size - 1);
    return grid.first + u32(inside.y * grid.size.x + inside.x);
}

/// The height between samples.
fn height(grid: Grid, place: Among) -> f32 {
    let along = shares(place.share.x);
    let across = shares(place.share.y);
    let first = place.sample - (TAPS / 2 - 1);
    var sum = 0f;
    for (var row = 0; row < TAPS; row++) {
        var blend = 0f;
        for (var column = 0; column < TAPS; column++) {
            blend = fma(stored(grid, first + vec2i(column, row)), along[column], blend);
        }
        sum = fma(blend, across[row], sum);
    }
    return sum;
}
