
// PS-p: the plain product series (Ren 2006, eqs. 15–17). `settings.method.x` is p.

fn exponential(f: Vector) -> Vector {
    let degree = u32(settings.method.x);
    let first = renormalised(f);
    var term = first;
    var sum = Scaled(open_sky(), 0f);
    for (var power = 1u; power <= degree; power++) {
        if power > 1u {
            let next = scaled(1f / f32(power), product(first.vector, term.vector));
            let near = renormalised(next);
            term = Scaled(near.vector, term.exponent + first.exponent + near.exponent);
        }
        if term.exponent > sum.exponent {
            let shift = i32(max(sum.exponent - term.exponent, -126f));
            sum = Scaled(scaled(power_of_two(shift), sum.vector), term.exponent);
        }
        let shift = i32(max(term.exponent - sum.exponent, -126f));
        sum.vector = added(sum.vector, power_of_two(shift), term.vector);
    }
    work.products += degree - 1u;
    return restored(sum, 0f);
}
