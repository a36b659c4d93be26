//! Fig. 8: orders under the sharpest light that they can hold.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::{alone, beside, direct, from_above};
use crate::ledger::Bench;
use glam::Vec3;
use halflight_reports::Sheet;
use halflight_scenes::{KeyLight, Light};

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig8",
    place: "Ren et al. 2006, Fig. 8",
    shows: "60 spheres over a ground of 200×200 receivers at orders 3 to 6, a light as narrow as the order allows",
    look: "Shadows sharpen and tell spheres apart as the order grows. The maps show SHEXP (PS*-2) less the product of the same order; printed: \
           1.9, 3.4, 6.5 and 11.0 times the product's speed.",
    make,
};

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let mut scene = from_above("spheres-60", Vec3::ZERO, 6.4, 200)?;
    let angular_radius = 1f32.to_radians();
    let radiance = Vec3::splat(1.0 / angular_radius.sin().powi(2));
    scene.lights.truncate(1);
    let direction = Vec3::new(-1.0, 0.6, 1.2).normalize();
    scene.lights[0].rest = Light::Key(KeyLight { direction, angular_radius, radiance });
    let scene = scene.as_changed();
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let mut seen = Vec::new();
    for order in ["3", "4", "5", "6"] {
        let exp = asked.shaded("shexp/ps-star", &[("order", order), ("p", "2")])?;
        seen.push((order, exp, asked.shaded("sh-product/ordered", &[("order", order)])?));
    }
    let mut shown = Vec::new();
    for (order, exp, product) in &seen {
        shown.push(beside(format!("SHEXP, n = {order}"), exp, product)?);
    }
    shown.extend(seen.last().map(|(order, _, product)| alone(format!("SH product, n = {order}"), product)));
    sheet.pictures(&shown)?;
    claim(bench, sheet, "S3")
}
