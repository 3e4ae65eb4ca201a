//! A population moved about by a test, with the work done on it.
#![allow(dead_code)]

use asperity::population::{Direction, Population};

/// Gauss–Legendre points of order 16 on [−1, 1] (Abramowitz & Stegun, table 25.4): abscissas and weights.
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_5),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_7),
    (0.755_404_408_355_003, 0.124_628_971_255_533_9),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_09),
];

/// ∫_a^b f, exact for polynomials of degree 31.
pub fn gauss(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    GAUSS.iter().map(|(t, w)| half * w * (f(middle - half * t) + f(middle + half * t))).sum()
}

/// ∫_a^b f over `parts` even parts of each interval between the `knots`.
pub fn integral(a: f64, b: f64, knots: &[f64], parts: u32, mut f: impl FnMut(f64) -> f64) -> f64 {
    let mut edges: Vec<f64> = knots.iter().copied().filter(|&x| x > a && x < b).chain([a, b]).collect();
    edges.sort_by(f64::total_cmp);
    let part = |pair: &[f64], k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(parts);
    edges
        .windows(2)
        .flat_map(|pair| (0..parts).map(move |k| (part(pair, k), part(pair, k + 1))))
        .map(|(low, high)| gauss(low, high, &mut f))
        .sum()
}

/// Moves to `position`, way by way; what stands at its threshold there breaks. The work done on the population.
pub fn drive(population: &mut dyn Population, position: f64) -> f64 {
    let mut work = 0.0;
    loop {
        let left = position - population.position();
        let direction = if left > 0.0 { Direction::Forward } else { Direction::Backward };
        let interval = population.smooth_interval(direction, &mut ()).unwrap();
        // Ends that break are here up to the rounding of positions.
        let ends = left.abs() > interval.length - if interval.breaks { 1e-12 } else { 0.0 };
        let by = if ends { direction.sign() * interval.length } else { left };
        work += gauss(0.0, by, |x| population.ahead(x).force);
        population.advance(by).unwrap();
        if ends && interval.breaks {
            population.cross(&mut ()).unwrap();
        }
        if (position - population.position()).abs() < 1e-12 {
            return work;
        }
    }
}

/// The force now.
pub fn force(population: &mut dyn Population) -> f64 {
    population.smooth_interval(Direction::Forward, &mut ()).unwrap();
    population.ahead(0.0).force
}
