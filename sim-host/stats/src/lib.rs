//! Statistics: summaries with confidence intervals, the curve of figure 6 of A. V. Kuznetsov 2017
//! (KUZ), and the Norton-Rice law of KUZ section 5 with its fit and test.
//!
//! Everything goes through `libm` and sums in the order of the samples, so that equal samples give
//! equal bits everywhere. A sample that is NaN or infinite never vanishes silently: the functions
//! answer `None` or an error, and the caller decides what a run without a value means.

mod describe;
mod norton_rice;
mod optimize;
mod regression;
mod special;

pub use describe::{Histogram, Summary, mean, quantile};
pub use norton_rice::{FitError, Goodness, NortonRice};
pub use optimize::minimize;
pub use regression::LogFit;
pub use special::{beta_regularized, gamma_q, ln_bessel_i_scaled, student_t_quantile};
