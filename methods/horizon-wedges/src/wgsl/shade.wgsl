// Radiance `albedo · L · (H(N) * V)` of a view's lights, a thread a receiver: the twin of `Shading::shade`. Before it stands the algebra
// of the order (`halflight_sh::wgsl`).

struct Receiver {
    normal: vec3f,
    albedo: vec3f,
}

@group(0) @binding(0) var<storage, read> view: View;
@group(0) @binding(1) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(2) var<storage, read> visibility: array<f32>;
@group(0) @binding(3) var<storage, read_write> results: array<f32>;
/// Of logs and exponentials, of which there is none here.
@group(0) @binding(4) var<storage, read> tables: array<f32>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + thread;
    if index >= arrayLength(&receivers) {
        return;
    }
    var seen = Vector();
    for (var i = 0u; i < SIZE; i++) {
        seen[i] = visibility[SIZE * index + i];
    }
    let receiver = receivers[index];
    let transfer = product(rotate_zonal(CLAMPED_COSINE, receiver.normal), seen);
    for (var channel = 0u; channel < 3u; channel++) {
        let at = 3u * index + channel;
        let before = select(0f, results[at], view.follows != 0u);
        results[at] = fma(receiver.albedo[channel], dot_product(view.light[channel], transfer), before);
    }
}
