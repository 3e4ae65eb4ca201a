//! scratch
use asperity::contacts::*;
use asperity::law::*;
use asperity::master::*;
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let g = |m: f64, s: f64| -> SharedLaw { Arc::new(Gaussian::new(m, s).unwrap()) };
    let p = |a: f64| -> SharedLaw { Arc::new(Point::new(a).unwrap()) };
    let r = |a: f64, b: f64| -> SharedLaw { Arc::new(Rectangular::new(a, b).unwrap()) };
    let e = |m: f64| -> SharedLaw { Arc::new(Exponential::new(m).unwrap()) };
    let run = |name: &str, pc: &SharedLaw, re: &SharedLaw, ini: &SharedLaw, d: f64, xs: &[f64]| {
        let t = Instant::now();
        let c = Contacts {
            count: 1.0,
            stiffness: Stiffness::Equal(1.0),
            thresholds: pc.clone(),
            reforming: re.clone(),
        };
        let me = MasterEquation::new(c, &Initial { law: ini.clone(), start: Start::Conditional }).unwrap();
        let t1 = t.elapsed();
        let pull = me.pull(d, 1e-10, &mut ()).unwrap();
        let t2 = t.elapsed();
        println!("== {name}: life {t1:?} pull {t2:?} cells {} err {:e}", pull.cells(), pull.error_estimate());
        println!(
            "  Fk {:.13} static {:?} Kc {:.12}",
            me.steady_state().kinetic_friction(),
            pull.static_friction(),
            pull.critical_stiffness()
        );
        for &x in xs {
            print!("  F({x})={:.13}", pull.force(x));
        }
        println!("\n  prob {:?}", xs.iter().map(|&x| pull.total_probability(x) - 1.0).collect::<Vec<_>>());
        let t3 = Instant::now();
        let rel = me.relaxation();
        println!(
            "  X* {:.10} paper {} roots {} valid {} F(end) {} vs {} in {:?}",
            rel.length(),
            rel.paper_estimate(),
            rel.roots().len(),
            rel.valid_from(),
            rel.force(d),
            pull.force(d),
            t3.elapsed()
        );
    };
    for _ in 0..2 {
        run("fig2", &g(1., 0.05), &p(0.), &g(0.1, 0.025), 20., &[1.09, 2.18, 5.0, 20.0]);
        run("fig2-50", &g(1., 0.05), &p(0.), &g(0.1, 0.025), 50., &[1.09, 2.18, 5.0, 20.0]);
    }
    run("gauss.1", &g(1., 0.1), &p(0.), &p(0.), 50., &[0.9, 1.0, 2.18, 5.45, 21.8]);
    run("gauss.2", &g(1., 0.2), &p(0.), &p(0.), 50., &[0.9, 1.0, 2.18, 5.45, 21.8]);
    run("rect.25", &r(0.75, 1.25), &p(0.), &p(0.), 50., &[0.95, 1.05, 2.5]);
    run("rect1", &r(0., 2.), &p(0.), &p(0.), 50., &[0.95, 1.05, 2.5]);
    run("rectR", &r(0.8, 1.2), &r(0., 0.2), &p(0.), 20., &[0.95, 1.05, 2.5]);
    run("rectRover", &r(0.4, 1.6), &r(0., 0.6), &p(0.), 20., &[0.95, 1.05, 2.5]);
    run("exp", &e(1.), &p(0.), &p(0.), 50., &[0.95, 1.05, 2.5]);
    run("identical", &p(1.), &p(0.), &g(0.1, 0.025), 20., &[0.95, 1.05, 2.5]);
    run("identical-p", &p(1.), &p(0.), &p(0.), 20., &[0.95, 1.05, 2.5]);
}
