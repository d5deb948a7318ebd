//! The rig at an MQTT broker: its state, findings and trips, retained; where that is asked for, two commands that heat nothing.
//!
//! Topics begin with `pt326/NAME`: `availability` (`online`, or `lost`, which the broker says where nobody else can), `state` (each second),
//! `finding` and `trip` (whenever one changes, with a number, so that one that is missing or came twice can be told), `command` and `answer`.

mod command;
mod discovery;
mod outbox;
mod tell;

use std::time::Duration;

use anyhow::{Context, ensure};
use axum::http::Uri;
use rumqttc::{AsyncClient, Event, EventLoop, LastWill, MqttOptions, Packet, QoS};
use serde_json::Value;
use tokio::sync::mpsc;
use tokio::time::{MissedTickBehavior, interval, sleep};

use crate::clock::{Ask, Clock};
use crate::history::Place;
use command::{Command, refused};
use outbox::{Message, Outbox};
use tell::Teller;

/// What `availability` says.
const ONLINE: &str = "online";
const LOST: &str = "lost";
/// So long without a word from this program, and half as much, and the broker says that it is lost.
const KEEP_ALIVE: Duration = Duration::from_secs(10);
/// Between two states.
const EVERY: Duration = Duration::from_secs(1);
/// Requests to the client that wait: one message, one state, a subscription and an answer, twice.
const REQUESTS: usize = 8;

/// What a rig is called that has no name.
const UNNAMED: &str = "rig";

/// A broker, and what the rig is called there.
#[derive(Clone, Debug, PartialEq)]
pub struct Broker {
    host: String,
    port: u16,
    login: Option<(String, String)>,
    name: String,
    commands: bool,
    /// Between two attempts to reach it.
    pause: Duration,
}

impl Broker {
    /// From `mqtt://[USER@]HOST[:PORT][/NAME]`; with `commands` it may be stopped from there, and its set-point changed.
    ///
    /// # Errors
    /// What the address lacks.
    pub fn new(url: &str, password: Option<String>, commands: bool) -> anyhow::Result<Self> {
        let expected = "expected mqtt://[USER@]HOST[:PORT][/NAME], such as mqtt://broker.local/bench-1";
        let uri: Uri = url.parse().with_context(|| format!("broker \"{url}\", {expected}"))?;
        let scheme = uri.scheme_str();
        ensure!(scheme != Some("mqtts"), "broker \"{url}\": there is no encryption here, {expected}");
        ensure!(scheme == Some("mqtt"), "broker \"{url}\", {expected}");
        let authority = uri.authority().map(|authority| authority.as_str()).unwrap_or_default();
        let user = authority.rsplit_once('@').map(|(user, _)| user);
        ensure!(
            !user.is_some_and(|user| user.contains(':')),
            "a password does not belong on a command line, which every user of the machine can read: set PT326_MQTT_PASSWORD"
        );
        let login = user.map(|user| (user.to_owned(), password.unwrap_or_default()));
        let name = uri.path().trim_matches('/');
        let name = if name.is_empty() { UNNAMED } else { name }.to_owned();
        let plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_');
        ensure!(plain, "rig \"{name}\", expected letters, digits, - and _");
        let host = uri.host().unwrap_or_default().trim_matches(['[', ']']).to_owned();
        ensure!(!host.is_empty(), "broker \"{url}\", {expected}");
        Ok(Self { host, port: uri.port_u16().unwrap_or(1883), login, name, commands, pause: EVERY })
    }

    /// The same broker for one board of several: its topics begin with `pt326/NAME-BOARD`, or `pt326/BOARD` where no name was given.
    #[must_use]
    pub fn of(&self, board: &str) -> Self {
        let name = if self.name == UNNAMED { board.to_owned() } else { format!("{}-{board}", self.name) };
        Self { name, ..self.clone() }
    }

    fn topic(&self, end: &str) -> String {
        format!("pt326/{}/{end}", self.name)
    }

    fn options(&self) -> MqttOptions {
        let mut options = MqttOptions::new(format!("pt326-{}", self.name), &self.host, self.port);
        options.set_keep_alive(KEEP_ALIVE).set_clean_session(false);
        options.set_last_will(LastWill::new(self.topic("availability"), LOST, QoS::AtLeastOnce, true));
        if let Some((user, password)) = &self.login {
            options.set_credentials(user, password);
        }
        options
    }
}

/// Tells a broker of a session, in a thread of its own, for as long as the program runs; `say` is told how that goes.
///
/// # Errors
/// The system gives no thread.
pub fn start(clock: Clock, broker: Broker, say: impl Fn(&str) + Send + 'static) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let bridge = Bridge::new(clock, broker, Box::new(say));
    std::thread::Builder::new().name("mqtt".into()).spawn(move || runtime.block_on(bridge.run()))?;
    Ok(())
}

/// What the client has to say.
enum Heard {
    Connected { remembers: bool },
    Lost(String),
    Acknowledged,
    Message { topic: String, payload: Vec<u8>, retained: bool },
}

struct Bridge {
    clock: Clock,
    broker: Broker,
    place: Place,
    teller: Teller,
    outbox: Outbox,
    /// What was told last.
    availability: &'static str,
    /// Which limits of the set-point Home Assistant was told last, where it was told of the rig.
    offered: Option<Option<[f32; 2]>>,
    say: Box<dyn Fn(&str) + Send>,
}

impl Bridge {
    fn new(clock: Clock, broker: Broker, say: Box<dyn Fn(&str) + Send>) -> Self {
        let (place, teller, outbox) = (Place::default(), Teller::default(), Outbox::default());
        Self { clock, broker, place, teller, outbox, availability: ONLINE, offered: None, say }
    }

