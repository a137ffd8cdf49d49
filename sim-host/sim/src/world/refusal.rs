//! Errors of interventions.

/// Why an intervention was refused: it is invalid or has no effect.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}; {remedy}")]
pub struct Refusal {
    /// Field of the intervention.
    pub field: &'static str,
    /// Cause of the refusal.
    pub what: String,
    /// How to correct it.
    pub remedy: String,
}

impl Refusal {
    pub(crate) fn new(field: &'static str, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { field, what: what.into(), remedy: remedy.into() }
    }
}
