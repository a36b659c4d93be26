const TAPS: i32 = 2;

/// Shares of the samples before and after a point at `t` between them.
fn shares(t: f32) -> array<f32, 2> {
    return array(1f - t, t);
}
