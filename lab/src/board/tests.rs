use fdi_core::schema::Numbers;
use fdi_core::{AdcCode, Command, Config, Instrument, RawSample};
use firmware_logic::control_loop::TickRecord;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::stream::frame;

use super::*;
use crate::scene::Order;
use crate::told::Told;

/// A board that is asked who it is, its settings, its stream; and what else is said.
struct Board {
    conversation: Conversation,
    now: f64,
    typed: String,
}

impl Board {
    /// One that answers.
    fn new() -> Self {
        let mut board = Self { conversation: Conversation::new(0.0), now: 0.0, typed: String::new() };
        for answer in ["\r\n> ", "get\r\nsetpoint = 36 degC\r\n> ", "stream on\r\nok\r\n> "] {
            board.hears();
            board.says(answer.as_bytes());
        }
        assert_eq!(board.typed, "\u{15}get\rstream on\r");
        assert_eq!(*board.conversation.standing(), Standing::Speaks);
        board
    }

    fn says(&mut self, bytes: &[u8]) {
        self.conversation.hear(bytes, self.now);
    }

    fn streams(&mut self, line: &str) {
        let mut framed = String::new();
        frame::write(&line, &mut framed).unwrap();
        self.says(framed.as_bytes());
    }

    /// Takes what is sent to it; all since the beginning.
    fn hears(&mut self) -> &str {
        self.typed += &String::from_utf8(self.conversation.take_bytes()).unwrap();
        &self.typed
    }

    fn waits(&mut self, seconds: f64) {
        for _ in 0..(seconds * 10.0) as u32 {
            self.now += 0.1;
            self.conversation.pass(self.now);
            self.hears();
        }
    }

    fn told(&mut self) -> Vec<Told> {
        std::iter::from_fn(|| self.conversation.take_told()).collect()
    }
}

/// The records of a board that was armed before tick 3.
fn records(ticks: u32) -> Vec<TickLine> {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    let code = |k: u32| AdcCode(2000.0 + (k % 7) as f32);
    let record = |k| {
        if k == 3 {
            instrument.command(Command::Arm).unwrap();
        }
        let raw = RawSample { t0: code(k), t1: code(k + 1), t2: code(k + 2), supply: AdcCode(0.0) };
        let tick = instrument.control(raw);
        let report = instrument.diagnose(&tick, tick.drive);
        TickLine::new(&TickRecord::new(raw, tick, tick.drive), &report)
    };
    (0..ticks).map(record).collect()
}

fn agreements(told: &[Told]) -> Vec<&Agreement> {
    told.iter()
        .filter_map(|told| if let Told::Agrees(agreement) = told { Some(agreement) } else { None })
        .collect()
}

fn rows(told: &[Told]) -> Vec<&Numbers> {
    told.iter().filter_map(|told| if let Told::Row(row) = told { Some(row) } else { None }).collect()
}

/// What the board says to a whole start; a line of `instead` in place of another.
fn start(board: &mut Board, instead: impl Fn(u32, TickLine) -> Option<TickLine>) -> Vec<Told> {
    board.streams("log format 5");
    for answer in ["\r\n> ", "get\r\nsetpoint = 35 degC\r\n> ", "stream on\r\nok\r\n> "] {
        board.hears();
        board.says(answer.as_bytes());
    }
    for (k, record) in (0..).zip(records(60)) {
        if k == 3 {
            board.streams("order 3 arm");
        }
        if let Some(record) = instead(k, record) {
            board.streams(&record.to_string());
            board.streams(&format!("cycles {k} 1 1"));
        }
    }
    board.told()
}

/// A board that streams already, or whose first ticks come with its answer, is there before they are told.
#[test]
fn ticks_that_come_before_the_answer_are_told_after_the_connection() {
    let mut board = Board { conversation: Conversation::new(0.0), now: 0.0, typed: String::new() };
    for answer in ["\r\n> ", "get\r\nsetpoint = 36 degC\r\n> "] {
        board.hears();
        board.says(answer.as_bytes());
    }
    board.hears();
    for (k, record) in (0..).zip(records(3)) {
        board.streams(&record.to_string());
        board.streams(&format!("cycles {k} 1 1"));
    }
    board.says(b"stream on\r\nok\r\n> ");
    let told = board.told();
    assert_eq!(told[0], Told::Link(true), "{told:?}");
    assert_eq!(rows(&told).len(), 3, "{told:?}");
}

