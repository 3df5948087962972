//! Days: what a robot's recordings are grouped by.

use chrono::{DateTime, NaiveDate, NaiveDateTime};

/// Days since 1970-01-01, of the calendar that the times are written in.
pub type Day = i32;

const EPOCH: NaiveDate = match NaiveDate::from_ymd_opt(1970, 1, 1) {
    Some(day) => day,
    None => NaiveDate::MIN,
};

/// Reads a day: `2026-03-01`, `20260301`, or the beginning of a time, `2026-03-01T07:30:00`, with a zone or without. The day
/// is that of the text, whatever its zone.
pub fn parse(text: &str) -> Option<Day> {
    let text = text.trim();
    let date = NaiveDate::parse_from_str(text, "%Y-%m-%d")
        .or_else(|_| NaiveDate::parse_from_str(text, "%Y%m%d"))
        .or_else(|_| DateTime::parse_from_rfc3339(text).map(|time| time.date_naive()))
        .or_else(|_| NaiveDateTime::parse_from_str(text, "%Y-%m-%dT%H:%M:%S%.f").map(|time| time.date()))
        .or_else(|_| NaiveDateTime::parse_from_str(text, "%Y-%m-%d %H:%M:%S%.f").map(|time| time.date()));
    let days = date.ok()?.signed_duration_since(EPOCH).num_days();
    Day::try_from(days).ok()
}

/// `2026-03-01`
pub fn written(day: Day) -> String {
    EPOCH
        .checked_add_signed(chrono::Duration::days(day.into()))
        .map_or_else(|| format!("day {day}"), |date| date.format("%Y-%m-%d").to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_and_times_are_read_as_the_day_of_their_text() {
        for text in [
            "1970-01-02",
            "19700102",
            "1970-01-02T23:59:59+02:00",
            "1970-01-02 07:00:00.5",
            "1970-01-02T07:00:00",
        ] {
            assert_eq!(parse(text), Some(1), "{text}");
        }
        assert_eq!(written(1), "1970-01-02");
        assert_eq!(parse(&written(20_500)), Some(20_500));
        for text in ["", "yesterday", "2026-13-01", "2026-02-30"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
