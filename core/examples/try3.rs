//! scratch
#[path = "../tests/common/mod.rs"]
mod common;
use common::*;
fn main() {
    let law = lognormal(1.0, 3.0);
    let m = master(&law, &point(0.0), &point(0.0));
    let c = m.life().breaking().curve();
    let k = c.boundaries.partition_point(|&b| b < 31.0);
    println!("{:?}", &c.boundaries[k - 4..(k + 6).min(c.boundaries.len())]);
    for x in [30.0, 31.0, 31.06, 31.07, 31.1, 31.5, 32.0, 35.0, 40.0] {
        println!("{x} {:e} {:e}", c.value(x) - law.density(x), law.density(x));
    }
}
