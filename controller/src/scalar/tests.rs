use super::*;
use proptest::prelude::*;

struct Tolerance {
    step: f64,
    relative: f64,
    root: f64,
    trig: f64,
    reduction: f64,
    atan: f64,
    exp: f64,
    ln: f64,
}

const F32: Tolerance = Tolerance {
    step: 1e-30,
    relative: 1.2e-7,
    root: 2e-7,
    trig: 1e-7,
    reduction: 0.0,
    atan: 3e-7,
    exp: 1.2e-7,
    ln: 1e-7,
};
const STEP: f64 = 1.0 / 65_536.0;
const Q16_: Tolerance = Tolerance {
    step: 0.501 * STEP,
    relative: 0.0,
    root: 0.0,
    trig: 0.51 * STEP,
    reduction: 0.0,
    atan: 0.55 * STEP,
    exp: 1e-8,
    ln: 0.9 * STEP,
};
const FAST: Tolerance = Tolerance {
    step: 1e-30,
    relative: 1.2e-7,
    root: 0.002,
    trig: 0.002,
    reduction: 1e-7,
    atan: 0.003,
    exp: 0.003,
    ln: 1e-4,
};

fn near(got: f64, exact: f64, absolute: f64, relative: f64) -> Result<(), TestCaseError> {
    let error = (got - exact).abs();
    prop_assert!(error <= absolute + relative * exact.abs(), "got {got}, exact {exact}, error {error:e}");
    Ok(())
}

fn agrees_with_f64<S: Scalar>(a: f64, b: f64, t: &Tolerance) -> Result<(), TestCaseError> {
    let (p, q) = (S::from_f64(a).unwrap(), S::from_f64(b).unwrap());
    let (a, b) = (p.to_f64(), q.to_f64());
    let in_range = |x: f64| x.abs() < S::MAX.to_f64();
    let basic = |got: S, exact: f64| match in_range(exact) {
        true => near(got.to_f64(), exact, t.step, t.relative),
        false => Ok(()),
    };
    basic(p + q, a + b)?;
    basic(p - q, a - b)?;
    basic(p * q, a * b)?;
    basic(-p, -a)?;
    basic(p.abs(), a.abs())?;
    match p.checked_div(q) {
        Some(quotient) => basic(quotient, a / b)?,
        None => prop_assert!(b == 0.0 || !in_range(a / b)),
    }
    prop_assert_eq!(p.min(q).to_f64(), a.min(b));
    prop_assert_eq!(p.max(q).to_f64(), a.max(b));
    prop_assert_eq!(p.order(q), a.total_cmp(&b));
    prop_assert_eq!(p.floor_to_i32(), Some(libm::floor(a) as i32));
    let milli = f64::from(p.to_milli().unwrap());
    near(milli, a * 1e3, 0.5, t.relative)?;

    let whole = libm::trunc(a) as i32;
    basic(S::from_i32(whole), whole.into())?;
    basic(S::from_milli(whole), f64::from(whole) / 1e3)?;
    basic(S::from_micro(whole), f64::from(whole) / 1e6)?;
    if b != 0.0 {
        let (n, d) = (whole, libm::ceil(b.abs()) as i32);
        basic(S::from_ratio(n, d), f64::from(n) / f64::from(d))?;
    }

    // Fixed point rounds roots down, hence two half steps.
    let root_step = 2.0 * t.step;
    near(p.abs().sqrt().to_f64(), libm::sqrt(a.abs()), root_step, t.root)?;
    let length = libm::sqrt(a * a + b * b + 1.0);
    if in_range(length) {
        let norm = S::norm([p, S::ONE, q]).to_f64();
        near(norm, length, root_step, t.root)?;
    }
    let unit = S::unit([q, p, S::ONE]).unwrap();
    for (got, exact) in unit.iter().zip([b, a, 1.0]) {
        near(got.to_f64(), exact / length, 1.01 * t.step, t.root)?;
    }
    let (sin, cos) = p.sin_cos();
    let trig = t.trig + t.reduction * a.abs();
    near(sin.to_f64(), libm::sin(a), trig, 0.0)?;
    near(cos.to_f64(), libm::cos(a), trig, 0.0)?;
    near(p.atan2(q).to_f64(), libm::atan2(a, b), t.atan, 0.0)?;
    let exp = libm::exp(a);
    if in_range(exp) && (1e-30..1e38).contains(&exp) {
        near(p.exp().to_f64(), exp, t.step, t.exp)?;
    }
    match p.ln() {
        Some(ln) => near(ln.to_f64(), libm::log(a), t.ln, 1e-6)?,
        None => prop_assert!(a <= 0.0),
    }
    Ok(())
}

