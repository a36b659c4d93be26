// Groups cast as the mean by area of what they consist of: the second half of `Forest::cast`, a thread a group. A pass does the groups
// of one height, those below were done before. Before it stands `forest.wgsl`.

@group(0) @binding(1) var<storage, read> level: array<u32>;
@group(0) @binding(2) var<storage, read_write> casting: array<vec4f>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) place: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + place;
    if index >= arrayLength(&level) {
        return;
    }
    let node = level[index];
    let children = children(node);
    let a = casting[children.x];
    let b = casting[children.y];
    let area = a.w + b.w;
    var share = 0.5f;
    if area > 0f {
        share = a.w / area;
    }
    casting[node] = vec4f(share * a.xyz + (1f - share) * b.xyz, area);
}
