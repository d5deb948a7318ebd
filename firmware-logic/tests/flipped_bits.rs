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

/// The loop in each state in which it is looked at, by name.
fn states() -> [(&'static str, ControlLoop); 7] {
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
    let mut heats = after(&config, &[(ROOM, None)], false);
    tick(&mut heats, ROOM, Some(Order::Command(Command::Arm)), &mut output);
    [
        ("never checked", unchecked),
        ("never armed", after(&config, &[(ROOM, None); 4], false)),
        ("stopped", after(&config, &[&armed[..], &[stop]].concat(), false)),
        ("tripped", after(&config, &[&armed[..], &[(BROKEN, None); 8]].concat(), false)),
        ("tripped without a sample", late),
        ("locked out", after(&config, &armed, true)),
        (HEATS, heats),
    ]
}

/// Here a bit may switch off, and must if it latches anything.
const HEATS: &str = "heats";

/// Whether this bit drives what must not be driven.
#[expect(unsafe_code, reason = "see above")]
fn is_wrong(name: &str, control: &ControlLoop, bit: usize) -> bool {
    let (mut control, mut output) = (with_flipped(control, bit), Output::default());
    // SAFETY: not sound where the bit has made no value of its type; nothing is dropped, and nothing here is a pointer.
    let control = unsafe { control.assume_init_mut() };
    (0..TICKS).any(|_| {
        control.look(ROOM, &mut output);
        let record = control.tick(ROOM, Arrival::default(), None, Feedback::default(), &mut output);
        !output.is_off() && (name != HEATS || record.lockout.is_some())
    })
}

/// In a child: the state, and the bit that it begins with.
const CHILD: &str = "FLIPPED_BITS";
const TEST: &str = "no_flipped_bit_heats_from_off_unarmed_or_locked_out";

/// What a bit makes of a value may be no value of its type, and then a program on this machine may end, as the image's would in a fault, which
/// cuts. So a child looks, and says where it is; after a bit that ends it, another goes on behind it.
#[test]
fn no_flipped_bit_heats_from_off_unarmed_or_locked_out() {
    const BITS: usize = 8 * size_of::<ControlLoop>();
    if let Ok(begin) = std::env::var(CHILD) {
        let (state, from) = begin.split_once(' ').expect("two numbers");
        let (name, control) = &states()[state.parse::<usize>().expect("a state")];
        for bit in from.parse().expect("a bit")..BITS {
            println!("at {bit}");
            if is_wrong(name, control, bit) {
                println!("wrong {bit}");
            }
        }
        return;
    }
    for (state, (name, _)) in states().iter().enumerate() {
        let (mut from, mut wrong, mut ended) = (0, Vec::new(), 0);
        while from < BITS {
            let mut child = std::process::Command::new(std::env::current_exe().expect("this program"));
            child.args(["--exact", TEST, "--nocapture"]).env(CHILD, format!("{state} {from}"));
            let output = child.output().expect("a child");
            let said = String::from_utf8_lossy(&output.stdout);
            wrong.extend(said.lines().filter_map(|line| line.split_once("wrong ")?.1.parse::<usize>().ok()));
            let last = said.lines().rev().find_map(|line| line.split_once("at ")?.1.parse().ok());
            from = last.map_or(BITS, |last: usize| last + 1);
            ended += usize::from(!output.status.success());
            assert!(last.is_some(), "{name}: {said}");
        }
        println!("{name}: {ended} of {BITS} bits end the program");
        assert!(wrong.is_empty(), "{name}: {} of {BITS} bits: {wrong:?}", wrong.len());
        assert!(ended < BITS / 20, "{name}: {ended} bits end the program: what they drive was not seen");
    }
}