fn number() -> impl Strategy<Value = f64> {
    let magnitude = (-12..15i32, 1.0..2.0f64, any::<bool>()).prop_map(|(e, m, negative)| {
        let x = libm::scalbn(m, e);
        if negative { -x } else { x }
    });
    prop_oneof![9 => magnitude, 1 => Just(0.0)]
}

fn survives<S: Scalar>(a: S, b: S, c: S) {
    let (sum, product) = (a + b, a * b);
    let _ = (sum - c, -product, a.abs(), a.checked_div(b));
    let (sin, cos) = a.sin_cos();
    if a.is_finite() {
        let bound = S::from_ratio(101, 100);
        assert!(sin.abs() <= bound && cos.abs() <= bound);
    }
    let _ = (a.atan2(b), a.exp(), a.ln(), a.sqrt(), a.floor_to_i32());
    let _ = (a.to_milli(), a.to_f64(), a.to_bits(), S::norm([a, b, c]));
    if let Some(unit) = S::unit([a, b, c]) {
        let length = S::norm(unit);
        let margin = S::from_ratio(1, 100);
        assert!(S::ONE - margin < length && length < S::ONE + margin);
    }
    let order = a.order(b);
    assert_eq!(order, b.order(a).reverse());
    assert_eq!(a.order(a), Ordering::Equal);
    assert!(order != Ordering::Less || b.order(c) != Ordering::Less || a.order(c).is_lt());
    let clamped = a.clamp(b, c);
    if b <= c {
        assert_eq!(b <= clamped && clamped <= c, a.to_f64() == a.to_f64());
    }
    let unknown = [a, b, c].iter().any(|x| x.to_f64().is_nan());
    assert_eq!(S::length_key([a, b, c]) == u64::MAX, unknown);
}

proptest! {
    #[test]
    fn f32_agrees_with_f64(a in number(), b in number()) {
        agrees_with_f64::<f32>(a, b, &F32)?;
    }

    #[test]
    fn q16_agrees_with_f64(a in number(), b in number()) {
        agrees_with_f64::<Q16>(a, b, &Q16_)?;
    }

    #[test]
    fn fast32_agrees_with_f64(a in number(), b in number()) {
        agrees_with_f64::<Fast32>(a, b, &FAST)?;
    }

    #[test]
    fn no_bits_make_f32_panic(a: u32, b: u32, c: u32) {
        let [a, b, c] = [a, b, c].map(f32::from_bits);
        survives(a, b, c);
        survives(Fast32(a), Fast32(b), Fast32(c));
    }

    #[test]
    fn no_bits_make_f64_panic(a: u64, b: u64, c: u64) {
        survives(f64::from_bits(a), f64::from_bits(b), f64::from_bits(c));
    }

    #[test]
    fn no_bits_make_q16_panic(a: i32, b: i32, c: i32, shift in 0..32u32) {
        let [a, b, c] = [a, b, c].map(|bits| Q16::from_bits(bits >> shift));
        survives(a, b, c);
    }

    #[test]
    fn any_integers_convert(n: i32, d: i32, shifts in any::<[u8; 2]>()) {
        fn all<S: Scalar>(n: i32, d: i32, t: &Tolerance) -> Result<(), TestCaseError> {
            let (whole, below, most) = (f64::from(n), f64::from(d), S::MAX.to_f64());
            for (x, exact) in [
                (S::from_i32(n), whole),
                (S::from_milli(n), whole / 1e3),
                (S::from_micro(n), whole / 1e6),
                (S::from_ratio(n, d), if d == 0 { f64::NAN } else { whole / below }),
            ] {
                // Numerator, denominator and quotient are rounded.
                if !exact.is_nan() {
                    near(x.to_f64(), exact.clamp(-most - S::EPSILON.to_f64(), most), 1.05 * t.step, 2.0 * t.relative)?;
                }
            }
            Ok(())
        }
        let [n, d] = [n >> (shifts[0] % 32), d >> (shifts[1] % 32)];
        all::<f32>(n, d, &F32)?;
        all::<f64>(n, d, &Tolerance { relative: 3e-16, ..F32 })?;
        all::<Q16>(n, d, &Q16_)?;
        all::<Fast32>(n, d, &FAST)?;
    }

    #[test]
    fn length_keys_order_vectors_like_exact_squares(v: [i32; 3], w: [i32; 3]) {
        let square = |v: [i32; 3]| v.iter().map(|&c| i128::from(c) * i128::from(c)).sum::<i128>();
        let key = |v: [i32; 3]| Q16::length_key(v.map(Q16::from_bits));
        prop_assert_eq!(key(v).cmp(&key(w)), square(v).cmp(&square(w)));
        let key = |v: [i32; 3]| f64::length_key(v.map(f64::from));
        prop_assert!((square(v) - square(w)).abs() < 1 << 20 || (key(v) < key(w)) == (square(v) < square(w)));
    }
}

