//! Numbered runs: the common interface of sweep plans and experiments.

/// A set of numbered runs, each a function of its number.
///
/// Runs `0..runs_per_point` belong to the first point, the next ones to the second, and so on. Runs
/// of a point differ in their seeds only.
pub trait Design: Sync {
    /// Name of the results.
    fn name(&self) -> &str;

    /// Fingerprint, 16 hex digits; other runs or rows have another fingerprint.
    fn fingerprint(&self) -> String;

    /// Number of runs.
    fn runs(&self) -> u64;

    /// Runs per point, at least 1.
    fn runs_per_point(&self) -> u64;

    /// Names of the parameters in rows.
    fn parameters(&self) -> Vec<String>;

    /// Parameters of a run below [`Design::runs`], as table cells.
    fn values(&self, run: u64) -> Vec<String>;

    /// Seed of a run below [`Design::runs`].
    fn seed(&self, run: u64) -> u64;

    /// Names of the figures in rows.
    fn figures(&self) -> Vec<String>;

    /// Meaning of a figure.
    fn meaning(&self, figure: &str) -> String;

    /// Most parallel runs on a machine; 1 for timed runs.
    fn at_once(&self) -> usize {
        usize::MAX
    }

    /// Sort key of the order in which runs are started; by default their number.
    fn turn(&self, run: u64) -> u64 {
        run
    }
}
