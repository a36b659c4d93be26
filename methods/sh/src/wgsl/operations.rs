//! How much arithmetic the generated functions are, counted in their text.

/// Additions and products of `f32` in functions of an order, a fused one counted as two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operations {
    /// `product(a, b)`.
    pub product: u64,
    /// `square(a)`.
    pub square: u64,
    /// `rotate_zonal(zonal, direction)`.
    pub rotate_zonal: u64,
}

/// What the generated functions of an order do.
///
/// # Panics
/// As [`algebra`](super::algebra).
pub fn operations(order: usize) -> Operations {
    let text = super::generated(order);
    let of = |function: &str| body(text, function).map_or(0, count);
    let pairs = body(text, "product").and_then(|body| body.split_once("pair < ")).map_or(0, |(_, rest)| number(rest));
    Operations {
        product: if pairs > 0 { pairs * of("product_on_pair") + of("product_at_poles") } else { of("product") },
        square: of("square"),
        rotate_zonal: of("rotate_zonal"),
    }
}

fn body<'t>(text: &'t str, function: &str) -> Option<&'t str> {
    let (_, rest) = text.split_once(&format!("fn {function}("))?;
    let (_, rest) = rest.split_once('\n')?;
    rest.split_once("\n}").map(|(body, _)| body)
}

fn count(body: &str) -> u64 {
    let of = |operation: &str| body.matches(operation).count() as u64;
    // Factors of 1 cost nothing.
    2 * of("fma(") + of(" * ") + of(" + ") + of(" - ") - of(" 1.0f * ")
}

fn number(text: &str) -> u64 {
    text.split('u').next().and_then(|digits| digits.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted by hand in `generated/order_1.wgsl` and `order_2.wgsl`.
    #[test]
    fn low_orders_are_as_counted_by_hand() {
        assert_eq!(operations(1), Operations { product: 2, square: 2, rotate_zonal: 0 });
        assert_eq!(operations(2), Operations { product: 19, square: 12, rotate_zonal: 3 });
    }

    /// A product takes less than a factor and a fused sum for each nonzero `Γ_ijk`, and no less than one operation for each that is not
    /// another's permutation.
    #[test]
    fn products_grow_as_triples_do() {
        for order in 1..=crate::MAX_ORDER {
            let (found, gamma) = (operations(order), crate::gamma(order));
            let [least, most] = [gamma.triples().len(), 3 * gamma.ordered_count()].map(|count| count as u64);
            assert!((least..=most).contains(&found.product), "{order}: {found:?}, {least} to {most}");
            assert!(found.square <= found.product && found.rotate_zonal + 1 >= order as u64, "{order}: {found:?}");
        }
    }
}