#[test]
fn constants_have_their_values() {
    fn check<S: Scalar>() {
        assert_eq!(S::ZERO.to_f64(), 0.0);
        assert_eq!(S::ONE.to_f64(), 1.0);
        assert_eq!(S::TWO.to_f64(), 2.0);
        assert_eq!(S::HALF.to_f64(), 0.5);
        assert!((S::PI.to_f64() - core::f64::consts::PI).abs() <= S::EPSILON.to_f64());
        assert!(S::ONE + S::EPSILON > S::ONE);
        assert!(S::ONE + S::EPSILON * S::from_ratio(1, 8) == S::ONE);
        assert!(S::MAX.is_finite() && -S::MAX < S::ZERO);
        assert_eq!(S::default(), S::ZERO);
    }
    check::<f32>();
    check::<f64>();
    check::<Q16>();
    check::<Fast32>();
}

#[test]
fn boundary_cases_have_defined_results() {
    fn check<S: Scalar>() {
        assert_eq!(S::ONE.checked_div(S::ZERO), None);
        assert_eq!(S::ZERO.checked_div(S::ZERO), None);
        assert_eq!(S::MAX.checked_div(S::from_ratio(1, 1000)), None);
        assert_eq!(S::ZERO.sqrt(), S::ZERO);
        assert_eq!((-S::ZERO).sqrt(), S::ZERO);
        assert_eq!((-S::ONE).sqrt(), S::ZERO);
        assert_eq!(S::ZERO.atan2(S::ZERO), S::ZERO);
        assert_eq!(S::ZERO.atan2(-S::ONE), S::PI);
        assert_eq!(S::ZERO.ln(), None);
        assert_eq!((-S::ONE).ln(), None);
        assert_eq!(S::ONE.ln(), Some(S::ZERO));
        assert_eq!(S::ZERO.exp(), S::ONE);
        assert_eq!((-S::MAX).exp(), S::ZERO);
        assert!(S::MAX.exp() >= S::MAX);
        assert_eq!(S::unit([S::ZERO; 3]), None);
        assert_eq!(S::ONE.clamp(S::TWO, S::ZERO), S::ZERO);
        assert_eq!((-S::HALF).floor_to_i32(), Some(-1));
        assert_eq!(S::from_milli(-1_500).to_milli(), Some(-1_500));
        assert_eq!(S::from_f64(f64::NAN), None);
        assert_eq!(S::from_f64(f64::INFINITY), Some(S::MAX));
    }
    check::<f32>();
    check::<f64>();
    check::<Q16>();
    check::<Fast32>();
}

