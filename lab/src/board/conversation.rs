//! A board that is watched: its ticks as rows for the page, orders to it and their answers, and whether it is there.
//!
//! It has no port and no clock. Bytes that came go in with the time, s; bytes to be sent and what is to be told come out. One line is under
//! way at a time. Stop does not come by here: whoever holds the port sends it at once, and says so, which voids all that was ordered before.

use std::collections::VecDeque;

use anyhow::{bail, ensure};
use fdi_core::Config;
use fdi_core::schema::Numbers;
use fdi_core::settings::Value;
use firmware_logic::console::ANSWER;
use firmware_logic::console::line::{LENGTH, is_stop_key};
use firmware_logic::console::request::Request;
use firmware_logic::log_line::LogLine;
use firmware_logic::stream::frame::{Reader, Step};

use super::record::Recorder;
use super::rows::Rows;
use super::text::{between, refusal, take_lines, without_prompts};
use super::twin::{Agreement, Twin};
use super::{ALONE, FORGET, FRAME, settings, visible};
use crate::names::Names;
use crate::scene::Order;
use crate::time::as_written;
use crate::told::Told;

/// How long an answer may take that is not soon there: a save erases the flash, an order waits for a tick of up to 5 s.
const PATIENCE: f64 = 15.0;
/// So long without a line, beyond a tick, and the board is called silent; its stream is asked for once more. In s.
const SILENCE: f64 = 2.0;
/// How often a board is asked whether it is there, and how long each time, s.
const GREETINGS: u32 = 8;
const GREETING: f64 = 0.4;
/// Most orders that wait; whoever clicks faster is refused.
const MOST_WAITING: usize = 100;
/// Bytes of a console's line that may come without an end before they are told as they are.
const UNENDED: usize = 4096;
/// Ticks between two times that the same bits are told.
const TOLD_EVERY: u32 = 50;
/// Most characters up to a prompt: an answer, its echo, and as much of what a check or an experiment tells meanwhile.
const MOST_TEXT: usize = 2 * ANSWER + LENGTH;

/// How far a conversation is.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// It is not known yet who is there.
    Meets,
    /// A board is there; it streams.
    Speaks,
    /// No board, or one of another release; why.
    Ended(String),
}

/// What is under way.
#[derive(Clone, Debug)]
enum Asked {
    /// Who is there? So many times.
    Greeting(u32),
    /// Its settings.
    Settings,
    /// Its stream.
    Stream,
    /// A line for somebody who waits for its answer.
    Line(String),
}

impl Asked {
    /// What is typed for it.
    fn line(&self) -> &str {
        match self {
            Self::Greeting(_) => "",
            Self::Settings => "get",
            Self::Stream => "stream on",
            Self::Line(line) => line,
        }
    }
}

/// A conversation with a board.
pub struct Conversation {
    reader: Reader<FRAME>,
    /// What the console has said and nobody has been told.
    text: String,
    asked: Option<(Asked, f64)>,
    waiting: VecDeque<Asked>,
    bytes: Vec<u8>,
    told: VecDeque<Told>,
    standing: Standing,
    /// Its settings as they were last told; a page begins with the defaults.
    known: Config,
    config: Config,
    rows: Rows,
    twin: Twin,
    /// The row of a tick for which the core beside it has not come yet, and that the tick was late.
    held: Option<(Option<Told>, Numbers)>,
    agreed: Option<Agreement>,
    record: Recorder<Vec<u8>>,
    /// What was recorded before is void.
    anew: bool,
    /// It has spoken once.
    met: bool,
    /// When a line was last heard.
    last: f64,
    silent: bool,
}

impl Conversation {
    /// Asks who is there.
    pub fn new(now: f64) -> Self {
        let mut this = Self {
            reader: Reader::default(),
            text: String::new(),
            asked: None,
            waiting: VecDeque::new(),
            bytes: Vec::new(),
            told: VecDeque::new(),
            standing: Standing::Meets,
            known: Config::default(),
            config: Config::default(),
            rows: Rows::default(),
            twin: Twin::new(),
            held: None,
            agreed: None,
            record: Recorder::new(Vec::new()),
            anew: false,
            met: false,
            last: now,
            silent: false,
        };
        this.meet(now);
        this
    }

    /// How far it is.
    pub fn standing(&self) -> &Standing {
        &self.standing
    }

