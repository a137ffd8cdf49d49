use crate::ticks::{enclosing, grouped, linear, logarithmic, round_down, sound};
use proptest::prelude::*;

fn labels(low: f64, high: f64, most: usize) -> Vec<String> {
    linear(low, high, most).into_iter().map(|tick| tick.label).collect()
}

#[test]
fn labels_are_short_and_exact() {
    assert_eq!(labels(0.0, 1.0, 5), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    assert_eq!(labels(-5.0, 5.0, 4), ["-5", "0", "5"]);
    assert_eq!(labels(0.0, 5000.0, 5).last().unwrap(), "5000");
    assert_eq!(labels(0.0, 50_000.0, 5)[1..3], ["10k", "20k"]);
    assert_eq!(labels(0.0, 2.5e6, 5)[1], "0.5M");
    assert_eq!(labels(1e6, 1e6 + 3.0, 3)[1], "1000001");
    assert_eq!(labels(0.0, 3e-9, 3), ["0", "1e-9", "2e-9", "3e-9"]);
    assert_eq!(labels(0.0, 4e20, 4)[1], "1e20");
    assert_eq!(labels(0.31, 0.59, 6), ["0.35", "0.40", "0.45", "0.50", "0.55"]);
}

#[test]
fn invalid_ranges_become_valid() {
    for (low, high) in [
        (f64::NAN, 1.0),
        (0.0, f64::NAN),
        (f64::NEG_INFINITY, f64::INFINITY),
        (3.0, 3.0),
        (0.0, 0.0),
        (5.0, -5.0),
        (-1e308, 1e308),
        (-1e220, -1e170),
        (1e170, f64::INFINITY),
        (f64::MIN_POSITIVE, 2.0 * f64::MIN_POSITIVE),
        (1.0, 1.0 + f64::EPSILON),
    ] {
        let [a, b] = sound(low, high);
        assert!(a < b && (b - a).is_finite(), "{low} {high}");
        let ticks = linear(low, high, 6);
        assert!(ticks.len() >= 2, "{low} {high}: {ticks:?}");
    }
}

#[test]
fn logarithmic_ticks_thin_out_with_the_range() {
    let texts = |low, high, most| -> Vec<String> {
        let ticks = logarithmic(low, high, most).into_iter();
        ticks.map(|tick| tick.label).collect()
    };
    assert_eq!(texts(10.0, 160.0, 8), ["10", "20", "50", "100"]);
    assert_eq!(texts(1.0, 1e5, 8), ["1", "10", "100", "1000", "10k", "100k"]);
    assert_eq!(texts(1e-9, 1e9, 6).len(), 7);
    // Ticks are needed even if the range is less than one step of 1, 2, 5.
    assert!(texts(21.0, 49.0, 6).len() >= 2);
    assert_eq!(texts(0.7, 2.0, 4), ["1.0", "1.5", "2.0"]);
}

#[test]
fn lengths_of_scale_bars_are_round() {
    for (value, round) in [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (49.0, 20.0), (0.07, 0.05), (99.9, 50.0)] {
        assert_eq!(round_down(value), round, "{value}");
    }
    assert_eq!(round_down(0.0), 1.0);
    assert_eq!(round_down(f64::NAN), 1.0);
}

#[test]
fn thousands_are_grouped() {
    let texts = [0, 999, 1000, 100_000, 1_234_567].map(grouped);
    assert_eq!(texts, ["0", "999", "1,000", "100,000", "1,234,567"]);
}

proptest! {
    #[test]
    fn marks_are_whole_steps_in_order_inside_the_range(
        low in -1e6_f64..1e6,
        exponent in -6_i32..8,
        fraction in 1.0_f64..10.0,
        most in 5_usize..14,
    ) {
        let high = low + fraction * libm::pow(10.0, exponent.into());
        let [low, high] = sound(low, high);
        let ticks = linear(low, high, most);
        prop_assert!(ticks.len() >= 2 && ticks.len() <= most + 1, "{ticks:?}");
        // Only the first digit of this difference of doubles is exact.
        let step: f64 = format!("{:.0e}", ticks[1].value - ticks[0].value).parse().unwrap();
        let digit = step / libm::pow(10.0, libm::floor(libm::log10(step * 1.000_001)));
        prop_assert!([1.0, 2.0, 5.0].iter().any(|d| (digit - d).abs() < 1e-3), "step {step}");
        for pair in ticks.windows(2) {
            prop_assert!((pair[1].value - pair[0].value - step).abs() < 1e-6 * step.max(high.abs() * 1e-9));
            prop_assert!(pair[0].label != pair[1].label, "{ticks:?}");
        }
        for tick in &ticks {
            prop_assert!(tick.value >= low && tick.value <= high);
            let multiple = tick.value / step;
            prop_assert!((multiple - libm::round(multiple)).abs() < 1e-3, "{tick:?}");
            if let Ok(read) = tick.label.parse::<f64>() {
                prop_assert!((read - tick.value).abs() <= 1e-6 * step.max(read.abs()), "{tick:?}");
            }
        }
        prop_assert!((high - low) / step > most as f64 / 2.5 - 1e-6);
    }

    #[test]
    fn enclosing_ranges_begin_and_end_at_marks(low in -1e3_f64..1e3, span in 1e-3_f64..1e5, most in 2_usize..10) {
        let high = low + span;
        let [a, b] = enclosing(low, high, most);
        prop_assert!(a <= low && b >= high);
        prop_assert!(b - a <= 6.0 * span);
    }

    #[test]
    fn logarithmic_marks_are_in_order_inside_the_range(
        low in -8.0_f64..8.0, decades in 0.01_f64..20.0, most in 2_usize..14,
    ) {
        let (low, high) = (libm::pow(10.0, low), libm::pow(10.0, low + decades));
        let ticks = logarithmic(low, high, most);
        prop_assert!(ticks.len() <= most + 1);
        prop_assert!(ticks.windows(2).all(|pair| pair[0].value < pair[1].value && pair[0].label != pair[1].label));
        prop_assert!(ticks.iter().all(|tick| tick.value >= low * 0.999_999 && tick.value <= high * 1.000_001));
    }
}
