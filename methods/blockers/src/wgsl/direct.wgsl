// Direct light under sphere blockers, a thread a receiver: the twin of `shading.rs`. Before it stands the algebra of the accumulated
// order (`halflight_sh::wgsl`), behind it how spheres are seen (`seen.wgsl`), which ones (`all_spheres.wgsl` or `cuts.wgsl`), what is known
// of others (`baked.wgsl`), the lamps and the method's `begin`, `block` and `finish`: what a scene does not need is not in its shader.

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
    /// Whether logs are scaled by ratio vectors.
    ratios: u32,
    padding: u32,
    /// The method's own.
    method: vec4f,
    /// A factor for each coefficient of visibility; 0 beyond the order of shading.
    window: Vector,
    light: array<Vector, 3>,
}

struct Receiver {
    position: vec3f,
    /// Its number; 0 if there are none.
    cluster: u32,
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
/// What groups of threads counted: low and high words.
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>, 2 * COUNTERS>;

/// Circles, those below the smallest angle, additions, products, squares, receivers guarded, circles known before,
/// receivers whose loops were ended on the way.
const COUNTERS: u32 = 8u;
/// What this group of threads counted.
var<workgroup> counted: array<atomic<u32>, COUNTERS>;

/// SH operations of this receiver.
struct Work {
    additions: u32,
    products: u32,
    squares: u32,
    /// Circles that were known before.
    kept: u32,
}
var<private> work: Work;

/// Above this, light times visibility could overflow: the guard then acts even where it is switched off.
const OVERFLOW: f32 = 1e30f;

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
    return (light + lamplight(receiver, visibility)) * receiver.albedo;
}

/// Visibility at a receiver, guarded and windowed.
fn visibility_at(index: u32, receiver: Receiver) -> Vector {
    let list = list(receiver);
    begin();
    resume(index);
    var circles = work.kept;
    var too_small = 0u;
    for (var place = list.x; place < list.y; place++) {
        let circle = seen(receiver, spheres[place]);
        if circle.sine > 0f {
            if circle.sine < settings.min_sine {
                too_small++;
            } else {
                block(circle, circles, place);
                circles++;
            }
        }
    }
    var visibility = open_sky();
    if circles > 0u {
        visibility = finish(circles);
    }
    let safe = guarded(visibility);
    let acts = safe.acted && (settings.guard != 0u || overflows(visibility));
    if acts {
        visibility = safe.vector;
    }
    for (var i = 0u; i < SIZE; i++) {
        visibility[i] *= settings.window[i];
    }
    count(0u, circles - work.kept);
    count(1u, too_small);
    count(2u, work.additions);
    count(3u, work.products);
    count(4u, work.squares);
    count(5u, u32(acts));
    count(6u, work.kept);
    return visibility;
}

fn overflows(visibility: Vector) -> bool {
    var overflows = false;
    for (var i = 0u; i < SIZE; i++) {
        overflows = overflows || !(abs(visibility[i]) <= OVERFLOW) || !is_finite(visibility[i]);
    }
    return overflows;
}

fn count(counter: u32, amount: u32) {
    if amount > 0u {
        atomicAdd(&counted[counter], amount);
    }
}

/// Adds what the group counted to what others did.
fn tell(counter: u32) {
    let amount = atomicLoad(&counted[counter]);
    if amount == 0u {
        return;
    }
    let before = atomicAdd(&counters[2u * counter], amount);
    if before + amount < before {
        atomicAdd(&counters[2u * counter + 1u], 1u);
    }
}

/// Whether loops still go to their end: lavapipe ends all of a thread's after 65 535 rounds in sum, each then in its first.
fn loops_end() -> bool {
    var rounds = 0u;
    for (var i = 0u; i <= settings.order; i++) {
        rounds++;
    }
    return rounds == settings.order + 1u;
}

fn shade(index: u32) {
    let receiver = receivers[index];
    let visibility = visibility_at(index, receiver);
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
    count(7u, u32(!loops_end()));
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + place;
    if index < arrayLength(&receivers) {
        shade(index);
    }
    workgroupBarrier();
    if place < COUNTERS {
        tell(place);
    }
}
