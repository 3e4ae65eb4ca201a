//! Contacts that keep their rank: the general way against the closed one, and its limits.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::finite_volumes::{Diffusion, DiffusionStep, NO_FLOOR, Work};
use crate::common::sliders::Impatient;
use crate::common::{contacts, gamma, gaussian, initial, lognormal, master, point, weibull};
use asperity::contacts::{
    Ageing, Contacts, Initial, Start, Temperature, ThresholdEvolution, ThresholdFokkerPlanck,
};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::{Exponential, Gamma, Mixture, Point, Rectangular, SharedLaw};
use asperity::life::moving;
use asperity::master::MasterEquation;
use asperity::monitor::Monitor;

/// F_k, and the error that the life reports.
fn reported(fresh: &SharedLaw, mature: &SharedLaw, velocity: f64) -> (f64, f64) {
    let mut contacts = Contacts::new(fresh.clone(), Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::FrozenRank { mature: mature.clone(), time: 1.0 });
    let life = moving(&contacts, &contacts.reforming, true, velocity, false, &mut ()).unwrap();
    (life.force().curve().integral() / life.survival().curve().integral(), life.error())
}

fn kinetic_friction(fresh: &SharedLaw, mature: &SharedLaw, velocity: f64) -> f64 {
    reported(fresh, mature, velocity).0
}

#[test]
fn a_mixture_of_one_gaussian_ages_like_that_gaussian() {
    let mixture: SharedLaw = Arc::new(Mixture::new(vec![(1.0, gaussian(0.5, 0.1))]).unwrap());
    for (velocity, expected) in [(10.0, 0.2721367872), (1.0, 0.3867782523), (0.1, 0.5012378105)] {
        let found = kinetic_friction(&mixture, &gaussian(1.0, 0.05), velocity);
        // What the fresh law has below 0 is cut off, of 2.9e-7.
        assert!((found - expected).abs() < 3e-7, "{velocity} {found}");
    }
}

#[test]
fn friction_weakens_from_that_of_the_mature_law_to_that_of_the_fresh_one() {
    let laws: [(SharedLaw, SharedLaw); 2] = [
        (gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.2).unwrap())),
        (gaussian(0.9, 0.05), Arc::new(Rectangular::new(0.6, 1.6).unwrap())),
    ];
    for (fresh, mature) in laws {
        let still = |law: &SharedLaw| law.upper_moment(2, -1.0) / (2.0 * law.mean());
        let found = [1e-3, 0.2, 1.0, 1e6].map(|velocity| kinetic_friction(&fresh, &mature, velocity));
        // Ages of a thousand times τ, and of a millionth.
        assert!((found[0] - still(&mature)).abs() < 1e-7);
        assert!((found[3] - still(&fresh)).abs() < 3e-6);
        assert!(found.windows(2).all(|pair| pair[0] > pair[1]), "{found:?}");
    }
}

/// F_k where S(x) = 1 − max G(x'; x'/v), G by finite volumes on so many cells, of which the stretch passes one at each step.
fn by_finite_volumes(fresh: &SharedLaw, mature: &SharedLaw, velocity: f64, cells: usize) -> f64 {
    let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature.clone(), mature.std().powi(2));
    let operator = Arc::new(Diffusion::of(&maturing, cells));
    let width = operator.width();
    let mut masses = maturing.fresh(&operator.middles(), -1.0, &mut ()).unwrap();
    let (mut work, step) = (Work::default(), DiffusionStep::new(&operator, width / velocity));
    let (mut met, mut sums) = (0.0_f64, [0.5 * width, 0.0]);
    for cell in 1..cells {
        step.advance(&mut masses, NO_FLOOR, &mut work);
        met = met.max(masses[..cell].iter().sum());
        sums[0] += width * (1.0 - met);
        sums[1] += width * operator.edge(cell) * (1.0 - met);
    }
    sums[1] / sums[0]
}

