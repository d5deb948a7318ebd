//! A session: one instrument on one simulated rig, tick by tick, with orders in between.

use anyhow::{Context, bail, ensure};
use fdi_core::schema::{self, COLUMNS, Explained, Moment};
use fdi_core::settings::Value;
use fdi_core::{AdcCode, Celsius, Command, Config, Instrument, Percent, RawSample, Report, Seconds, Tick};
use pt326_rig::Rig;
use pt326_rig::fault::Fault;

use crate::change::Settings;
use crate::refusal::Refused;
use crate::scene::{Order, Scene};
use crate::time::as_written;
use crate::trace::{SETTINGS, append_cells, header};

/// Orders that a scene may hold: more are no user's.
const MOST_ORDERS: usize = 100_000;

/// One instrument on one rig.
pub struct Session {
    /// What it began with, and all that was done since or is still to be done.
    scene: Scene,
    /// How many of its orders have been carried out.
    done: usize,
    settings: Settings,
    instrument: Instrument,
    rig: Rig,
    faults: Vec<Fault>,
    sample_time: f64,
    ticks: u32,
}

/// What came of a tick.
#[derive(Clone, Debug)]
pub struct Row {
    /// First half.
    pub tick: Tick,
    /// Second half.
    pub report: Report,
    /// Number of the fault that acts, 0 for none.
    pub truth: u8,
    /// What each hypothesis explains of an alarm.
    pub explained: Option<Explained>,
    /// Settings since the tick before, as they stand in a trace; on the first tick, those that are not the defaults.
    pub settings: String,
}

impl Session {
    /// A session before its first tick. Orders that the scene holds are carried out when their ticks come.
    ///
    /// # Errors
    /// A preset that there is not; orders out of their order; a fault that cannot be.
    pub fn new(scene: Scene) -> anyhow::Result<Self> {
        ensure!(
            scene.orders.len() <= MOST_ORDERS,
            "{} orders, expected at most {MOST_ORDERS}",
            scene.orders.len()
        );
        ensure!(
            scene.orders.is_sorted_by_key(|(tick, _)| *tick),
            "the orders of the scene are not in the order of time"
        );
        for (i, (_, order)) in scene.orders.iter().enumerate() {
            order.validate().with_context(|| format!("order {}", i + 1))?;
        }
        let config = scene.config()?;
        let sample_time = as_written(config.sample_time.0);
        let rig = Rig::new(&scene.rig()?, scene.disturbance, sample_time, scene.seed, &[]);
        let instrument = Instrument::new(&config)?;
        let settings = Settings::new(&config);
        Ok(Self { scene, done: 0, settings, instrument, rig, faults: Vec::new(), sample_time, ticks: 0 })
    }

    /// The scene that leads here: what is still to come is left out.
    pub fn scene(&self) -> Scene {
        Scene { orders: self.scene.orders[..self.done].to_vec(), ..self.scene.clone() }
    }

    /// What it began with, all that was done since, and what is still to come.
    pub fn plan(&self) -> &Scene {
        &self.scene
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The settings in force.
    pub fn config(&self) -> &Config {
        self.settings.in_force()
    }

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// Does what is ordered, effective from the next tick. What the scene still held for later is dropped: from here on it goes another way.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn order(&mut self, order: Order) -> anyhow::Result<()> {
        ensure!(self.done < MOST_ORDERS, "{MOST_ORDERS} orders are enough");
        order.validate()?;
        self.carry_out(&order)?;
        self.scene.orders.truncate(self.done);
        self.scene.orders.push((self.ticks, order));
        self.done += 1;
        Ok(())
    }

    fn carry_out(&mut self, order: &Order) -> anyhow::Result<()> {
        match order {
            Order::Arm => self.instrument.command(Command::Arm)?,
            Order::Tune => self.instrument.command(Command::Tune)?,
            Order::Stop => self.instrument.command(Command::Stop)?,
            Order::Acknowledge => self.instrument.command(Command::Acknowledge)?,
            Order::Shelve { seconds } => self.instrument.command(Command::Shelve(Seconds(*seconds)))?,
            Order::Relearn | Order::Accept => self.instrument.command(Command::Relearn)?,
            Order::Setpoint { celsius } => self.instrument.command(Command::SetPoint(Celsius(*celsius)))?,
            Order::Excite { on } => self.instrument.command(Command::Excite(*on))?,
            Order::Fan { percent } => {
                self.instrument.command(Command::Fan(Percent(*percent)))?;
                self.rig.set_fan(f64::from(*percent) / 100.0);
            }
            Order::Set { name, value } => self.set(name, *value)?,
            Order::Break { fault } => {
                self.rig.inject(fault.clone());
                self.faults.push(Fault { at: self.now() + fault.at, ..fault.clone() });
            }
            Order::Mend => {
                self.rig.clear();
                self.faults.clear();
            }
            Order::Console { .. } => bail!(Refused::NoConsole),
        }
        Ok(())
    }

