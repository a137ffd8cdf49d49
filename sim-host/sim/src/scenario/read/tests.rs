use super::*;

#[test]
fn huge_and_tiny_numbers_have_an_exponent() {
    for (value, text) in
        [(1e308, "1e308"), (-2.5e-9, "-2.5e-9"), (600_000.0, "600000"), (0.0, "0"), (-1.5, "-1.5"), (f64::NAN, "NaN")]
    {
        assert_eq!(short(value), text);
    }
}

#[test]
fn whole_numbers_may_have_a_point_or_an_exponent() {
    let read = |text: &str| {
        let node = Spanned::new(0..0, DeValue::parse(text).unwrap().into_inner());
        u32::read(&node).map_err(|wrong| wrong.what)
    };
    for (text, value) in [("30", 30), ("30.0", 30), ("3e1", 30), ("0.0", 0), ("-0.0", 0), ("0x1e", 30), ("1_0.0", 10)] {
        assert_eq!(read(text), Ok(value), "{text}");
    }
    for (text, said) in
        [("30.5", "30.5"), ("-1.0", "-1"), ("1e10", "10000000000"), ("1e300", "1e300"), ("nan", "NaN"), ("inf", "inf")]
    {
        assert_eq!(read(text), Err(format!("{said} is not a whole number from 0 to 4294967295")), "{text}");
    }
}
