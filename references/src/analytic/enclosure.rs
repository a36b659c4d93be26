//! Light between the walls of a closed room.

/// Radiance in a closed enclosure whose walls all emit `emission` and are diffuse with `albedo` in `[0, 1)`, after all bounces:
/// `e/(1 − ρ)`.
pub fn enclosure(emission: f64, albedo: f64) -> f64 {
    emission / (1.0 - albedo)
}

/// The same after so many bounces: `e (1 + ρ + … + ρᵏ)`, the emission alone after none.
pub fn enclosure_after(emission: f64, albedo: f64, bounces: u32) -> f64 {
    (0..bounces).fold(emission, |radiance, _| emission + albedo * radiance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_furnace_is_one_and_bounces_converge_to_it() {
        assert_eq!(enclosure(0.5, 0.5), 1.0);
        assert_eq!(enclosure_after(0.5, 0.5, 0), 0.5);
        assert_eq!(enclosure_after(0.5, 0.5, 1), 0.75);
        for (emission, albedo) in [(0.5, 0.5), (3.0, 0.0), (0.1, 0.9)] {
            let (one, after) = (enclosure(emission, albedo), enclosure_after(emission, albedo, 400));
            assert!((after / one - 1.0).abs() < 1e-12, "{emission} {albedo}: {after} for {one}");
            // What arrives at a wall is what the walls send.
            assert!((one - (emission + albedo * one)).abs() < 1e-12);
        }
    }
}
