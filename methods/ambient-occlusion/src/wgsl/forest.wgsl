// The trees of all objects: parents before children, first child next to its parent.

struct Forest {
    nodes: u32,
    /// First node after all that lie below: the next one for an element.
    next: array<u32>,
}

@group(0) @binding(0) var<storage, read> forest: Forest;

fn children(node: u32) -> vec2u {
    return vec2u(node + 1u, forest.next[node + 1u]);
}
