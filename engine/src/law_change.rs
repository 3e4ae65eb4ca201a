//! Changes of a distribution by hand: to another family of the same mean and width, of what is dragged on its curve, or of a part
//! of a mixture.

use asperity::scenario::{Component, Law};
use serde::Deserialize;

use crate::handles;
use crate::polygon::{Polygon, REACH};
use crate::width;

/// Coefficient of variation of a distribution that takes the place of one without a width.
const WIDTH: f64 = 0.2;
/// Least standard deviation, in the mean.
const LEAST: f64 = 1e-4;
/// The name of polygons in scenarios.
const POLYGON: &str = "tabulated";
/// The name of mixtures in scenarios.
const MIXTURE: &str = "mixture";
/// Weights are whole numbers of this part of 1, so that those of the text sum to 1.
const WEIGHTS: f64 = 1e4;

/// A change of a distribution.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LawChange {
    /// The member of a parametric family with about the same mean and width, the polygon through points of the density, or a
    /// mixture of two halves, each of which is the distribution.
    Family(String),
    /// What is dragged on the curve goes elsewhere. A node of a polygon stays between its neighbours, and the density of the
    /// others keeps its form.
    Move {
        /// The handle or the node, from 0 on.
        handle: usize,
        /// Its stretch, a length.
        stretch: f64,
        /// The density there, per length, for a node.
        density: f64,
    },
    /// Another standard deviation and the same mean; of a mixture that of the first part with one, the others in proportion.
    Width(f64),
    /// A node is added on the curve of the density, in the middle of the longest side unless a stretch is given.
    Add(Option<f64>),
    /// A node is removed.
    Remove(usize),
    /// A part of a mixture has another weight; those of the others keep their ratios.
    Weight {
        /// The part, from 0 on.
        part: usize,
        /// Its weight.
        weight: f64,
    },
    /// The last part of a mixture becomes two halves.
    Split,
    /// A part of a mixture is removed; the last one that is left is no mixture.
    RemovePart(usize),
}

/// The distribution after a change. `scale` is the mean of one whose own is 0. Parameters have four digits.
///
/// # Errors
/// A change that the distribution does not allow, in words.
pub fn changed(law: &Law, change: &LawChange, scale: f64) -> Result<Law, String> {
    match change {
        LawChange::Family(name) => family(law, name, scale),
        LawChange::Move { handle, stretch, density } => {
            let Ok(mut polygon) = Polygon::of(law) else { return handles::moved(law, *handle, *stretch) };
            polygon.check(*handle)?;
            polygon.move_node(*handle, *stretch, *density);
            Ok(polygon.law())
        }
        LawChange::Width(std) => {
            let least = LEAST * width::mean(law);
            Ok(width::changed(law, std.max(least)))
        }
        LawChange::Add(stretch) => {
            let mut polygon = Polygon::of(law)?;
            polygon.add(*stretch)?;
            Ok(polygon.law())
        }
        LawChange::Remove(node) => {
            let mut polygon = Polygon::of(law)?;
            polygon.check(*node)?;
            polygon.remove(*node)?;
            Ok(polygon.law())
        }
        LawChange::Weight { part, weight } => {
            let parts = parts_of(law, *part)?;
            let rest = 1.0 - parts[*part].weight;
            let least = 1.0 / WEIGHTS;
            let own =
                if rest > 0.0 { weight.max(least).min(1.0 - least * (parts.len() - 1) as f64) } else { 1.0 };
            let weights = parts.iter().map(|other| other.weight * (1.0 - own) / rest);
            let mut weights: Vec<f64> = weights.collect();
            weights[*part] = own;
            Ok(mixture(parts, &weights, *part))
        }
        LawChange::Split => {
            let mut parts = parts_of(law, 0)?.to_vec();
            parts.extend(parts.last().cloned());
            let last = parts.len() - 1;
            let mut weights: Vec<f64> = parts.iter().map(|part| part.weight).collect();
            weights[last - 1..].iter_mut().for_each(|weight| *weight *= 0.5);
            Ok(mixture(&parts, &weights, last))
        }
        LawChange::RemovePart(part) => {
            let mut parts = parts_of(law, *part)?.to_vec();
            parts.remove(*part);
            match parts.as_slice() {
                [] => Err("a mixture keeps one part".to_owned()),
                [left] => Ok(left.law.clone()),
                _ => {
                    let weights: Vec<f64> = parts.iter().map(|part| part.weight).collect();
                    Ok(mixture(&parts, &weights, 0))
                }
            }
        }
    }
}

