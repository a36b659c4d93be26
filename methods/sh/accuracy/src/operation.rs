//! The operations that are measured, and the errors that they are stated to keep.

/// An operation with what is stated of its errors.
#[derive(Debug)]
pub struct Operation {
    /// As tables print it.
    pub name: &'static str,
    /// What errors are divided by.
    pub relative_to: &'static str,
    /// The largest error in `f32` at orders 1 to 8.
    pub single: [f64; 8],
    /// The largest error in `f64`; NaN where there is no such instance.
    pub double: f64,
}

/// What distinguishes rounding from approximation: the same at every order.
const fn all(bound: f64) -> [f64; 8] {
    [bound; 8]
}

macro_rules! operations {
    ($($name:ident: $text:literal, $relative:literal, $single:expr, $double:expr;)*) => {
        $(pub(crate) static $name: Operation =
            Operation { name: $text, relative_to: $relative, single: $single, double: $double };)*
        /// All operations, in the order of tables.
        pub static OPERATIONS: &[&Operation] = &[$(&$name),*];
    };
}

/// Products err most for narrow lobes, whose product with themselves is up to 1.4 ‖a‖‖b‖ long; to and from the rings and there
/// every step rounds as much, so that no single compensated sum would halve it.
const PRODUCTS: [f64; 8] = [1e-7, 1e-7, 1.5e-7, 2.5e-7, 2.5e-7, 3e-7, 4e-7, 5e-7];

operations! {
    EVALUATE: "evaluate", "n", [3e-8, 4e-8, 5e-8, 7e-8, 1e-7, 2e-7, 2e-7, 3e-7], 2e-15;
    PRODUCT: "product", "‖a‖‖b‖", PRODUCTS, 2e-14;
    SPARSE: "product, sparse loop", "‖a‖‖b‖", PRODUCTS, 2e-14;
    SQUARE: "square", "‖a‖²", PRODUCTS, 2e-14;
    MATRIX: "product matrix times vector", "‖a‖‖b‖", PRODUCTS, 2e-14;
    TRIPLE: "triple product", "n‖a‖‖b‖‖c‖", all(1e-7), 5e-15;
    ZONAL: "zonal rotation", "n‖zonal‖", all(3e-7), 2e-15;
    ROTATION: "general rotation", "‖f‖", all(2e-7), 1e-14;
    ROTATION_Z: "rotation about z", "‖f‖", [2e-7, 2e-7, 3e-7, 4e-7, 5e-7, 6e-7, 7e-7, 8e-7], 1e-14;
    CIRCLE: "circle visibility", "1", all(2e-6), 2.5e-7;
    CIRCLE_LOG: "circle log", "1 or the largest", [3e-6, 3e-6, 3e-6, 3e-6, 3e-6, 3e-6, 5e-6, 1e-4], 1e-4;
    LOG: "eigen log", "‖g‖", all(f64::NAN), 2e-14;
    REPRODUCTION: "eigen exp of eigen log, circles to 90°", "‖g‖", all(f64::NAN), 0.08;
    PS_8: "exp PS-8", "‖exp‖", all(0.7), 0.7;
    PS_21: "exp PS-21", "‖exp‖", [5e-6, 5e-6, 5e-6, 5e-6, 5e-6, 5e-6, 1.5e-5, 1.5e-5], 3e-8;
    SCALED_2: "exp PS*-2", "‖exp‖", [3e-7, 4e-4, 9e-4, 1e-3, 1.5e-3, 3e-3, 5e-3, 7e-3], 7e-3;
    SCALED_5: "exp PS*-5", "‖exp‖", [3e-7, 2e-6, 4e-4, 6e-4, 1.5e-3, 3e-3, 5e-3, 7e-3], 7e-3;
    LINEAR: "exp OL", "‖exp‖", [3e-7, 3e-7, 0.2, 0.25, 0.3, 0.4, 0.4, 0.4], 0.4;
    HYBRID: "exp HYB", "‖exp‖", [3e-7, 2e-6, 0.04, 0.05, 0.08, 0.12, 0.12, 0.12], 0.12;
    EIGEN: "exp eigen", "‖exp‖", all(1e-7), 2e-14;
}

impl Operation {
    /// The largest error that is stated at an order in a precision (`f32` or `f64`).
    pub fn stated(&self, order: usize, precision: &str) -> f64 {
        if precision == "f32" { self.single[order - 1] } else { self.double }
    }
}