#[test]
fn who_is_there_is_told_with_its_settings() {
    let mut board = Board::new();
    let told = board.told();
    assert_eq!(told[0], Told::Link(true));
    assert!(told.contains(&Told::Order(Order::Set { name: "setpoint".into(), value: 36.0 })), "{told:?}");
    assert_eq!(board.conversation.config().setpoint.0, 36.0);
}

/// What the board says of itself comes with its stream, before or after the connection.
#[test]
fn which_image_a_board_runs_is_told_with_the_format_that_is_read_here() {
    let mut board = Board::new();
    board.streams("image 0.2.0 (1a2b3c4-dirty) on NUCLEO-F446RE, format 6");
    let told = board.told();
    let image = told.iter().find(|told| matches!(told, Told::Image { .. })).and_then(|told| told.message(0));
    let expected = serde_json::json!({
        "type": "image", "release": "0.2.0", "commit": "1a2b3c4-dirty", "board": "NUCLEO-F446RE", "format": 6, "expected": 5
    });
    assert_eq!(image, Some(expected), "{told:?}");
    board.streams("image of a board");
    assert_eq!(board.told(), []);
}

#[test]
fn where_nobody_answers_or_no_board_that_is_said() {
    for answer in ["", "login: ", "\r\n> "] {
        let mut conversation = Conversation::new(0.0);
        for k in 0..400 {
            conversation.pass(0.1 * f64::from(k));
            if !conversation.take_bytes().is_empty() {
                conversation.hear(answer.as_bytes(), 0.1 * f64::from(k));
            }
        }
        let Standing::Ended(why) = conversation.standing() else { panic!("{answer:?} is a board") };
        assert!(why.contains("is this the board's port?"), "{why}");
    }
}

#[test]
fn a_setting_that_is_not_known_here_ends_it() {
    let mut conversation = Conversation::new(0.0);
    for answer in ["\r\n> ", "get\r\nwarp.factor = 9\r\n> "] {
        conversation.take_bytes();
        conversation.hear(answer.as_bytes(), 0.0);
    }
    let Standing::Ended(why) = conversation.standing() else { panic!("it goes on") };
    assert!(why.contains("warp.factor = 9") && why.contains("release"), "{why}");
}

#[test]
fn an_order_is_typed_when_the_one_before_is_answered_and_its_answer_is_told() {
    let mut board = Board::new();
    board.told();
    board.typed.clear();
    for line in ["status", "arm"] {
        board.conversation.order(&Order::Console { line: line.into() }, 0.0).unwrap();
    }
    assert_eq!(board.hears(), "status\r");
    board.says(b"status\r\nmode off\r\n> ");
    assert_eq!(board.hears(), "status\rarm\r");
    board.says(b"arm\r\nerror: no `check` has passed\r\n> ");
    let told = board.told();
    assert_eq!(told[0], Told::Said("> status\nmode off".into()));
    assert!(matches!(&told[2], Told::Refused { why, .. } if why.contains("no `check`")), "{told:?}");
    assert!(board.conversation.order(&Order::Console { line: "x".repeat(121) }, 0.0).is_err());
    assert!(board.conversation.order(&Order::Console { line: "a\rarm".into() }, 0.0).is_err());
}

#[test]
fn nothing_that_was_ordered_before_a_stop_is_typed_behind_it() {
    let mut board = Board::new();
    board.told();
    board.typed.clear();
    for line in ["status", "arm", "tune start"] {
        board.conversation.order(&Order::Console { line: line.into() }, 0.0).unwrap();
    }
    board.conversation.stopped();
    board.says(b"sta^C\r\nstopped\r\n> ");
    board.waits(30.0);
    assert!(!board.typed.contains("arm") && !board.typed.contains("tune"), "{:?}", board.typed);
    let refused = board.told().iter().filter(|told| matches!(told, Told::Refused { .. })).count();
    assert_eq!(refused, 3);
    assert!(stops(&Order::Stop) && stops(&Order::Console { line: " stop it".into() }));
    assert!(stops(&Order::Console { line: "se!t".into() }) && !stops(&Order::Arm));
}

#[test]
fn a_core_beside_a_board_comes_to_the_same_bits_and_fills_what_no_log_holds() {
    let mut board = Board::new();
    let told = start(&mut board, |_, record| Some(record));
    let all = agreements(&told);
    assert!(matches!(all[..], [Agreement::Same(0), .., Agreement::Same(50)]), "{all:?}");
    assert_eq!(rows(&told).len(), 60);
    let (anew, log) = board.conversation.take_log();
    let log = String::from_utf8(log).unwrap();
    assert!(!anew && log.starts_with("log format 5\n") && log.contains("order 3 arm\ntick 3 "), "{log}");
}

