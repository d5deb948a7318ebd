//! What clients can still be told: the rows of the last two hours, the notes between them, and what was counted.

use std::collections::VecDeque;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::counts::Counts;
use crate::source::Numbers;

/// Rows that are kept: two hours at the usual sample time.
pub(crate) const MOST_ROWS: usize = 1 << 16;
/// Notes that are kept.
const MOST_NOTES: usize = 10_000;
/// Rows in one message.
const ROWS_A_MESSAGE: usize = 500;

/// The rows and notes that are kept, numbered from the first of the scene.
pub(crate) struct History {
    /// What a client is told first.
    hello: Value,
    /// Of this server.
    id: String,
    /// Scenes that were here before: who was told of one of them begins anew.
    life: usize,
    rows: VecDeque<Numbers>,
    /// Number of the first row that is kept.
    first_row: usize,
    /// Messages, each with the tick before which it was sent.
    notes: VecDeque<(usize, String)>,
    first_note: usize,
    /// Over all scenes.
    pub(crate) counts: Counts,
    /// Lowest and highest set-point that is taken now, degC.
    pub(crate) setpoint_limits: Option<[f32; 2]>,
}

/// How far a client has been told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    life: usize,
    row: usize,
    note: usize,
}

impl History {
    /// Nothing yet; `hello` is what a client is told first.
    pub(crate) fn new(hello: Value, id: String) -> Self {
        let (rows, notes) = (VecDeque::new(), VecDeque::new());
        let counts = Counts::default();
        Self { hello, id, life: 0, rows, first_row: 0, notes, first_note: 0, counts, setpoint_limits: None }
    }

    /// What is watched, by the keys of `hello`.
    pub(crate) fn about(&self) -> &Value {
        &self.hello
    }

    /// What a client is told first.
    pub(crate) fn hello(&self) -> Value {
        let mut hello = self.hello.clone();
        hello["session"] = json!(self.session());
        hello
    }

    /// Another for each scene: a page that was with another begins anew.
    pub(crate) fn session(&self) -> String {
        format!("{}-{}", self.id, self.life)
    }

    /// All that was is void: `opened` says so, and `hello` what is told first from now on.
    pub(crate) fn begin(&mut self, hello: Value, mut opened: Value) {
        let mut counts = std::mem::take(&mut self.counts);
        counts.begin();
        *self = Self { life: self.life + 1, counts, ..Self::new(hello, std::mem::take(&mut self.id)) };
        opened["session"] = json!(self.session());
        self.push_note(opened.to_string());
    }

    pub(crate) fn push_row(&mut self, row: Numbers) {
        self.rows.push_back(row);
        if self.rows.len() > MOST_ROWS {
            self.rows.pop_front();
            self.first_row += 1;
        }
    }

    pub(crate) fn push_note(&mut self, note: String) {
        self.notes.push_back((self.end(), note));
        if self.notes.len() > MOST_NOTES {
            self.notes.pop_front();
            self.first_note += 1;
        }
    }

    /// Number of the row that comes next.
    pub(crate) fn end(&self) -> usize {
        self.first_row + self.rows.len()
    }

    pub(crate) fn last(&self) -> Option<&Numbers> {
        self.rows.back()
    }

    /// Where a client goes on that wants rows from one on.
    pub(crate) fn place(&self, row: usize) -> Place {
        let row = if row > self.end() { 0 } else { row };
        let before = self.notes.iter().take_while(|(tick, _)| *tick < row).count();
        Place { life: self.life, row, note: self.first_note + before }
    }

    /// The rows that come next, all there are.
    pub(crate) fn next_rows(&self, place: &mut Place) -> Vec<Numbers> {
        self.find(place);
        let rows = self.rows.range(place.row - self.first_row..).copied().collect();
        place.row = self.end();
        rows
    }

    /// Where a place is now: in another life at the beginning, and not before what is kept.
    fn find(&self, place: &mut Place) {
        if place.life != self.life {
            *place = Place { life: self.life, ..Place::default() };
        }
        place.row = place.row.max(self.first_row);
    }