#[test]
fn nan_fails_closed() {
    fn check<S: Scalar>(nan: S, infinity: S) {
        assert!(!nan.is_finite() && !infinity.is_finite());
        for x in [nan.min(S::ONE), S::ONE.min(nan), nan.max(S::ONE), S::ONE.max(nan)] {
            assert!(x.to_f64().is_nan());
        }
        assert!(nan.clamp(S::ZERO, S::ONE).to_f64().is_nan());
        assert!(nan.sqrt().to_f64().is_nan() && nan.exp().to_f64().is_nan());
        assert!(nan.sin_cos().0.to_f64().is_nan() && infinity.sin_cos().1.to_f64().is_nan());
        assert!(nan.atan2(S::ONE).to_f64().is_nan() && S::ONE.atan2(nan).to_f64().is_nan());
        assert_eq!(infinity.sqrt(), infinity);
        assert_eq!(nan.ln(), None);
        assert_eq!(infinity.ln(), Some(infinity));
        assert_eq!((nan.to_milli(), nan.floor_to_i32()), (None, None));
        assert_eq!(infinity.to_milli(), Some(i32::MAX));
        assert_eq!(infinity.floor_to_i32(), None);
        assert_eq!(nan.checked_div(S::ONE), None);
        assert_eq!(S::unit([S::ONE, nan, S::ZERO]), None);
        assert_eq!(S::unit([S::ONE, infinity, S::ZERO]), None);
        assert_eq!(nan.order(infinity), Ordering::Greater);
        assert_eq!((-nan).order(-infinity), Ordering::Greater);
        assert_eq!((-nan).to_bits(), nan.to_bits());
        assert!(S::length_key([nan, S::ZERO, S::ZERO]) > S::length_key([infinity; 3]));
    }
    check(f32::NAN, f32::INFINITY);
    check(f64::NAN, f64::INFINITY);
    check(Fast32(f32::NAN), Fast32(f32::INFINITY));
}

#[test]
fn q16_saturates_at_both_ends() {
    let (max, min) = (Q16::MAX, Q16::from_bits(i32::MIN));
    assert_eq!(max + Q16::EPSILON, max);
    assert_eq!(min - Q16::EPSILON, min);
    assert_eq!(-min, max);
    assert_eq!(min.abs(), max);
    assert_eq!(min * min, max);
    assert_eq!(min * max, min);
    assert_eq!(min.checked_div(-Q16::ONE), None);
    assert_eq!(Q16::from_i32(40_000), max);
    assert_eq!(Q16::from_milli(i32::MIN), min);
    assert_eq!(Q16::from_ratio(1, 0), max);
    assert_eq!(Q16::from_ratio(-1, 0), min);
    assert_eq!(Q16::from_ratio(i32::MIN, -1), max);
    assert_eq!(Q16::norm([min; 3]), max);
    assert_eq!(min.to_milli(), Some(-32_768_000));
}

#[test]
fn q16_direction_of_one_step_is_exact() {
    let step = Q16::EPSILON;
    let [x, y, _] = Q16::unit([step, -step, Q16::ZERO]).unwrap();
    assert_eq!((x.bits(), y.bits()), (46_341, -46_341));
    let min = Q16::from_bits(i32::MIN);
    assert_eq!(Q16::unit([min, Q16::ZERO, step]), Some([-Q16::ONE, Q16::ZERO, Q16::ZERO]));
}

fn sweep<S: Scalar>() -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325u64;
    let mut rng = crate::rand::Rng::new(1);
    let mut draw = || {
        let wide = rng.next_u64();
        S::from_ratio((wide as i32) >> ((wide >> 32) & 31), 1 << ((wide >> 40) & 15))
    };
    for _ in 0..10_000 {
        let (a, b) = (draw(), draw());
        let (sin, cos) = a.sin_cos();
        let [x, y, _] = S::unit([a, b, S::ONE]).unwrap();
        let quotient = a.checked_div(b).unwrap_or_default();
        let ln = a.ln().unwrap_or_default();
        for result in [a * b, a + b, quotient, sin, cos, a.atan2(b), a.exp(), ln, a.abs().sqrt(), x, y] {
            hash = (hash ^ result.to_bits()).wrapping_mul(0x100_0000_01B3);
        }
    }
    hash
}

#[test]
fn bits_are_pinned() {
    // Recorded runs depend on these bits.
    let (sin, cos) = Scalar::sin_cos(1f32);
    let known = [sin, cos, Scalar::exp(1f32), Scalar::sqrt(2f32), Scalar::atan2(1f32, 2.0)];
    let bits = [0x3F57_6AA4, 0x3F0A_5140, 0x402D_F854, 0x3FB5_04F3, 0x3EED_6338];
    assert_eq!(known.map(f32::to_bits), bits);
    assert_eq!(Scalar::ln(2f32).map(f32::to_bits), Some(0x3F31_7218));
    assert_eq!(sweep::<f32>(), 0x93A9_039E_72AC_6459);
    assert_eq!(sweep::<f64>(), 0x3DE6_F148_B728_ADA9);
    assert_eq!(sweep::<Q16>(), 0x88D0_72D3_E208_77B4);
    assert_eq!(sweep::<Fast32>(), 0x1A26_2972_5E7C_82B8);
}
