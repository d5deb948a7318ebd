//! A board as its console reaches it: what may be done while the heater is on, and what has to be done before it is.

use embedded_storage_async::nor_flash::NorFlash;
use fdi_core::control::Controller;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::tune::Standing;
use fdi_core::{Command, Config, ConfigError, Seconds};

use super::{ApplyError, Board, BoardError};
use crate::calibration::{Calibration, Still};
use crate::control_loop::{Denial, Order};
use crate::diagnosis_loop::DiagnosisLoop;
use crate::history::Entry;
use crate::reset_cause::Restart;
use crate::self_test::Progress;
use crate::settings::commissioning::Commissioning;
use crate::settings::store::{SaveError, Store};
use crate::settings::stored::StoredError;
use crate::status::Status;
use crate::teaching::Teaching;
use crate::tuning::Tuner;

/// What the console needs of the chip, and of the tasks beside it.
#[expect(
    async_fn_in_trait,
    reason = "used by the firmware and the host's console, neither of which crosses threads"
)]
pub trait Chip {
    /// Looks at the diagnosis half.
    fn diagnosis<R>(&self, look: impl FnOnce(&DiagnosisLoop) -> R) -> R;
    /// Changes something of the diagnosis half.
    fn change<R>(&mut self, change: impl FnOnce(&mut DiagnosisLoop) -> R) -> R;
    /// Proposes settings to the diagnosis half, and logs them.
    ///
    /// # Errors
    /// See [`DiagnosisLoop::propose`].
    fn propose(&mut self, config: &Config) -> Result<Controller, ConfigError>;
    /// Gives the control half an order, and waits for the tick that says what became of it.
    ///
    /// # Errors
    /// Why it was not carried out.
    async fn order(&mut self, order: Order) -> Result<(), Denial>;
    /// Disables the heater's output at once, and orders a stop.
    fn stop(&mut self);
    /// Whether the heater's output is enabled at this moment, of which the last tick may not know yet.
    fn is_output_enabled(&self) -> bool;
    /// Lets the other tasks run for a moment.
    async fn pause(&mut self);
    /// A stall of the processor that was planned is over; it makes no task late.
    fn stalled(&mut self);
    /// How the instrument is, the health of the board included.
    fn status(&self) -> Status;
    /// Sends the log over the port, or no more; `false` where there is no port.
    fn stream(&mut self, on: bool) -> bool;
    /// Starts anew, with both outputs off before anything else. It comes back only where there is no board.
    fn restart(&mut self, how: Restart);
    /// Whether its codes come from the port, and its outputs are locked off.
    fn is_simulated(&self) -> bool;
    /// Programs the brown-out level, which stalls the processor; `false` if the chip refuses.
    fn program_brown_out_level(&mut self) -> bool;
}

/// A board, as its console reaches it.
pub struct ConsoleBoard<C, F: NorFlash> {
    /// The chip.
    pub chip: C,
    store: Store<F>,
    /// The flash has the mark that tells the next start of a power failure.
    marked: bool,
    /// The commissioning that the flash was given last. What it refuses is not offered again until a save has mended it.
    given: Option<Commissioning>,
    calibration: Calibration,
    tuner: Tuner,
}

impl<C: Chip, F: NorFlash> ConsoleBoard<C, F> {
    /// A board whose settings and commissioning are kept in `store`; `marked` says whether the mark of a power failure stands there.
    pub fn new(chip: C, store: Store<F>, marked: bool) -> Self {
        let given = chip.diagnosis(|diagnosis| diagnosis.commissioning().copied());
        Self { chip, store, marked, given, calibration: Calibration::default(), tuner: Tuner::default() }
    }

    /// Takes the mark away once the heater is off and nothing is latched, and keeps a new commissioning. To be called while there is
    /// nothing else to do.
    pub async fn settle(&mut self) {
        if self.chip.is_simulated() {
            return; // what is learnt is of no rig, and no power failure has ever left it hot
        }
        self.keep().await;
        let latched = self.chip.diagnosis(|diagnosis| diagnosis.status().is_latched());
        if self.marked && !latched && !self.may_heat() {
            let _ = self.mark(false).await; // tried again
        }
    }

    /// Gives the flash back.
    pub fn into_flash(self) -> F {
        self.store.into_flash()
    }

    /// Writes a commissioning that the flash does not have.
    async fn keep(&mut self) {
        let commissioning = self.chip.diagnosis(|diagnosis| diagnosis.commissioning().copied());
        if commissioning == self.given || self.may_heat() {
            return;
        }
        let _ = self.store.keep(commissioning.as_ref()).await;
        self.given = commissioning;
        self.chip.stalled();
    }

