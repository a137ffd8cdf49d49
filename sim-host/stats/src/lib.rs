//! Statistics: summaries with confidence intervals, lines of least squares, and the Norton-Rice law
//! of A. V. Kuznetsov 2017 (KUZ), section 5, with its fit and test.
//!
//! All functions use `libm` and sum in the order of the samples, so equal samples give equal bits
//! on every machine. If a value is NaN or infinite, they return `None` or an error.

mod describe;
mod line;
mod norton_rice;
mod optimize;
mod special;

pub use describe::{Histogram, Summary, mean, quantile};
pub use line::Line;
pub use norton_rice::{FitError, Goodness, NortonRice};
pub use optimize::minimize;
pub use special::{beta_regularized, gamma_q, ln_bessel_i_scaled, student_t_quantile};
