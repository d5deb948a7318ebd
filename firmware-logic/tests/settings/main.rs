//! Settings must survive: a round trip, an update of the firmware, damage, and a power cut after any single step.

#[path = "../flash/mod.rs"]
mod flash;

mod power_cut;
mod record;
mod store;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::diagnosis::signature::Signature;
use fdi_core::identify::Adaptation;
use fdi_core::likelihood::Commissioned;
use fdi_core::likelihood::taught::Response;
use fdi_core::name::Name as Called;
use fdi_core::{Celsius, Config};
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{Origin, Store};
use firmware_logic::settings::stored::Stored;
use flash::Flash;

/// The mock never waits, so one poll is all it takes.
fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("the mock flash never waits"),
    }
}

fn load(flash: &Flash) -> (Stored, Origin) {
    now(Store::new(flash.clone()).load())
}

/// Something that is nowhere at its default.
fn unusual(setpoint: f32) -> Stored {
    let mut config = Config { setpoint: Celsius(setpoint), ..Config::default() };
    config.sensors.t1.offset = Celsius(-0.25);
    config.prbs.start = 77;
    config.identification.adaptation = Adaptation::RandomWalk { r1: 1e-4, r2: 0.01 };
    let rows = &mut config.diagnosis.isolation;
    rows.clear();
    for number in 1..=3u8 {
        let pattern = ["0 -1 0 +1 x", "+1 x -1 0 -1", "+1 0 -1 x +1"][usize::from(number - 1)];
        rows.push(Signature { number, pattern: pattern.parse().expect("a pattern"), name: Called::NONE })
            .expect("room");
    }
    let effects = core::array::from_fn(|i| 300 - 77 * i as i16);
    config.likelihood.taught.push(Response { name: "cap".parse().expect("a name"), effects }).expect("room");
    let numbers = |k: usize| core::array::from_fn(|i| (7 * k + i) as f32 * 0.125);
    let normal = |k| Normal { mean: numbers(k), sigma: numbers(k + 1) };
    Stored { config, baseline: Some(Baseline { samples: 1637, raw: normal(0), filtered: normal(2) }) }
}

fn commissioning(number: u32) -> Commissioning {
    let parameters = core::array::from_fn(|i| 0.3 + (number as f32) * (i as f32));
    Commissioning { number, models: Commissioned { parameters } }
}
