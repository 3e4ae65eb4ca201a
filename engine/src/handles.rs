//! What is dragged on the curve of a distribution: its mean and one standard deviation from it, its ends, its point, or its nodes.

use asperity::law::{Law as _, Weibull};
use asperity::scenario::{Law, Scenario};

use crate::polygon::Polygon;

/// A place on the curve of a distribution that can be dragged.
#[derive(Debug)]
pub struct LawHandle {
    /// The key of the distribution, or of the part of a mixture.
    pub key: String,
    /// Its number there, from 0 on.
    pub handle: usize,
    /// Where it is, a length.
    pub stretch: f64,
    /// The density there, per length, of the distribution that is drawn.
    pub density: f64,
    /// The weight of the point mass there; 0 where there is none.
    pub weight: f64,
    /// Whether it is a node of a polygon, which can be removed.
    pub node: bool,
}

/// Least width that is left, in the mean.
const NARROWEST: f64 = 1e-3;

/// The handles of the distributions of `scenario`.
pub fn of_scenario(scenario: &Scenario) -> Vec<LawHandle> {
    let contacts = &scenario.contacts;
    let thresholds = contacts.thresholds.as_ref().map(|law| ("contacts.thresholds", law));
    let others = [("contacts.reforming", &contacts.reforming), ("initial", &scenario.initial)];
    thresholds.into_iter().chain(others).flat_map(|(key, law)| handles(key, law)).collect()
}

/// The handles of a distribution; of a mixture those of its parts, nodes aside.
fn handles(key: &str, law: &Law) -> Vec<LawHandle> {
    if let Ok(polygon) = Polygon::of(law) {
        let nodes = polygon.nodes.iter().enumerate();
        let handle = |(handle, &(stretch, density))| LawHandle {
            key: key.to_owned(),
            handle,
            stretch,
            density,
            weight: 0.0,
            node: true,
        };
        return nodes.map(handle).collect();
    }
    let places = places(key, law);
    let Some(whole) = (!places.is_empty()).then(|| law.build().ok()).flatten() else { return vec![] };
    let weight =
        |x: f64| whole.atoms().iter().find(|atom| atom.position == x).map_or(0.0, |atom| atom.weight);
    let handle = |Place { key, handle, stretch, within }| {
        let density = within.map_or(0.0, |x| whole.density(x));
        let weight = if within.is_none() { weight(stretch) } else { 0.0 };
        LawHandle { key, handle, stretch, density, weight, node: false }
    };
    places.into_iter().map(handle).collect()
}

/// Where a handle is.
struct Place {
    key: String,
    handle: usize,
    stretch: f64,
    /// Where the density is read: beside the ends of an interval, which are jumps. A point mass has none.
    within: Option<f64>,
}

fn places(key: &str, law: &Law) -> Vec<Place> {
    if let Law::Mixture(parts) = law {
        let of = |(i, part)| places(&format!("{key}.mixture.{i}.law"), part);
        return parts.iter().map(|part| &part.law).enumerate().flat_map(of).collect();
    }
    let places = match *law {
        Law::Rectangular { min, max } => {
            let inside = NARROWEST * (max - min);
            vec![(min, Some(min + inside)), (max, Some(max - inside))]
        }
        Law::Point { at } => vec![(at, None)],
        _ => mean_and_std(law).into_iter().map(|x| (x, Some(x))).collect(),
    };
    let place = |(handle, (stretch, within))| Place { key: key.to_owned(), handle, stretch, within };
    places.into_iter().enumerate().map(place).collect()
}

/// The mean, and one standard deviation from it where that can be chosen.
fn mean_and_std(law: &Law) -> Vec<f64> {
    match *law {
        Law::Gaussian { mean, std } | Law::Gamma { mean, std } | Law::Lognormal { mean, std } => {
            vec![mean, mean + std]
        }
        Law::Exponential { mean } => vec![mean],
        Law::Weibull { .. } => law.build().map_or(vec![], |law| vec![law.mean(), law.mean() + law.std()]),
        _ => vec![],
    }
}

