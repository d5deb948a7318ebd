//! What clients can still be told: the rows of the last two hours, and the notes between them.

use std::collections::VecDeque;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use crate::source::Numbers;

/// Rows that are kept: two hours at the usual sample time.
pub(crate) const MOST_ROWS: usize = 1 << 16;
/// Notes that are kept.
const MOST_NOTES: usize = 10_000;
/// Rows in one message.
const ROWS_A_MESSAGE: usize = 500;

/// The rows and notes that are kept, numbered from the first that ever was.
#[derive(Default)]
pub(crate) struct History {
    rows: VecDeque<Numbers>,
    /// Number of the first row that is kept.
    first_row: usize,
    /// Messages, each with the tick before which it was sent.
    notes: VecDeque<(usize, String)>,
    first_note: usize,
}

/// How far a client has been told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) row: usize,
    pub(crate) note: usize,
}

impl History {
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
        Place { row, note: self.first_note + before }
    }

    /// The next message for a client, if there is any: notes and rows in the order in which they came.
    pub(crate) fn next(&self, place: &mut Place) -> Option<String> {
        place.row = place.row.max(self.first_row);
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
    use serde_json::Value;

    use super::*;

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
        let mut history = History::default();
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

    /// One that comes back goes on where it was; one that was away for too long gets what is left; one from another life all.
    #[test]
    fn who_comes_back_gets_what_was_missed_and_memory_is_bounded() {
        let mut history = History::default();
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
