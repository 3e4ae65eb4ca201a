//! scratch
#[path = "../tests/common/mod.rs"]
mod common;
use common::*;
use std::time::Instant;
fn main() {
    let only: Option<usize> = std::env::args().nth(1).map(|a| a.parse().unwrap());
    for (n, (l, r, i, d, tol)) in [
        (weibull(0.5, 1.0), point(0.0), point(0.0), 50.0, 1e-10),
        (weibull(1.5, 1.0), point(0.0), point(0.0), 50.0, 1e-10),
        (weibull(12.153, 1.0), point(0.0), point(0.0), 50.0, 1e-10),
        (gamma(1.0, 1.3), point(0.0), point(0.0), 50.0, 1e-10),
        (gamma(1.0, 0.3), point(0.0), point(0.0), 50.0, 1e-10),
        (lognormal(1.0, 0.1), point(0.0), point(0.0), 50.0, 1e-10),
        (lognormal(1.0, 1.0), point(0.0), point(0.0), 50.0, 1e-10),
        (lognormal(1.0, 3.0), point(0.0), point(0.0), 50.0, 1e-10),
        (lognormal(1.0, 0.8), gaussian(0.1, 0.1), point(0.0), 50.0, 1e-10),
        (mixture(&[(0.3, point(0.8)), (0.7, gaussian(1.0, 0.1))]), point(0.0), point(0.0), 50.0, 1e-10),
        (mixture(&[(0.3, point(0.8)), (0.7, rectangular(0.7, 1.31))]), point(0.0), point(0.0), 50.0, 1e-10),
        (mixture(&[(0.5, point(1.0)), (0.5, point(2.0))]), point(0.0), point(0.0), 50.0, 1e-10),
        (
            mixture(&[(0.5, gaussian(0.5, 0.001)), (0.5, gaussian(1.0, 0.2))]),
            point(0.0),
            point(0.0),
            50.0,
            1e-10,
        ),
        (gaussian(1.0, 0.05), point(0.0), gaussian(0.1, 0.025), 10000.0, 1e-10),
        (gaussian(1.0, 0.3), gaussian(0.2, 0.1), gaussian(0.1, 0.025), 50.0, 1e-10),
        (gaussian(1.0, 1e-4), point(0.0), point(0.0), 50.0, 1e-10),
        (gaussian(1.0, 1e-5), point(0.0), point(0.0), 50.0, 1e-10),
        (gaussian(1.0, 1e-5), point(0.0), gaussian(0.1, 0.025), 20.0, 1e-10),
        (weibull(0.3, 1.0), point(0.0), point(0.0), 50.0, 1e-10),
        (gamma(1.0, 2.0), point(0.0), point(0.0), 50.0, 1e-10),
        (point(1.0), rectangular(0.0, 0.5), point(0.0), 50.0, 1e-10),
        (point(1.0), point(0.0), gaussian(0.1, 0.025), 50.0, 1e-10),
    ]
    .into_iter()
    .enumerate()
    {
        if only.is_some_and(|o| o != n) {
            continue;
        }
        println!("#{n}");
        let t = Instant::now();
        let m = master(&l, &r, &i);
        let t1 = t.elapsed();
        let p = m.pull(d, tol, &mut ()).unwrap();
        let t2 = t.elapsed() - t1;
        println!(
            "{l:?}\n   life {t1:?} ({} cells) pull {t2:?} cells {} err {:e} Fk {} F {}",
            m.life().breaking().curve().coefficients.len(),
            p.cells(),
            p.error_estimate(),
            m.steady_state().kinetic_friction(),
            p.force(d)
        );
        let t = Instant::now();
        let r = m.relaxation();
        println!(
            "   X* {} {} {} F {} {:?}",
            r.length(),
            r.roots().len(),
            r.valid_from(),
            r.force(d),
            t.elapsed()
        );
    }
}
