//! Q16.16 beside the crate `fixed`.

use fixed::types::I16F16;
use proptest::prelude::*;
use staya_controller::scalar::{Q16, Scalar as _};

proptest! {
    #[test]
    fn q16_computes_as_the_crate_fixed_does(a: i32, b: i32, shift in 0..32u32) {
        let (p, q) = (Q16::from_bits(a >> shift), Q16::from_bits(b >> shift));
        let (x, y) = (I16F16::from(p), I16F16::from(q));
        prop_assert_eq!((x.to_bits(), Q16::from(x)), (p.bits(), p));
        prop_assert_eq!((p + q).bits(), x.saturating_add(y).to_bits());
        prop_assert_eq!((p - q).bits(), x.saturating_sub(y).to_bits());
        prop_assert_eq!((-p).bits(), x.saturating_neg().to_bits());
        prop_assert_eq!(p.cmp(&q), x.cmp(&y));
        prop_assert_eq!((p.to_f32(), p.to_f64()), (x.to_num::<f32>(), x.to_num::<f64>()));
        prop_assert_eq!(p.floor_to_i32(), Some(x.to_num::<i32>()));
        prop_assert_eq!(Q16::from_i32(a), Q16::from(I16F16::saturating_from_num(a)));
    }
}
