//! Every rule with every family of thresholds at one velocity: the renewal equation, contacts followed through time and single
//! contacts, three answers that share the description of the contacts alone.

use std::fmt;
use std::sync::Arc;

use crate::common::{
    contacts, exponential, gamma, gaussian, initial, lognormal, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::{Renormalised, SharedLaw, Tabulated};
use asperity::master::{MasterEquation, Transport};

const VELOCITY: f64 = 0.5;
const DISTANCE: f64 = 2.2;
/// What rounding of thousands of steps in time adds up to, which is not reported.
const ROUNDING: f64 = 1e-12;
/// Places that are compared, no breaks of a force among them.
const PLACES: usize = 7;

fn laws() -> Vec<(&'static str, SharedLaw)> {
    let renormalised = Renormalised::new(gaussian(1.0, 0.3), 0.1).unwrap();
    let samples = Tabulated::from_samples(&[0.5, 0.8, 0.9, 1.1, 1.5]).unwrap();
    vec![
        ("gaussian", gaussian(1.0, 0.1)),
        ("gamma", gamma(1.0, 0.3)),
        ("gamma with a pole", gamma(1.0, 1.2)),
        ("lognormal", lognormal(1.0, 0.5)),
        ("weibull", weibull(1.5, 1.0)),
        ("rectangular", rectangular(0.9, 1.1)),
        ("exponential", exponential(1.0)),
        ("point", point(1.0)),
        ("samples", Arc::new(samples)),
        ("mixture", mixture(&[(0.4, point(0.7)), (0.6, gamma(1.1, 0.22))])),
        ("renormalised", Arc::new(renormalised)),
    ]
}

fn rules() -> Vec<(&'static str, Rules)> {
    let warm = |barrier, energy| Rules {
        temperature: Some(Temperature { barrier, ..Temperature::new(energy, 1.0) }),
        ..Rules::default()
    };
    let ageing = |rule| Rules { ageing: Some(rule), ..Rules::default() };
    let logarithmic = ageing(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    let frozen = ageing(Ageing::FrozenRank { mature: gaussian(1.5, 0.1), time: 1.0 });
    let elastic = warm(Barrier::Elastic, 0.05);
    vec![
        ("none", Rules::default()),
        ("delay", Rules { delay: 0.7.into(), ..Rules::default() }),
        ("elastic", elastic.clone()),
        ("bell", warm(Barrier::Bell, 0.05)),
        ("catastrophe", warm(Barrier::Catastrophe, 0.05)),
        ("logarithmic", logarithmic.clone()),
        ("frozen_rank", frozen.clone()),
        ("smoluchowski", ageing(Ageing::Smoluchowski { mature: gaussian(1.5, 0.2), diffusion: 0.01 })),
        (
            "logarithmic, elastic, delay",
            Rules { delay: 0.3.into(), temperature: elastic.temperature, ..logarithmic },
        ),
        ("frozen_rank, elastic", Rules { temperature: elastic.temperature, ..frozen }),
    ]
}

/// A rule with a family of thresholds.
struct Case {
    rule: &'static str,
    law: &'static str,
    contacts: Contacts,
}

impl Case {
    /// Whether contacts are followed in a few seconds: without temperature or diffusion, or with smooth thresholds.
    fn is_quick(&self) -> bool {
        match self.rule {
            "none" | "delay" | "logarithmic" => true,
            "frozen_rank, elastic" => self.law == "gaussian",
            _ => matches!(self.law, "gaussian" | "lognormal"),
        }
    }

    /// Whether contacts are followed to 1e-9 in a second: their thresholds neither diffuse nor have edges or a pole that
    /// cells in time would have to resolve, and no temperature breaks them.
    fn is_accurate(&self) -> bool {
        let sharp = matches!(self.law, "gamma with a pole" | "rectangular" | "samples" | "mixture");
        match self.rule {
            "none" | "delay" | "logarithmic" => !sharp,
            "frozen_rank" => matches!(self.law, "gaussian" | "lognormal"),
            _ => false,
        }
    }

    fn diffuses(&self) -> bool {
        self.rule == "smoluchowski"
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.rule, self.law)
    }
}

fn all() -> impl Iterator<Item = Case> {
    rules().into_iter().flat_map(|(rule, rules)| {
        // Contacts that share a threshold have no rank of their own.
        let ranked = matches!(rules.ageing, Some(Ageing::FrozenRank { .. }));
        let known = move |(_, law): &(&str, SharedLaw)| !ranked || law.atoms().is_empty();
        laws().into_iter().filter(known).map(move |(law, thresholds)| {
            let contacts = Contacts { rules: rules.clone(), ..contacts(&thresholds, &point(0.0)) };
            Case { rule, law, contacts }
        })
    })
}

fn places() -> Vec<f64> {
    (0..PLACES).map(|k| DISTANCE * (k as f64 + 0.618) / PLACES as f64).collect()
}

/// F by the renewal equation, and what it is off by.
fn renewed(contacts: &Contacts) -> (Vec<f64>, f64) {
    let start = initial(&point(0.0));
    let equation = MasterEquation::at(contacts.clone(), &start, VELOCITY).unwrap();
    let pull = equation.pull(DISTANCE).unwrap();
    (places().into_iter().map(|x| pull.force(x)).collect(), pull.error_estimate())
}

/// F by contacts that are followed through time, and what it is off by.
fn followed(contacts: &Contacts, tolerance: f64) -> (Vec<f64>, f64) {
    let start = initial(&point(0.0));
    let times: Vec<f64> = places().into_iter().map(|x| x / VELOCITY).collect();
    let history = History::new(vec![Piece { velocity: VELOCITY, duration: DISTANCE / VELOCITY }]).unwrap();
    let mut transport = Transport::new_with(contacts.clone(), &start, tolerance, &mut ()).unwrap();
    let trace = transport.follow(&history, &times).unwrap();
    (trace.force, trace.error)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// How far both are apart, at most. Neither may be off by more than it reports.
fn compare(tolerance: f64, which: impl Fn(&Case) -> bool) -> f64 {
    let (mut wrong, mut most) = (Vec::new(), 0.0_f64);
    for case in all().filter(which) {
        let (exact, of_exact) = renewed(&case.contacts);
        let (force, error) = followed(&case.contacts, tolerance);
        let apart = apart(&exact, &force);
        let reported = format!("{case}: {apart:.1e} apart, {error:.1e} and {of_exact:.1e} reported");
        println!("{reported}");
        if apart > error + of_exact + ROUNDING {
            wrong.push(reported);
        }
        most = most.max(apart);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    most
}

#[test]
fn the_renewal_equation_and_contacts_followed_through_time_agree() {
    // Transport aims at its tolerance times the mean threshold, which is 1.
    assert!(compare(1e-9, Case::is_accurate) < 1e-9);
    compare(1e-6, |case| case.is_quick() && !case.is_accurate() && !case.diffuses());
    compare(1e-4, |case| case.is_quick() && case.diffuses());
}

/// Thresholds beside the edge of the fresh law fall at once, and rise again: the stretch meets them inside of the first step.
#[test]
fn a_tolerance_is_kept_where_contacts_break_as_soon_as_they_form() {
    let rule = |case: &Case| case.rule == "frozen_rank" && case.law == "exponential";
    let contacts = all().find(rule).unwrap().contacts;
    let off = apart(&renewed(&contacts).0, &followed(&contacts, 1e-4).0);
    // 6e-4 without them.
    assert!(off < 1e-4, "{off:e}");
}

/// The table of thresholds by rank is the same for both tolerances, of which one is to show what the other is off by.
#[test]
fn what_ranks_are_off_by_is_reported() {
    let rule =
        |case: &Case| case.rule == "frozen_rank" && matches!(case.law, "exponential" | "gamma with a pole");
    compare(1e-6, rule);
}

/// Weak contacts break as the exponent of the catastrophe barrier has a singularity where they meet their thresholds.
#[test]
fn a_tolerance_is_kept_where_weak_contacts_meet_their_thresholds() {
    let rule = |case: &Case| case.rule == "catastrophe" && case.law == "exponential";
    let contacts = all().find(rule).unwrap().contacts;
    let (position, start) = (0.194, initial(&point(0.0)));
    let history = History::new(vec![Piece { velocity: VELOCITY, duration: position / VELOCITY }]).unwrap();
    let mut transport = Transport::new_with(contacts.clone(), &start, 1e-9, &mut ()).unwrap();
    let force = transport.follow(&history, &[position / VELOCITY]).unwrap().force[0];
    let equation = MasterEquation::at(contacts, &start, VELOCITY).unwrap();
    let pull = equation.pull(position).unwrap();
    let off = force - pull.force(position);
    // A tenth of the tolerance; panels of one octave, whatever the tolerance, are off by 1.1e-9.
    assert!(off.abs() < 1e-10, "{off:e}");
}

#[test]
#[ignore = "takes half an hour"]
fn they_agree_for_all_rules_and_laws() {
    compare(1e-6, |_| true);
}

/// Within 4.5 standard errors. With fresh seeds a right program fails once in 450 runs of these 322 comparisons; seeds are fixed.
/// Where few of the contacts have broken yet, they scatter by one contact, or none.
#[test]
fn the_renewal_equation_and_single_contacts_agree() {
    const SIZE: usize = 20_000;
    let mut wrong = Vec::new();
    for (seed, case) in (0..).zip(all()).filter(|(_, case)| case.is_quick()) {
        let (contacts, initial) = (case.contacts.clone(), initial(&point(0.0)));
        let ensemble = Ensemble::new(contacts, initial, SIZE, seed, Disorder::Annealed).unwrap();
        let drawn = ensemble.pull_at(VELOCITY, &places()).unwrap();
        let (exact, off) = renewed(&case.contacts);
        let most = (0..PLACES)
            .map(|i| {
                ((drawn.force[i] - exact[i]).abs() - off).max(0.0) / drawn.error[i].max(1.0 / SIZE as f64)
            })
            .fold(0.0, f64::max);
        println!("{case}: {most:.2} standard errors");
        if most > 4.5 {
            wrong.push(format!("{case}: {most:.2}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