    /// Its settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        as_written(self.config.sample_time.0)
    }

    /// What is told next.
    pub fn take_told(&mut self) -> Option<Told> {
        self.told.pop_front()
    }

    /// What is to be sent now.
    pub fn take_bytes(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }

    /// The lines of the log since this was last asked, for a file that `pt326 replay` reads; and whether those before are void, since the
    /// board has started and they did not begin with a start.
    pub fn take_log(&mut self) -> (bool, Vec<u8>) {
        (std::mem::take(&mut self.anew), std::mem::take(self.record.out()))
    }

    /// Bytes have come.
    pub fn hear(&mut self, bytes: &[u8], now: f64) {
        for &byte in bytes {
            let line = match self.reader.push(byte) {
                Step::Text(b'\r') | Step::Nothing => continue,
                Step::Text(byte) => {
                    self.text += &visible(char::from(byte).encode_utf8(&mut [0; 4]));
                    continue;
                }
                Step::Line(line) => visible(line),
                Step::Broken => {
                    self.record.broken();
                    continue;
                }
            };
            self.line(&line, now);
        }
        self.answered(now, false);
        if self.asked.is_none() {
            self.say();
        }
    }

    /// Time has passed.
    pub fn pass(&mut self, now: f64) {
        self.next(now);
        if self.asked.as_ref().is_some_and(|(_, late)| now > *late) {
            self.answered(now, true);
        }
        if self.standing == Standing::Speaks && now - self.last > SILENCE + self.sample_time() {
            // It may have been reset, or another program has switched its stream off.
            self.last = now;
            if self.asked.is_none() {
                self.bytes.extend([FORGET]);
                self.bytes.extend(b"stream on\r");
            }
            if !std::mem::replace(&mut self.silent, true) {
                self.told.push_back(Told::Link(false));
            }
        }
    }

    /// Has an order carried out; what becomes of it is told.
    ///
    /// # Errors
    /// No board does this, none is there, or too many orders wait.
    pub fn order(&mut self, order: &Order, now: f64) -> anyhow::Result<()> {
        let line = line(order)?;
        ensure!(self.standing == Standing::Speaks, "the port has gone, so the board was not told");
        ensure!(
            self.waiting.len() < MOST_WAITING,
            "`{line}` was not sent: {MOST_WAITING} orders wait before it"
        );
        let fits = line.len() <= LENGTH && line.bytes().all(|byte| (b' '..=b'~').contains(&byte));
        ensure!(
            fits,
            "\"{}\" is no line for a board, expected at most {LENGTH} plain characters",
            visible(&line)
        );
        self.waiting.push_back(Asked::Line(line));
        self.next(now);
        Ok(())
    }

    /// The board was stopped: nothing that was ordered before is typed any more, and no answer to it is waited for.
    pub fn stopped(&mut self) {
        self.bytes.clear();
        let under_way = self.asked.take().map(|(asked, _)| asked);
        let (ours, theirs): (Vec<_>, Vec<_>) = under_way
            .into_iter()
            .chain(self.waiting.drain(..))
            .partition(|asked| !matches!(asked, Asked::Line(_)));
        for asked in theirs {
            self.refuse(format!("`{}` was stopped before it was done", asked.line()));
        }
        // What is asked for no one heats nothing, and is asked again.
        self.waiting.extend(ours);
        self.say();
    }

    /// The port has gone.
    pub fn lost(&mut self) {
        self.stopped();
        self.waiting.clear();
        self.release(None);
        self.reader = Reader::default();
        self.text.clear();
        self.silent = true;
        self.standing = Standing::Meets;
        self.told.push_back(Told::Link(false));
    }

    /// It is open again.
    pub fn found(&mut self, now: f64) {
        self.meet(now);
    }

    /// Asks who is there, and for all that is to be known of it.
    fn meet(&mut self, now: f64) {
        self.asked = None;
        for asked in [Asked::Stream, Asked::Settings, Asked::Greeting(0)] {
            self.waiting.push_front(asked);
        }
        self.next(now);
    }

    /// Types what waits, where no answer is waited for.
    fn next(&mut self, now: f64) {
        if self.asked.is_some() {
            return;
        }
        let Some(asked) = self.waiting.pop_front() else { return };
        self.say();
        if let Asked::Greeting(_) = asked {
            self.text.clear(); // a prompt of before is no answer
        }
        let patience = match &asked {
            Asked::Greeting(_) => GREETING,
            Asked::Line(line) => patience(line, self.sample_time()),
            _ => PATIENCE,
        };
        match asked {
            Asked::Greeting(_) => self.bytes.push(FORGET),
            _ => self.bytes.extend(format!("{}\r", asked.line()).bytes()),
        }
        self.asked = Some((asked, now + patience));
    }

    /// Whether the answer has come to what is under way; `late`: or never will.
    fn answered(&mut self, now: f64, late: bool) {
        while let Some((asked, _)) = &self.asked {
            let echo = asked.line();
            // A byte that was lost on the wire makes another echo.
            let found = between(&self.text, echo).or_else(|| between(&self.text, "").filter(|_| late));
            let endless = self.text.len() > MOST_TEXT;
            let Some((before, answer, after)) = found else {
                if late || endless {
                    self.unanswered(endless, now);
                }
                return;
            };
            // What starts the board anew is answered by its start, or by why not.
            if starts(echo) && !late && refusal(&without_prompts(answer)).is_none() {
                return;
            }
            let (told, answer) = (format!("{before}{after}"), without_prompts(answer));
            let asked = asked.clone();
            self.asked = None;
            self.text = told;
            self.take(&asked, &answer);
            self.next(now);
        }
    }

    /// No answer comes.
    fn unanswered(&mut self, endless: bool, now: f64) {
        let Some((asked, _)) = self.asked.take() else { return };
        if endless {
            self.text.push_str(" [cut]\n");
            self.say();
        }
        match asked {
            Asked::Greeting(times) if times + 1 < GREETINGS || self.met => {
                self.waiting.push_front(Asked::Greeting(times.saturating_add(1)));
            }
            Asked::Greeting(_) => self.end("no answer, expected a prompt: is this the board's port?".into()),
            Asked::Settings | Asked::Stream if !self.met => {
                self.end(format!("no answer to `{}`: is this the board's port?", asked.line()));
            }
            // One that falls silent is told as such.
            Asked::Settings | Asked::Stream => {
                self.waiting.retain(|asked| matches!(asked, Asked::Line(_)));
                return self.meet(now);
            }
            Asked::Line(line) => self.refuse(format!("no answer to `{}`: {ALONE}", visible(&line))),
        }
        self.next(now);
    }

    fn end(&mut self, why: String) {
        self.waiting.clear();
        self.standing = Standing::Ended(why);
    }

    /// What an answer brings.
    fn take(&mut self, asked: &Asked, answer: &str) {
        match asked {
            Asked::Greeting(_) => {}
            Asked::Settings => match self.settings(answer) {
                Ok(()) => {}
                Err(error) if !self.met => self.end(format!("{error:#}")),
                Err(error) => {
                    // Another board than before, of which nothing can be shown.
                    self.waiting.retain(|asked| matches!(asked, Asked::Line(_)));
                    self.refuse(format!("{error:#}"));
                }
            },
            Asked::Stream => {
                let (met, silent) =
                    (std::mem::replace(&mut self.met, true), std::mem::take(&mut self.silent));
                match (met, silent) {
                    (true, false) => {}
                    (true, true) => self.told.push_back(Told::Link(true)),
                    // It may have streamed already: nothing of that is told before it is there.
                    (false, _) => self.told.push_front(Told::Link(true)),
                }
                if let Standing::Meets = std::mem::replace(&mut self.standing, Standing::Speaks) {
                    self.tell_settings();
                }
            }
            Asked::Line(line) => {
                self.told.push_back(Told::Said(format!("> {line}\n{}", answer.trim_end())));
                if let Some(error) = refusal(answer) {
                    self.refuse(format!("the board says to `{line}`: {error}"));
                }
            }
        }
    }

    fn settings(&mut self, answer: &str) -> anyhow::Result<()> {
        ensure!(answer.contains(" = "), "no answer to `get` as a board gives it: is this the board's port?");
        let config = settings::read(answer)?;
        self.rows.retune(&config)?;
        self.config = config;
        if self.standing == Standing::Speaks {
            self.tell_settings();
        }
        Ok(())
    }

    /// The settings that are not as they were last told.
    fn tell_settings(&mut self) {
        for setting in Config::settings() {
            if let (Value::Number(value), before) = (self.config.get(setting), self.known.get(setting))
                && before != Value::Number(value)
            {
                self.told.push_back(Told::Order(Order::Set { name: setting.name.into(), value }));
            }
        }
        let names = Names::of(&self.config);
        if names != Names::of(&self.known) {
            self.told.push_back(Told::Names(names));
        }
        self.known = self.config.clone();
    }

    fn refuse(&mut self, why: String) {
        self.told.push_back(Told::refused(why));
    }

    /// What the console says by itself, line by line.
    fn say(&mut self) {
        if self.text.len() > UNENDED {
            self.text.push('\n');
        }
        self.told.extend(take_lines(&mut self.text).into_iter().map(Told::Said));
    }

    /// A line of the stream.
    fn line(&mut self, line: &str, now: f64) {
        self.last = now;
        if self.met && std::mem::take(&mut self.silent) {
            self.told.push_back(Told::Link(true));
        }
        let parsed = LogLine::find(line).ok().flatten();
        if let Some(LogLine::Start { .. }) = parsed {
            self.started(now);
        }
        let _ = self.record.line(line); // into memory
        let Some(parsed) = parsed else { return };
        if let LogLine::Image(image) = parsed {
            self.told.push_back(Told::image(image));
        }
        let ends = Twin::ends_tick(&parsed);
        let core = self.twin.line(parsed);
        if ends || !self.twin.runs() {
            self.release(core);
        }
        let news = self.rows.line(line);
        let mut told = news.told;
        if self.twin.runs()
            && let Some(Told::Row(row)) = told.pop_if(|told| matches!(told, Told::Row(_)))
        {
            self.held = Some((told.pop_if(|told| matches!(told, Told::Late { .. })), row));
        }
        self.told.extend(told);
        self.tell_agreement();
        if news.settings {
            self.waiting.push_front(Asked::Settings);
            self.next(now);
        }
    }

    /// The row that is held, with what only the core beside the board knows.
    fn release(&mut self, core: Option<Numbers>) {
        let Some((late, mut row)) = self.held.take() else { return };
        for (board, core) in row.iter_mut().zip(core.into_iter().flatten()) {
            if board.is_nan() {
                *board = core;
            }
        }
        self.told.extend(late.into_iter().chain([Told::Row(row)]));
    }

    /// Tells how the core beside the board agrees, of ticks that are the same now and then.
    fn tell_agreement(&mut self) {
        let now = &self.twin.agreement;
        let is_news = match (now, &self.agreed) {
            (Agreement::Same(ticks), Some(Agreement::Same(told))) => {
                *ticks >= told.saturating_add(TOLD_EVERY)
            }
            (now, before) => before.as_ref() != Some(now),
        };
        if is_news {
            self.agreed = Some(now.clone());
            self.told.push_back(Told::Agrees(now.clone()));
        }
    }

    /// A board has started anew, by whatever hand: what was asked of the one before is void.
    fn started(&mut self, now: f64) {
        if self.record.ticks > 0 && !self.record.from_start {
            (self.record, self.anew) = (Recorder::new(Vec::new()), true);
        }
        match self.asked.take() {
            Some((Asked::Line(line), _)) if starts(&line) => {
                self.told.push_back(Told::Said(format!("> {line}\nthe board has started anew")));
            }
            Some((Asked::Line(line), _)) => {
                self.refuse(format!("no answer to `{line}`: the board has started anew"))
            }
            _ => {}
        }
        self.text.clear();
        if self.standing == Standing::Speaks {
            self.waiting.retain(|asked| matches!(asked, Asked::Line(_)));
            self.meet(now);
        }
    }
}

