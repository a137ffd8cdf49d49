//! Numbers in options, and remarks to the operator.

use std::io::{self, Write as _};

/// Parses a number within limits.
pub(crate) fn number(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let value = text.parse().ok().filter(|value| (least..=most).contains(value));
        value.ok_or_else(|| format!("give a number from {least} to {most}"))
    }
}

/// Tells the operator something. Standard error may be closed.
pub(crate) fn say(remark: &str) {
    let _ = writeln!(io::stderr(), "staya: {remark}");
}
