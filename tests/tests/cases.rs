//! Golden hashes of the built-in swarms, which the host and every part must produce.

use std::fmt::Write as _;

#[test]
fn golden_hashes_of_the_canned_swarms() {
    let mut table = String::new();
    staya_cases::every(|name, number, summary| {
        writeln!(table, "{name} {number} {summary}").expect("strings take everything");
    });
    staya_tests::golden("cases", &table, &[]);
}