#[test]
fn between_gammas_ranks_are_those_of_the_law_followed_by_finite_volumes() {
    let law = |mean, std| Arc::new(Gamma::new(mean, std).unwrap()) as SharedLaw;
    let (fresh, mature) = (law(0.7, 0.14), law(1.2, 0.15));
    for velocity in [5.0, 0.7] {
        let [coarse, fine, finest] =
            [500, 1000, 2000].map(|cells| by_finite_volumes(&fresh, &mature, velocity, cells));
        let (better, best) = (fine + (fine - coarse) / 3.0, finest + (finest - fine) / 3.0);
        let (found, error) = reported(&fresh, &mature, velocity);
        // The tolerance by default is 1e-10; a digit for both solutions.
        assert!(error < 1e-9, "{velocity}: {error:e}");
        // Finite volumes are of second order, extrapolated once: the better one is off by a fifteenth of what they differ by,
        // or less. What they differ by may be 0 by chance, what the life reports is not.
        let off = (found - best).abs();
        assert!(
            off < (best - better).abs() + error && off < 3e-8,
            "{velocity} {found} {best} {better} {error:e}"
        );
    }
}

#[test]
fn a_pull_reaches_an_accuracy_that_is_asked_for() {
    let law = |mean, std| Arc::new(Gamma::new(mean, std).unwrap()) as SharedLaw;
    let mut contacts = Contacts::new(law(0.7, 0.14), Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::FrozenRank { mature: law(1.2, 0.15), time: 1.0 });
    let initial = Initial { law: Arc::new(Point::new(0.0).unwrap()), start: Start::Conditional };
    let equation = MasterEquation::at(contacts, &initial, 5.0).unwrap();
    let pull = equation.pull_with(1.4, 1e-9, &mut ()).unwrap();
    let reported = pull.error_estimate() / equation.life().mean();
    // The tolerance that was asked for.
    assert!(equation.life().error() <= reported && reported < 1e-9, "{reported:e}");
    // ∫Q = 1, by a quadrature that shares nothing with the solution but Γ.
    for position in [0.2, 0.7, 1.0, 1.37] {
        assert!((pull.total_probability(position) - 1.0).abs() < 1e-9, "{position}");
    }
}

/// Thresholds of exponential law mature away from the stretch, which meets those near 0 as soon as contacts form, and no others
/// until much later: 1e-3 of all, by finite volumes.
#[test]
fn single_contacts_break_beside_an_edge_as_soon_as_they_form() {
    const SIZE: usize = 200_000;
    let (velocity, cells, to) = (0.5, 200_000, 0.03);
    let (fresh, mature): (SharedLaw, _) = (Arc::new(Exponential::new(1.0).unwrap()), gaussian(1.5, 0.1));
    let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature.clone(), mature.std().powi(2));
    let operator = Arc::new(Diffusion::of(&maturing, cells));
    let width = operator.width();
    let mut masses = maturing.fresh(&operator.middles(), -1.0, &mut ()).unwrap();
    let (mut work, step) = (Work::default(), DiffusionStep::new(&operator, width / velocity));
    // The largest share below the stretch so far has been met; what carried x there carries x less from then on.
    let (mut met, mut lost) = (0.0, 0.0);
    for cell in 1..(to / width) as usize {
        step.advance(&mut masses, NO_FLOOR, &mut work);
        let below: f64 = masses[..cell].iter().sum();
        lost += (below - met).max(0.0) * (cell as f64 - 0.5) * width;
        met = below.max(met);
    }
    let start = Arc::new(Point::new(0.0).unwrap());
    let mut contacts = Contacts::new(fresh, start.clone());
    contacts.rules.ageing = Some(Ageing::FrozenRank { mature, time: 1.0 });
    let initial = Initial { law: start, start: Start::Conditional };
    let ensemble = Ensemble::new(contacts, initial, SIZE, 1, Disorder::Annealed).unwrap();
    let position = 0.5;
    let pull = ensemble.pull_at(velocity, &[position]).unwrap();
    // Those that break twice are a thousandth of them.
    let off = (position - pull.force[0] - lost) / pull.error[0];
    assert!(off.abs() < 4.0, "{off} standard errors, of {:e}", pull.error[0]);
}

/// Counts what it is asked.
struct Counting(usize);

impl Monitor for Counting {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.0 += 1;
        ControlFlow::Continue(())
    }
}

/// The threshold of a contact, and whether a table was computed for it: that asks its monitor.
fn aged(contacts: &Contacts) -> (f64, bool) {
    let mut asked = Counting(0);
    let evolution = ThresholdEvolution::of_with(contacts, &mut asked).unwrap();
    (evolution.threshold(0.9, 0.7), asked.0 > 0)
}

