//! Text of the summary for first breaks.

use asperity::record::Quantity;
use asperity::task::summary::{Compared, FirstBreakStatistics, Summary};

use super::{digits, fitted, with_unit};

/// Adds lines in the form of the rest of the summary.
pub fn lines(summary: &Summary, found: &FirstBreakStatistics) -> Vec<(&'static str, String)> {
    let length = |number: f64| with_unit(digits(number), number, &summary.units.label(Quantity::Length));
    let law = |law: &Compared| {
        format!(
            "mean {}, std {}; distance {:.4} from the measured distribution",
            length(law.mean),
            length(law.std),
            law.distance
        )
    };
    let (mean, std) =
        (fitted(summary, found.mean, Quantity::Length), fitted(summary, found.std, Quantity::Length));
    let none = || "none: at κ_c and above, a finite fraction of all contacts breaks at once".to_owned();
    vec![
        ("coupling", format!("κ = {}, κ_c = {}", digits(found.coupling), digits(found.critical_coupling))),
        ("first breaks", format!("mean {mean}, std {std}; {} runs of {}", found.runs, found.size)),
        ("thresholds", law(&found.thresholds)),
        ("mean field", found.mean_field.as_ref().map_or_else(none, law)),
    ]
}
