// Sums of log visibilities: the twin of `cpu.rs`. Behind it stands the variant's `exponential`.
//
// Squares of long vectors leave the range of `f32`, so intermediate vectors carry a power of two besides; powers of two disturb no
// rounding.

var<private> log_sum: Vector;

fn begin() {
    log_sum = Vector();
}

fn set_kept(sum: Vector) {
    log_sum = sum;
}

fn block(circle: Circle, before: u32, place: u32) {
    log_sum = added(log_sum, 1f, rotate_zonal(matched(circle_log(circle.sine), place), circle.direction));
}

fn finish(circles: u32) -> Vector {
    work.additions += circles - work.kept;
    return exponential(log_sum);
}

/// `2^exponent·vector`.
struct Scaled {
    vector: Vector,
    exponent: f32,
}

/// `e^mean·exp(2^squarings·residual)` is what is wanted.
struct Isolated {
    residual: Vector,
    mean: f32,
    /// Of the residual.
    norm: f32,
    squarings: i32,
}

/// No coefficient of a result exceeds this.
const LARGEST: f32 = 1e30f;

/// Takes the mean out and scales the rest down by `max(0, ⌊log2(scale·‖f̂‖)⌋)` halvings, and at least as many as bring its norm below
/// the limit (Ren 2006, eqs. 19–21).
fn isolated(f: Vector, scale: f32, limit: f32) -> Isolated {
    var residual = f;
    residual[0] = 0f;
    let norm = sqrt(dot_product(residual, residual));
    var squarings = 0;
    if norm > 0f {
        let excess = max(norm / limit, 1e-30f);
        let below = exponent(excess);
        let forced = select(below, below + 1, power_of_two(below) < excess);
        squarings = clamp(max(exponent(norm * scale), forced), 0, 60);
    }
    let shrink = power_of_two(-squarings);
    return Isolated(scaled(shrink, residual), f[0] / SQRT_4_PI, norm * shrink, squarings);
}

/// Brings a vector that is far from 1 in magnitude near to it.
fn renormalised(v: Vector) -> Scaled {
    let largest = largest_magnitude(v);
    if largest == 0f || (largest >= 1f / 65536f && largest < 65536f) {
        return Scaled(v, 0f);
    }
    let power = exponent(largest);
    return Scaled(scaled(power_of_two(-power), v), f32(power));
}

/// Squares so often (Ren 2006, eq. 21).
fn squared(value: Vector, count: i32) -> Scaled {
    var result = Scaled(value, 0f);
    for (var i = 0; i < count; i++) {
        let near = renormalised(result.vector);
        result = Scaled(square(near.vector), 2f * (result.exponent + near.exponent));
    }
    work.squares += u32(count);
    return result;
}

/// The vector times `e^mean`, or times less where a coefficient would exceed the largest.
fn restored(value: Scaled, mean: f32) -> Vector {
    let near = renormalised(value.vector);
    let largest = largest_magnitude(near.vector);
    if largest == 0f {
        return near.vector;
    }
    let factor = precise_exp((value.exponent + near.exponent) * 0.6931472f + mean);
    return scaled(min(factor, LARGEST / largest), near.vector);
}

/// `e^x` to a few roundings, clamped to the range of numbers: that of the language errs by `2|x|` of them.
fn precise_exp(x: f32) -> f32 {
    let clamped = clamp(x, -87f, 88f);
    let power = floor(fma(clamped, 1.442695f, 0.5f));
    // ln 2 in two parts, the first short enough for exact multiples
    let rest = fma(-power, 1.4286068e-6f, fma(-power, 0.69314575f, clamped));
    var sum = 1f;
    for (var k = 7; k > 0; k--) {
        sum = fma(sum * rest, 1f / f32(k), 1f);
    }
    return sum * power_of_two(i32(power));
}

/// `a·1 + b·residual`, fitted to circles by the residual's norm (Ren 2006, eqs. 23–24).
fn linear(given: Isolated) -> Vector {
    let factors = optimal_linear(given.norm);
    var value = scaled(factors.y, given.residual);
    value[0] = factors.x * SQRT_4_PI;
    return value;
}