/// Velocities, tolerances and solvers share a table; other distributions and times have their own.
#[test]
fn copies_of_contacts_compute_their_thresholds_once() {
    let fresh: SharedLaw = Arc::new(Gamma::new(1.0, 0.3).unwrap());
    let mature: SharedLaw = Arc::new(Gamma::new(1.5, 0.2).unwrap());
    let aging = |mature: &SharedLaw, time: f64| Some(Ageing::FrozenRank { mature: mature.clone(), time });
    let mut contacts = Contacts::new(fresh, Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = aging(&mature, 1.0);
    let (threshold, computed) = aged(&contacts);
    assert!(computed);
    assert_eq!(aged(&contacts.clone()), (threshold, false));
    // With the place for a table of other contacts, which is not theirs.
    let same: SharedLaw = Arc::new(Gamma::new(1.5, 0.2).unwrap());
    let other: SharedLaw = Arc::new(Gamma::new(1.6, 0.2).unwrap());
    for (ageing, equal) in
        [(aging(&same, 1.0), true), (aging(&mature, 2.0), false), (aging(&other, 1.0), false)]
    {
        let mut changed = contacts.clone();
        changed.rules.ageing = ageing;
        let (found, computed) = aged(&changed);
        assert!(computed);
        assert_eq!(found == threshold, equal);
    }
    // The last one was kept: made anew, to the same bits.
    assert_eq!(aged(&contacts), (threshold, true));
}

/// Thresholds from 0, as a power, to thousands of means mature at the same thresholds: how high the barriers of new contacts are
/// matters only where they break when they are new.
#[test]
fn thresholds_of_any_size_that_mature_slide_as_single_contacts_do() {
    /// Twenty times what it asks; a sum over thresholds of one age asked more often than this before it resolved a thousandth.
    const QUESTIONS: usize = 1_000_000;
    for thresholds in [weibull(0.41, 1.0), lognormal(1.0, 3.0)] {
        let mut contacts = contacts(&thresholds, &point(0.0));
        contacts.rules.ageing = Some(Ageing::FrozenRank { mature: gaussian(1.5, 0.2), time: 1.0 });
        contacts.rules.temperature = Some(Temperature::new(0.05, 1.0));
        let start = initial(&point(0.0));
        let equation = MasterEquation::at_with(contacts.clone(), &start, 0.1, &mut Impatient(QUESTIONS));
        let expected = equation.unwrap().steady_state().kinetic_friction();
        let ensemble = Ensemble::new(contacts, start, 3000, 1, Disorder::Annealed).unwrap();
        let slide = History::new(vec![Piece { velocity: 0.1, duration: 300.0 }]).unwrap();
        let trace = ensemble.follow(&slide, &[300.0]).unwrap();
        let errors = (trace.force[0] - expected).abs() / trace.error[0];
        println!("{expected}: {} ± {}", trace.force[0], trace.error[0]);
        assert!(errors < 4.0, "{expected}, {} ± {}", trace.force[0], trace.error[0]);
    }
}

/// Slow sliding of contacts whose fresh thresholds have an infinite density at 0: they are mature before they have stretched, and no
/// number of the pull is lost to the infinite density of thresholds that none of them has any more.
#[test]
fn an_infinite_density_of_fresh_thresholds_leaves_numbers() {
    let (fresh, mature) = (gamma(1.0, 1.5), gaussian(3.0, 0.3));
    let mut slow = contacts(&fresh, &point(0.0));
    slow.rules.ageing = Some(Ageing::FrozenRank { mature: mature.clone(), time: 1.0 });
    let ageing = MasterEquation::at(slow, &initial(&point(0.0)), 1e-11).unwrap().pull(5.0).unwrap();
    let athermal = master(&mature, &point(0.0), &point(0.0)).pull(5.0).unwrap();
    for x in [0.5, 1.5, 2.8, 3.2, 4.5] {
        // What has not matured after an advance of 1e-10.
        let (found, expected) = (ageing.force(x), athermal.force(x));
        assert!((found - expected).abs() < 1e-6, "{x}: {found} {expected}");
    }
    assert!(ageing.error_estimate().is_finite());
}
