//! `pt326 live`: the lab served to browsers on this machine.

mod rigs;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use anyhow::Context;
use pt326_live::mqtt::Broker;
use pt326_live::{Access, Rig, Server, listen};
use pt326_rig::Disturbance;

use super::board::Heed;
use super::terminal::print;
use rigs::{BoardAt, Boards};

/// Arguments of `live`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
All who open the page see the same rig; whoever has it may break it, arm it and stop it. It is served to this machine only, unless \
--listen names an address, which needs a token: then everybody who can reach that address and knows the token may. It is read from a file or from \
PT326_TOKEN, since every user of the machine can read a command line.

With --board, a real board: its page arms, stops and acknowledges. Stop, and the key !, go to the board at once. While \
nothing is heard of the board the page says so; the board goes on regulating, and trips by itself. Ctrl-C stops every board before the program \
ends, and says of each whether it has said that its heater is off; exit code 2 where one has not.

The page watches. With --page lab.html, which `cargo lab` writes, it has all that lies in that file as well: *Connect a board* opens a \
board at a port of the computer that the browser runs on, and a trace is run again.

With several boards the page is a wall: a tile each, and \"Stop all\", which needs no second press. A click on a tile opens the board's own \
page; nothing on the wall arms. A board that is not plugged in, or is lost, says so on its tile and keeps none of the others. With --rigs the \
same with simulated rigs.

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
  pt326 live --board lab1=/dev/ttyACM0 --board lab2=/dev/ttyACM1 --record logs    a wall of two
  pt326 live --rigs 12 --preset trainer   a wall of twelve simulated rigs
  (umask 077; openssl rand -hex 16 > token); pt326 live --listen 192.168.1.7 --token-file token")]
pub struct LiveArgs {
    /// Which rig: paper, trainer, harsh, recorded; oven, hotend or tclab, with the settings that belong to it. Several: a wall with one of each.
    #[arg(long, default_value = "paper")]
    pub preset: Vec<String>,
    /// How many simulated rigs, 1 to 64: from 2 on a wall. Each has the next seed, and the next of the presets.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub rigs: u16,
    /// Seed of the rig's noise and of the phase of the excitation; of several rigs, that of the first.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How much the surroundings move: none, calm or lively.
    #[arg(long, default_value_t = Disturbance::default())]
    pub disturbance: Disturbance,
    /// A recording in place of the rig: a board's log as text, or a trace.csv.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["preset", "rigs", "seed", "disturbance"])]
    pub recording: Option<PathBuf>,
    /// Settings that the recording was made with, TOML, as for `replay`.
    #[arg(long, value_name = "FILE.toml", requires = "recording")]
    pub config: Option<PathBuf>,
    /// A real board in place of the rig, at this serial port; without PORT: the only ST-LINK that is plugged in. Several: a wall, on which each
    /// has its NAME, or the end of its port's.
    #[arg(
        long,
        value_name = "[NAME=]PORT",
        num_args = 0..=1,
        default_missing_value = "",
        conflicts_with_all = ["preset", "rigs", "seed", "disturbance", "recording", "speed"]
    )]
    pub board: Vec<BoardAt>,
    /// Folder in which the log of each board is kept, in a new file NAME-TIME.log; `pt326 replay` reads it.
    #[arg(long, value_name = "FOLDER", requires = "board", conflicts_with_all = ["preset", "rigs", "seed", "disturbance", "recording"])]
    pub record: Option<PathBuf>,
    /// The page to serve, lab.html as `cargo lab` writes it; left out: one that watches only.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// How many times as fast as time it goes, 0 to 100.
    #[arg(long, default_value_t = 1.0)]
    pub speed: f64,
    /// Port; another one where it is taken.
    #[arg(long, default_value_t = 8326)]
    pub port: u16,
    /// Address to listen on, for other machines; needs a token.
    #[arg(long, value_name = "ADDRESS")]
    pub listen: Option<IpAddr>,
    /// A file that holds what everybody must know who opens the page: 16 letters and digits or more. Without it: PT326_TOKEN.
    #[arg(long, value_name = "FILE", requires = "listen")]
    pub token_file: Option<PathBuf>,
    /// An MQTT broker that is told of the rig: mqtt://[USER@]HOST[:PORT][/NAME]; topics begin with pt326/NAME, of a board of several with
    /// pt326/NAME-BOARD. The password of USER is taken from PT326_MQTT_PASSWORD.
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
    let broker = args.mqtt.as_deref().map(|url| {
        let password = std::env::var("PT326_MQTT_PASSWORD").ok();
        Broker::new(url, password, args.mqtt_commands)
    });
    let boards = Boards::default();
    let leaving = boards.clone();
    // Before any board is there: from then on nothing ends this with one that heats.
    let _heed = (!args.board.is_empty())
        .then(|| Heed::new(move || std::process::exit(if leaving.leave() { 0 } else { 2 })))
        .transpose()?;
    let rigs = rigs::all(args, &boards, broker.transpose()?.as_ref())?;
    serve(args, rigs)
}

/// Listens, and says where.
fn serve(args: &LiveArgs, rigs: Vec<Arc<Rig>>) -> anyhow::Result<()> {
    let access = match args.listen {
        Some(_) => Access::open(&token(args.token_file.as_deref())?)?,
        // A board heats: its page is for the user who has started this, not for every user of the machine.
        None => Access::local(!args.board.is_empty())?,
    };
    let what = if rigs.len() > 1 { "wall" } else { "lab" };
    let address = SocketAddr::new(args.listen.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST)), args.port);
    let server = match &args.page {
        None => Server::new(rigs, access, None)?,
        Some(file) => {
            let lab =
                std::fs::read_to_string(file).with_context(|| format!("can't read {}", file.display()))?;
            Server::new(rigs, access, Some(&lab)).with_context(|| file.display().to_string())?
        }
    };
    listen(server, address, |address, query| {
        let page = format!("http://{address}/{query}");
        print(&format!("The {what} is at {page}\nCtrl-C ends it.\n"))?;
        // What a browser is started with, every user can read.
        if !args.no_open && query.is_empty() {
            open(&page);
        }
        Ok(())
    })
    .with_context(|| format!("can't serve on {address}"))
}

/// What everybody must know who opens the page, from a file or from the environment.
fn token(file: Option<&Path>) -> anyhow::Result<String> {
    let token = match file {
        Some(file) => {
            std::fs::read_to_string(file).with_context(|| format!("can't read {}", file.display()))?
        }
        None => std::env::var("PT326_TOKEN")
            .context("--listen needs a token: put one into PT326_TOKEN, or name a file by --token-file")?,
    };
    Ok(token.trim().to_owned())
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
