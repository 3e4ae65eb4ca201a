//! scratch
#[path="../tests/common/mod.rs"] mod common;
use common::*;
fn main() {
    let law = weibull(0.5, 1.0);
    let m = master(&law, &point(0.0), &point(0.0));
    let p = m.pull(1.0, 1e-10, &mut ()).unwrap();
    for x in [1e-9f64, 1e-6, 1.3e-4, 1e-3, 0.017, 0.1] {
        
        let (mut s, mut t) = (0.0, 0.0);
        for (k, t0) in (0..200).flat_map(|k| asperity::numerics::legendre::RULE.nodes.iter().enumerate().map(move |(i, t)| (i, (k as f64 + 0.5 + 0.5 * t) / 200.0))) {
            let th = std::f64::consts::FRAC_PI_2 * t0;
            let y = x * th.sin().powi(2);
            let u = x * th.cos().powi(2);
            let w = 2.0 * x * th.sin() * th.cos() * std::f64::consts::FRAC_PI_2 / 200.0 * 0.5 * asperity::numerics::legendre::RULE.weights[k];
            s += w * p.breaking_rate(y) * law.density(u);
            t += w * p.breaking_rate(y) * law.survival(u);
        }
        println!("{x:e} residual {:e} prob {:e} vs {:e}", (p.breaking_rate(x) - law.density(x) - s) / p.breaking_rate(x), t + law.survival(x) - 1.0, p.total_probability(x) - 1.0);
    }
}