    fn set(&mut self, name: &str, value: f32) -> anyhow::Result<()> {
        // The grid of ticks is the session's own.
        let setting = Config::settings().find(|s| s.name == name && name != "sample_time");
        let mut config = self.config().clone();
        let known = setting.is_some_and(|setting| config.set(setting, Value::Number(value)));
        ensure!(known, Refused::Setting(name.into()));
        self.instrument.retune(&config)?;
        self.settings.change(config);
        Ok(())
    }

    /// Time of the next tick, s.
    fn now(&self) -> f64 {
        f64::from(self.ticks) * self.sample_time
    }

    /// One tick.
    pub fn step(&mut self) -> Row {
        while let Some((tick, order)) = self.scene.orders.get(self.done).cloned()
            && tick <= self.ticks
        {
            self.done += 1;
            // An order that was refused then is refused now.
            let _ = self.carry_out(&order);
        }
        let truth = truth(&self.faults, self.now());
        let tick = self.instrument.control(sample(&mut self.rig));
        let report = self.instrument.diagnose(&tick, tick.drive);
        self.rig.advance(f64::from(tick.drive.0));
        self.ticks += 1;
        let explained = schema::explained(&self.instrument, &report);
        Row { tick, report, truth, explained, settings: self.settings.take() }
    }

    /// The numbers of a row, in the order of [`FIELDS`](schema::FIELDS).
    pub fn numbers(&self, row: &Row) -> schema::Numbers {
        schema::row(&Moment {
            truth: row.truth,
            explained: row.explained.as_ref(),
            normal: self.instrument.baseline().map(|baseline| &baseline.filtered),
            sigma_factor: self.config().diagnosis.sigma_factor,
            ..Moment::new(&row.tick, &row.report)
        })
    }

    /// The trace of all ticks so far, as `pt326 run` writes it: the scene is run anew, so nothing needs to be kept.
    ///
    /// # Errors
    /// None that the scene did not have at its start.
    pub fn trace(&self) -> anyhow::Result<Trace> {
        let session = Self::new(self.scene())?;
        let changes = |(_, order): &_| matches!(order, Order::Set { .. });
        let tells_settings = session.settings.tell() || session.scene.orders.iter().any(changes);
        let more = if tells_settings { format!(",{SETTINGS}") } else { String::new() };
        Ok(Trace { session, of: self.ticks, line: header(COLUMNS.iter()) + &more, tells_settings })
    }

    /// FNV-1a, 64 bit, of the trace of all ticks so far, in hexadecimal: the same wherever the same bits are.
    ///
    /// # Errors
    /// Those of [`trace`](Self::trace).
    pub fn digest(&self) -> anyhow::Result<String> {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for line in self.trace()? {
            for byte in line.bytes().chain([b'\n']) {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        Ok(format!("{hash:016x}"))
    }
}

/// The lines of a trace.csv, without their ends.
pub struct Trace {
    session: Session,
    of: u32,
    /// The line that comes next.
    line: String,
    /// It has the column [`SETTINGS`].
    tells_settings: bool,
}

impl Iterator for Trace {
    type Item = String;

    fn next(&mut self) -> Option<String> {
        if self.line.is_empty() {
            return None;
        }
        let mut next = String::new();
        if self.session.ticks < self.of {
            let row = self.session.step();
            let on = Moment { truth: row.truth, ..Moment::new(&row.tick, &row.report) };
            append_cells(&mut next, COLUMNS.iter(), &on, self.session.sample_time);
            if self.tells_settings {
                next = next + "," + &row.settings;
            }
        }
        Some(std::mem::replace(&mut self.line, next))
    }
}

impl Order {
    /// Checks what the instrument does not.
    ///
    /// # Errors
    /// A fault that cannot be.
    pub fn validate(&self) -> anyhow::Result<()> {
        match self {
            Self::Break { fault } => fault.validate("fault"),
            _ => Ok(()),
        }
    }
}

/// What the inputs of the board read of the rig at the present tick.
pub fn sample(rig: &mut Rig) -> RawSample {
    let [t0, t1, t2] = rig.sample().map(|code| AdcCode(code as f32));
    RawSample { t0, t1, t2, supply: AdcCode(rig.supply() as f32) }
}

/// The true fault at a time.
pub fn truth(faults: &[Fault], t: f64) -> u8 {
    let active = faults.iter().filter(|f| f.is_active(t));
    active.max_by(|a, b| a.at.total_cmp(&b.at)).map_or(0, Fault::truth)
}

#[cfg(test)]
mod tests;
