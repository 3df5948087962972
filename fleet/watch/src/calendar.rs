//! Days since 1970 as dates.

/// Year, month and day of the proleptic Gregorian calendar as `2026-03-04` (H. Hinnant, chrono-Compatible Low-Level Date
/// Algorithms, civil_from_days).
pub(crate) fn date(day: i64) -> String {
    let shifted = day.saturating_add(719_468);
    let era = shifted.div_euclid(146_097);
    let of_era = shifted.rem_euclid(146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{of_month:02}")
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn days_are_dates_leap_years_included() {
        let dates = [0, 59, 11_016, 20_515, -1, 19_782].map(date);
        assert_eq!(
            dates,
            ["1970-01-01", "1970-03-01", "2000-02-29", "2026-03-03", "1969-12-31", "2024-02-29"]
        );
        assert!(!date(i64::MAX).is_empty() && !date(i64::MIN).is_empty());
    }
}
