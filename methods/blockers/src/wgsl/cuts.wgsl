// A cluster's receivers look at the spheres of its cut (Ren 2006, §6.3), which the CPU makes: the twin of `clustered.rs`.

/// For each cluster its first sphere and the one after its last.
@group(0) @binding(LISTS) var<storage, read> lists: array<vec2u>;
/// For each sphere a factor for each band of its log (37).
@group(0) @binding(RATIOS) var<storage, read> ratios: array<Zonal>;

/// The first sphere that a receiver looks at, and the one after the last.
fn list(receiver: Receiver) -> vec2u {
    return lists[receiver.cluster];
}

/// The log of a sphere's circle, scaled to look like what the sphere bounds.
fn matched(log: Zonal, place: u32) -> Zonal {
    if settings.ratios == 0u {
        return log;
    }
    return scaled_bands(log, ratios[place]);
}
