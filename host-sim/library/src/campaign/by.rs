//! The two diagnoses that a campaign holds against each other.

use serde::{Deserialize, Serialize};

/// Which diagnosis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// The likelihood diagnosis.
    #[default]
    Likelihood,
    /// The paper's signatures.
    Signature,
}

impl By {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Likelihood, Self::Signature];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Likelihood => "likelihood",
            Self::Signature => "signature",
        }
    }
}
