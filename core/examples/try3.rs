//! scratch
#[path="../tests/common/mod.rs"] mod common;
use common::*;
use num_complex::Complex64;
fn main() {
    let m = master(&gaussian(1.0, 0.05), &gaussian(0.9, 0.05), &point(0.0));
    let k = m.life().breaking();
    let mean = m.life().mean();
    println!("mean {mean} end {}", k.curve().end());
    for re in [2.0, 4.0,6.0,8.0,10.0,12.0,15.0] { for im in [2.0,4.0,6.0,8.0,10.0,14.0,18.0] {
        let s = Complex64::new(-re, im) / mean;
        let f = k.curve().transform(s).0;
        print!(" {:.2e}", (f - 1.0).norm() / f.norm());
    } println!(" re {} end*re {}", re, re / mean * k.curve().end()); }
}
