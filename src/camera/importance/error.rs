//! Why a camera has no importance.

use thiserror::Error;

use crate::camera::model::Model;

/// Why a camera has no importance.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImportanceError {
    /// Its rays begin in one point, or run in one direction only.
    #[error(
        "model \"{model}\" {}: its importance We is infinite or 0, and not defined; {advice}",
        if *parallel { "without a lens has parallel rays" } else { "without a lens has all its rays through one point" }
    )]
    NoArea {
        /// The model.
        model: Model,
        /// Whether they are parallel.
        parallel: bool,
        /// What to give instead.
        advice: &'static str,
    },
}
