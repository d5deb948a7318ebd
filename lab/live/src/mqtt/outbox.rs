//! What is to be said to a broker: each message once, in order, the next one when the last was acknowledged.

use std::collections::{BTreeMap, VecDeque};

/// Messages that wait for a broker; of more the oldest is dropped, and the number in the others says so.
const MOST_WAITING: usize = 10_000;

/// A retained message.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Message {
    pub(super) topic: String,
    pub(super) payload: String,
}

/// What waits, and what the broker has.
#[derive(Default)]
pub(super) struct Outbox {
    waiting: VecDeque<Message>,
    /// The first that waits was sent, and is not acknowledged.
    under_way: bool,
    connected: bool,
    /// What the broker has acknowledged last, by topic.
    told: BTreeMap<String, String>,
}

impl Outbox {
    pub(super) fn push(&mut self, message: Message) {
        self.waiting.push_back(message);
        if self.waiting.len() > MOST_WAITING {
            self.waiting.remove(usize::from(self.under_way));
        }
    }

    /// A connection to a broker; one that does not remember is told all that it should retain again. `greeting` goes first.
    pub(super) fn connected(&mut self, remembers: bool, greeting: Message) {
        self.connected = true;
        if !remembers {
            self.under_way = false;
            let waits = |topic: &str| self.waiting.iter().any(|message| message.topic == topic);
            let told = std::mem::take(&mut self.told).into_iter();
            let again: Vec<_> = told.filter(|(topic, _)| !waits(topic) && *topic != greeting.topic).collect();
            again
                .into_iter()
                .for_each(|(topic, payload)| self.waiting.push_front(Message { topic, payload }));
        }
        self.waiting.insert(usize::from(self.under_way), greeting);
    }

    pub(super) fn lost(&mut self) {
        self.connected = false;
    }

    pub(super) fn is_connected(&self) -> bool {
        self.connected
    }

    /// What is to be sent now.
    pub(super) fn next(&self) -> Option<&Message> {
        self.waiting.front().filter(|_| self.connected && !self.under_way)
    }

    pub(super) fn sent(&mut self) {
        self.under_way = true;
    }

    pub(super) fn acknowledged(&mut self) {
        if std::mem::take(&mut self.under_way)
            && let Some(Message { topic, payload }) = self.waiting.pop_front()
        {
            self.told.insert(topic, payload);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(topic: &str, payload: &str) -> Message {
        Message { topic: topic.into(), payload: payload.into() }
    }

    /// All that is sent, as long as the broker acknowledges.
    fn sent(outbox: &mut Outbox) -> Vec<String> {
        std::iter::from_fn(|| {
            let payload = outbox.next()?.payload.clone();
            outbox.sent();
            outbox.acknowledged();
            Some(payload)
        })
        .collect()
    }

    #[test]
    fn what_was_said_while_no_broker_was_there_is_said_once() {
        let mut outbox = Outbox::default();
        for payload in ["1", "2"] {
            outbox.push(message("trip", payload));
        }
        assert_eq!(outbox.next(), None);
        outbox.connected(false, message("hello", "on"));
        assert_eq!(sent(&mut outbox), ["on", "1", "2"]);
        outbox.lost();
        outbox.push(message("trip", "3"));
        outbox.connected(true, message("hello", "on"));
        assert_eq!(sent(&mut outbox), ["on", "3"]);
    }

    /// The client behind it sends that one again by itself.
    #[test]
    fn what_was_under_way_to_a_broker_that_remembers_is_not_said_twice() {
        let mut outbox = Outbox::default();
        outbox.connected(false, message("hello", "on"));
        sent(&mut outbox);
        for payload in ["1", "2"] {
            outbox.push(message("trip", payload));
        }
        outbox.sent();
        outbox.lost();
        outbox.connected(true, message("hello", "on"));
        assert_eq!(outbox.next(), None, "until it is acknowledged");
        outbox.acknowledged();
        assert_eq!(sent(&mut outbox), ["on", "2"]);
    }

    #[test]
    fn a_broker_that_forgot_is_told_again_what_it_should_retain() {
        let mut outbox = Outbox::default();
        outbox.connected(false, message("hello", "on"));
        for (topic, payload) in [("trip", "1"), ("trip", "2"), ("finding", "1")] {
            outbox.push(message(topic, payload));
        }
        sent(&mut outbox);
        outbox.push(message("finding", "2"));
        outbox.sent();
        outbox.lost();
        outbox.connected(false, message("hello", "on"));
        assert_eq!(sent(&mut outbox), ["on", "2", "2"], "the last trip, and what was under way");
    }

    #[test]
    fn it_is_bounded_and_what_is_under_way_is_kept() {
        let mut outbox = Outbox::default();
        outbox.connected(true, message("hello", "on"));
        outbox.sent();
        (0..MOST_WAITING + 5).for_each(|i| outbox.push(message("trip", &i.to_string())));
        outbox.acknowledged();
        let sent = sent(&mut outbox);
        assert_eq!((sent.len(), &*sent[0]), (MOST_WAITING - 1, "6"));
    }
}