#[test]
fn a_number_that_differs_and_a_record_that_is_missing_are_told() {
    let mut board = Board::new();
    let told = start(&mut board, |k, mut record| {
        record.0[8] ^= u32::from(k == 40); // what the controller drives
        Some(record)
    });
    let all = agreements(&told);
    assert!(matches!(all[..], [.., Agreement::Differs { tick: 40, .. }]), "{all:?}");
    assert_eq!(rows(&told).len(), 60, "what the board says is shown in any case");
    let mut board = Board::new();
    let told = start(&mut board, |k, record| (k != 40).then_some(record));
    assert_eq!(agreements(&told).last(), Some(&&Agreement::NotWhole));
    assert_eq!(rows(&told).len(), 60, "a row stands for the one that is missing");
    let mut board = Board::new();
    board.streams("log format 6");
    let told = board.told();
    assert_eq!(agreements(&told), [&Agreement::Format(6)]);
}

#[test]
fn a_port_that_has_gone_comes_back_with_what_was_missed_as_a_gap() {
    let mut board = Board::new();
    let lines = records(30);
    board.streams(&lines[0].to_string());
    board.conversation.order(&Order::Arm, 0.0).unwrap();
    board.conversation.lost();
    assert!(board.conversation.order(&Order::Arm, 0.0).is_err(), "nobody is there");
    let told = board.told();
    assert_eq!(told.last(), Some(&Told::Link(false)));
    board.typed.clear();
    board.conversation.found(board.now);
    for answer in ["\r\n> ", "get\r\nsetpoint = 36 degC\r\n> ", "stream on\r\nok\r\n> "] {
        board.hears();
        board.says(answer.as_bytes());
    }
    board.streams(&lines[20].to_string());
    let told = board.told();
    assert!(told.contains(&Told::Link(true)) && rows(&told).len() == 20, "{told:?}");
    assert!(!board.hears().contains("arm"), "what was ordered before is not carried out later");
}

#[test]
fn another_board_at_the_port_of_which_nothing_can_be_shown_is_told() {
    let mut board = Board::new();
    board.conversation.lost();
    board.conversation.found(board.now);
    board.told();
    for answer in ["\r\n> ", "get\r\nwarp.factor = 9\r\n> "] {
        board.hears();
        board.says(answer.as_bytes());
    }
    board.waits(5.0);
    let told = board.told();
    assert!(matches!(&told[..], [Told::Refused { why, .. }] if why.contains("warp.factor")), "{told:?}");
    assert!(board.conversation.order(&Order::Arm, board.now).is_err());
}

#[test]
fn a_board_that_falls_silent_is_missed_and_asked_for_its_stream() {
    let mut board = Board::new();
    board.told();
    board.typed.clear();
    board.waits(5.0);
    assert_eq!(board.told(), [Told::Link(false)]);
    assert!(board.hears().starts_with("\u{15}stream on\r"));
    board.streams("mode 3 off -> settle");
    assert_eq!(board.told()[0], Told::Link(true));
}

mod hostile {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Bytes of any kind, and lines that are nearly those of a board.
        #[test]
        fn no_bytes_panic_or_are_told_as_they_are(bytes: Vec<u8>, lines in proptest::collection::vec("(tick|order|setting|baseline|commissioned|log format|lockout|dropped|denied)[ 0-9a-f.=]{0,300}|order [0-9]{1,10} (arm|settings|setpoint [0-9a-f]{8})", 0..20)) {
            let mut board = Board::new();
            board.says(&bytes);
            lines.iter().for_each(|line| board.streams(line));
            board.says(b"\n");
            for told in board.told() {
                if let Told::Said(text) | Told::Refused { why: text, .. } = told {
                    prop_assert!(text.chars().all(|c| matches!(c, '\n' | '\t' | ' '..='~')), "{text:?}");
                }
            }
        }
    }

    #[test]
    fn what_never_ends_is_told_in_pieces_and_not_kept() {
        let mut board = Board::new();
        board.told();
        for _ in 0..10_000 {
            board.says(&[b'x'; 1024]);
            for told in board.told() {
                assert!(matches!(told, Told::Said(text) if text.len() < 10_000));
            }
        }
        // An order that is never answered ends, too.
        board.conversation.order(&Order::Arm, board.now).unwrap();
        for _ in 0..100 {
            board.says(&[b'x'; 1024]);
        }
        assert!(board.told().iter().any(|told| matches!(told, Told::Refused { .. })));
    }
}
