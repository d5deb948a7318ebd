//! Which trips are right, and their names.

use fdi_core::TripReason;
use serde::{Deserialize, Serialize};

/// Which trips are right in a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected true, false or a list of reasons such as [\"t1_open\"]")]
pub enum MayTrip {
    /// `true`: whatever switches off is right; `false`: nothing may.
    Whatever(bool),
    /// These alone.
    For(Vec<TripReason>),
}

impl Default for MayTrip {
    fn default() -> Self {
        Self::Whatever(false)
    }
}

impl MayTrip {
    /// Whether a trip for this reason is right.
    pub(in crate::campaign) fn allows(&self, reason: TripReason) -> bool {
        match self {
            Self::Whatever(allowed) => *allowed,
            Self::For(reasons) => reasons.contains(&reason),
        }
    }
}
