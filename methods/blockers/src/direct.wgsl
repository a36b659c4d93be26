// Direct light under sphere blockers, a thread a receiver: the twin of `shading.rs` and `seen.rs`. Before it stands the algebra of the
// accumulated order (`halflight_sh::wgsl`), after it the method's `begin`, `block` and `finish`.

struct Settings {
    spheres: u32,
    /// 0: continuous, 1: paper, 2: off.
    self_shadow: u32,
    guard: u32,
    /// Order of light and shading, at most that of accumulation.
    order: u32,
    /// Coefficients of visibility wanted; 0: radiance.
    coefficients: u32,
    min_sine: f32,
    padding: vec2u,
    /// The method's own.
    method: vec4f,
    /// A factor for each coefficient of visibility; 0 beyond the order of shading.
    window: Vector,
    light: array<Vector, 3>,
}

struct Receiver {
    position: vec3f,
    geometric_normal: vec3f,
    normal: vec3f,
    albedo: vec3f,
}

@group(0) @binding(0) var<storage, read> settings: Settings;
@group(0) @binding(1) var<storage, read> receivers: array<Receiver>;
/// Centre and radius.
@group(0) @binding(2) var<storage, read> spheres: array<vec4f>;
@group(0) @binding(3) var<storage, read> tables: array<f32>;
@group(0) @binding(4) var<storage, read_write> results: array<f32>;
/// Low and high words.
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>, 12>;

/// SH operations of this receiver.
struct Work {
    additions: u32,
    products: u32,
    squares: u32,
}
var<private> work: Work;

/// Above this, light times visibility could overflow: the guard then acts even where it is switched off.
const OVERFLOW: f32 = 1e30f;
/// Squared distances below count as 0.
const LEAST_SQUARE: f32 = 1.1754944e-38f;
/// Squared distances above count as this.
const LARGEST_SQUARE: f32 = 1e38f;

/// Directions that a sphere blocks; none where the sine is 0.
struct Circle {
    direction: vec3f,
    sine: f32,
}

const NO_CIRCLE = Circle(vec3f(), 0f);

fn circle(to: vec3f, radius: f32) -> Circle {
    let square = dot(to, to);
    if !(square > LEAST_SQUARE) || !(radius > 0f) {
        return NO_CIRCLE;
    }
    let nearness = inverseSqrt(min(square, LARGEST_SQUARE));
    return Circle(to * nearness, min(radius * nearness, 1f));
}

/// The circle of a sphere at a receiver under the self-shadow rule (Ren 2006, §6.2; `halflight_proxies::seen`).
fn seen(receiver: Receiver, sphere: vec4f) -> Circle {
    let to = sphere.xyz - receiver.position;
    let radius = sphere.w;
    let height = dot(to, receiver.geometric_normal);
    if settings.self_shadow == 2u {
        return circle(to, radius);
    }
    if height <= -radius {
        return NO_CIRCLE;
    }
    if dot(to, to) < radius * radius {
        return circle(to, height);
    }
    if height >= radius {
        return circle(to, radius);
    }
    return straddling(to, receiver.geometric_normal, height, radius);
}

/// The tangent replacement of a sphere that pokes through the plane, faded in with the distance from the rim.
fn straddling(to: vec3f, normal: vec3f, height: f32, radius: f32) -> Circle {
    let tangent_radius = 0.5f * (height + radius);
    let foot = to - height * normal;
    let rim = sqrt(max((radius - height) * (radius + height), 0f));
    var alpha = 1f;
    if rim > 0f {
        alpha = clamp(length(foot) / rim - 1f, 0f, 1f);
    }
    if settings.self_shadow == 1u {
        return circle(foot + tangent_radius * normal, alpha * tangent_radius);
    }
    let first_radius = max(height, 0f);
    let blended_height = height + alpha * (tangent_radius - height);
    return circle(foot + blended_height * normal, first_radius + alpha * (tangent_radius - first_radius));
}

/// What distant light a receiver reflects under a visibility.
fn radiance(receiver: Receiver, visibility: Vector) -> vec3f {
    var cosine = CLAMPED_COSINE;
    for (var l = settings.order; l < ORDER; l++) {
        cosine[l] = 0f;
    }
    let transfer = product(rotate_zonal(cosine, receiver.normal), visibility);
    var light = vec3f();
    for (var channel = 0u; channel < 3u; channel++) {
        light[channel] = dot_product(settings.light[channel], transfer);
    }
    return light * receiver.albedo;
}

fn tell(counter: u32, amount: u32) {
    if amount == 0u {
        return;
    }
    let before = atomicAdd(&counters[2u * counter], amount);
    if before + amount < before {
        atomicAdd(&counters[2u * counter + 1u], 1u);
    }
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + place;
    if index >= arrayLength(&receivers) {
        return;
    }
    let receiver = receivers[index];
    var circles = 0u;
    var too_small = 0u;
    begin();
    for (var i = 0u; i < settings.spheres; i++) {
        let circle = seen(receiver, spheres[i]);
        if circle.sine > 0f {
            if circle.sine < settings.min_sine {
                too_small++;
            } else {
                block(circle, circles);
                circles++;
            }
        }
    }
    var visibility = open_sky();
    if circles > 0u {
        visibility = finish(circles);
    }
    let safe = guarded(visibility);
    var overflows = false;
    for (var i = 0u; i < SIZE; i++) {
        overflows = overflows || !(abs(visibility[i]) <= OVERFLOW) || !is_finite(visibility[i]);
    }
    if safe.acted && (settings.guard != 0u || overflows) {
        visibility = safe.vector;
        tell(5u, 1u);
    }
    for (var i = 0u; i < SIZE; i++) {
        visibility[i] *= settings.window[i];
    }
    if settings.coefficients > 0u {
        for (var i = 0u; i < settings.coefficients; i++) {
            results[settings.coefficients * index + i] = visibility[i];
        }
    } else {
        let light = radiance(receiver, visibility);
        for (var channel = 0u; channel < 3u; channel++) {
            results[3u * index + channel] = light[channel];
        }
    }
    tell(0u, circles);
    tell(1u, too_small);
    tell(2u, work.additions);
    tell(3u, work.products);
    tell(4u, work.squares);
}
