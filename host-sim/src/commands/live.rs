//! `pt326 live`: the lab served to browsers on this machine.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::Context;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
use pt326_live::mqtt::Broker;
use pt326_live::source::{Recording, Source, Told};
use pt326_live::{Access, Server, clock, listen, mqtt};
use pt326_rig::Disturbance;

use super::replay::{self, ReplayArgs};
use super::terminal::print;
use crate::board::find;
use crate::board::watch::Watch;
use crate::record::numbers;

/// Arguments of `live`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
All who open the page see the same rig; whoever has it may break it, arm it and stop it. It is served to this machine only, unless \
--listen names an address, which needs --token: then everybody who can reach that address and knows the token may.

With --board, a real board: its page arms, stops and acknowledges. Stop, and the key !, go to the board at once. While \
nothing is heard of the board the page says so; the board goes on regulating, and trips by itself.

The page watches. With --page lab.html, which `cargo lab` writes, it has all that lies in that file as well: *Connect a board* opens a \
board at a port of the computer that the browser runs on, and a trace is run again.

With --board or --listen the page opens only by the link that is printed, which holds a token. No browser is opened then: other users of \
the machine could read the link on its command line.

Numbers for Prometheus: /metrics (with --listen, the token as bearer). With --mqtt, state, findings and trips as JSON at a broker, for Home \
Assistant, too. Neither can switch a heater on. See docs/dashboards.md.

Examples:
  pt326 live                              the simulated rig, where it monitors
  pt326 live --preset trainer --seed 7
  pt326 live --recording out/trace.csv --speed 10
  pt326 live --page lab.html              this page can also go over to a board
  pt326 live --board                      the ST-LINK that is plugged in; or: --board /dev/ttyACM0
  pt326 live --board --mqtt mqtt://broker.local/bench-1
  pt326 live --listen 192.168.1.7 --token $(openssl rand -hex 16)")]
pub struct LiveArgs {
    /// Which rig: paper, trainer, harsh, recorded; oven, hotend or tclab, with the settings that belong to it.
    #[arg(long, default_value = "paper")]
    pub preset: String,
    /// Seed of the rig's noise and of the phase of the excitation.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How much the surroundings move: none, calm or lively.
    #[arg(long, default_value_t = Disturbance::default())]
    pub disturbance: Disturbance,
    /// A recording in place of the rig: a board's log as text, or a trace.csv.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["preset", "seed", "disturbance"])]
    pub recording: Option<PathBuf>,
    /// Settings that the recording was made with, TOML, as for `replay`.
    #[arg(long, value_name = "FILE.toml", requires = "recording")]
    pub config: Option<PathBuf>,
    /// A real board in place of the rig, at this serial port; without PORT: the only ST-LINK that is plugged in.
    #[arg(long, value_name = "PORT", num_args = 0..=1, conflicts_with_all = ["preset", "seed", "disturbance", "recording", "speed"])]
    pub board: Option<Option<String>>,
    /// The page to serve, lab.html as `cargo lab` writes it; left out: one that watches only.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// How many times as fast as time it goes, 0 to 100.
    #[arg(long, default_value_t = 1.0)]
    pub speed: f64,
    /// Port; another one where it is taken.
    #[arg(long, default_value_t = 8326)]
    pub port: u16,
    /// Address to listen on, for other machines; needs --token.
    #[arg(long, value_name = "ADDRESS", requires = "token")]
    pub listen: Option<IpAddr>,
    /// What everybody must know who opens the page: 16 letters and digits or more.
    #[arg(long, requires = "listen")]
    pub token: Option<String>,
    /// An MQTT broker that is told of the rig: mqtt://[USER@]HOST[:PORT][/NAME]; topics begin with pt326/NAME. The password of USER is taken
    /// from PT326_MQTT_PASSWORD.
    #[arg(long, value_name = "URL")]
    pub mqtt: Option<String>,
    /// Take commands from the broker: stop, and a set-point within its bounds. Whoever may publish there may do that; nobody can arm.
    #[arg(long, requires = "mqtt")]
    pub mqtt_commands: bool,
    /// Do not open a browser, where one would be opened.
    #[arg(long)]
    pub no_open: bool,
}

/// Serves until it is interrupted.
///
/// # Errors
/// A bad file or value; no port that is free.
pub fn run(args: &LiveArgs) -> anyhow::Result<()> {
    match (&args.board, &args.recording) {
        (Some(port), _) => serve(args, Watch::open(&find(port.as_deref())?)?),
        (None, Some(file)) => {
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let (file, config) = (file.clone(), args.config.clone());
            let replayed = ReplayArgs { file, config, seed: None, out: PathBuf::new() };
            let record = replay::again(&replayed, None, |_, _, _| ())?.record;
            let rows = numbers::of(&record);
            serve(args, Recording::new(name, record.sample_time, record.names, rows))
        }
        (None, None) => {
            let scene = Scene {
                seed: args.seed,
                preset: args.preset.clone(),
                disturbance: args.disturbance,
                ..Scene::default()
            };
            serve(args, Session::new(scene)?)
        }
    }
}

/// A board at a serial port.
impl Source for Watch {
    fn name(&self) -> String {
        Self::name(self).to_owned()
    }

    fn kind(&self) -> &'static str {
        "board"
    }

    fn can(&self) -> &'static [&'static str] {
        &["order"]
    }

    fn sample_time(&self) -> f64 {
        Self::sample_time(self)
    }

    fn has_own_time(&self) -> bool {
        true
    }

    fn next(&mut self) -> Option<Told> {
        self.take()
    }

    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        Self::order(self, &order)
    }

    fn setpoint_limits(&self) -> Option<[f32; 2]> {
        Some(Self::setpoint_limits(self))
    }
}

fn serve(args: &LiveArgs, source: impl Source) -> anyhow::Result<()> {
    let access = match (&args.listen, &args.token) {
        (Some(_), Some(token)) => Access::open(token)?,
        // A board heats: its page is for the user who has started this, not for every user of the machine.
        _ => Access::local(args.board.is_some())?,
    };
    let broker = args.mqtt.as_deref().map(|url| {
        let password = std::env::var("PT326_MQTT_PASSWORD").ok();
        Broker::new(url, password, args.mqtt_commands)
    });
    let broker = broker.transpose()?;
    let clock = clock::start(source, args.speed)?;
    let server = match &args.page {
        None => Server::new(clock.clone(), access, None)?,
        Some(file) => {
            let lab =
                std::fs::read_to_string(file).with_context(|| format!("can't read {}", file.display()))?;
            Server::new(clock.clone(), access, Some(&lab)).with_context(|| file.display().to_string())?
        }
    };
    if let Some(broker) = broker {
        mqtt::start(clock, broker, |said| drop(print(&format!("{said}\n"))))?;
    }
    let address = SocketAddr::new(args.listen.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST)), args.port);
    listen(server, address, |address, query| {
        let page = format!("http://{address}/{query}");
        print(&format!("The lab is at {page}\nCtrl-C ends it.\n"))?;
        // What a browser is started with, every user can read.
        if !args.no_open && query.is_empty() {
            open(&page);
        }
        Ok(())
    })
    .with_context(|| format!("can't serve on {address}"))
}

/// Opens a browser, where there is one.
fn open(page: &str) {
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(target_os = "windows") {
        "explorer"
    } else {
        "xdg-open"
    };
    let silent = Stdio::null;
    let _ = Command::new(opener).arg(page).stdin(silent()).stdout(silent()).stderr(silent()).spawn();
}