    /// Also in a check, whose next pulse may come while the flash stalls the core.
    fn may_heat(&self) -> bool {
        self.chip.diagnosis(|diagnosis| diagnosis.status().may_heat()) || self.chip.is_output_enabled()
    }

    /// After a `stop` the output is off at once, and the control half says so on its next tick.
    async fn follow_stop(&mut self) {
        while self.chip.diagnosis(|diagnosis| diagnosis.status().is_heating())
            && !self.chip.is_output_enabled()
        {
            self.chip.pause().await;
        }
    }

    async fn mark(&mut self, stands: bool) -> Result<(), SaveError> {
        let result = self.store.mark(stands).await;
        self.chip.stalled();
        if result.is_ok() {
            self.marked = stands;
        }
        result
    }
}

impl<C: Chip, F: NorFlash> Board for ConsoleBoard<C, F> {
    async fn command(&mut self, command: Command) -> Result<(), Denial> {
        if command.heats() && !self.marked && !self.may_heat() && !self.chip.is_simulated() {
            self.mark(true).await.map_err(|_| Denial::NoMark)?;
        }
        self.chip.order(Order::Command(command)).await
    }

    async fn check(&mut self) -> Result<(), Denial> {
        self.chip.order(Order::Check).await
    }

    fn progress(&self) -> Progress {
        self.chip.diagnosis(|diagnosis| diagnosis.status().check.clone())
    }

    fn stop(&mut self) {
        self.chip.stop();
    }

    fn status(&self) -> Status {
        self.chip.status()
    }

    fn sample_time(&self) -> Seconds {
        self.chip.diagnosis(DiagnosisLoop::sample_time)
    }

    fn config(&self) -> Config {
        self.chip.diagnosis(|diagnosis| diagnosis.settings().config.clone())
    }

    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError> {
        let controller = self.chip.propose(config)?;
        Ok(self.chip.order(Order::Retune(controller)).await?)
    }

    async fn save(&mut self) -> Result<(), SaveError> {
        self.follow_stop().await;
        if self.chip.is_simulated() {
            return Err(SaveError::Simulated);
        }
        if self.chip.diagnosis(DiagnosisLoop::is_damaged) {
            return Err(SaveError::Record(StoredError::Damaged));
        }
        if self.may_heat() {
            return Err(SaveError::Heating);
        }
        let settings = self.chip.diagnosis(|diagnosis| diagnosis.to_keep());
        let result = self.store.save(&settings).await;
        self.given = None; // saving may have had to erase it
        self.chip.stalled();
        result
    }

    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {
        if self.may_heat() {
            return Err(SaveError::Heating);
        }
        let done = self.chip.program_brown_out_level();
        self.chip.stalled();
        done.then_some(()).ok_or(SaveError::Flash)
    }

    fn commission(&mut self) -> bool {
        self.chip.change(DiagnosisLoop::commission)
    }

    fn decommission(&mut self) {
        self.chip.change(|diagnosis| diagnosis.commissioned(None));
    }

    fn still(&self) -> Still {
        self.chip.diagnosis(|diagnosis| *diagnosis.still())
    }

    fn calibration(&mut self) -> &mut Calibration {
        &mut self.calibration
    }

    fn tuning(&self) -> Option<Standing> {
        self.chip.diagnosis(|diagnosis| diagnosis.status().tuning)
    }

    fn tuner(&mut self) -> &mut Tuner {
        &mut self.tuner
    }

    fn teach<R>(&mut self, change: impl FnOnce(&mut Teaching) -> R) -> R {
        self.chip.change(|diagnosis| change(diagnosis.teaching()))
    }

    async fn pause(&mut self) {
        self.chip.pause().await;
    }

    fn stream(&mut self, on: bool) -> Result<(), BoardError> {
        self.chip.stream(on).then_some(()).ok_or(BoardError::NoBoard)
    }

    /// Nobody has looked at a board that starts anew because a program asked for it: what is latched has to stay so, and a trip
    /// does not outlive a reset.
    async fn restart(&mut self, how: Restart) -> Result<(), BoardError> {
        self.follow_stop().await;
        if self.may_heat() {
            return Err(BoardError::NotOff);
        }
        if self.chip.diagnosis(|diagnosis| diagnosis.status().is_latched()) {
            return Err(BoardError::Latched);
        }
        self.chip.restart(how);
        Err(BoardError::NoBoard)
    }

    fn baseline(&self) -> Option<Baseline> {
        self.chip.diagnosis(|diagnosis| diagnosis.baseline().copied())
    }

    fn fault(&self, index: usize) -> Option<Entry> {
        self.chip.diagnosis(|diagnosis| diagnosis.history().get(index).copied())
    }
}
