// Total visibility through a swath, a thread a receiver: wedges looked up, turned to their azimuths and added up. The twin of `sum.rs`.

/// Coefficients lie four by four.
struct Wedge {
    /// The number of the azimuth at its start.
    start: u32,
    /// That at its end; `BOUNDARY` for a boundary.
    end: u32,
    /// `cos mφ` of its origin for each coefficient, those with `m < 0` negated where it is the mirror image of what is tabulated.
    cosines: array<vec4f, QUADS>,
    /// `sin mφ` likewise.
    sines: array<vec4f, QUADS>,
}

const BOUNDARY: u32 = 0xffffffffu;

@group(0) @binding(0) var<storage, read> view: View;
@group(0) @binding(1) var<storage, read> wedges: array<Wedge>;
/// Those with two angles, by the first, then by the second; then boundaries.
@group(0) @binding(2) var<storage, read> tables: array<vec4f>;
/// One a receiver.
@group(0) @binding(3) var<storage, read> places: array<vec4u>;
/// In radians, those of all receivers under an azimuth after those under another.
@group(0) @binding(4) var<storage, read> elevations: array<f32>;
@group(0) @binding(5) var<storage, read_write> visibility: array<f32>;

/// Between two entries of a table.
struct Place {
    entry: u32,
    fraction: f32,
}

/// Where the horizon of a receiver is in the tables.
fn horizon(azimuth: u32, receiver: u32) -> Place {
    let elevation = elevations[(view.first + azimuth) * arrayLength(&places) + receiver];
    let at = clamp(elevation * PER_RADIAN, 0f, f32(ELEVATIONS - 1u));
    let entry = min(floor(at), f32(ELEVATIONS - 2u));
    return Place(u32(entry), at - entry);
}

/// Linear from one entry to the next, four coefficients.
fn between(entry: u32, quad: u32, share: f32) -> vec4f {
    let low = tables[entry * QUADS + quad];
    return fma(tables[(entry + 1u) * QUADS + quad] - low, vec4f(share), low);
}

var<private> even: array<vec4f, QUADS>;
var<private> odd: array<vec4f, QUADS>;

/// Adds four coefficients of a wedge, times `cos mφ` and times `sin mφ`.
fn add(number: u32, quad: u32, value: vec4f) {
    even[quad] = fma(value, wedges[number].cosines[quad], even[quad]);
    odd[quad] = fma(value, wedges[number].sines[quad], odd[quad]);
}

fn add_interior(number: u32, start: Place, end: Place) {
    let entry = start.entry * ELEVATIONS + end.entry;
    for (var quad = 0u; quad < QUADS; quad++) {
        let low = between(entry, quad, end.fraction);
        let high = between(entry + ELEVATIONS, quad, end.fraction);
        add(number, quad, fma(high - low, vec4f(start.fraction), low));
    }
}

fn add_boundary(number: u32, start: Place) {
    let entry = ELEVATIONS * ELEVATIONS + start.entry;
    for (var quad = 0u; quad < QUADS; quad++) {
        add(number, quad, between(entry, quad, start.fraction));
    }
}

/// A coefficient, all wedges turned by their azimuths at once: that of `m` is its even sum and, times a sign, the odd one of `−m`.
fn turned(l: u32, place: u32) -> f32 {
    let at = l * l + place;
    let opposite = l * l + 2u * l - place;
    let sign = f32(place < l) - f32(place > l);
    return fma(sign, odd[opposite / 4u][opposite % 4u], even[at / 4u][at % 4u]);
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let receiver = (group.y * groups.x + group.x) * 64u + thread;
    if receiver >= arrayLength(&places) {
        return;
    }
    for (var number = 0u; number < view.wedges; number++) {
        let start = horizon(wedges[number].start, receiver);
        if wedges[number].end == BOUNDARY {
            add_boundary(number, start);
        } else {
            add_interior(number, start, horizon(wedges[number].end, receiver));
        }
    }
    for (var l = 0u; l < ORDER; l++) {
        for (var place = 0u; place <= 2u * l; place++) {
            let i = l * l + place;
            if i < view.coefficients {
                visibility[view.coefficients * receiver + i] = view.window[i] * turned(l, place);
            }
        }
    }
}
