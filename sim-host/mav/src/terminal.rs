//! Numbers in options, and words for the operator.

use staya_mavlink::constants::*;

/// Parses a number within limits.
pub(crate) fn number(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let value = text.parse().ok().filter(|value| (least..=most).contains(value));
        value.ok_or_else(|| format!("give a number from {least} to {most}"))
    }
}

/// Tells the operator something. Standard error may be closed.
pub(crate) fn say(remark: &str) {
    staya_console::say(&format!("staya: {remark}"));
}

/// Describes a MAV_RESULT.
pub(crate) const fn result_words(result: u8) -> &'static str {
    const FAILED: u8 = 4;
    const CANCELLED: u8 = 6;
    match result {
        MAV_RESULT_ACCEPTED => "accepted",
        MAV_RESULT_TEMPORARILY_REJECTED => "temporarily rejected",
        MAV_RESULT_DENIED => "denied",
        MAV_RESULT_UNSUPPORTED => "unsupported",
        FAILED => "failed",
        CANCELLED => "cancelled",
        MAV_RESULT_COMMAND_INT_ONLY => "as COMMAND_INT only",
        MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME => "unsupported frame",
        _ => "refused",
    }
}
