//! Runs that have numbers: what plans of sweeps and experiments have in common.

/// Which runs there are, and what is known of each before it is made. A run is a function of its number.
///
/// Runs `0..runs_per_point` are the first point, those that follow the second one, and so on: runs of a point differ in
/// their seeds only.
pub trait Design: Sync {
    /// What results are called.
    fn name(&self) -> &str;

    /// What tells designs apart that mean other runs or rows, as 16 hex digits.
    fn fingerprint(&self) -> String;

    /// How many runs there are.
    fn runs(&self) -> u64;

    /// How many runs there are of each point, 1 or more.
    fn runs_per_point(&self) -> u64;

    /// The names of the parameters that rows have.
    fn parameters(&self) -> Vec<String>;

    /// The parameters of a run below [`Design::runs`], as cells of a table.
    fn values(&self, run: u64) -> Vec<String>;

    /// The seed of a run below [`Design::runs`].
    fn seed(&self, run: u64) -> u64;

    /// The names of the figures that rows have.
    fn figures(&self) -> Vec<String>;

    /// What a figure says, in words.
    fn meaning(&self, figure: &str) -> String {
        let _ = figure;
        String::from("a figure of summary.json")
    }

    /// How many runs may go on at once, whatever the machine has: 1 for what is timed.
    fn at_once(&self) -> usize {
        usize::MAX
    }

    /// The order in which runs are begun, if it is another one than that of their numbers.
    fn turn(&self, run: u64) -> u64 {
        run
    }
}
