//! What a cell says of the time: a number, a date, a clock or a duration.

use jiff::SignedDuration;
use jiff::civil::Date;

use super::cell::{Decimal, number};

/// The seconds of an hour and of a day.
pub(super) const HOUR: f64 = 3600.0;
pub(super) const DAY: f64 = 86_400.0;

/// How the times of a column are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// A date with a clock behind it, with its fields in this order.
    Date(Order),
    /// A number with this mark before its decimals.
    Number(Decimal),
    /// Hours, minutes and seconds; of two numbers these are hours and minutes.
    Clock,
    /// The same; of two numbers these are minutes and seconds.
    Stopwatch,
    /// Words: `PT10S`, `1h 2m 3s`, `500ms`.
    Duration,
}

/// Which field of a date comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Order {
    /// Year, month, day.
    Year,
    /// Month, day, year: never with points between.
    Month,
    /// Day, month, year.
    Day,
}

/// Each month by how its name begins in English, German, Portuguese and Spanish.
const MONTHS: [&[&str]; 12] = [
    &["jan", "ene"],
    &["feb", "fev"],
    &["mar", "mär", "mrz"],
    &["apr", "abr"],
    &["may", "mai"],
    &["jun"],
    &["jul"],
    &["aug", "ago"],
    &["sep", "set"],
    &["oct", "okt", "out"],
    &["nov"],
    &["dec", "dez", "dic"],
];
const WEEKDAYS: [&str; 7] = ["mon", "tue", "wed", "thu", "fri", "sat", "sun"];
/// What clocks call their distance from UTC, and it, h.
const ZONES: [(&str, f64); 16] = [
    ("z", 0.0),
    ("utc", 0.0),
    ("gmt", 0.0),
    ("wet", 0.0),
    ("west", 1.0),
    ("bst", 1.0),
    ("cet", 1.0),
    ("cest", 2.0),
    ("est", -5.0),
    ("edt", -4.0),
    ("cst", -6.0),
    ("cdt", -5.0),
    ("mst", -7.0),
    ("mdt", -6.0),
    ("pst", -8.0),
    ("pdt", -7.0),
];

impl Form {
    /// All of them, of numbers with this mark before their decimals. A date of digits alone is no number.
    pub(super) fn all(decimal: Decimal) -> [Self; 7] {
        let [year, month, day] = [Order::Year, Order::Month, Order::Day].map(Self::Date);
        [year, Self::Number(decimal), month, day, Self::Clock, Self::Stopwatch, Self::Duration]
    }

    /// The seconds of a cell; of a number what it is.
    pub(super) fn seconds(self, cell: &str) -> Option<f64> {
        match self {
            Self::Number(decimal) => number(cell, decimal),
            Self::Date(order) => date(cell, order),
            Self::Clock => clock(cell, HOUR).filter(|_| cell.contains(':')),
            Self::Stopwatch => clock(cell, 60.0).filter(|_| cell.contains(':')),
            Self::Duration => cell.parse::<SignedDuration>().ok().map(|time| time.as_secs_f64()),
        }
    }

    /// What cells are taken for that another form reads as well, and how to say otherwise.
    pub(super) fn in_doubt(self) -> Option<&'static str> {
        match self {
            Self::Date(Order::Month) => Some("month, day and year; 2026-05-31 is never in doubt"),
            Self::Date(Order::Day) => Some("day, month and year; 2026-05-31 is never in doubt"),
            Self::Clock => Some("hours and minutes; --time-unit min says that they are minutes and seconds"),
            Self::Stopwatch => {
                Some("minutes and seconds; --time-unit h says that they are hours and minutes")
            }
            _ => None,
        }
    }

    /// Whether a clock on a wall shows such times: it is put forward and back for summer time.
    pub(super) fn is_on_a_wall(self) -> bool {
        matches!(self, Self::Date(_) | Self::Clock)
    }
}

/// Whether a cell may be a time that is no number.
pub fn is_time(cell: &str) -> bool {
    let is_no_time = |form: &Form| matches!(form, Form::Number(_) | Form::Duration);
    Form::all(Decimal::Either).iter().any(|form| !is_no_time(form) && form.seconds(cell).is_some())
}

/// Blanks, and what stands for them.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '_'
}

/// A date with a clock behind it, in s since 1970. A date alone is no time of a sample.
fn date(cell: &str, order: Order) -> Option<f64> {
    zoned(cell, order).map(|(seconds, offset)| seconds - offset)
}