fn family(law: &Law, name: &str, scale: f64) -> Result<Law, String> {
    let known = law.build().map_err(|error| error.to_string())?;
    let mean = if known.mean() > 0.0 { known.mean() } else { scale };
    let width = if known.std() > 0.0 { known.std() / mean } else { WIDTH };
    if name == MIXTURE {
        let half = Component { weight: 0.5, law: law.clone() };
        return Ok(Law::Mixture(vec![half.clone(), half]));
    }
    if name == POLYGON {
        let polygon = Polygon::through(|x| known.density(x), mean, width);
        // Point masses have no density; a triangle is as wide.
        let triangle = || Polygon::through(|x| 1.0 - (x / mean - 1.0).abs() / (REACH * width), mean, width);
        return Ok(if known.atoms().is_empty() { polygon } else { triangle() }.law());
    }
    let families: Vec<&str> = Law::FAMILIES.iter().map(|family| family.name).collect();
    let family = Law::FAMILIES.iter().find(|family| family.name == name);
    let family = family.ok_or_else(|| format!("expected one of {}, got {name}", families.join(", ")))?;
    Ok((family.member)(mean, width))
}

/// The parts of the mixture that `law` is, of which `part` is one.
fn parts_of(law: &Law, part: usize) -> Result<&[Component], String> {
    match law {
        Law::Mixture(parts) if part < parts.len() => Ok(parts),
        Law::Mixture(parts) => Err(format!("expected a part from 0 to {}, got {part}", parts.len() - 1)),
        _ => Err("expected a mixture".to_owned()),
    }
}

