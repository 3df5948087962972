use dynid_runtime::model::*;
use std::time::Instant;
fn main() {
    for &m in dynid::models::all() {
        let n = m.robot().joints();
        let e = m.pattern().columns.len();
        let nb = m.robot().base.len();
        let t: usize = std::env::args().nth(1).map_or(256, |a| a.parse().unwrap());
        let q: Vec<Vec<f64>> =
            (0..n).map(|j| (0..t).map(|i| ((i * 7 + j * 13) as f64 * 0.37).sin() * 2.0).collect()).collect();
        let s: Vec<&[f64]> = q.iter().map(|x| x.as_slice()).collect();
        let states = States { q: &s, dq: &s, ddq: &s };
        let mut out = vec![0.0; e.max(nb) * t];
        let mut entries = vec![0.0; e];
        let mut best = [f64::MAX; 6];
        let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
        let chi = vec![0.3; nb];
        let cols: Vec<Vec<f64>> = (0..t).map(|i| (0..n).map(|j| q[j][i]).collect()).collect();
        let mut h = vec![0.0; nb];
        let time = |f: &mut dyn FnMut()| {
            let i = Instant::now();
            for _ in 0..8 {
                f();
            }
            i.elapsed().as_secs_f64() / (8 * t) as f64 * 1e9
        };
        for _ in 0..200 {
            let a = time(&mut || {
                for c in &cols {
                    m.idm(c, c, c, &mut entries);
                    std::hint::black_box(&entries);
                }
            });
            let b = time(&mut || {
                m.idm_block(states, t, &mut out);
                std::hint::black_box(&out);
            });
            let c = time(&mut || {
                m.power_block(states, t, &mut out);
                std::hint::black_box(&out);
            });
            let d = time(&mut || {
                m.energy_block(states, t, &mut out);
                std::hint::black_box(&out);
            });
            let e = time(&mut || {
                for c in &cols {
                    m.mass_and_bias(&chi, c, c, &mut mass, &mut bias);
                    std::hint::black_box(&mass);
                }
            });
            let f = time(&mut || {
                for c in &cols {
                    m.power(c, c, c, &mut h);
                    std::hint::black_box(&h);
                }
            });
            for (x, y) in best.iter_mut().zip([a, b, c, d, e, f]) {
                *x = x.min(y);
            }
        }
        println!(
            "{:10} idm {:.0} ns  batch {:.1}  dh {:.0} batch {:.1}  h batch {:.1}  forward {:.0}   ops {:?}",
            m.robot().name,
            best[0],
            best[1],
            best[5],
            best[2],
            best[3],
            best[4],
            dynid::models::operations(&m.robot().name)
                .unwrap()
                .iter()
                .map(|o| o.multiplications + o.additions)
                .collect::<Vec<_>>()
        );
    }
}
