// Lights that share a swath, and a wedge of it.

struct View {
    /// The number of the swath's first azimuth among all.
    first: u32,
    wedges: u32,
    /// Coefficients of visibility that are written.
    coefficients: u32,
    /// Whether other views were added up before.
    follows: u32,
    /// A factor for each coefficient of visibility.
    window: array<f32, SIZE>,
    /// Radiance of each colour.
    light: array<array<f32, SIZE>, 3>,
}
