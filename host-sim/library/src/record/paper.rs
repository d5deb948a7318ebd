//! What the paper reports of its own experiment, to stand beside a run of the same one.

/// Fault, detection delay in s, indicated duration in s (sections 4.3 and 4.4).
pub const FAULTS: [(&str, f64, f64); 3] = [("AFS2", 2.0, 27.0), ("MFS1", 2.0, 14.0), ("MFP", 2.0, 27.0)];

/// Largest control error, % of the set-point (section 4.1).
pub const CONTROL_ERROR: f64 = 4.3;
