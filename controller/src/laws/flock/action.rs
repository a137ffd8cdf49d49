//! Scalar functions of the alpha flock (Olfati-Saber 2006, sections II and VII), in the paper's
//! units: neighbours in a lattice are [`SPACING`] apart.

use crate::scalar::Scalar;

/// Distance of neighbours in the lattice (d), in the paper's units.
pub const SPACING: i32 = 7;

/// Parameter e of the sigma norm, 1/10.
#[must_use]
pub fn epsilon<S: Scalar>() -> S {
    S::from_ratio(1, 10)
}

/// A length in the sigma norm, (sqrt(1 + e z^2) - 1) / e, and its slope z / sqrt(1 + e
/// z^2), |n_ij|.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SigmaNorm<S> {
    /// ||z||_sigma.
    pub sigma: S,
    /// 1 / sqrt(1 + e z^2): n_ij is the offset times this.
    pub slope: S,
}

/// The sigma norm of a vector with this squared length. Unlike the norm it is smooth at 0.
#[must_use]
pub fn sigma_norm<S: Scalar>(squared: S) -> SigmaNorm<S> {
    let root = (S::ONE + epsilon::<S>() * squared).sqrt();
    // Equal to (root - 1) / e, without the cancellation.
    let sigma = squared.checked_div(root + S::ONE).unwrap_or(S::MAX);
    let slope = S::ONE.checked_div(root).unwrap_or(S::ZERO);
    SigmaNorm { sigma, slope }
}

/// The bump rho_h: 1 on [0, h), falling smoothly to 0 at 1, 0 beyond; 0 for NaN.
#[must_use]
pub fn bump<S: Scalar>(z: S, h: S) -> S {
    if z < h {
        return S::ONE;
    }
    let is_within = z <= S::ONE;
    if !is_within {
        return S::ZERO;
    }
    // With h = 1 the function does not fall.
    let along = (z - h).checked_div(S::ONE - h).unwrap_or(S::ONE);
    let (_, cos) = (S::PI * along).sin_cos();
    (S::ONE + cos) * S::HALF
}

/// sigma_1(z) = z / sqrt(1 + z^2), without overflow of the square.
#[must_use]
pub fn sigma_1<S: Scalar>(z: S) -> S {
    if z.abs() <= S::ONE {
        return z.checked_div((S::ONE + z * z).sqrt()).unwrap_or(S::ZERO);
    }
    let inverse = S::ONE.checked_div(z).unwrap_or(S::ZERO);
    let magnitude = S::ONE.checked_div((S::ONE + inverse * inverse).sqrt()).unwrap_or(S::ONE);
    if z < S::ZERO { -magnitude } else { magnitude }
}

/// The uneven sigmoid ((a + b) sigma_1(z + c) + (a - b)) / 2; c = |a - b| / sqrt(4 a b) makes
/// phi(0) = 0 ([`sigmoid_shift`]).
#[must_use]
pub fn phi<S: Scalar>(z: S, a: S, b: S, c: S) -> S {
    ((a + b) * sigma_1(z + c) + (a - b)) * S::HALF
}

/// c of [`phi`]; `None` unless 0 < a <= b, as the paper asks.
#[must_use]
pub fn sigmoid_shift<S: Scalar>(a: S, b: S) -> Option<S> {
    let is_sound = a > S::ZERO && b >= a && b.is_finite();
    // Two roots: in fixed point the product might not fit.
    is_sound.then(|| (b - a).checked_div(S::TWO * a.sqrt() * b.sqrt())).flatten()
}

/// The interaction of robots, rho_h(z / r_alpha) phi(z - d_alpha); negative: repulsion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PhiAlpha<S> {
    /// ||r||_sigma of the interaction range.
    pub r_alpha: S,
    /// ||d||_sigma of the lattice's spacing, at which it is 0.
    pub d_alpha: S,
    /// a of [`phi`]: strength of attraction.
    pub a: S,
    /// b of [`phi`]: strength of repulsion.
    pub b: S,
    /// c of [`phi`].
    pub c: S,
}

impl<S: Scalar> PhiAlpha<S> {
    /// Where the bump begins to fall (h of phi_alpha and of a_ij).
    #[must_use]
    pub fn plateau() -> S {
        S::from_ratio(1, 5)
    }

    /// a_ij = rho_h(z / r_alpha): how far a robot at distance `z` (sigma norm) is a neighbour.
    #[must_use]
    pub fn adjacency(&self, z: S) -> S {
        let ratio = z.checked_div(self.r_alpha).unwrap_or(S::MAX);
        bump(ratio, Self::plateau())
    }

    /// phi_alpha(z), `z` in the sigma norm, given a_ij of the same z.
    #[must_use]
    pub fn at(&self, z: S, adjacency: S) -> S {
        adjacency * phi(z - self.d_alpha, self.a, self.b, self.c)
    }
}

/// The effect of obstacles, rho_h(z / d_beta) (sigma_1(z - d_beta) - 1), from -2 to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PhiBeta<S> {
    /// ||d'||_sigma of the distance kept from obstacles.
    pub d_beta: S,
}

impl<S: Scalar> PhiBeta<S> {
    /// Where the bump begins to fall (h of phi_beta).
    #[must_use]
    pub fn plateau() -> S {
        S::from_ratio(9, 10)
    }

    /// b_ik = rho_h(z / d_beta).
    #[must_use]
    pub fn adjacency(&self, z: S) -> S {
        let ratio = z.checked_div(self.d_beta).unwrap_or(S::MAX);
        bump(ratio, Self::plateau())
    }

    /// phi_beta(z), `z` in the sigma norm, given b_ik of the same z.
    #[must_use]
    pub fn at(&self, z: S, adjacency: S) -> S {
        adjacency * (sigma_1(z - self.d_beta) - S::ONE)
    }
}
