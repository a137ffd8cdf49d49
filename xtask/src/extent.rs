//! How much `cargo xtask test` tests.

/// Where tests are that the command leaves out.
pub const LONG: &str = "a part of `cargo xtask test --all`";

/// How much is tested.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The tests that every change should pass: all tests on the host but the long ones, clients,
    /// two parts.
    Short,
    /// All there is: besides, peers, every program on every part, debug builds, budgets, long
    /// tests, goals of benchmarks.
    All,
}
