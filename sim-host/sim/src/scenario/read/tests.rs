use super::*;

#[test]
fn huge_and_tiny_numbers_have_an_exponent() {
    for (value, text) in
        [(1e308, "1e308"), (-2.5e-9, "-2.5e-9"), (600_000.0, "600000"), (0.0, "0"), (-1.5, "-1.5"), (f64::NAN, "NaN")]
    {
        assert_eq!(short(value), text);
    }
}
