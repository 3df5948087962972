//! Blocked Householder reduction of rows below a triangle (Schreiber and Van Loan 1989: compact WY form).

use wide::f64x4;

/// Reflectors that are gathered before the columns to their right are updated.
const PANEL: usize = 4;

/// Replaces the triangle R by that of [R; A] and destroys A.
///
/// `r` is `columns` x `columns`, column by column, upper-triangular. Column l of A is
/// `a[l * rows..(l + 1) * rows]`; `rows` is a multiple of four (pad with zero rows).
pub(super) fn reduce(columns: usize, r: &mut [f64], rows: usize, a: &mut [f64]) {
    debug_assert!(rows.is_multiple_of(4) && r.len() == columns * columns && a.len() == columns * rows);
    if rows == 0 {
        return;
    }
    let mut j = 0;
    while j < columns {
        let width = PANEL.min(columns - j);
        let (head, tail) = a.split_at_mut((j + width) * rows);
        let panel = &mut head[j * rows..];
        let t = reduce_panel(columns, r, rows, panel, j, width);
        if width == PANEL {
            let v = std::array::from_fn(|i| &panel[i * rows..(i + 1) * rows]);
            apply_panel(columns, r, rows, &Panel { first: j, v, t: &t }, tail);
        }
        j += width;
    }
}

/// Reduces the columns j..j + width and returns T with Q = I - V T VT.
fn reduce_panel(
    columns: usize,
    r: &mut [f64],
    rows: usize,
    panel: &mut [f64],
    j: usize,
    width: usize,
) -> [[f64; PANEL]; PANEL] {
    let mut t = [[0.0; PANEL]; PANEL];
    for i in 0..width {
        let (done, rest) = panel.split_at_mut(i * rows);
        let (own, right) = rest.split_at_mut(rows);
        let diagonal = &mut r[(j + i) * columns + j + i];
        let below = dot(own, own);
        if below == 0.0 {
            continue;
        }
        let norm = (*diagonal * *diagonal + below).sqrt();
        let beta = if *diagonal > 0.0 { -norm } else { norm };
        let tau = (beta - *diagonal) / beta;
        let scale = f64x4::splat(1.0 / (*diagonal - beta));
        for x in own.chunks_exact_mut(4) {
            store(x, load(x) * scale);
        }
        *diagonal = beta;
        for (l, x) in right.chunks_exact_mut(rows).enumerate().take(width - i - 1) {
            let top = &mut r[(j + i + 1 + l) * columns + j + i];
            let u = tau * (*top + dot(own, x));
            *top -= u;
            subtract(x, u, own);
        }
        // T[..i, i] = -tau T[..i, ..i] (VT v_i); the tops of different reflectors do not meet.
        let mut inner = [0.0; PANEL];
        for (k, v) in done.chunks_exact(rows).enumerate() {
            inner[k] = dot(v, own);
        }
        for (row, t) in t.iter_mut().enumerate().take(i) {
            t[i] = -tau * (row..i).map(|k| t[k] * inner[k]).sum::<f64>();
        }
        t[i][i] = tau;
    }
    t
}

/// Columns that were reduced together: Q = I - V T VT.
struct Panel<'a> {
    /// Its first column.
    first: usize,
    /// V below R.
    v: [&'a [f64]; PANEL],
    t: &'a [[f64; PANEL]; PANEL],
}

/// Applies QT of the panel to every column to its right, two at a time.
fn apply_panel(columns: usize, r: &mut [f64], rows: usize, panel: &Panel<'_>, tail: &mut [f64]) {
    let &Panel { first: j, v, t } = panel;
    let mut pairs = tail.chunks_exact_mut(2 * rows);
    let mut l = j + PANEL;
    for pair in pairs.by_ref() {
        let (x, y) = pair.split_at_mut(rows);
        let mut sums = [[f64x4::ZERO; 2]; PANEL];
        for at in (0..rows).step_by(4) {
            let (x, y) = (load(&x[at..at + 4]), load(&y[at..at + 4]));
            for (sum, v) in sums.iter_mut().zip(&v) {
                let v = load(&v[at..at + 4]);
                sum[0] = v.mul_add(x, sum[0]);
                sum[1] = v.mul_add(y, sum[1]);
            }
        }
        let u: [[f64x4; PANEL]; 2] = std::array::from_fn(|side| {
            let top = &mut r[(l + side) * columns + j..][..PANEL];
            update_top(top, std::array::from_fn(|i| sums[i][side].reduce_add()), t)
        });
        for at in (0..rows).step_by(4) {
            let (mut p, mut s) = (load(&x[at..at + 4]), load(&y[at..at + 4]));
            for (i, v) in v.iter().enumerate() {
                let v = load(&v[at..at + 4]);
                p = v.mul_add(u[0][i], p);
                s = v.mul_add(u[1][i], s);
            }
            store(&mut x[at..at + 4], p);
            store(&mut y[at..at + 4], s);
        }
        l += 2;
    }
    let x = pairs.into_remainder();
    if x.len() == rows {
        let dots = std::array::from_fn(|i| dot(v[i], x));
        let u = update_top(&mut r[l * columns + j..][..PANEL], dots, t);
        for (u, v) in u.iter().zip(&v) {
            for (x, v) in x.chunks_exact_mut(4).zip(v.chunks_exact(4)) {
                store(x, load(v).mul_add(*u, load(x)));
            }
        }
    }
}

/// Updates the rows of R that belong to the panel and returns the factors -u by which V is added below.
fn update_top(top: &mut [f64], dots: [f64; PANEL], t: &[[f64; PANEL]; PANEL]) -> [f64x4; PANEL] {
    let w: [f64; PANEL] = std::array::from_fn(|i| top[i] + dots[i]);
    std::array::from_fn(|i| {
        let u: f64 = (0..=i).map(|k| t[k][i] * w[k]).sum();
        top[i] -= u;
        f64x4::splat(-u)
    })
}

fn load(x: &[f64]) -> f64x4 {
    f64x4::from([x[0], x[1], x[2], x[3]])
}

fn store(to: &mut [f64], x: f64x4) {
    to.copy_from_slice(&x.to_array());
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [f64x4::ZERO; 2];
    let (mut xs, mut ys) = (x.chunks_exact(8), y.chunks_exact(8));
    for (x, y) in xs.by_ref().zip(ys.by_ref()) {
        sums[0] = load(x).mul_add(load(y), sums[0]);
        sums[1] = load(&x[4..]).mul_add(load(&y[4..]), sums[1]);
    }
    let (x, y) = (xs.remainder(), ys.remainder());
    if x.len() >= 4 && y.len() >= 4 {
        sums[0] = load(x).mul_add(load(y), sums[0]);
    }
    (sums[0] + sums[1]).reduce_add()
}

fn subtract(x: &mut [f64], u: f64, v: &[f64]) {
    let u = f64x4::splat(-u);
    for (x, v) in x.chunks_exact_mut(4).zip(v.chunks_exact(4)) {
        store(x, load(v).mul_add(u, load(x)));
    }
}
