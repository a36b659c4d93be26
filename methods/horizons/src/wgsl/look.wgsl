// Horizons, a thread for each receiver under each azimuth: the twin of `Rays` over receivers that lie anywhere. Places are whole numbers
// and fractions apart, so that no rounding grows with the field.

struct Settings {
    /// Steps of an azimuth.
    steps: u32,
    /// Whether there is nothing beyond the border.
    open: u32,
}

/// In grid coordinates of the field.
struct Place {
    whole: vec2i,
    fraction: vec2f,
}

struct Step {
    offset: Place,
    level: u32,
    /// 1 over the distance in metres.
    inverse: f32,
    /// Whether the azimuth's horizon is smoothed over scales.
    smooth_scale: u32,
}

@group(0) @binding(0) var<storage, read> settings: Settings;
/// All levels, the coarsest first, then what they are brought back to.
@group(0) @binding(1) var<storage, read> grids: array<Grid>;
@group(0) @binding(2) var<storage, read> back: array<f32>;
/// Azimuth after azimuth, the longest first.
@group(0) @binding(3) var<storage, read> steps: array<Step>;
@group(0) @binding(4) var<storage, read> places: array<Place>;
/// In radians, those of all receivers under an azimuth after those under another.
@group(0) @binding(5) var<storage, read_write> elevations: array<f32>;

fn stored(grid: Grid, sample: vec2i) -> f32 {
    return back[number(grid, sample)];
}

/// Where a place of the field lies among a grid's samples.
fn among(grid: Grid, place: Place) -> Among {
    // What is left of a rectangle of the grid.
    let rest = vec2f(place.whole & ((vec2i(1) << grid.halvings) - 1)) + place.fraction;
    let at = fma(rest + 0.5f, grid.scale, grid.shift - 0.5f);
    let before = floor(at);
    return Among((place.whole >> grid.halvings) + vec2i(before), at - before);
}

fn moved(place: Place, by: Place) -> Place {
    let fraction = place.fraction + by.fraction;
    let carried = floor(fraction);
    return Place(place.whole + by.whole + vec2i(carried), fraction - carried);
}

/// Whether a place is on the field.
fn on_field(place: Place, last: vec2i) -> bool {
    let before_last = place.whole < last | (place.whole == last & place.fraction == vec2f());
    return all(place.whole >= vec2i() & before_last);
}

/// The tangent of the elevation that a step leads to.
fn slope(place: Place, step: Step) -> f32 {
    let to = moved(place, step.offset);
    let count = arrayLength(&grids) / 2u;
    if settings.open != 0u && !on_field(to, grids[count - 1u].size - 1) {
        return 0f;
    }
    let grid = grids[count + step.level];
    return (height(grid, among(grid, to)) - height(grid, among(grid, place))) * step.inverse;
}

fn arctangent(tangent: f32) -> f32 {
    let size = abs(tangent);
    let ratio = min(size, 1f) / max(size, 1f);
    let square = ratio * ratio;
    var sum = 0f;
    for (var i = 7u; i > 0u; i--) {
        sum = fma(sum, square, ODD[i - 1u]);
    }
    let angle = select(sum * ratio, RIGHT_ANGLE - sum * ratio, size > 1f);
    return select(angle, -angle, tangent < 0f);
}

/// What is linear between scales is greatest at one of them, and the arctangent is monotonic.
fn steepest(place: Place, first: u32) -> f32 {
    var greatest = 0f;
    for (var i = 0u; i < settings.steps; i++) {
        greatest = max(greatest, slope(place, steps[first + i]));
    }
    return arctangent(greatest);
}

/// The B-spline at the middle one of three.
fn knot(before: f32, at: f32, after: f32) -> f32 {
    return fma(before + after, 1f / 6f, at * (2f / 3f));
}

/// The B-spline between the inner ones of four.
fn half_knot(before: f32, low: f32, high: f32, after: f32) -> f32 {
    return fma(before + after, 1f / 48f, (low + high) * (23f / 48f));
}

/// The greatest value at knots and half knots of the B-spline over the steps' angles (eqs. 3 to 5).
fn smoothed(place: Place, first: u32) -> f32 {
    var before = arctangent(slope(place, steps[first]));
    var low = before;
    var high = before;
    var greatest = 0f;
    for (var i = 1u; i < settings.steps; i++) {
        let next = arctangent(slope(place, steps[first + i]));
        if i > 1u {
            greatest = max(greatest, half_knot(before, low, high, next));
        }
        greatest = max(greatest, knot(low, high, next));
        before = low;
        low = high;
        high = next;
    }
    if settings.steps > 1u {
        greatest = max(greatest, half_knot(before, low, high, high));
    }
    return max(greatest, knot(low, high, high));
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + thread;
    let receivers = arrayLength(&places);
    let first = index / receivers * settings.steps;
    if first >= arrayLength(&steps) {
        return;
    }
    let place = places[index % receivers];
    var elevation = 0f;
    if steps[first].smooth_scale != 0u {
        elevation = smoothed(place, first);
    } else {
        elevation = steepest(place, first);
    }
    elevations[index] = clamp(elevation, 0f, RIGHT_ANGLE);
}