/// The mixture with weights in these ratios, each rounded; `kept` has its own as exactly as that goes, and the heaviest of the
/// others takes what rounding leaves.
fn mixture(parts: &[Component], weights: &[f64], kept: usize) -> Law {
    let sum: f64 = weights.iter().sum();
    let mut rounded: Vec<f64> =
        weights.iter().map(|weight| (WEIGHTS * weight / sum).round().max(1.0)).collect();
    let left = WEIGHTS - rounded.iter().sum::<f64>();
    let others = (0..parts.len()).filter(|&i| i != kept || parts.len() == 1);
    if let Some(heaviest) = others.max_by(|&i, &j| rounded[i].total_cmp(&rounded[j])) {
        rounded[heaviest] += left;
    }
    let weighted = parts.iter().zip(rounded);
    Law::Mixture(
        weighted
            .map(|(part, weight)| Component { weight: weight / WEIGHTS, law: part.law.clone() })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use asperity::law::{Gaussian, Law as _};

    use super::*;
    use crate::polygon::{FIRST, MOST};

    fn polygon(nodes: &[(f64, f64)]) -> Law {
        Polygon { nodes: nodes.to_vec() }.law()
    }

    fn nodes(law: &Law) -> Vec<(f64, f64)> {
        Polygon::of(law).unwrap().nodes
    }

    /// Mass and mean by Simpson's rule on each side, which is exact for them.
    fn moments(nodes: &[(f64, f64)]) -> (f64, f64) {
        let sides = nodes.windows(2).map(|side| {
            let ((a, p), (b, q)) = (side[0], side[1]);
            let (middle, between) = (0.5 * (a + b), 0.5 * (p + q));
            let rule = |f: [f64; 3]| (b - a) / 6.0 * (f[0] + 4.0 * f[1] + f[2]);
            (rule([p, between, q]), rule([a * p, middle * between, b * q]))
        });
        sides.fold((0.0, 0.0), |sum, side| (sum.0 + side.0, sum.1 + side.1))
    }

    #[test]
    fn a_polygon_through_a_density_is_near_it() {
        let gaussian = Law::Gaussian { mean: 2.0, std: 0.2 };
        let found = nodes(&changed(&gaussian, &LawChange::Family(POLYGON.into()), 1.0).unwrap());
        let (mass, mean) = moments(&found);
        assert!((mass - 1.0).abs() < 1e-12 && (mean - 2.0).abs() < 1e-12, "{mass} {mean}");
        let exact = Gaussian::new(2.0, 0.2).unwrap();
        for &(x, density) in &found[1..FIRST - 1] {
            // The polygon leaves out 1.2 % beyond its ends, and what is above the chords.
            assert!((density / exact.density(x) - 1.0).abs() < 0.03, "{x} {density}");
        }
        // Point masses become a triangle around them.
        let point = changed(&Law::Point { at: 1.0 }, &LawChange::Family(POLYGON.into()), 1.0).unwrap();
        assert!((moments(&nodes(&point)).1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_node_goes_where_it_is_dragged_and_the_mass_stays() {
        let law = polygon(&[(0.5, 0.0), (0.8, 1.0), (1.2, 2.0), (1.5, 0.0)]);
        let before = nodes(&law);
        let moved =
            nodes(&changed(&law, &LawChange::Move { handle: 2, stretch: 1.1, density: 1.3 }, 1.0).unwrap());
        assert!((moved[2].0 - 1.1).abs() < 1e-12 && (moved[2].1 - 1.3).abs() < 1e-12, "{moved:?}");
        assert!((moments(&moved).0 - 1.0).abs() < 1e-12);
        assert_eq!((moved[0], moved[1].0, moved[3]), (before[0], 0.8, before[3]));
        // It stays between its neighbours, at 0 or above, and leaves the others some mass.
        let far =
            nodes(&changed(&law, &LawChange::Move { handle: 2, stretch: 9.0, density: -1.0 }, 1.0).unwrap());
        assert!(far[2].0 < 1.5 && far[2].1 == 0.0 && (moments(&far).0 - 1.0).abs() < 1e-12, "{far:?}");
        let high =
            nodes(&changed(&law, &LawChange::Move { handle: 2, stretch: 1.1, density: 1e9 }, 1.0).unwrap());
        assert!(high[1].1 > 0.0 && (moments(&high).0 - 1.0).abs() < 1e-12, "{high:?}");
        // The only node above 0 has all mass.
        let triangle = polygon(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
        let same = nodes(
            &changed(&triangle, &LawChange::Move { handle: 1, stretch: 1.5, density: 3.0 }, 1.0).unwrap(),
        );
        assert!((same[1].0 - 1.5).abs() < 1e-12 && (same[1].1 - 1.0).abs() < 1e-12, "{same:?}");
        assert!(changed(&law, &LawChange::Move { handle: 4, stretch: 1.0, density: 1.0 }, 1.0).is_err());
    }

    #[test]
    fn the_weights_of_a_mixture_change_and_their_sum_stays() {
        let weights = |law: &Law| match law {
            Law::Mixture(parts) => parts.iter().map(|part| part.weight).collect::<Vec<_>>(),
            _ => vec![],
        };
        let gaussian = Law::Gaussian { mean: 1.0, std: 0.1 };
        let two = changed(&gaussian, &LawChange::Family(MIXTURE.into()), 1.0).unwrap();
        // Nothing changes until a part does.
        let (before, after) = (gaussian.build().unwrap(), two.build().unwrap());
        assert!((before.density(1.1) - after.density(1.1)).abs() < 1e-12);
        let three = changed(&two, &LawChange::Split, 1.0).unwrap();
        assert_eq!(weights(&three), [0.5, 0.25, 0.25]);
        let moved = changed(&three, &LawChange::Weight { part: 1, weight: 0.1 }, 1.0).unwrap();
        assert_eq!(weights(&moved), [0.6, 0.1, 0.3]);
        // Thirds of 1 are no numbers of four digits; the text has those that sum to 1.
        let third = changed(&two, &LawChange::Weight { part: 0, weight: 1.0 / 3.0 }, 1.0).unwrap();
        assert_eq!(weights(&third), [0.3333, 0.6667]);
        for weight in [-1.0, 2.0] {
            let end = weights(&changed(&three, &LawChange::Weight { part: 0, weight }, 1.0).unwrap());
            assert!(
                end.iter().all(|&weight| weight > 0.0) && (end.iter().sum::<f64>() - 1.0).abs() < 1e-15,
                "{end:?}"
            );
        }
        let left = changed(&moved, &LawChange::RemovePart(0), 1.0).unwrap();
        assert_eq!(weights(&left), [0.25, 0.75]);
        assert_eq!(changed(&left, &LawChange::RemovePart(0), 1.0).unwrap(), gaussian);
        assert!(changed(&left, &LawChange::RemovePart(2), 1.0).unwrap_err().contains("from 0 to 1"));
        assert!(changed(&gaussian, &LawChange::Split, 1.0).unwrap_err().contains("a mixture"));
    }

    #[test]
    fn nodes_are_added_on_the_curve_and_removed() {
        let law = polygon(&[(0.5, 0.0), (0.8, 1.0), (1.2, 2.0), (1.5, 0.0)]);
        let before = nodes(&law);
        let more = changed(&law, &LawChange::Add(None), 1.0).unwrap();
        let found = nodes(&more);
        assert_eq!((found.len(), found[2].0), (5, 1.0));
        assert!((found[2].1 - 0.5 * (before[1].1 + before[2].1)).abs() < 1e-12);
        let back = nodes(&changed(&more, &LawChange::Remove(2), 1.0).unwrap());
        assert!(back.iter().zip(&before).all(|(a, b)| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-12));
        // Beyond the ends the density is 0.
        assert_eq!(nodes(&changed(&law, &LawChange::Add(Some(2.0)), 1.0).unwrap())[4], (2.0, 0.0));
        assert!(changed(&law, &LawChange::Add(Some(0.5)), 1.0).unwrap_err().contains("between two nodes"));
        let mut full = law;
        for _ in 4..MOST {
            full = changed(&full, &LawChange::Add(None), 1.0).unwrap();
        }
        assert!(changed(&full, &LawChange::Add(None), 1.0).unwrap_err().contains("up to 12 nodes"));
        let two = polygon(&[(0.0, 1.0), (1.0, 1.0)]);
        assert!(changed(&two, &LawChange::Remove(0), 1.0).unwrap_err().contains("two nodes"));
        let one = polygon(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
        assert!(changed(&one, &LawChange::Remove(1), 1.0).is_err());
    }
}