/// Whether a line starts the board anew.
fn starts(line: &str) -> bool {
    matches!(Request::parse(line), Ok(Request::Restart | Request::Simulate))
}

/// How long the answer to a line may take, s. Whoever watches is to hear soon that a board has fallen silent; what erases flash or searches
/// takes its time.
fn patience(line: &str, sample_time: f64) -> f64 {
    let is_slow =
        ["save", "brownout", "tune", "teach", "commission"].iter().any(|word| line.starts_with(word));
    if is_slow || starts(line) { PATIENCE } else { SILENCE + 2.0 * sample_time }
}

/// Whether an order stops the board, by its button or typed: it does not wait for its turn.
pub fn stops(order: &Order) -> bool {
    let typed = |line: &str| line.trim_start().starts_with("stop") || line.bytes().any(is_stop_key);
    *order == Order::Stop || matches!(order, Order::Console { line } if typed(line))
}

/// What is typed for an order.
///
/// # Errors
/// A board has nothing that does this.
pub fn line(order: &Order) -> anyhow::Result<String> {
    Ok(match order {
        Order::Arm => "arm".into(),
        Order::Tune => "tune start".into(),
        Order::Stop => "stop".into(),
        Order::Acknowledge => "ack".into(),
        Order::Shelve { seconds } => format!("shelve {}", seconds / 60.0),
        Order::Relearn => "baseline learn".into(),
        Order::Accept => "accept".into(),
        Order::Setpoint { celsius } => format!("set setpoint {celsius}"),
        Order::Fan { percent } => format!("fan {percent}"),
        Order::Set { name, value } => format!("set {name} {value}"),
        Order::Console { line } => line.clone(),
        Order::Excite { .. } => bail!("a board's excitation is not switched from here"),
        Order::Break { .. } | Order::Mend => bail!("a real rig is broken and mended by hand"),
    })
}