/// The distribution after one of its handles, but for nodes, is dragged to `x`.
///
/// # Errors
/// A handle that it has not, in words.
pub fn moved(law: &Law, handle: usize, x: f64) -> Result<Law, String> {
    let count = places("", law).len();
    if handle >= count {
        return Err(format!("expected a handle below {count}, got {handle}"));
    }
    let of_mean = |mean, std| mean_and_std_moved([mean, std], handle, x);
    let moved = match *law {
        Law::Point { .. } => Law::Point { at: x.max(0.0) },
        Law::Rectangular { min, max } => {
            let least = NARROWEST * (max - min);
            if handle == 0 {
                Law::Rectangular { min: x.max(0.0).min(max - least), max }
            } else {
                Law::Rectangular { min, max: x.max(min + least) }
            }
        }
        Law::Gaussian { mean, std } => {
            let [mean, std] = of_mean(mean, std);
            Law::Gaussian { mean, std }
        }
        Law::Gamma { mean, std } => {
            let [mean, std] = of_mean(mean, std);
            Law::Gamma { mean, std }
        }
        Law::Lognormal { mean, std } => {
            let [mean, std] = of_mean(mean, std);
            Law::Lognormal { mean, std }
        }
        Law::Exponential { mean } => Law::Exponential { mean: of_mean(mean, 0.0)[0] },
        Law::Weibull { shape, scale } => {
            let old = Weibull::new(shape, scale).map_err(|error| error.to_string())?;
            let [mean, std] = of_mean(old.mean(), old.std());
            // The shape that a width has is found by bisection: the same width keeps its own.
            let shape = if handle == 0 { shape } else { Weibull::shape_of_width(std / mean) };
            let unit = Weibull::new(shape, 1.0).map_err(|error| error.to_string())?;
            Law::Weibull { shape, scale: mean / unit.mean() }
        }
        _ => law.clone(),
    };
    Ok(moved)
}

/// Mean and standard deviation after the mean, or the place one standard deviation from it, is dragged to `x`.
fn mean_and_std_moved([mean, std]: [f64; 2], handle: usize, x: f64) -> [f64; 2] {
    let least = NARROWEST * mean;
    if handle == 0 { [x.max(least), std] } else { [mean, (x - mean).max(least)] }
}

#[cfg(test)]
mod tests {
    use asperity::scenario::Component;

    use super::*;

    fn families() -> Vec<Law> {
        vec![
            Law::Gaussian { mean: 1.0, std: 0.2 },
            Law::Gamma { mean: 1.0, std: 0.3 },
            Law::Lognormal { mean: 1.0, std: 0.3 },
            Law::Weibull { shape: 2.0, scale: 1.0 },
            Law::Rectangular { min: 0.5, max: 1.5 },
            Law::Exponential { mean: 1.0 },
            Law::Point { at: 1.0 },
        ]
    }

    #[test]
    fn a_handle_goes_where_it_is_dragged_and_the_others_stay() {
        for law in families() {
            let before = handles("law", &law);
            assert!(!before.is_empty(), "{law:?}");
            for handle in &before {
                let to = 1.1 * handle.stretch;
                let after = handles("law", &moved(&law, handle.handle, to).unwrap());
                // Shapes are found by bisection to rounding.
                assert!((after[handle.handle].stretch - to).abs() < 1e-9, "{law:?} {after:?}");
                // The width of those with a mean moves with it.
                if handle.handle > 0 {
                    assert!((after[0].stretch - before[0].stretch).abs() < 1e-9, "{law:?} {after:?}");
                }
                // What is dragged too far gives a distribution, too.
                for far in [-1.0, 0.0, 1e6] {
                    assert!(moved(&law, handle.handle, far).unwrap().build().is_ok(), "{law:?} {far}");
                }
            }
            assert!(moved(&law, before.len(), 1.0).unwrap_err().contains("handle"));
        }
    }

    #[test]
    fn handles_are_on_the_curve_of_the_whole_mixture() {
        let parts: Vec<Component> =
            families().into_iter().map(|law| Component { weight: 1.0 / 7.0, law }).collect();
        let law = Law::Mixture(parts);
        let whole = law.build().unwrap();
        let found = handles("law", &law);
        assert_eq!(found.len(), 12);
        assert_eq!(found[2].key, "law.mixture.1.law");
        for handle in &found {
            // Those at the ends of an interval are read a thousandth of it inside.
            let x = handle.stretch;
            let near = [x - 1e-3, x, x + 1e-3].map(|x| whole.density(x));
            assert!(handle.weight > 0.0 || near.contains(&handle.density), "{handle:?}");
        }
        assert!((found[11].weight - 1.0 / 7.0).abs() < 1e-12 && found[0].weight == 0.0, "{found:?}");
    }
}
