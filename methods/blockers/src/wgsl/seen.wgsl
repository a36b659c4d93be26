// Spheres as a receiver sees them: the twin of `seen.rs`.

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
