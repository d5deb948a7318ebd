//! Tells people about a self-test and an experiment of `tune` while they are under way: each stage when it begins, each finding when it is there.

use core::fmt::Write;
use core::mem::discriminant;

use fdi_core::Config;
use fdi_core::tune::Standing;

use super::Board;
use crate::decimal::Fixed;
use crate::self_test::progress::offset_setting;
use crate::self_test::{Ending, Progress, Stage};
use crate::tuning::TuningText;

/// What has been shown.
#[derive(Clone, Debug, Default)]
pub struct Follow {
    stage: Option<Stage>,
    findings: usize,
    ending: Option<Ending>,
    tuning: Option<Standing>,
}

impl Follow {
    /// Whether there is something to show.
    pub fn is_news(&self, board: &impl Board) -> bool {
        let now = board.progress();
        (self.stage, self.findings, self.ending) != (now.stage, now.findings.len(), now.ending)
            || self.tuning.as_ref().map(discriminant) != board.tuning().as_ref().map(discriminant)
    }

    /// Shows what is new.
    pub fn show(&mut self, board: &impl Board, out: &mut dyn Write) {
        self.check(&board.progress(), &board.config(), out);
        let tuning = board.tuning();
        if let Some(standing) = &tuning
            && self.tuning.as_ref().map(discriminant) != Some(discriminant(standing))
        {
            let _ = writeln!(out, "{}", TuningText(standing));
            if let Standing::Over(Ok(_)) = standing {
                let _ = writeln!(out, "`tune` shows what follows from it");
            }
        }
        self.tuning = tuning;
    }

    fn check(&mut self, now: &Progress, config: &Config, out: &mut dyn Write) {
        if self.stage.is_none() && now.stage.is_some() {
            *self = Self { tuning: self.tuning, ..Self::default() };
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
