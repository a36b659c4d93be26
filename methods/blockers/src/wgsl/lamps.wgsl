// Lamps, spheres that emit: the twin of `lamps.rs`. Behind it stands what is visible of one, in `shares.wgsl` or `lobes.wgsl`.

struct Lamp {
    /// Centre and radius.
    sphere: vec4f,
    radiance: vec3f,
}

struct Lamps {
    /// A factor for each band of light; 0 beyond the order of shading.
    window: Zonal,
    each: array<Lamp>,
}
@group(0) @binding(LAMPS) var<storage, read> lamps: Lamps;

/// A lamp's circle as a receiver sees it; all 0 for a receiver inside, which sees none of its light.
struct LampCircle {
    direction: vec3f,
    sine: f32,
    /// Of the angle between its middle and the normal.
    cosine: f32,
}

/// What lamps bring to a surface of albedo 1.
fn lamplight(receiver: Receiver, visibility: Vector) -> vec3f {
    var light = vec3f();
    for (var i = 0u; i < arrayLength(&lamps.each); i++) {
        let lamp = lamps.each[i];
        let circle = lamp_circle(lamp.sphere, receiver);
        if circle.sine > 0f {
            light += lamp.radiance * visible_of_lamp(circle, receiver.normal, visibility);
        }
    }
    return light;
}

fn lamp_circle(sphere: vec4f, receiver: Receiver) -> LampCircle {
    let to = sphere.xyz - receiver.position;
    let square = dot(to, to);
    let distance = sqrt(square);
    if !(square <= LARGEST_SQUARE) || !(distance > sphere.w) {
        return LampCircle();
    }
    let direction = to / distance;
    return LampCircle(direction, sphere.w / distance, dot(direction, receiver.normal));
}

/// `atan2(y, x)` of a `y` of at least 0, to a few roundings: that of the language errs by thousands.
fn angle_of(y: f32, x: f32) -> f32 {
    var tangent = y / max(sqrt(fma(x, x, y * y)) + abs(x), LEAST_SQUARE); // of half the angle from ±x
    for (var halving = 0; halving < 2; halving++) {
        tangent /= 1f + sqrt(fma(tangent, tangent, 1f));
    }
    let square = tangent * tangent; // at most tan²(π/16)
    var sum = 0f;
    for (var k = 5; k >= 0; k--) {
        sum = fma(-square, sum, 1f / f32(2 * k + 1));
    }
    let angle = 8f * tangent * sum;
    return select(angle, PI - angle, x < 0f);
}
