//! Points as a picture in characters.

/// Columns and rows of the picture, axes not counted.
const COLUMNS: usize = 64;
const ROWS: usize = 15;

/// Draws points; `y` and `x` are the names of the axes.
pub(super) fn picture(points: &[(f64, f64)], x: &str, y: &str) -> String {
    let range = |of: fn(&(f64, f64)) -> f64| {
        points.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let (left, right) = range(|p| p.0);
    // The axis of no torque is always there.
    let (low, high) = range(|p| p.1);
    let (low, high) = (low.min(0.0), high.max(0.0));
    if !(right > left && high > low) {
        return String::new();
    }
    let mut cells = vec![[' '; COLUMNS]; ROWS];
    let column = |v: f64| ((v - left) / (right - left) * (COLUMNS - 1) as f64).round() as usize;
    let row = |v: f64| ((high - v) / (high - low) * (ROWS - 1) as f64).round() as usize;
    cells[row(0.0)] = ['-'; COLUMNS];
    if left < 0.0 && right > 0.0 {
        cells.iter_mut().for_each(|line| line[column(0.0)] = '|');
        cells[row(0.0)][column(0.0)] = '+';
    }
    for (at, value) in points {
        cells[row(*value)][column(*at)] = '*';
    }
    let label = |k: usize| {
        let text = if k == row(0.0) {
            "0".to_owned()
        } else if k == 0 {
            short(high)
        } else if k == ROWS - 1 {
            short(low)
        } else {
            String::new()
        };
        format!("{text:>8} ")
    };
    let mut lines = vec![format!("{:9}{y}", "")];
    for (k, line) in cells.iter().enumerate() {
        let line: String = line.iter().collect();
        lines.push(format!("{}{}", label(k), line).trim_end().to_owned());
    }
    let (from, to) = (short(left), short(right));
    let gap = COLUMNS.saturating_sub(from.chars().count() + to.chars().count());
    lines.push(format!("{:9}{from}{x:^gap$}{to}", ""));
    lines.join("\n")
}

fn short(value: f64) -> String {
    dynid_runtime::report::significant(value, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_from_corner_to_corner_through_the_cross_of_the_axes() {
        let points: Vec<(f64, f64)> = (-100..=100).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        let drawn = picture(&points, "x, m", "y, N");
        let lines: Vec<&str> = drawn.lines().collect();
        assert_eq!(lines.len(), ROWS + 2);
        assert!(lines[0].trim() == "y, N" && lines[1].trim_start().starts_with("200"), "{drawn}");
        assert!(lines[1].ends_with('*') && lines[ROWS].trim_start().starts_with("-200 *"), "{drawn}");
        assert!(lines[ROWS + 1].contains("x, m"));
    }

    #[test]
    fn what_does_not_vary_is_no_picture() {
        assert_eq!(picture(&[(1.0, 0.0), (2.0, 0.0)], "x", "y"), "");
        assert_eq!(picture(&[], "x", "y"), "");
    }
}
