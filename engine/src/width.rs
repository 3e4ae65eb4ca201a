//! The width of a distribution: its standard deviation, or that of a part of a mixture, all of whose widths change alike.

use asperity::law::Weibull;
use asperity::scenario::{Component, Law};

/// The standard deviation that can be chosen: of a mixture that of its first part with one.
pub fn of(law: &Law) -> Option<f64> {
    match law {
        Law::Mixture(parts) => {
            let each = parts.iter().map(|part| &part.law);
            // All of its parts have widths that can be chosen, or none.
            if !each.clone().all(|law| matches!(law, Law::Point { .. }) || of(law).is_some()) {
                return None;
            }
            each.filter_map(of).next()
        }
        Law::Gaussian { std, .. } | Law::Gamma { std, .. } | Law::Lognormal { std, .. } => Some(*std),
        Law::Weibull { .. } | Law::Rectangular { .. } => law.build().ok().map(|law| law.std()),
        _ => None,
    }
    .filter(|std| *std > 0.0)
}

/// The mean of the distribution, or of the part, whose width [`of`] is.
pub fn mean(law: &Law) -> f64 {
    match law {
        Law::Mixture(parts) => {
            parts.iter().map(|part| &part.law).find(|law| of(law).is_some()).map_or(1.0, mean)
        }
        // Before truncation it does not change with the width.
        Law::Gaussian { mean, .. } => *mean,
        _ => law.build().map_or(1.0, |law| law.mean()),
    }
}

/// What the width is, in words.
pub fn words(law: &Law) -> &'static str {
    match law {
        Law::Mixture(_) => "standard deviation σ of the first part, all others in proportion",
        _ => "standard deviation σ of the thresholds",
    }
}

/// The distribution with another width and the same mean, if its width can be chosen; parts of a mixture keep the ratios of theirs.
pub fn changed(law: &Law, std: f64) -> Law {
    of(law).map_or_else(|| law.clone(), |old| scaled(law, std, std / old))
}

/// All widths are multiplied by a factor; that of a family is then exactly `std`.
fn scaled(law: &Law, std: f64, factor: f64) -> Law {
    match *law {
        Law::Mixture(ref parts) => {
            let part = |part: &Component| {
                let own = of(&part.law).map_or(0.0, |own| factor * own);
                Component { weight: part.weight, law: scaled(&part.law, own, factor) }
            };
            Law::Mixture(parts.iter().map(part).collect())
        }
        Law::Gaussian { mean, .. } => Law::Gaussian { mean, std },
        Law::Gamma { mean, .. } => Law::Gamma { mean, std },
        Law::Lognormal { mean, .. } => Law::Lognormal { mean, std },
        Law::Rectangular { min, max } => {
            let (middle, half) = (0.5 * (min + max), 0.5 * (max - min) * factor);
            Law::Rectangular { min: middle - half, max: middle + half }
        }
        Law::Weibull { shape, scale } => weibull(shape, scale, factor).unwrap_or_else(|| law.clone()),
        _ => law.clone(),
    }
}

fn weibull(shape: f64, scale: f64, factor: f64) -> Option<Law> {
    let old = Weibull::new(shape, scale).ok()?;
    let (mean, std) = (asperity::law::Law::mean(&old), asperity::law::Law::std(&old));
    let shape = Weibull::shape_of_width(factor * std / mean);
    let unit = Weibull::new(shape, 1.0).ok()?;
    Some(Law::Weibull { shape, scale: mean / asperity::law::Law::mean(&unit) })
}