/// How far from UTC the clock of a date is, s; 0 where it does not say.
pub(super) fn offset(cell: &str) -> f64 {
    let orders = [Order::Year, Order::Month, Order::Day];
    orders.into_iter().find_map(|order| zoned(cell, order)).map_or(0.0, |(_, offset)| offset)
}

/// What a clock on a wall shows, from s since 1970 on it: `2026-03-28 22:00:05`.
pub(super) fn shown(seconds: f64) -> String {
    let span = SignedDuration::from_secs(seconds.round() as i64);
    let shown = Date::constant(1970, 1, 1).to_datetime(jiff::civil::Time::midnight()).saturating_add(span);
    shown.strftime("%Y-%m-%d %H:%M:%S").to_string()
}

/// What the clock of a date shows, in s since 1970, and its distance from UTC.
fn zoned(cell: &str, order: Order) -> Option<(f64, f64)> {
    if !cell.starts_with(|c: char| c.is_alphanumeric()) || cell.len() < 10 {
        return None;
    }
    let compact = compact(cell);
    let cell = compact.as_deref().unwrap_or(cell);
    // The name of a zone in brackets says no more than the distance before it.
    let (day, clock_of) = cut(cell.split('[').next()?)?;
    // Sat Mar 28 22:00:05 2026
    let is_year = |word: &str| word.len() == 4 && word.bytes().all(|c| c.is_ascii_digit());
    let (clock_of, year) = match clock_of.rsplit_once(is_blank) {
        Some((clock, year)) if is_year(year) => (clock, year),
        _ => (clock_of, ""),
    };
    let (time, offset) = without_zone(clock_of)?;
    let seconds = clock(time, HOUR).filter(|seconds| *seconds <= DAY)?;
    Some((days(&format!("{day} {year}"), order)? * DAY + seconds, offset))
}

/// `20260328220005`, `20260328T220005` and `20260328 22:00:05` as `2026-03-28 22:00:05`.
fn compact(cell: &str) -> Option<String> {
    let (day, rest) = cell.split_at_checked(8)?;
    let rest = rest.trim_start_matches(|c: char| matches!(c, 'T' | 't' | '-') || is_blank(c));
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    if !day.bytes().all(|c| c.is_ascii_digit()) || !(day.starts_with("19") || day.starts_with("20")) {
        return None;
    }
    let (year, month, day) = (&day[..4], &day[4..6], &day[6..]);
    let time = match digits {
        2 => rest.to_owned(),
        4 => format!("{}:{}{}", &rest[..2], &rest[2..4], &rest[4..]),
        6 => format!("{}:{}:{}{}", &rest[..2], &rest[2..4], &rest[4..6], &rest[6..]),
        _ => return None,
    };
    Some(format!("{year}-{month}-{day} {time}"))
}

/// The date and the clock of a cell: the clock begins with the number before the first colon, or it is the second word.
fn cut(cell: &str) -> Option<(&str, &str)> {
    let Some(colon) = cell.find(':') else {
        return cell.split_once(is_blank).filter(|(_, time)| time.contains(['.', '-']));
    };
    let hours = cell[..colon].trim_end_matches(|c: char| c.is_ascii_digit()).len();
    // Apache's log has a colon between date and clock: `28/Mar/2026:22:00:05`.
    let is_year = cell[..hours].ends_with('/') || cell[..hours].ends_with('-');
    Some(if is_year { (&cell[..colon], &cell[colon + 1..]) } else { cell.split_at(hours) })
}

/// A clock without its distance from UTC, and that, s.
fn without_zone(cell: &str) -> Option<(&str, f64)> {
    let cell = cell.trim_end_matches(is_blank);
    let begin = cell.trim_end_matches(char::is_alphabetic).len();
    let word = cell[begin..].to_lowercase();
    if let Some((_, hours)) = ZONES.iter().find(|(name, _)| *name == word) {
        return Some((cell[..begin].trim_end_matches(is_blank), hours * HOUR));
    }
    // The year of `Sat Mar 28 22:00:00 2026` is no distance.
    let Some(at) = cell.rfind(['+', '-']).filter(|at| cell[..*at].contains(':')) else {
        return Some((cell, 0.0));
    };
    let digits: String = cell[at + 1..].chars().filter(|c| *c != ':').collect();
    let (hours, minutes) = digits.split_at_checked(2)?;
    let minutes: f64 = if minutes.is_empty() { 0.0 } else { minutes.parse().ok()? };
    let offset = hours.parse::<f64>().ok()? * HOUR + minutes * 60.0;
    Some((cell[..at].trim_end_matches(is_blank), if cell[at..].starts_with('-') { -offset } else { offset }))
}