    async fn run(mut self) {
        let (client, events) = AsyncClient::new(self.broker.options(), REQUESTS);
        let (tell, mut heard) = mpsc::channel(REQUESTS);
        tokio::spawn(listen(events, tell, self.broker.pause));
        let mut changed = self.clock.changed.clone();
        changed.mark_changed();
        let mut second = interval(EVERY);
        second.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                Some(heard) = heard.recv() => self.hear(heard, &client).await,
                is_there = changed.changed() => match is_there {
                    Ok(()) => self.look(),
                    Err(_) => return, // the session has ended
                },
                _ = second.tick() => self.tell_state(&client),
            }
            if let Some(Message { topic, payload }) = self.outbox.next()
                && client.try_publish(topic, QoS::AtLeastOnce, true, payload.as_bytes()).is_ok()
            {
                self.outbox.sent();
            }
        }
    }

    /// Takes what is new of the session.
    fn look(&mut self) {
        let (rows, lost, limits, version) = {
            let history = self.clock.history();
            let version = history.about()["version"].as_str().unwrap_or_default().to_owned();
            (history.next_rows(&mut self.place), history.counts.lost, history.setpoint_limits, version)
        };
        let limits = limits.filter(|_| self.broker.commands);
        if self.offered.replace(limits) != Some(limits) {
            let name = &self.broker.name;
            let payload = discovery::message(&format!("pt326/{name}"), name, &version, limits).to_string();
            self.outbox.push(Message { topic: format!("homeassistant/device/pt326_{name}/config"), payload });
        }
        for (end, message) in rows.iter().flat_map(|row| self.teller.row(row)) {
            self.outbox.push(Message { topic: self.broker.topic(end), payload: message.to_string() });
        }
        let availability = if lost { LOST } else { ONLINE };
        if std::mem::replace(&mut self.availability, availability) != availability {
            self.outbox.push(self.greeting());
        }
    }

    fn greeting(&self) -> Message {
        Message { topic: self.broker.topic("availability"), payload: self.availability.into() }
    }

    /// The state is what is now: one that nobody could be told is void.
    fn tell_state(&self, client: &AsyncClient) {
        if !self.outbox.is_connected() {
            return;
        }
        let state = {
            let history = self.clock.history();
            history.last().map(|row| tell::state(row, !history.counts.lost))
        };
        if let Some(state) = state {
            let _ = client.try_publish(self.broker.topic("state"), QoS::AtMostOnce, true, state.to_string());
        }
    }

    async fn hear(&mut self, heard: Heard, client: &AsyncClient) {
        match heard {
            Heard::Connected { remembers } => {
                let Broker { host, port, name, commands, .. } = &self.broker;
                (self.say)(&format!("The broker at {host}:{port} is told of this rig under pt326/{name}"));
                self.outbox.connected(remembers, self.greeting());
                // At most once: a command that comes late is not carried out late. A session that is remembered may have asked for them.
                let topic = self.broker.topic("command");
                let _ = match commands {
                    true => client.try_subscribe(topic, QoS::AtMostOnce),
                    false => client.try_unsubscribe(topic),
                };
            }
            Heard::Lost(why) => {
                let Broker { host, port, .. } = &self.broker;
                (self.say)(&format!(
                    "No connection to the broker at {host}:{port}: {why}; it is tried again and again"
                ));
                self.outbox.lost();
            }
            Heard::Acknowledged => self.outbox.acknowledged(),
            // Somebody else of the same name may have asked for other topics, on which others may publish.
            Heard::Message { topic, .. } if topic != self.broker.topic("command") => {}
            Heard::Message { payload, retained, .. } => {
                let answer = self.answer(&payload, retained).await.to_string();
                if self.broker.commands {
                    let topic = self.broker.topic("answer");
                    let _ = client.try_publish(topic, QoS::AtMostOnce, false, answer);
                }
            }
        }
    }

    /// Carries out a command, where any are taken.
    async fn answer(&self, payload: &[u8], retained: bool) -> Value {
        if !self.broker.commands {
            return refused("no commands are taken here");
        }
        if retained {
            return refused(
                "a retained command was refused, for it may be old: publish it without the retain flag",
            );
        }
        let limits = self.clock.history().setpoint_limits;
        match Command::read(payload, limits) {
            Ok(command) => match self.clock.ask(Ask::Order(command.order())).await {
                Ok(done) => done,
                Err(why) => why,
            },
            Err(why) => why,
        }
    }
}

/// Keeps the client going and hands on what it hears. Of failures one after another the first is told.
async fn listen(mut events: EventLoop, tell: mpsc::Sender<Heard>, pause: Duration) {
    let mut is_lost = false;
    loop {
        let heard = match events.poll().await {
            Ok(Event::Incoming(Packet::ConnAck(there))) => {
                is_lost = false;
                Heard::Connected { remembers: there.session_present }
            }
            Ok(Event::Incoming(Packet::PubAck(_))) => Heard::Acknowledged,
            Ok(Event::Incoming(Packet::Publish(message))) => {
                let (payload, retained) = (message.payload.to_vec(), message.retain);
                Heard::Message { topic: message.topic, payload, retained }
            }
            Ok(_) => continue,
            Err(error) => {
                if !std::mem::replace(&mut is_lost, true)
                    && tell.send(Heard::Lost(error.to_string())).await.is_err()
                {
                    return;
                }
                sleep(pause).await;
                // What was said before that was heard: a broker that remembers is sent it again, another forgets it with all the rest.
                events.clean();
                continue;
            }
        };
        if tell.send(heard).await.is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests;
