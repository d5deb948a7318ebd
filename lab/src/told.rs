//! What whatever is watched tells, in the order in which it happens.

use fdi_core::schema::Numbers;
use firmware_logic::log_line::{Image, VERSION};
use serde_json::{Value, json};

use crate::board::Agreement;
use crate::board::text::persists;
use crate::names::Names;
use crate::scene::Order;

/// Something that is told to all who watch.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// A tick.
    Row(Numbers),
    /// A tick of a board was not in time; goes before its row. Pages are not told.
    Late {
        /// How late it began, µs.
        micros: u32,
        /// It never began.
        missed: bool,
    },
    /// An order was carried out, by whomever it was given; in force from the next row on.
    Order(Order),
    /// An order was not carried out.
    Refused {
        /// Why, in words.
        why: String,
        /// Name of the trip whose cause persists, where that is why.
        persists: Option<&'static str>,
    },
    /// What a user calls faults of his own, from now on.
    Names(Names),
    /// What the board's console has said.
    Said(String),
    /// Whether there is a connection to what is watched.
    Link(bool),
    /// How the core beside a board agrees with it.
    Agrees(Agreement),
    /// Which image a board runs.
    Image {
        /// Its release.
        release: String,
        /// The state of its sources.
        commit: String,
        /// Name of its board.
        board: String,
        /// The format of its log.
        format: u32,
    },
}

impl Told {
    /// A refusal in the words of a board.
    pub fn refused(why: String) -> Self {
        Self::Refused { persists: persists(&why), why }
    }

    /// A board has said which image it runs.
    pub fn image(Image { release, commit, board, format }: Image<'_>) -> Self {
        let [release, commit, board] = [release, commit, board].map(str::to_owned);
        Self::Image { release, commit, board, format }
    }

    /// The message that says so; `tick` is the next. A row goes with others, and times are not for pages.
    pub fn message(&self, tick: usize) -> Option<Value> {
        Some(match self {
            Self::Row(_) | Self::Late { .. } => return None,
            Self::Order(order) => json!({ "type": "order", "tick": tick, "order": order }),
            Self::Refused { why, persists: None } => json!({ "type": "refused", "why": why }),
            Self::Refused { why, persists: Some(trip) } => {
                json!({ "type": "refused", "why": why, "code": "persists", "values": { "trip": trip } })
            }
            Self::Names(Names { rows, taught }) => {
                json!({ "type": "names", "own_names": rows, "taught_names": taught })
            }
            Self::Said(text) => json!({ "type": "said", "text": text }),
            Self::Link(up) => json!({ "type": "link", "up": up }),
            Self::Image { release, commit, board, format } => {
                json!({ "type": "image", "release": release, "commit": commit, "board": board, "format": format, "expected": VERSION })
            }
            Self::Agrees(Agreement::NotWhole) => json!({ "type": "agrees", "whole": false }),
            Self::Agrees(Agreement::Same(ticks)) => {
                json!({ "type": "agrees", "whole": true, "ticks": ticks })
            }
            Self::Agrees(Agreement::Differs { tick, name }) => {
                json!({ "type": "agrees", "whole": true, "differs": tick, "name": name })
            }
            Self::Agrees(Agreement::Format(format)) => {
                json!({ "type": "agrees", "whole": false, "format": format, "expected": VERSION })
            }
            Self::Agrees(Agreement::Other(why)) => json!({ "type": "agrees", "whole": false, "why": why }),
        })
    }
}
