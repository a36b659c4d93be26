
// HYB: the optimal linear fit, scaled and squared. `settings.method.x` is 2 to the offset of the squaring rule.

fn exponential(f: Vector) -> Vector {
    let given = isolated(f, settings.method.x, UNCLIPPED_NORM);
    return restored(squared(linear(given), given.squarings), given.mean);
}
