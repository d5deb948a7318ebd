//! Tells people about a self-test while it is under way: each stage when it begins, each finding when it is there.

use core::fmt::Write;

use fdi_core::Config;

use crate::decimal::Fixed;
use crate::self_test::progress::offset_setting;
use crate::self_test::{Ending, Progress, Stage};

/// What of a check has been shown.
#[derive(Clone, Debug, Default)]
pub struct Follow {
    stage: Option<Stage>,
    findings: usize,
    ending: Option<Ending>,
}

impl Follow {
    /// Whether there is something to show.
    pub fn is_news(&self, now: &Progress) -> bool {
        (self.stage, self.findings, self.ending) != (now.stage, now.findings.len(), now.ending)
    }

    /// Shows what is new.
    pub fn show(&mut self, now: &Progress, config: &Config, out: &mut dyn Write) {
        if self.stage.is_none() && now.stage.is_some() {
            *self = Self::default();
        }
        if let Some(stage) = now.stage.filter(|stage| self.stage != Some(*stage)) {
            let _ = writeln!(out, "check: {}", stage.name());
        }
        for finding in now.findings.iter().skip(self.findings) {
            let _ = write!(out, "{finding}");
            if let Some((name, offset)) = offset_setting(finding, config) {
                let _ = write!(out, ": `set {name} {}`", Fixed(offset, 2));
            }
            let _ = writeln!(out);
        }
        if let Some(ending) = now.ending.filter(|_| self.ending.is_none()) {
            let _ = writeln!(out, "{ending}");
        }
        (self.stage, self.findings, self.ending) = (now.stage, now.findings.len(), now.ending);
    }
}
