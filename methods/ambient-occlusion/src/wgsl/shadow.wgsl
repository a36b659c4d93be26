// The sum of shadows at a point: the twin of `Forest::shadow`. Before it stands `forest.wgsl`.

/// Position; squared distance up to which a group is opened, below 0 for an element.
@group(0) @binding(1) var<storage, read> places: array<vec4f>;
/// Normal as far as it casts; area over π.
@group(0) @binding(2) var<storage, read> casters: array<vec4f>;
/// Low and high words of: nodes summed, those of them that face the point, walks that did not come to their end.
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>, 6>;

/// The same of the threads of a group, so that few meet at the counters of all.
var<workgroup> together: array<atomic<u32>, 3>;

struct Shadow {
    sum: f32,
    nodes: u32,
    facing: u32,
    unfinished: u32,
}

fn shadow(position: vec3f, normal: vec3f) -> Shadow {
    var shadow = Shadow();
    var node = 0u;
    while node < forest.nodes {
        let place = places[node];
        let to = place.xyz - position;
        // In the order of `Points::to`, so that both backends open the same groups; `dot` may take another.
        let square = to.x * to.x + to.y * to.y + to.z * to.z;
        if square <= place.w {
            node++;
        } else {
            add(casters[node], to, square, normal, &shadow);
            node = forest.next[node];
        }
    }
    // A driver may end loops that it finds too long.
    shadow.unfinished = u32(node < forest.nodes);
    return shadow;
}

/// Adds a node's shadow: `ElementShadow` of Bunnell 2005.
fn add(caster: vec4f, to: vec3f, square: f32, normal: vec3f, shadow: ptr<function, Shadow>) {
    const LEAST = 1.1754944e-38f;
    let area = caster.w;
    let back = dot(caster.xyz, to);
    let front = 4f * dot(normal, to);
    shadow.nodes++;
    // Within its own radius an element shadows nothing: such a point lies on it.
    if !(back > 0f && front > 0f) || square < max(area, LEAST) {
        return;
    }
    let distance = sqrt(square);
    // 1 − 1/√(A/πr² + 1) without cancellation.
    let rim = sqrt(square + area);
    let cover = area / (rim * (rim + distance));
    let near = 1f / distance;
    shadow.sum += cover * min(near * back, 1f) * min(near * front, 1f);
    shadow.facing++;
}

/// What remains of the hemisphere under a sum of shadows.
fn accessibility(shadow: f32) -> f32 {
    return max(1f - shadow, 0f);
}

/// Counts for all threads of a group, each of which calls it.
fn tell(shadow: Shadow, place: u32) {
    atomicAdd(&together[0], shadow.nodes);
    atomicAdd(&together[1], shadow.facing);
    atomicAdd(&together[2], shadow.unfinished);
    workgroupBarrier();
    if place < 3u {
        count(place, atomicLoad(&together[place]));
    }
}

fn count(counter: u32, amount: u32) {
    let before = atomicAdd(&counters[2u * counter], amount);
    if before + amount < before {
        atomicAdd(&counters[2u * counter + 1u], 1u);
    }
}
