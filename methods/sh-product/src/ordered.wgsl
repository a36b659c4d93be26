// The product from left to right: the twin of `ordered.rs`.

var<private> so_far: Vector;

fn begin() {}

fn set_kept(product: Vector) {
    so_far = product;
}

fn block(circle: Circle, before: u32, place: u32) {
    let visibility = rotate_zonal(circle_visibility(circle.sine), circle.direction);
    if before == 0u {
        so_far = visibility;
    } else {
        so_far = product(so_far, visibility);
    }
}

fn finish(circles: u32) -> Vector {
    work.products += circles - max(work.kept, 1u);
    return so_far;
}
