//! The samples of a plot for the script of a page: columns of 16-bit steps, as text.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};

use super::plot::Plot;
use super::series::SeriesKind;
use super::thin::kept_rows;

/// Rows of a curve that a page carries; of longer ones some, see [`kept_rows`].
const MOST_ROWS: usize = 3000;
/// Steps between the least and the largest value of a column; one more code says that there is no value.
const STEPS: u16 = u16::MAX - 1;

/// Points of the series in each view: as it is drawn, then over every other variable.
fn views(plot: &Plot) -> Vec<Vec<&[(f64, f64)]>> {
    let first = plot.series.iter().map(|s| s.points.as_slice()).collect();
    let others = plot.over.iter().map(|view| view.points.iter().map(Vec::as_slice).collect());
    std::iter::once(first).chain(others).collect()
}

/// What the script of a page needs of a plot: `columns`, each as its least value, its step and its codes (16 bits,
/// low byte first, Base64); `views`, each with the name of x, the range of its axes and the columns of each curve.
pub(super) fn samples(plot: &Plot) -> Value {
    let views = views(plot);
    let mut columns: Vec<Value> = Vec::new();
    let mut place = |values: Vec<f64>| {
        let encoded = encoded(&values);
        columns.iter().position(|known| *known == encoded).unwrap_or_else(|| {
            columns.push(encoded);
            columns.len() - 1
        })
    };
    let rows = rows(&views);
    let mut told = Vec::new();
    for (view, rows) in views.iter().zip(&rows) {
        let curves: Vec<[usize; 2]> = view
            .iter()
            .zip(rows)
            .map(|(points, rows)| {
                [rows.iter().map(|&k| points[k].0).collect(), rows.iter().map(|&k| points[k].1).collect()]
                    .map(&mut place)
            })
            .collect();
        told.push(curves);
    }
    let views: Vec<Value> = (0..told.len())
        .map(|v| {
            let (name, [x, y]) = (plot.name_of_x(v), plot.axes(v).map(|axis| axis.range()));
            json!({"x": name, "time": name == Plot::TIME, "range": [x[0], x[1], y[0], y[1]], "curves": told[v]})
        })
        .collect();
    let kind = |kind: SeriesKind| match kind {
        SeriesKind::Line => "line",
        SeriesKind::Points => "points",
        SeriesKind::Stems => "stems",
    };
    let curves: Vec<Value> = plot
        .series
        .iter()
        .map(|s| json!({"label": s.label, "role": s.role.class(), "kind": kind(s.kind)}))
        .collect();
    json!({"y": plot.y, "curves": curves, "views": views, "columns": columns,
        "bands": plot.bands.iter().map(|b| [b.from, b.to]).collect::<Vec<_>>()})
}

/// The rows that are kept of each curve in each view. Curves with the same x, and a curve in all views in which it has
/// as many points, are of the same rows.
fn rows(views: &[Vec<&[(f64, f64)]>]) -> Vec<Vec<Vec<usize>>> {
    let Some(first) = views.first() else { return Vec::new() };
    let same_x = |a: &[(f64, f64)], b: &[(f64, f64)]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0.to_bits() == b.0.to_bits())
    };
    let leader: Vec<usize> =
        (0..first.len()).map(|s| (0..s).find(|&k| same_x(first[k], first[s])).unwrap_or(s)).collect();
    let of = |members: &[&[(f64, f64)]]| {
        let count = members.first().map_or(0, |m| m.len());
        let column = |f: fn(&(f64, f64)) -> f64| -> Vec<Vec<f64>> {
            members.iter().map(|m| m.iter().map(f).collect()).collect()
        };
        let (x, mut y) = (column(|p| p.0), column(|p| p.1));
        // The same residual over another variable adds no extremes.
        y.dedup_by(|a, b| a.iter().zip(b.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
        let [x, y] = [&x, &y].map(|columns| columns.iter().map(Vec::as_slice).collect::<Vec<_>>());
        kept_rows(count, &x, &y, MOST_ROWS)
    };
    let shared: Vec<Vec<usize>> = (0..first.len())
        .map(|s| {
            let members = (0..first.len()).filter(|&k| leader[k] == leader[s]);
            let of_series = |k: usize| views.iter().filter_map(move |view| view.get(k).copied());
            let fits: Vec<&[(f64, f64)]> =
                members.flat_map(of_series).filter(|points| points.len() == first[s].len()).collect();
            of(&fits)
        })
        .collect();
    let of_view = |view: &Vec<&[(f64, f64)]>| -> Vec<Vec<usize>> {
        let one = |(s, points): (usize, &&[(f64, f64)])| match first.get(s) {
            Some(known) if known.len() == points.len() => shared[s].clone(),
            _ => of(&[points]),
        };
        view.iter().enumerate().map(one).collect()
    };
    views.iter().map(of_view).collect()
}

/// Least value, step, codes.
fn encoded(values: &[f64]) -> Value {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return json!([0.0, 0.0, BASE64_STANDARD.encode(vec![u8::MAX; 2 * values.len()])]);
    }
    let step = (high - low) / f64::from(STEPS);
    let code = |v: f64| match v.is_finite() {
        true if step > 0.0 => ((v - low) / step).round() as u16,
        true => 0,
        false => u16::MAX,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|&v| code(v).to_le_bytes()).collect();
    json!([low, step, BASE64_STANDARD.encode(bytes)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Role;

    #[test]
    fn a_column_that_several_curves_have_is_carried_once() {
        let points =
            |f: fn(f64) -> f64| (0..9000).map(|k| (f64::from(k), f(f64::from(k)))).collect::<Vec<_>>();
        let (a, b) = (points(f64::sin), points(f64::cos));
        let swapped = |p: &[(f64, f64)]| p.iter().map(|p| ((0.1 * p.0).sin(), p.1)).collect::<Vec<_>>();
        let over = vec![swapped(&a), swapped(&b)];
        let plot = Plot::new("t", Plot::TIME, "y")
            .with("a", Role::Before, SeriesKind::Points, a)
            .with("b", Role::After, SeriesKind::Points, b)
            .over("q, rad", over);
        let told = samples(&plot);
        assert_eq!(told["columns"].as_array().map(Vec::len), Some(4));
        assert_eq!(told["views"][0]["curves"], json!([[0, 1], [0, 2]]));
        assert_eq!(told["views"][1]["curves"], json!([[3, 1], [3, 2]]));
        assert_eq!((&told["views"][0]["time"], &told["views"][1]["time"]), (&json!(true), &json!(false)));
    }

    #[test]
    fn what_is_no_number_has_a_code_of_its_own() {
        assert_eq!(encoded(&[0.0, f64::NAN, 1.0])[2], json!("AAD///7/"));
        assert_eq!(encoded(&[f64::NAN])[2], json!("//8="));
        assert_eq!(encoded(&[3.0, 3.0])[0], json!(3.0));
    }
}
