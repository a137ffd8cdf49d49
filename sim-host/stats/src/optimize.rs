//! Downhill simplex minimisation (Nelder and Mead 1965) for a few parameters.

use std::cell::Cell;

type Vertex<const N: usize> = ([f64; N], f64);

/// Returns the point where `f` is smallest, and its value there.
///
/// Starts from a simplex around `start` with edges `step`. Ends if the values of the simplex differ
/// by at most `tolerance` and a fresh simplex around the answer finds no better one, or after about
/// `max_evals` evaluations. NaN counts as infinitely bad.
#[must_use]
pub fn minimize<const N: usize>(
    mut f: impl FnMut([f64; N]) -> f64,
    start: [f64; N],
    step: [f64; N],
    tolerance: f64,
    max_evals: usize,
) -> Vertex<N> {
    let evals = Cell::new(0);
    let mut value = |x: [f64; N]| {
        evals.set(evals.get() + 1);
        let y = f(x);
        if y.is_nan() { f64::INFINITY } else { y }
    };
    let may_continue = || evals.get() < max_evals;
    let mut best = (start, value(start));
    loop {
        let before = best.1;
        best = descend(&mut value, &may_continue, best, step, tolerance);
        // A collapsed simplex can stop on a slope, which a fresh one detects.
        if !may_continue() || before - best.1 <= tolerance || before == best.1 {
            return best;
        }
    }
}

fn descend<const N: usize>(
    value: &mut impl FnMut([f64; N]) -> f64,
    may_continue: &impl Fn() -> bool,
    start: Vertex<N>,
    step: [f64; N],
    tolerance: f64,
) -> Vertex<N> {
    let mut simplex = vec![start];
    for axis in 0..N {
        let mut x = start.0;
        x[axis] += step[axis];
        simplex.push((x, value(x)));
    }
    loop {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, second_worst, worst) = (simplex[0], simplex[N - 1], simplex[N]);
        if !may_continue() || worst.1 - best.1 <= tolerance {
            return best;
        }
        let mut center = [0.0; N];
        for (x, _) in &simplex[..N] {
            (0..N).for_each(|axis| center[axis] += x[axis] / N as f64);
        }
        let mut at = |factor: f64| {
            let mut x = center;
            (0..N).for_each(|axis| x[axis] += factor * (center[axis] - worst.0[axis]));
            (x, value(x))
        };
        let reflected = at(1.0);
        let accepted = if reflected.1 < best.1 {
            let expanded = at(2.0);
            Some(if expanded.1 < reflected.1 { expanded } else { reflected })
        } else if reflected.1 < second_worst.1 {
            Some(reflected)
        } else {
            let contracted = at(if reflected.1 < worst.1 { 0.5 } else { -0.5 });
            (contracted.1 < reflected.1.min(worst.1)).then_some(contracted)
        };
        if let Some(vertex) = accepted {
            simplex[N] = vertex;
            continue;
        }
        for vertex in &mut simplex[1..] {
            (0..N).for_each(|axis| vertex.0[axis] = (vertex.0[axis] + best.0[axis]) / 2.0);
            vertex.1 = value(vertex.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curved_valley_is_followed_to_its_end() {
        let rosenbrock = |[x, y]: [f64; 2]| 100.0 * (y - x * x) * (y - x * x) + (1.0 - x) * (1.0 - x);
        let (at, value) = minimize(rosenbrock, [-1.2, 1.0], [0.5, 0.5], 1e-14, 5000);
        assert!(value < 1e-10, "{at:?} {value}");
        assert!((at[0] - 1.0).abs() < 1e-4 && (at[1] - 1.0).abs() < 1e-4);
    }

    #[test]
    fn forbidden_regions_are_left_alone() {
        let f = |[x]: [f64; 1]| if x < 0.5 { f64::NAN } else { x };
        let (at, _) = minimize(f, [4.0], [1.0], 1e-12, 1000);
        assert!((at[0] - 0.5).abs() < 1e-6, "{at:?}");
    }

    #[test]
    fn work_is_bounded_when_nothing_is_finite() {
        let mut evals = 0;
        let f = |_: [f64; 3]| {
            evals += 1;
            f64::NAN
        };
        let (_, value) = minimize(f, [0.0; 3], [1.0; 3], 1e-9, 100);
        assert_eq!(value, f64::INFINITY);
        assert!(evals <= 110, "{evals}");
    }
}