/// Days since 1970 of a date whose fields come in this order.
fn days(day: &str, order: Order) -> Option<f64> {
    let fields = day.split(|c: char| !c.is_alphanumeric()).filter(|field| !field.is_empty());
    let lower: Vec<String> = fields.map(str::to_lowercase).collect();
    let is_filler = |field: &&String| {
        matches!(field.as_str(), "t" | "at") || WEEKDAYS.iter().any(|day| field.starts_with(day))
    };
    let mut fields: Vec<&str> = lower.iter().filter(|field| !is_filler(field)).map(String::as_str).collect();
    if let Some(last) = fields.last_mut() {
        *last =
            last.strip_suffix('t').filter(|day| day.ends_with(|c: char| c.is_ascii_digit())).unwrap_or(last);
    }
    let [a, b, c] = fields[..] else { return None };
    let (year, month, day) = match order {
        Order::Year => (a, b, c),
        Order::Month if day.contains('.') && month(a).is_none() => return None,
        Order::Month => (c, a, b),
        Order::Day => (c, b, a),
    };
    let year: i16 = match year.len() {
        4 => year.parse().ok()?,
        2 if order != Order::Year => 2000 + year.parse::<i16>().ok()?,
        _ => return None,
    };
    let date = Date::new(year, month_of(month)?, day.parse().ok()?).ok()?;
    Some(f64::from((date - Date::constant(1970, 1, 1)).get_days()))
}

/// The month of this name.
fn month(name: &str) -> Option<i8> {
    let found = MONTHS.iter().position(|names| names.iter().any(|known| name.starts_with(known)));
    found.map(|at| at as i8 + 1)
}

fn month_of(field: &str) -> Option<i8> {
    field.parse().ok().or_else(|| month(field))
}

/// A time of day or a duration: hours, minutes and seconds, perhaps thousandths; of two numbers the first counts so many s.
fn clock(cell: &str, first: f64) -> Option<f64> {
    let (days, cell) = match cell.split_once(" day") {
        Some((days, rest)) => (days.parse().ok()?, rest.trim_start_matches(['s', ',', ' '])),
        None => (0.0, cell),
    };
    let lower = cell.to_lowercase().replace("a.m.", "am").replace("p.m.", "pm");
    let (cell, half) = match lower.as_str() {
        cell if cell.ends_with("am") => (&cell[..cell.len() - 2], Some(0.0)),
        cell if cell.ends_with("pm") => (&cell[..cell.len() - 2], Some(12.0)),
        cell => (cell, None),
    };
    let cell = cell.trim_end_matches(is_blank);
    let separator = if cell.contains(':') { ':' } else { cell.chars().find(|c| matches!(c, '.' | '-'))? };
    let mut fields: Vec<&str> = cell.split(separator).collect();
    // 22:00:05:123 has thousandths.
    let thousandths = match fields[..] {
        [_, _, _, last] if last.len() == 3 => fields.pop().map_or(Some(0.0), |last| last.parse().ok())?,
        _ => 0.0,
    };
    let (hours, minutes, seconds) = match fields[..] {
        [hours, minutes, seconds] => (hours, minutes, seconds),
        [hours, minutes] if first == HOUR => (hours, minutes, "0"),
        [minutes, seconds] => ("0", minutes, seconds),
        _ => return None,
    };
    let whole = |field: &str| field.parse::<u32>().ok().map(f64::from);
    let seconds: f64 = seconds.replace(',', ".").parse().ok()?;
    let (hours, minutes) = (whole(hours)?, whole(minutes)?);
    // Twelve is the hour before one. A stopwatch may count on, and a minute may have 61 seconds.
    let hours = half.map_or(hours, |half| hours % 12.0 + half);
    let counts_on = fields.len() == 2 && first < HOUR;
    let is_day = fields.len() == 3 || first < HOUR || hours < 24.0;
    let is_time = is_day && (counts_on || minutes < 60.0) && (0.0..61.0).contains(&seconds);
    is_time.then_some(days * DAY + hours * HOUR + minutes * 60.0 + seconds + thousandths / 1000.0)
}
