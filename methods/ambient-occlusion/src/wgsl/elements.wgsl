// Elements cast as far as they are accessible: the first half of `Forest::cast`, a thread an element. Before it stands `shadow.wgsl`,
// whose casters are the elements' normals.

@group(0) @binding(4) var<storage, read> elements: array<u32>;
@group(0) @binding(5) var<storage, read_write> casting: array<vec4f>;

/// The direction of a mean of normals, which may be 0.
fn direction(normal: vec3f) -> vec3f {
    let square = dot(normal, normal);
    if square > 0f {
        return normal / sqrt(square);
    }
    return vec3f();
}

fn shaded_by_others(element: u32) -> Shadow {
    let caster = casters[element];
    let shadow = shadow(places[element].xyz, direction(caster.xyz));
    casting[element] = vec4f(accessibility(shadow.sum) * caster.xyz, caster.w);
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
    if index < arrayLength(&elements) {
        shadow = shaded_by_others(elements[index]);
    }
    tell(shadow, place);
}
