// No lamp shines.

fn lamplight(receiver: Receiver, visibility: Vector) -> vec3f {
    return vec3f();
}