    /// The next message for a client, if there is any: notes and rows in the order in which they came.
    pub(crate) fn next(&self, place: &mut Place) -> Option<String> {
        self.find(place);
        place.note = place.note.max(self.first_note);
        let note = self.notes.get(place.note - self.first_note);
        if let Some((tick, text)) = note
            && *tick <= place.row
        {
            place.note += 1;
            return Some(text.clone());
        }
        let to = note.map_or(self.end(), |(tick, _)| *tick).min(place.row + ROWS_A_MESSAGE);
        let rows = self.rows.range(place.row - self.first_row..to - self.first_row);
        let bytes: Vec<u8> = rows.flatten().flat_map(|number| number.to_le_bytes()).collect();
        if bytes.is_empty() {
            return None;
        }
        let (from, count) = (place.row, to - place.row);
        place.row = to;
        Some(
            json!({ "type": "rows", "from": from, "count": count, "values": STANDARD.encode(bytes) })
                .to_string(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history() -> History {
        History::new(json!({}), "id".into())
    }

    fn row(tick: usize) -> Numbers {
        let mut row = [0.0; _];
        row[0] = tick as f32;
        row
    }

    fn told(history: &History, place: &mut Place) -> Vec<Value> {
        std::iter::from_fn(|| history.next(place)).map(|text| serde_json::from_str(&text).unwrap()).collect()
    }

    #[test]
    fn notes_come_between_the_rows_between_which_they_were_sent() {
        let mut history = history();
        (0..3).for_each(|tick| history.push_row(row(tick)));
        history.push_note("\"a\"".into());
        (3..5).for_each(|tick| history.push_row(row(tick)));
        let mut place = history.place(0);
        let all = told(&history, &mut place);
        let spans: Vec<_> =
            all.iter().map(|m| (m["from"].as_u64(), m["count"].as_u64(), m.as_str())).collect();
        assert_eq!(spans, [(Some(0), Some(3), None), (None, None, Some("a")), (Some(3), Some(2), None)]);
        assert!(told(&history, &mut place).is_empty());
        history.push_row(row(5));
        assert_eq!(told(&history, &mut place).len(), 1, "only what is new");
    }

    /// Whoever has been told half of a scene is told of the next from its beginning, and what is remembered of the last is void.
    #[test]
    fn another_scene_begins_for_everybody() {
        let mut history = history();
        (0..5).for_each(|tick| history.push_row(row(tick)));
        history.push_note("\"old\"".into());
        let mut place = history.place(0);
        assert_eq!(told(&history, &mut place).len(), 2);
        let before = history.session();
        history.begin(json!({ "name": "new" }), json!({ "type": "opened" }));
        (0..3).for_each(|tick| history.push_row(row(tick)));
        for place in [&mut place, &mut history.place(0)] {
            let all = told(&history, place);
            assert_eq!((&all[0]["type"], &all[0]["session"]), (&json!("opened"), &json!(history.session())));
            assert_eq!((&all[1]["from"], &all[1]["count"], all.len()), (&json!(0), &json!(3), 2));
        }
        assert_ne!(history.session(), before);
        assert_eq!(history.hello()["name"], json!("new"));
    }

    /// One that comes back goes on where it was; one that was away for too long gets what is left; one from another life all.
    #[test]
    fn who_comes_back_gets_what_was_missed_and_memory_is_bounded() {
        let mut history = history();
        for tick in 0..MOST_ROWS + 100 {
            history.push_row(row(tick));
            if tick % 3 == 0 {
                history.push_note("0".into());
            }
        }
        assert_eq!((history.rows.len(), history.notes.len()), (MOST_ROWS, MOST_NOTES));
        let first = |from: usize| {
            let mut place = history.place(from);
            told(&history, &mut place).into_iter().find_map(|m| m["from"].as_u64())
        };
        assert_eq!(first(MOST_ROWS + 90), Some(MOST_ROWS as u64 + 90));
        assert_eq!(first(5), Some(100));
        assert_eq!(first(MOST_ROWS + 1000), Some(100));
    }
}
