
const SQRT_4_PI: f32 = 3.5449077f;
const PI: f32 = 3.1415927f;

// How tables lie: `TERMS` powers a band for small circles, then two sets of pieces: starts, ends, middles and scales of
// `PIECES` pieces, then for each function and power the coefficients of all pieces.
const LARGE: u32 = TERMS * ORDER;
const LINEAR: u32 = LARGE + PIECES * (4u + (DEGREE + 1u) * ORDER);

/// The open sky, or the constant 1.
fn open_sky() -> Vector {
    var sky = Vector();
    sky[0] = SQRT_4_PI;
    return sky;
}

fn scaled(factor: f32, v: Vector) -> Vector {
    var out = v;
    for (var i = 0u; i < SIZE; i++) {
        out[i] *= factor;
    }
    return out;
}

fn dot_product(a: Vector, b: Vector) -> f32 {
    var sum = 0f;
    for (var i = 0u; i < SIZE; i++) {
        sum = fma(a[i], b[i], sum);
    }
    return sum;
}

fn largest_magnitude(v: Vector) -> f32 {
    var largest = 0f;
    for (var i = 0u; i < SIZE; i++) {
        largest = max(largest, abs(v[i]));
    }
    return largest;
}

/// By its bits: shaders may assume that there is no such number.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn is_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

/// `⌊log2 x⌋` of a positive normal number.
fn exponent(x: f32) -> i32 {
    return i32((bitcast<u32>(x) >> 23u) & 0xffu) - 127;
}

/// `2^k` for `k` from −126 to 127.
fn power_of_two(k: i32) -> f32 {
    return bitcast<f32>(u32(clamp(k, -126, 127) + 127) << 23u);
}

/// `1 − cos θ` from `sin θ`, clamped to [0, 1].
fn circle_height(sine: f32) -> f32 {
    let s = clamp(sine, 0f, 1f);
    let cosine = sqrt(max(fma(-s, s, 1f), 0f));
    return s * s / (1f + cosine);
}

/// `∫ y_l0` over a circle about z.
fn circle_light(sine: f32) -> Zonal {
    let height = circle_height(sine);
    let cosine = 1f - height;
    let square = height * (1f + cosine);
    var zonal = Zonal();
    zonal[0] = sqrt(PI) * height;
    var below = 1f;
    var p = cosine;
    var slope_below = 0f;
    var slope = 1f;
    for (var l = 1u; l < ORDER; l++) {
        let width = f32(2u * l + 1u);
        let next = f32(l + 1u);
        zonal[l] = sqrt(PI * width) / (f32(l) * next) * square * slope;
        let slope_above = fma(width, p, slope_below);
        let above = fma(-below, f32(l) / next, width / next * cosine * p);
        below = p;
        p = above;
        slope_below = slope;
        slope = slope_above;
    }
    return zonal;
}

/// Where in its piece `x` lies.
struct Place {
    piece: u32,
    position: f32,
}

/// So many pieces on, if the one there begins at or below `x`.
fn later(base: u32, x: f32, piece: u32, pieces: u32) -> u32 {
    return select(piece, piece + pieces, x >= tables[base + piece + pieces]);
}

/// The last piece that begins at or below `x`, which is clamped to the table at `base`.
fn find_piece(base: u32, x: f32) -> Place {
    let clamped = clamp(x, tables[base], tables[base + 2u * PIECES - 1u]);
    var piece = later(base, clamped, 0u, PIECES / 2u);
    piece = later(base, clamped, piece, PIECES / 4u);
    piece = later(base, clamped, piece, PIECES / 8u);
    piece = later(base, clamped, piece, PIECES / 16u);
    let middle = tables[base + 2u * PIECES + piece];
    return Place(piece, (clamped - middle) * tables[base + 3u * PIECES + piece]);
}

/// The factors of `a·1 + b·f̂` for a norm of `f̂`.
fn optimal_linear(norm: f32) -> vec2f {
    if ORDER == 1u || norm == 0f {
        return vec2f(1f, 1f);
    }
    let place = find_piece(LINEAR, norm);
    let slope = piece_value(LINEAR, 1u, place) * (LINEAR_END / max(norm, LINEAR_END));
    return vec2f(piece_value(LINEAR, 0u, place), slope);
}

struct Guarded {
    vector: Vector,
    acted: bool,
}

/// Brings a vector to where the projections of all binary functions are: `0 ≤ g₀ ≤ √4π`, `‖g‖² ≤ √4π·g₀`.
fn guarded(given: Vector) -> Guarded {
    const SLACK = 7.6293945e-6f; // 64 roundings
    var g = given;
    var acted = false;
    if is_nan(g[0]) {
        g[0] = 0f;
        acted = true;
    } else if g[0] < -SLACK || g[0] > SQRT_4_PI + SLACK || !is_finite(g[0]) {
        g[0] = select(0f, SQRT_4_PI, g[0] > 0f);
        acted = true;
    }
    var largest = 0f;
    for (var i = 1u; i < SIZE; i++) {
        if !is_finite(g[i]) {
            g[i] = 0f;
            acted = true;
        }
        largest = max(largest, abs(g[i]));
    }
    // so that no square overflows
    let shrink = power_of_two(select(0, -exponent(largest), largest > 1e15f));
    var energy = 0f;
    for (var i = 1u; i < SIZE; i++) {
        g[i] *= shrink;
        energy = fma(g[i], g[i], energy);
    }
    let bound = max(g[0] * (SQRT_4_PI - g[0]), 0f);
    if shrink < 1f || energy > bound + SLACK {
        let scale = sqrt(bound / energy);
        for (var i = 1u; i < SIZE; i++) {
            g[i] *= scale;
        }
        acted = true;
    }
    return Guarded(g, acted);
}
