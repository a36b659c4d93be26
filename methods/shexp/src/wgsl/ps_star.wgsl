
// PS*-p: the factored product series, scaled and squared (Ren 2006, eq. 22). `settings.method` holds 2 to the offset of the squaring
// rule, the norm from which more squarings are forced, and p.

fn exponential(f: Vector) -> Vector {
    let given = isolated(f, settings.method.x, settings.method.y);
    return restored(squared(series(given.residual, u32(settings.method.z)), given.squarings), given.mean);
}

/// Even powers one from the other, so that two vectors are held instead of all: where the CPU squares the half power, this is a product.
fn series(residual: Vector, degree: u32) -> Vector {
    var even = open_sky();
    var odd = open_sky();
    if degree >= 2u {
        let square_of_it = square(residual);
        work.squares += 1u;
        var power = square_of_it;
        var reciprocal = 1f;
        for (var k = 1u; k <= degree / 2u; k++) {
            if k > 1u {
                power = product(power, square_of_it);
                work.products += 1u;
            }
            reciprocal /= f32(2u * k);
            even = added(even, reciprocal, power);
            reciprocal /= f32(2u * k + 1u);
            if 2u * k + 1u <= degree {
                odd = added(odd, reciprocal, power);
            }
        }
    }
    if degree < 3u {
        return added(even, 1f, residual);
    }
    work.products += 1u;
    return added(even, 1f, product(residual, odd));
}
