//! Text of the summary for a fit.

use asperity::record::Quantity;
use asperity::scenario::Units;
use asperity::task::summary::{
    FitFreeForm, FitLaw, FitLaws, FitNumber, FitSummary, PosteriorNumber, PosteriorSummary, Summary,
    Uncertain,
};

use super::{digits, with_unit};

/// Lines for the estimates, the misfit, correlations, and friction with its errors.
pub fn lines(summary: &Summary, fit: &FitSummary) -> Vec<(String, String)> {
    let mut lines: Vec<(String, String)> = Vec::new();
    for source in &fit.sources {
        let hash = source.sha256.get(..12).unwrap_or(&source.sha256);
        let line = ("data".to_owned(), format!("{}, SHA-256 {hash}…", source.name));
        // Curves may be parts of one record.
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines.push(("readings".to_owned(), fit.readings.to_string()));
    if !fit.converged {
        let text = "the search has not converged: the values are the last ones, their errors mean nothing";
        lines.push(("not converged".to_owned(), text.to_owned()));
    }
    lines.extend(fit.numbers.iter().map(|number| (number.key.clone(), estimate(number))));
    lines.extend(
        fit.fixed.iter().map(|number| (number.key.clone(), format!("{} (fixed)", digits(number.value)))),
    );
    let unit = summary.units.label(Quantity::Force);
    if let Some(misfit) = &fit.misfit {
        if !fit.numbers.iter().any(|number| number.key == "fit.reading") {
            // Forces at several velocities may have errors of their own.
            let words = if fit.friction.is_some() { "error of a reading" } else { "error of a reading, rms" };
            lines.push((words.to_owned(), with_unit(digits(fit.reading), fit.reading, &unit)));
        }
        let tested = misfit.probability.map_or(String::new(), |p| format!(", p = {}", probability(p)));
        let degrees = misfit.degrees_of_freedom;
        lines.push((
            "χ²".to_owned(),
            format!("{:.1} for {degrees} degrees of freedom{tested}", misfit.chi_squared),
        ));
        lines.push((
            "whitened residuals".to_owned(),
            format!("white with p = {} (Ljung–Box)", probability(misfit.whiteness)),
        ));
        lines.push(("−2 ln L, AIC".to_owned(), format!("{:.2}, {:.2}", misfit.deviance, misfit.akaike)));
        if misfit.is_unlikely() {
            let text = "the curve is not of this kind (p < 0.001): the errors are not to be trusted";
            lines.push(("misfit".to_owned(), text.to_owned()));
        }
    } else {
        lines.push((
            "planned".to_owned(),
            "no forces: the errors that such a measurement would have".to_owned(),
        ));
    }
    for correlation in &fit.correlations {
        let [first, second] = &correlation.between;
        lines.push((
            "correlation".to_owned(),
            format!("{:+.2} between {first} and {second}", correlation.coefficient),
        ));
    }
    lines.extend(fit.laws.iter().flat_map(laws));
    lines.extend(fit.free_form.iter().flat_map(|form| free_form(form, &summary.units)));
    lines.extend(fit.posterior.iter().flat_map(posterior));
    let Some(friction) = &fit.friction else { return lines };
    let of = |name: &str, value: Option<Uncertain>, quantity| {
        let text =
            value.map_or("not reached".to_owned(), |value| uncertain(&value, &summary.units.label(quantity)));
        (name.to_owned(), text)
    };
    lines.push(of("static friction", friction.static_friction, Quantity::Force));
    lines.push(of("kinetic friction", Some(friction.kinetic_friction), Quantity::Force));
    lines.push(of("relaxation length", Some(friction.relaxation_length), Quantity::Length));
    lines.push(of("critical stiffness", Some(friction.critical_stiffness), Quantity::Stiffness));
    lines
}

/// Lines for thresholds of free form.
fn free_form(form: &FitFreeForm, units: &Units) -> Vec<(String, String)> {
    let unit = units.label(Quantity::Length);
    let unsure = if form.converged { "" } else { ", not converged" };
    let misfit = form.chi_squared.map_or(String::new(), |found| format!(", χ² {found:.1}"));
    vec![
        ("free form, mean threshold".to_owned(), uncertain(&form.mean, &unit)),
        ("free form, std of thresholds".to_owned(), uncertain(&form.std, &unit)),
        (
            "free form, parameters".to_owned(),
            format!("{:.1} beyond a Gaussian{misfit}{unsure}", form.effective),
        ),
    ]
}

/// A line for each distribution of thresholds, with its difference of Akaike's criterion from the lowest.
fn laws(laws: &FitLaws) -> Vec<(String, String)> {
    let own = ("ΔAIC of the fitted thresholds".to_owned(), format!("{:.1}", laws.difference));
    let other = |law: &FitLaw| {
        let unsure = if law.converged { "" } else { ", not converged" };
        let text = match (law.difference, &law.refused) {
            (Some(difference), _) if difference.is_finite() => format!("{difference:.1}{unsure}"),
            (_, Some(why)) => format!("no fit: {why}"),
            _ => "no measured forces".to_owned(),
        };
        (format!("ΔAIC of {}", law.law), text)
    };
    std::iter::once(own).chain(laws.others.iter().map(other)).collect()
}

/// A line for each number that was drawn, and one for all draws.
fn posterior(reported: &PosteriorSummary) -> Vec<(String, String)> {
    let PosteriorSummary { chains, draws, divergences, numbers } = reported;
    let all = format!("{chains} chains of {draws} draws, {divergences} of them diverged");
    let number = |number: &PosteriorNumber| {
        let PosteriorNumber { key, mean, std, quantiles: [low, _, high], r_hat, effective_size } = number;
        let (value, error) = rounded(*mean, *std);
        let interval = format!("95 % from {} to {}", like(*low, *std), like(*high, *std));
        let chains = format!("r̂ = {:.3}, worth {:.0} draws", r_hat.0, effective_size.0);
        (format!("posterior of {key}"), format!("{value} ± {error}, {interval}; {chains}"))
    };
    std::iter::once(("posterior".to_owned(), all)).chain(numbers.iter().map(number)).collect()
}

/// A probability with two digits.
pub fn probability(p: f64) -> String {
    match p {
        0.0 => "0".to_owned(),
        _ if p < 0.01 => format!("{p:.1e}"),
        _ => format!("{p:.2}"),
    }
}

/// A value with its error and its interval, or the limit below which it is.
fn estimate(number: &FitNumber) -> String {
    if let Some(limit) = number.limit {
        return if limit.0.is_finite() {
            format!("below {} (95 %)", digits(limit.0))
        } else {
            "not determined".into()
        };
    }
    let [low, high] = number.interval;
    let (value, error) = rounded(number.value, number.error);
    format!("{value} ± {error}, 95 % from {} to {}", like(low.0, number.error), like(high.0, number.error))
}

fn uncertain(value: &Uncertain, unit: &str) -> String {
    if value.error.0.is_nan() || !value.value.0.is_finite() {
        return with_unit(digits(value.value.0), value.value.0, unit);
    }
    let (number, error) = rounded(value.value.0, value.error.0);
    with_unit(format!("{number} ± {error}"), value.value.0, unit)
}

/// A value and its error, with two digits of the error.
pub(super) fn rounded(value: f64, error: f64) -> (String, String) {
    (like(value, error), like(error, error))
}

/// A number with as many decimals as two digits of `error` have.
fn like(number: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite() && number.is_finite()) {
        return digits(number);
    }
    let decimals = 1 - error.log10().floor() as i32;
    if decimals > 6 || number.abs() >= 1e6 {
        let precision = (number.abs().max(error).log10().floor() as i32 + decimals).clamp(0, 16);
        return format!("{number:.*e}", precision as usize);
    }
    if decimals < 0 {
        let unit = 10_f64.powi(-decimals);
        return format!("{:.0}", (number / unit).round() * unit);
    }
    format!("{number:.*}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_decimals_of_two_digits_of_their_errors() {
        for (value, error, text) in [
            (0.99866, 0.00113, ("0.9987", "0.0011")),
            (2096.66, 178.1, ("2100", "180")),
            (-0.5, 0.25, ("-0.50", "0.25")),
            (1.5e-9, 2.5e-11, ("1.500e-9", "2.5e-11")),
        ] {
            let (value, error) = rounded(value, error);
            assert_eq!((value.as_str(), error.as_str()), text);
        }
    }
}
