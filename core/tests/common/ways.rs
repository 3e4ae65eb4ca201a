//! Time-dependent contacts, of every kind that can be followed one by one, and ways of a slider over them in time.

use std::sync::Arc;

use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Temperature};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::master::Transport;

/// Contacts of one kind, and a velocity at which time matters to them.
pub struct Kind {
    /// What it is called.
    pub name: &'static str,
    /// The contacts.
    pub contacts: Contacts,
    velocity: f64,
}

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).expect("a mean of 0 or above, a std above 0"))
}

fn relaxed() -> SharedLaw {
    Arc::new(Point::new(0.0).expect("a point at 0 or above"))
}

/// Contacts of stiffness 1 that re-form at 0.
pub fn contacts(thresholds: SharedLaw, rules: Rules) -> Contacts {
    Contacts { rules, ..Contacts::new(thresholds, relaxed()) }
}

/// Breaking at a temperature, attempted at the rate 1.
pub fn thermal(barrier: Barrier, energy: f64) -> Rules {
    let temperature = Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
    Rules { temperature, ..Rules::default() }
}

/// Ageing by one rule.
pub fn ageing(ageing: Ageing) -> Rules {
    Rules { ageing: Some(ageing), ..Rules::default() }
}

/// Every kind: heat over barriers of k x̄²/2T = 10, thresholds that strengthen, and those that mature from G(½, 0.1) to G(1, 0.05).
pub fn kinds() -> Vec<Kind> {
    let (fresh, mature) = (|| gaussian(0.5, 0.1), || gaussian(1.0, 0.05));
    let warm = |barrier| contacts(gaussian(1.0, 0.1), thermal(barrier, 0.05));
    let ranked = Ageing::FrozenRank { mature: mature(), time: 1.0 };
    let diffusing = Ageing::Smoluchowski { mature: mature(), diffusion: 0.0025 };
    let strengthening = ageing(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    let waiting = Rules { delay: 0.5.into(), ..thermal(Barrier::Elastic, 0.05) };
    let of = |name, contacts, velocity| Kind { name, contacts, velocity };
    vec![
        of("elastic barrier", warm(Barrier::Elastic), 1e-3),
        of("bell barrier", warm(Barrier::Bell), 1e-3),
        of("catastrophe barrier", warm(Barrier::Catastrophe), 1e-3),
        of("logarithmic", contacts(gaussian(1.0, 0.1), strengthening), 1e-1),
        of("frozen_rank", contacts(fresh(), ageing(ranked)), 3e-1),
        of("smoluchowski", contacts(fresh(), ageing(diffusing)), 3e-1),
        of("elastic barrier, delay", contacts(gaussian(1.0, 0.1), waiting), 3e-1),
    ]
}

/// A slide, in which contacts lose step; then steps of the velocity down and up, a hold, or slow creep and fast slips in turn.
/// Each piece is a velocity, in units of that of the kind, and a distance, or the time of a hold in units of 1/velocity.
const STEPS: [(f64, f64); 3] = [(1.0, 1.2), (0.1, 0.6), (10.0, 0.9)];
const HOLD: [(f64, f64); 3] = [(1.0, 1.2), (0.0, 3.0), (1.0, 1.0)];
const STICK_SLIP: [(f64, f64); 6] =
    [(1.0, 1.2), (0.03, 0.3), (30.0, 0.8), (0.03, 0.25), (30.0, 0.7), (0.03, 0.25)];

impl Kind {
    /// Ways of the slider by name.
    pub fn ways(&self) -> [(&'static str, History); 3] {
        let piece = |&(factor, by): &(f64, f64)| match factor * self.velocity {
            0.0 => Piece { velocity: 0.0, duration: by / self.velocity },
            velocity => Piece { velocity, duration: by / velocity },
        };
        let way = |pieces: &[(f64, f64)]| {
            History::new(pieces.iter().map(piece).collect()).expect("velocities of 0 or above, times above 0")
        };
        [("velocity steps", way(&STEPS)), ("hold", way(&HOLD)), ("stick-slip", way(&STICK_SLIP))]
    }

    /// Follows transport to a tolerance, and `size` contacts one by one, both from rest.
    pub fn follow(&self, way: &History, tolerance: f64, size: usize) -> Followed {
        let initial = Initial { law: relaxed(), start: Start::Conditional };
        let transport = Transport::new_with(self.contacts.clone(), &initial, tolerance, &mut ());
        let ensemble = Ensemble::new(self.contacts.clone(), initial, size, 1, Disorder::Annealed);
        let times = looks(way);
        let trace = transport.and_then(|mut transport| transport.follow(way, &times));
        let drawn = ensemble.and_then(|ensemble| ensemble.follow(way, &times));
        let (trace, drawn) = (trace.expect("a way at this tolerance"), drawn.expect("a rule of one contact"));
        Followed { times, exact: trace.force, drawn: drawn.force, error: drawn.error }
    }
}

/// The end of the first piece, before which contacts are in step, and four times in every other.
fn looks(way: &History) -> Vec<f64> {
    let ends: Vec<f64> = way.knots().iter().map(|knot| knot.0).filter(|&time| time > 0.0).collect();
    let within = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        (1..=4).map(move |k| from + 0.25 * f64::from(k) * (to - from)).collect::<Vec<_>>()
    };
    ends[..1].iter().copied().chain(ends.windows(2).flat_map(within)).collect()
}

/// The forces of both.
pub struct Followed {
    /// When.
    pub times: Vec<f64>,
    /// F of transport.
    pub exact: Vec<f64>,
    /// F of the ensemble.
    pub drawn: Vec<f64>,
    /// Standard error of that.
    pub error: Vec<f64>,
}

impl Followed {
    /// Differences in standard errors.
    pub fn deviations(&self) -> Vec<f64> {
        let off = self.drawn.iter().zip(&self.exact).map(|(drawn, exact)| drawn - exact);
        off.zip(&self.error).map(|(off, error)| off / error).collect()
    }
}
