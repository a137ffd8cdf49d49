//! How much `cargo xtask test` tests.

/// Why tests are left out that only [`Extent::All`] runs.
pub const LONG: &str = "long proofs run with `cargo xtask test --all`";

/// How much is tested.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// What every change should pass: all tests on the host but the long ones, clients, each part once.
    Short,
    /// All there is: besides, peers, every program on every part, debug builds, budgets, long tests.
    All,
}
