// What a lamp gives with nothing in the way, times the share of its circle that visibility leaves.

/// What is visible of a lamp of radiance 1.
fn visible_of_lamp(circle: LampCircle, normal: vec3f, visibility: Vector) -> f32 {
    let open = open_lamp(circle.sine, circle.cosine);
    if open == 0f {
        return 0f;
    }
    var zonal = circle_light(circle.sine);
    let whole = zonal[0] * SQRT_4_PI; // times the open sky's first coefficient, which y₀₀ makes 1
    for (var l = 0u; l < ORDER; l++) {
        zonal[l] *= lamps.window[l];
    }
    let share = dot_product(rotate_zonal(zonal, circle.direction), visibility) / whole;
    return open * select(share, clamp(share, 0f, 1f), settings.guard != 0u);
}

/// `1/π ∫ max(0, n·ω) dω` over a circle by the sine of its radius and the cosine of the angle between its middle and the normal.
fn open_lamp(sine: f32, cosine: f32) -> f32 {
    let square = sine * sine;
    if abs(cosine) >= sine {
        return square * max(cosine, 0f);
    }
    let cut = (sine - cosine) * (sine + cosine);
    let rest = max(fma(-sine, sine, 1f), 0f);
    let turn = angle_of(sqrt(cut), -cosine * sqrt(rest));
    let chord = angle_of(sqrt(cut), sqrt(rest));
    let half_sine = sqrt(cut * rest) / (cut + rest); // of twice the chord
    let kept = fma(square * cosine, turn, segment(chord, half_sine)) + cosine * cosine * half_sine;
    return max(kept / PI, 0f);
}

/// `x − sin(2x)/2`, to the last digits where it is small; `half_sine` is `sin(2x)/2`.
fn segment(x: f32, half_sine: f32) -> f32 {
    if x * x >= 0.1f {
        return x - half_sine;
    }
    let square = 4f * x * x;
    var sum = 0f;
    for (var k = 4; k >= 1; k--) {
        sum = fma(-square / f32((2 * k + 2) * (2 * k + 3)), sum, 1f);
    }
    return x * square / 6f * sum;
}
