// The paper's lamps: the twin of `lamps/lobes.rs`, on its table. `LOBE_ANGLES` and `LOBE_TILTS` are the table's extents.

/// By radius, then tilt: the lobe's angle from the normal, then its zonal coefficients.
@group(0) @binding(LOBES) var<storage, read> lobes: array<f32>;

/// The entry below a share of the range, and how far it is to the next.
struct LobePlace {
    below: u32,
    rest: f32,
}

fn lobe_place(share: f32, entries: u32) -> LobePlace {
    let at = clamp(share, 0f, 1f) * f32(entries - 1u);
    let below = min(u32(at), entries - 2u);
    return LobePlace(below, at - f32(below));
}

/// What is visible of a lamp of radiance 1 by the lobe of `H(N) * L`.
fn visible_of_lamp(circle: LampCircle, normal: vec3f, visibility: Vector) -> f32 {
    let sine = min(circle.sine, 1f);
    let cosine = clamp(circle.cosine, -1f, 1f);
    let across_square = fma(-cosine, cosine, 1f);
    let radius = angle_of(sine, sqrt(max(fma(-sine, sine, 1f), 0f)));
    let tilt = angle_of(sqrt(max(across_square, 0f)), cosine);
    let row = lobe_place(radius * 2f / PI, LOBE_ANGLES);
    let column = lobe_place(tilt / PI, LOBE_TILTS);

    let sideways = (circle.direction - circle.cosine * normal) / sqrt(max(across_square, 1e-12f));
    let turned = cosine_and_sine(lobe_value(row, column, 0u));
    var zonal = Zonal();
    for (var l = 0u; l < settings.order; l++) {
        zonal[l] = sine * sine * lobe_value(row, column, l + 1u);
    }
    return dot_product(rotate_zonal(zonal, turned.x * normal + turned.y * sideways), visibility);
}

/// A number of the entries around a place, between them.
fn lobe_value(row: LobePlace, column: LobePlace, number: u32) -> f32 {
    let size = settings.order + 1u;
    let first = (row.below * LOBE_TILTS + column.below) * size + number;
    let next = first + LOBE_TILTS * size;
    let above = mix(lobes[first], lobes[first + size], column.rest);
    let below = mix(lobes[next], lobes[next + size], column.rest);
    return mix(above, below, row.rest);
}

/// Of an angle from 0 to π, to a few roundings.
fn cosine_and_sine(angle: f32) -> vec2f {
    let x = angle - 0.5f * PI;
    var sums = vec2f(); // of sin x/x and cos x
    for (var k = 7; k >= 0; k--) {
        let n = f32(2 * k);
        sums = 1f - x * x * sums / vec2f((n + 2f) * (n + 3f), (n + 1f) * (n + 2f));
    }
    return vec2f(-x * sums.x, sums.y);
}
