// Light at receivers, a thread a receiver. Before it stand the algebra of the light's order (`halflight_sh::wgsl::generated`) and
// `shadow.wgsl`.

struct Receiver {
    position: vec3f,
    normal: vec3f,
    albedo: vec3f,
}

/// Of each colour.
@group(0) @binding(4) var<storage, read> light: array<Vector, 3>;
@group(0) @binding(5) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(6) var<storage, read_write> results: array<f32>;

fn shade(index: u32) -> Shadow {
    let receiver = receivers[index];
    let shadow = shadow(receiver.position, receiver.normal);
    let weights = rotate_zonal(CLAMPED_COSINE, receiver.normal);
    for (var channel = 0u; channel < 3u; channel++) {
        var irradiance = 0f;
        for (var i = 0u; i < SIZE; i++) {
            irradiance = fma(light[channel][i], weights[i], irradiance);
        }
        results[3u * index + channel] = receiver.albedo[channel] * irradiance * accessibility(shadow.sum);
    }
    return shadow;
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + place;
    var shadow = Shadow();
    if index < arrayLength(&receivers) {
        shadow = shade(index);
    }
    tell(shadow, place);
}
