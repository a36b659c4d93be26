const TAPS: i32 = 4;

/// Shares of the two samples before and the two after a point at `t` between the inner ones (eq. 4).
fn shares(t: f32) -> array<f32, 4> {
    let u = 1f - t;
    return array(outer(u), inner(t), inner(u), outer(t));
}

fn inner(t: f32) -> f32 {
    return fma(t * t, fma(t, 0.5f, -1f), 2f / 3f);
}

fn outer(t: f32) -> f32 {
    return t * t * t * (1f / 6f);
}
