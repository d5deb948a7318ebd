//! From reset to running tasks. The heater's pin is an input until its timer holds it low; nothing here enables it.

use embassy_executor::{Executor, Spawner};
use embassy_futures::block_on;
use fdi_core::ConfigError;
use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use firmware_logic::cadence;
use firmware_logic::console::board::{Chip, ConsoleBoard};
use firmware_logic::control_loop::{ControlLoop, Order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::explain::Explained;
use firmware_logic::interlock::Interlock;
use firmware_logic::log_line;
use firmware_logic::reset_cause::{ResetCause, Restart};
use firmware_logic::retained::Retained;
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{Origin, Store};
use firmware_logic::settings::stored::Stored;
use heapless::spsc::{Consumer, Producer};
use static_cell::StaticCell;

use crate::hardware::board::Parts;
use crate::hardware::heater::HeaterOutput;
use crate::hardware::inputs::Inputs;
use crate::hardware::panel::Panel;
use crate::hardware::settings_flash::SettingsFlash;
use crate::hardware::{
    self, clock, control_executor, cycles, halt, memory, reset, retained, serial, tick_timer, undervoltage,
    watchdog,
};
use crate::shared::Shared;
use crate::{link, log, simulation, tasks};

#[cortex_m_rt::entry]
fn main() -> ! {
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(start)
}

/// Brings everything up. Not part of `main`, whose stack frame lies beneath that of every task for ever.
#[inline(never)]
fn start(spawner: Spawner) {
    // Before anything that could hang: the clocks are the first candidates.
    watchdog::start();
    let left = retained::load();
    let (death, restart) = left.as_ref().map_or((None, None), |left| (left.death, left.restart));
    let cause = ResetCause::new(reset::take_flags(), death, restart);
    let mut interlock = Interlock::at_boot(cause, left.as_ref().and_then(|left| left.lockout));
    // The crash record is in `left`; a lockout must outlive the next reset, too.
    retained::store(&Retained { lockout: interlock.lockout(), ..Retained::EMPTY });

    let (peripherals, clock) = clock::init();
    hardware::set_priorities();
    halt::freeze_output_not_guard();
    let (first, parts) = Parts::new(peripherals);
    tick_timer::start(first.tick_timer); // the log's clock, too
    count_cycles();
    memory::start(first.checksum);

    let mut store = Store::new(SettingsFlash::new(first.flash));
    let (settings, origin) = read_settings(&mut store);
    let (marked, commissioning) = read_marks(&mut store);
    interlock.marked(cause, marked);
    log::banner(clock, cause, left.as_ref(), &origin);
    let (orders_in, orders_out) = link::orders();
    let mut shared = share(settings, orders_in);
    shared.begin(cause, clock);
    shared.change(|diagnosis| diagnosis.commissioned(commissioning));
    run(spawner, parts, shared, ConsoleBoard::new(shared, store, marked), interlock, (cause, orders_out));
}

/// What is left when the settings are known: output, inputs, tasks. Not part of `start`, for the stack: reading the settings is deep, and
/// so is the control half on its way to its task.
#[inline(never)]
fn run(
    spawner: Spawner,
    parts: Parts,
    shared: &'static Shared,
    console: ConsoleBoard<&'static Shared, SettingsFlash>,
    interlock: Interlock,
    (cause, orders): (ResetCause, Consumer<'static, Order>),
) {
    let simulated = cause == ResetCause::Restarted(Restart::Simulating);
    let outputs = (parts.heater, parts.contactor);
    let heater = HeaterOutput::new(parts.pwm_timer, outputs, parts.break_input, simulated);
    if simulated {
        simulation::begin();
    }
    undervoltage::watch();
    tick_timer::enable_interrupt();
    let inputs = Inputs::new(parts.adc, parts.thermistors, parts.supply);
    let (records_out, records_in) = link::records();
    let (period, control) = shared.diagnosis(|diagnosis| {
        let config = &diagnosis.settings().config;
        let mut control = ControlLoop::new(in_force(Controller::new(config)), config.setpoint, interlock);
        if let Some(baseline) = diagnosis.baseline() {
            log_line::baseline(baseline, |line| shared.line(line));
            control.restored(baseline);
        }
        (cadence::period(config.sample_time), control)
    });
    link::TASKS.set_period(period.get() / 1000);
    let panel = Panel::new(parts.led, parts.button);
    let port = serial::open(parts.usart, parts.rx, parts.tx);

    let (codes_in, codes_out) = simulation::codes();
    let spawned = tasks::control::control(period, control, heater, inputs, records_in, orders, codes_out);
    control_executor::start().spawn(once(spawned));
    spawner.spawn(once(tasks::diagnosis::diagnosis(records_out, shared)));
    spawner.spawn(once(tasks::status::status(shared)));
    spawner.spawn(once(tasks::panel::panel(panel, shared)));
    if let Some((tx, rx)) = port {
        spawner.spawn(once(tasks::console::console(tx, rx, shared, console, codes_in)));
    }
    spawner.spawn(once(tasks::watchdog::watchdog()));
}

/// Not part of `start`, for the stack: what is read goes through buffers that nothing later needs.
#[inline(never)]
fn read_settings(store: &mut Store<SettingsFlash>) -> (Stored, Origin) {
    block_on(store.load())
}

/// The same of the mark of a power failure, and of the commissioning.
#[inline(never)]
fn read_marks(store: &mut Store<SettingsFlash>) -> (bool, Option<Commissioning>) {
    (block_on(store.is_marked()), block_on(store.commissioning()))
}

/// Not part of what the tasks lie on, as the core's peripherals are taken whole.
fn count_cycles() {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        cycles::start(&mut core.DCB, &mut core.DWT);
    }
}

/// A half of the instrument. What was read from flash has been checked, and the defaults are tested.
fn in_force<T>(half: Result<T, ConfigError>) -> T {
    half.unwrap_or_else(|error| panic!("settings: {}", Explained(&error)))
}

/// Not part of `run`, for the stack: the diagnosis half lies on it once, on its way to where it stays.
#[inline(never)]
fn share(settings: Stored, orders: Producer<'static, Order>) -> &'static Shared {
    static SHARED: StaticCell<Shared> = StaticCell::new();
    let place = SHARED.uninit(); // not `init_with`, whose closure takes both along once more
    let diagnosis = in_force(Diagnosis::new(&settings.config));
    place.write(Shared::new(DiagnosisLoop::new(diagnosis, settings), orders))
}

/// Each task is spawned once, and there is room for one of each.
fn once<T>(token: Result<T, embassy_executor::SpawnError>) -> T {
    match token {
        Ok(token) => token,
        Err(_) => panic!("a task was spawned twice"),
    }
}
