//! Ticks of an axis: multiples of 1, 2 or 5 times a power of ten.

/// A tick of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Value on the axis.
    pub value: f64,
    /// Number as shown.
    pub label: String,
}

/// Returns a valid range of an axis: finite, rising, and wide enough for ticks.
#[must_use]
pub fn sound(low: f64, high: f64) -> [f64; 2] {
    // Beyond this, differences would overflow.
    const MOST: f64 = 1e150;
    if low.is_nan() || high.is_nan() {
        return [0.0, 1.0];
    }
    let within = |value: f64| value.clamp(-MOST, MOST);
    let (low, high) = (within(low.min(high)), within(high.max(low)));
    let largest = low.abs().max(high.abs());
    if high - low > 1e-9 * largest && high - low > 1e-150 {
        return [low, high];
    }
    let half = if largest == 0.0 { 0.5 } else { largest * 0.1 };
    [low - half, high + half]
}

#[derive(Clone, Copy)]
struct Step {
    mantissa: i64,
    exponent: i32,
}

impl Step {
    fn new(span: f64, most: usize) -> Self {
        let wanted = span / most.max(1) as f64 * (1.0 - 1e-12);
        let exponent = libm::floor(libm::log10(wanted)) as i32;
        for mantissa in [1, 2, 5] {
            let step = Self { mantissa, exponent };
            if step.times(1) >= wanted {
                return step;
            }
        }
        Self { mantissa: 1, exponent: exponent + 1 }
    }

    /// Nearest double, computed in decimals so that 3 x 0.1 is 0.3.
    fn times(self, count: i64) -> f64 {
        let digits = count * self.mantissa;
        format!("{digits}e{}", self.exponent).parse().unwrap_or(f64::NAN)
    }

    fn index(self, value: f64, round: fn(f64) -> f64) -> i64 {
        let near = value / self.times(1);
        // A multiple except for rounding counts as one.
        let whole = libm::round(near);
        let tolerance = 1e-9 + 4.0 * f64::EPSILON * whole.abs();
        (if (near - whole).abs() < tolerance { whole } else { round(near) }) as i64
    }
}

/// Widens the range to whole steps, at most `most` of them before widening.
#[must_use]
pub fn enclosing(low: f64, high: f64, most: usize) -> [f64; 2] {
    let [low, high] = sound(low, high);
    let step = Step::new(high - low, most);
    [step.times(step.index(low, libm::floor)).min(low), step.times(step.index(high, libm::ceil)).max(high)]
}

/// Largest 1, 2 or 5 x 10^k up to `value`; 1 if `value` is not a positive number.
#[must_use]
pub fn round_down(value: f64) -> f64 {
    if !value.is_finite() || value <= 0.0 {
        return 1.0;
    }
    let exponent = libm::floor(libm::log10(value)) as i32;
    [(5, exponent), (2, exponent), (1, exponent), (5, exponent - 1)]
        .into_iter()
        .map(|(mantissa, exponent)| Step { mantissa, exponent }.times(1))
        .find(|step| *step <= value)
        .unwrap_or(value)
}

/// Ticks from `low` to `high`, both ends included, with at most `most` steps between them.
#[must_use]
pub fn linear(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let [low, high] = sound(low, high);
    let step = Step::new(high - low, most);
    let (first, last) = (step.index(low, libm::ceil), step.index(high, libm::floor));
    let largest = low.abs().max(high.abs());
    (first..=last)
        .map(|count| {
            let value = step.times(count);
            Tick { value: value.clamp(low, high), label: label(value, step, largest) }
        })
        .collect()
}

/// Decimals of the step; k, M, G, T for thousands and above; else a power of ten.
fn label(value: f64, step: Step, largest: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if largest >= 1e15 || (step.exponent < -5 && largest < 1e-3) {
        return format!("{value:e}");
    }
    // At most two decimals before a suffix: 19.95k, but 1000001.
    let (suffix, power) = [("T", 12), ("G", 9), ("M", 6), ("k", 3)]
        .into_iter()
        .find(|(_, power)| largest >= ten_to(*power) && step.exponent > power - 3)
        .filter(|_| largest >= 1e4)
        .unwrap_or(("", 0));
    let decimals = (power - step.exponent).max(0) as usize;
    format!("{:.decimals$}{suffix}", value / ten_to(power))
}

fn ten_to(power: i32) -> f64 {
    (0..power).fold(1.0, |product, _| product * 10.0)
}

/// Ticks of a logarithmic axis, `low` above 0: powers of ten, and their 2- and 5-fold if they fit.
#[must_use]
pub fn logarithmic(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let most = most.max(2);
    let exponents = libm::floor(libm::log10(low)) as i32..=libm::ceil(libm::log10(high)) as i32;
    let marks = |mantissas: &[i64], every: usize| -> Vec<Tick> {
        exponents
            .clone()
            .filter(|exponent| exponent.rem_euclid(every as i32) == 0)
            .flat_map(|exponent| mantissas.iter().map(move |mantissa| (*mantissa, exponent)))
            .map(|(mantissa, exponent)| {
                let step = Step { mantissa, exponent };
                let value = step.times(1);
                let label = if (-4..6).contains(&exponent) {
                    // Each label has its own decimals: 0.1, 1, 10.
                    label(value, step, value)
                } else {
                    format!("{value:e}")
                };
                Tick { value, label }
            })
            .filter(|tick| tick.value >= low * (1.0 - 1e-12) && tick.value <= high * (1.0 + 1e-12))
            .collect()
    };
    let fine = [marks(&[1, 2, 5], 1), marks(&[1], 1)];
    if let Some(fits) = fine.into_iter().find(|ticks| ticks.len() <= most + 1) {
        return if fits.len() >= 3 { fits } else { linear(low, high, most) };
    }
    (2..).map(|every| marks(&[1], every)).find(|ticks| ticks.len() <= most + 1).unwrap_or_default()
}

/// Formats a whole number with commas between thousands.
#[must_use]
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    groups.map(String::from_utf8_lossy).collect::<Vec<_>>().join(",")
}
