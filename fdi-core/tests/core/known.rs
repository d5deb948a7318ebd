//! Known inputs: what the supply and the fan may change, and what they may not.

use fdi_core::control::Controller;
use fdi_core::units::Volt;
use fdi_core::{
    AdcCode, Command, Config, Feedback, Instrument, Mode, Percent, RawSample, Refusal, RetuneError, Tick,
    TripReason,
};

/// The room; 10.8 V of 12 V.
const SAMPLE: RawSample = RawSample {
    t0: AdcCode(2160.0),
    t1: AdcCode(2160.0),
    t2: AdcCode(2160.0),
    supply: AdcCode(4095.0 * 10.8 / 16.5),
};

fn measured() -> Config {
    let mut config = Config::default();
    config.supply.nominal_voltage = Volt(12.0);
    config
}

/// A controller that heats; `fan` was announced, `air_flow` was found.
fn heated(config: &Config, fan: f32, air_flow: f32) -> Tick {
    let controller = Controller::new(config).unwrap();
    let mut state = controller.start(config.setpoint);
    controller.command(&mut state, Command::Arm).unwrap();
    assert!(controller.step(&mut state, SAMPLE).drive.0 > 0.0);
    controller.command(&mut state, Command::Fan(Percent(fan))).unwrap();
    controller.feed_back(&mut state, Feedback { air_flow: Some(Percent(air_flow)), ..Feedback::default() });
    controller.step(&mut state, SAMPLE)
}

/// Whether too little air has tripped, on the same tick.
fn lost_air(config: &Config, fan: f32, air_flow: f32) -> bool {
    let tick = heated(config, fan, air_flow);
    let tripped = matches!(tick.mode, Mode::Tripped(trip) if trip.reason == TripReason::AirFlowLost);
    assert_eq!(tripped, tick.drive.0 == 0.0);
    tripped
}

#[test]
fn a_fan_announced_to_stand_still_switches_the_heater_off() {
    let config = Config::default();
    for fan in [0.0, 4.9, 49.0] {
        assert!(lost_air(&config, fan, 100.0), "fan {fan} %");
    }
    for fan in [50.0, 100.0, 200.0] {
        assert!(!lost_air(&config, fan, 100.0), "fan {fan} %");
    }
    let mut lenient = Config::default();
    lenient.supervisor.min_air_flow = Percent(0.0);
    assert!(lost_air(&lenient, 0.0, 100.0), "no air is too little whatever is allowed");
    assert!(!lost_air(&lenient, 30.0, 100.0));
}

#[test]
fn no_announcement_widens_the_limit_of_the_air_flow() {
    for fan in [60.0, 100.0, 200.0] {
        assert!(lost_air(&Config::default(), fan, 45.0), "fan {fan} %");
    }
}

/// Neither `arm` nor `ack` goes on without the fan; both do once it is announced to run.
#[test]
fn without_the_fan_nothing_is_armed_or_acknowledged() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    let refused = Err(Refusal::CausePersists(TripReason::AirFlowLost));
    let announce = |instrument: &mut Instrument, level| {
        instrument.command(Command::Fan(Percent(level))).unwrap();
        instrument.control(SAMPLE)
    };
    announce(&mut instrument, 0.0);
    assert_eq!(instrument.command(Command::Arm), refused);
    announce(&mut instrument, 100.0);
    instrument.command(Command::Arm).unwrap();
    assert!(announce(&mut instrument, 100.0).drive.0 > 0.0);
    assert_eq!(announce(&mut instrument, 0.0).drive.0, 0.0);
    assert_eq!(instrument.command(Command::Acknowledge), refused);
    announce(&mut instrument, 100.0);
    assert_eq!(instrument.command(Command::Acknowledge), Ok(()));
}

#[test]
fn levels_that_no_fan_has_are_refused() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    for level in [-1.0, 200.1, f32::INFINITY, f32::NAN] {
        let refused = instrument.command(Command::Fan(Percent(level))).unwrap_err();
        assert!(refused.to_string().contains("expected 0 to 200 %"), "{refused}");
    }
    assert_eq!(instrument.control(SAMPLE).known.fan, None);
}

#[test]
fn the_supply_is_known_where_it_is_measured() {
    let tick = |config: &Config| Instrument::new(config).unwrap().control(SAMPLE);
    assert_eq!(tick(&Config::default()).known.supply, None);
    let known = tick(&measured()).known;
    assert!(known.supply.is_some_and(|share| (share - 0.9).abs() < 1e-5), "{known:?}");
    assert!((known.effective(50.0) - 40.5).abs() < 1e-3);
}

/// As a thermistor's constants: what power and heat mean must not change under a heater that is on.
#[test]
fn the_supply_is_calibrated_with_the_heater_off_only() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    instrument.command(Command::Arm).unwrap();
    let _ = instrument.control(SAMPLE);
    let refused = Err(RetuneError::Refused(Refusal::WidensLimit("supply.nominal_voltage")));
    assert_eq!(instrument.retune(&measured()), refused);
    instrument.command(Command::Stop).unwrap();
    let _ = instrument.control(SAMPLE);
    assert_eq!(instrument.retune(&measured()), Ok(()));
    assert!(instrument.control(SAMPLE).forget, "what was learnt is of other powers");
}
