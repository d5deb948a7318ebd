//! A bit flips in the memory of the control loop: whichever it is, nothing is driven that no order has switched on.

mod output;

use core::mem::{MaybeUninit, size_of};

use fdi_core::control::Controller;
use fdi_core::{AdcCode, Command, Config, Feedback, Mode, RawSample};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::{ControlLoop, Order};
use firmware_logic::interlock::{Interlock, Lockout};
use output::Output;

/// Three thermistors at 22 degC.
const ROOM: RawSample =
    RawSample { t0: AdcCode(2160.0), t1: AdcCode(2160.0), t2: AdcCode(2160.0), supply: AdcCode(0.0) };
const BROKEN: RawSample = RawSample { t1: AdcCode(4095.0), ..ROOM };
/// Three ticks: on the first a bit that has flipped acts, on the next whatever it has led to.
const TICKS: usize = 3;

fn tick(control: &mut ControlLoop, raw: RawSample, order: Option<Order>, output: &mut Output) -> Mode {
    control.tick(raw, Arrival::default(), order, Feedback::default(), output).tick.mode
}

/// A loop after these orders and samples, as a board would have it.
fn after(config: &Config, orders: &[(RawSample, Option<Command>)], locked_out: bool) -> ControlLoop {
    let controller = Controller::new(config).expect("valid");
    let mut control = ControlLoop::new(controller, config.setpoint, Interlock::default());
    let mut output = Output::default();
    for (raw, command) in orders {
        tick(&mut control, *raw, command.map(Order::Command), &mut output);
    }
    if locked_out {
        control.lock_out(Lockout::WrongClock, &mut output);
    }
    assert!(output.is_off());
    control
}

/// The loop with one bit of its memory changed, which may be a bit of padding.
#[expect(unsafe_code, reason = "memory is what flips: no value of a type can be asked for it")]
fn with_flipped(control: &ControlLoop, bit: usize) -> MaybeUninit<ControlLoop> {
    let mut copy = MaybeUninit::new(control.clone());
    // SAFETY: the byte lies within the copy. What is made of it may be no value of its type, as on a board.
    unsafe { *copy.as_mut_ptr().cast::<u8>().add(bit / 8) ^= 1 << (bit % 8) };
    copy
}

/// Whatever flips while it heats: what is latched has switched off.
#[test]
#[expect(unsafe_code, reason = "see above")]
fn what_flips_while_it_heats_switches_off_or_latches_nothing() {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    let controller = Controller::new(&config).expect("valid");
    let (mut control, mut output) =
        (ControlLoop::new(controller, config.setpoint, Interlock::default()), Output::default());
    tick(&mut control, ROOM, Some(Order::Command(Command::Arm)), &mut output);
    assert!(output.given() > 0.0);
    let mut latched = 0;
    for bit in 0..8 * size_of::<ControlLoop>() {
        let (mut control, mut output) = (with_flipped(&control, bit), Output { ..output });
        // SAFETY: as above.
        let control = unsafe { control.assume_init_mut() };
        let record = control.tick(ROOM, Arrival::default(), None, Feedback::default(), &mut output);
        latched += usize::from(record.lockout.is_some());
        assert!(record.lockout.is_none() || output.is_off(), "bit {bit}: {:?}", record.lockout);
    }
    assert!(latched > 1000, "{latched}: at least the limits");
}

/// How many of all bits drive anything.
#[expect(unsafe_code, reason = "see above")]
fn heating_bits(control: &ControlLoop) -> Vec<usize> {
    let drives = |bit: &usize| {
        let (mut control, mut output) = (with_flipped(control, *bit), Output::default());
        // SAFETY: not sound where the bit has made no value of its type; nothing is dropped, and nothing here is a pointer.
        let control = unsafe { control.assume_init_mut() };
        (0..TICKS).any(|_| {
            control.look(ROOM, &mut output);
            tick(control, ROOM, None, &mut output);
            !output.is_off()
        })
    };
    (0..8 * size_of::<ControlLoop>()).filter(drives).collect()
}

#[test]
fn no_flipped_bit_heats_from_off_unarmed_or_locked_out() {
    let mut config = Config::default();
    let unchecked = after(&config, &[(ROOM, None); 4], false);
    config.supervisor.check_before_arming = false;
    let (arm, stop) = ((ROOM, Some(Command::Arm)), (ROOM, Some(Command::Stop)));
    let armed = [arm, (ROOM, None), (ROOM, None)];
    // A trip on a tick that did not come, which is the last thing that was done.
    let mut late = after(&config, &[(ROOM, None)], false);
    let mut output = Output::default();
    tick(&mut late, ROOM, Some(Order::Command(Command::Arm)), &mut output);
    while late.missed(Arrival::default(), &mut output).tick.mode.is_heating() {}
    let states = [
        ("never checked", unchecked),
        ("never armed", after(&config, &[(ROOM, None); 4], false)),
        ("stopped", after(&config, &[&armed[..], &[stop]].concat(), false)),
        ("tripped", after(&config, &[&armed[..], &[(BROKEN, None); 8]].concat(), false)),
        ("tripped without a sample", late),
        ("locked out", after(&config, &armed, true)),
    ];
    for (name, control) in &states {
        let bits = heating_bits(control);
        assert!(bits.is_empty(), "{name}: {} of {} bits: {bits:?}", bits.len(), 8 * size_of::<ControlLoop>());
    }
}
