//! Sliding far beyond the way on which it becomes steady: it costs as much as that way, and nothing but time and position is
//! different afterwards.

use std::ops::ControlFlow;

use crate::common::{contacts, gamma, gaussian, lognormal, master, mixture, point, rectangular, weibull};
use asperity::contacts::{Ageing, Barrier, Contacts, FreeFriction, FreeTime, Initial, Rules, Temperature};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Transport};
use asperity::monitor::{Cost, Monitor};
use asperity::rate_dependent::RateDependentContacts as _;

const TOLERANCE: f64 = 1e-6;
/// By default, where thresholds diffuse: steps cost a thousand times as much as those of other contacts.
const DIFFUSING_TOLERANCE: f64 = 1e-4;

fn tolerance_of(contacts: &Contacts) -> f64 {
    let diffusing = matches!(contacts.rules.ageing, Some(Ageing::Smoluchowski { .. }));
    if diffusing { DIFFUSING_TOLERANCE } else { TOLERANCE }
}

/// Counts pieces of work of one kind.
struct Count {
    cost: Cost,
    pieces: usize,
}

impl Count {
    fn of(cost: Cost) -> Self {
        Self { cost, pieces: 0 }
    }
}

impl Monitor for Count {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        if cost == self.cost {
            self.pieces += pieces;
        }
    }
}

fn with(thresholds: SharedLaw, ageing: Option<Ageing>, energy: f64, delay: FreeTime) -> Contacts {
    let heat = Temperature { barrier: Barrier::Elastic, ..Temperature::new(energy, 1.0) };
    let temperature = Some(heat).filter(|_| energy > 0.0);
    let free = !matches!(delay, FreeTime::Fixed(0.0));
    let free_friction = FreeFriction { force: if free { 0.1 } else { 0.0 }, viscosity: 0.0 };
    let rules = Rules { ageing, temperature, delay, free_friction, ..Rules::default() };
    Contacts { rules, ..contacts(&thresholds, &point(0.0)) }
}

fn cases() -> Vec<(&'static str, Contacts)> {
    let logarithmic = || Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let frozen_rank = || Some(Ageing::FrozenRank { mature: gaussian(1.2, 0.15), time: 1.0 });
    let smoluchowski = || Some(Ageing::Smoluchowski { mature: gaussian(1.2, 0.2), diffusion: 0.04 });
    let law = || gaussian(1.0, 0.2);
    vec![
        ("no rule", with(law(), None, 0.0, 0.0.into())),
        ("temperature", with(law(), None, 0.02, 0.0.into())),
        ("logarithmic", with(law(), logarithmic(), 0.0, 0.0.into())),
        ("logarithmic and temperature", with(law(), logarithmic(), 0.02, 0.0.into())),
        ("frozen_rank", with(law(), frozen_rank(), 0.0, 0.0.into())),
        ("smoluchowski", with(law(), smoluchowski(), 0.0, 0.0.into())),
        ("delay", with(law(), logarithmic(), 0.0, 0.3.into())),
        ("free times", with(law(), None, 0.0, gamma(0.4, 0.2).into())),
        ("broad thresholds", with(gamma(1.0, 0.5), None, 0.02, 0.0.into())),
        (
            "re-forming over a distribution",
            Contacts { reforming: rectangular(0.0, 0.1), ..with(law(), None, 0.02, 0.0.into()) },
        ),
    ]
}

/// The transport after a motion, with the trace at these times and the number of steps.
fn moved(contacts: &Contacts, pieces: &[Piece], times: &[f64]) -> (Transport, Vec<f64>, usize) {
    let mut steps = Count::of(Cost::TransportSteps);
    let mut transport =
        Transport::new_with(contacts.clone(), &Initial::default(), tolerance_of(contacts), &mut ()).unwrap();
    let history = History::new(pieces.to_vec()).unwrap();
    let trace = transport.follow_with(&history, times, &mut steps).unwrap();
    (transport, trace.force, steps.pieces)
}

#[test]
fn long_sliding_costs_what_becoming_steady_costs() {
    let (velocity, near, far) = (2.0, 60.0, 2e4);
    for (name, contacts) in cases() {
        let tolerance = tolerance_of(&contacts);
        let slide = |duration| Piece { velocity, duration };
        let faster = Piece { velocity: 20.0, duration: 0.1 };
        let after = |start: f64| -> Vec<f64> { (0..20).map(|k| start + 0.005 * f64::from(k)).collect() };
        let (mut short, force, few) = moved(&contacts, &[slide(near), faster], &after(near));
        let (mut long, same, steps) = moved(&contacts, &[slide(far), faster], &after(far));
        // The shorter way is long enough to become steady.
        assert_eq!(steps, few, "{name}");
        // The step to another velocity is what it is after a way on which sliding becomes steady, to the tolerance; times are
        // rounded at 2e4.
        let off = force.iter().zip(&same).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < tolerance, "{name}: {off:e}");
        // Rounding.
        assert!((long.time() / (far + 0.1) - 1.0).abs() < 1e-14);
        assert!((long.position() / (velocity * far + 2.0) - 1.0).abs() < 1e-14);
        // Breaks and energies grow by as much per length as renewal theory says, which shares no code with transport.
        let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
        let steady = equation.steady_state();
        let (more, less) = (long.energies(), short.energies());
        let way = velocity * (far - near);
        let rate = (more.broken - less.broken) / way;
        // The tolerance, of numbers of order 1.
        assert!((rate - steady.breaking_rate()).abs() < tolerance, "{name}: {rate}");
        let work = (more.lost + more.sliding - more.strengthening - less.lost - less.sliding
            + less.strengthening)
            / way;
        assert!((work - steady.kinetic_friction()).abs() < tolerance, "{name}: {work}");
        for transport in [&mut short, &mut long] {
            transport.step(0.5, 0.3, &mut ()).unwrap();
        }
        let [one, two] = [short.force(), long.force()];
        assert!((one - two).abs() < tolerance, "{name}: {one} {two}");
    }
}

#[test]
fn long_pulls_cost_what_becoming_steady_costs() {
    let laws = [
        gaussian(1.0, 0.1),
        gaussian(1.0, 0.03),
        gamma(1.0, 1.4),
        weibull(1.5, 1.0),
        lognormal(1.0, 0.5),
        mixture(&[(0.999, gaussian(1.0, 0.2)), (1e-3, gaussian(20.0, 2.0))]),
    ];
    for law in laws {
        let master = master(&law, &point(0.0), &point(0.0));
        let kinetic = master.steady_state().kinetic_friction();
        let pulled = |distance: f64| {
            let mut cells = Count::of(Cost::VolterraCells);
            let pull = master.pull_with(distance, TOLERANCE, &mut cells).unwrap();
            for x in [0.7 * distance, distance] {
                let off = (pull.force(x) - kinetic).abs();
                // The tolerance, of contacts with a mean life of about 1.
                assert!(off < TOLERANCE, "{law:?}: {off:e} at {x}");
            }
            cells.pieces
        };
        let (near, far) = (pulled(3e3), [1e5, 1e6, 1e7].map(pulled));
        // Steady after 1500 at most; cells grow wider for a while before one is allowed to reach to the end.
        assert!(far.iter().all(|&cells| cells < 3 * near), "{law:?}: {near}, {far:?}");
    }
}

/// Contacts that hold for longer than all others break at a constant rate keep it from being steady.
#[test]
fn rare_strong_contacts_are_waited_for() {
    let laws = mixture(&[(0.999, gaussian(1.0, 0.2)), (1e-3, gaussian(20.0, 2.0))]);
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.01, time: 1.0 }), ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&laws, &point(0.0)) };
    let velocity = 1.0;
    let (transport, _, _) = moved(&contacts, &[Piece { velocity, duration: 150.0 }], &[]);
    let equation = MasterEquation::at(contacts, &Initial::default(), velocity).unwrap();
    let steady = equation.steady_state().kinetic_friction();
    // They carry a third of the force; the tolerance.
    let off = (transport.force() - steady).abs();
    assert!(off < TOLERANCE * transport.unit(), "{off:e}");
}

/// Sliding is not steady while contacts break together again and again.
#[test]
fn contacts_that_stay_in_phase_are_followed() {
    let contacts = Contacts::new(point(1.0), point(0.0));
    let duration = 100.25;
    let (transport, _, steps) = moved(&contacts, &[Piece { velocity: 1.0, duration }], &[]);
    assert!(steps > 100, "{steps}");
    assert!((transport.force() - 0.25).abs() < TOLERANCE);
}

/// Contacts that do not depend on time and start in steady sliding remain in it at every velocity and at rest, without a step of
/// the solver: narrow thresholds would take some 1e5 of them, each with as many cohorts, per life.
#[test]
fn a_steady_start_without_time_dependence_takes_no_step() {
    let contacts = contacts(&gaussian(1.0, 1e-4), &point(0.0));
    let equation = MasterEquation::new(contacts.clone(), &Initial::default()).unwrap();
    let steady = equation.steady_state();
    let pieces = [(0.5, 2.0), (0.0, 10.0), (2.0, 5e3)];
    let history =
        History::new(pieces.map(|(velocity, duration)| Piece { velocity, duration }).to_vec()).unwrap();
    let mut steps = Count::of(Cost::TransportSteps);
    let mut transport = Transport::steady_with(&contacts, 0.5, TOLERANCE, &mut ()).unwrap();
    let trace =
        transport.follow_with(&history, &[0.0, 1.0, 2.0, 7.0, 12.0, 1e3, 5012.0], &mut steps).unwrap();
    assert_eq!(steps.pieces, 0);
    for force in &trace.force {
        // The tolerance.
        assert!((force - steady.kinetic_friction()).abs() < TOLERANCE, "{force}");
    }
    // Breaks and the energy that they lose, by renewal theory, to the tolerance; the slider has moved by 10001.
    let (energies, way) = (transport.energies(), 10_001.0);
    assert_eq!(transport.position(), way);
    assert!((energies.broken / way - steady.breaking_rate()).abs() < TOLERANCE, "{}", energies.broken);
    assert!((energies.lost / way - steady.kinetic_friction()).abs() < TOLERANCE, "{}", energies.lost);
    // A state that is written and read remains steady; it has no second solution.
    let state = transport.state();
    let mut resumed = Transport::steady_with(&contacts, 0.5, TOLERANCE, &mut ()).unwrap();
    resumed.restore(&state).unwrap();
    resumed.step(0.5, 0.1, &mut steps).unwrap();
    assert_eq!((steps.pieces, resumed.force()), (0, transport.force()));
    // Back by less than the stretch of most contacts none breaks: the force falls by the stiffness of all, 1, per length.
    transport.step(-1e-3, 0.1, &mut steps).unwrap();
    assert!(steps.pieces > 0);
    let fallen = trace.force[0] - transport.force();
    // The fraction that is attached, to the tolerance, times 1e-3.
    assert!((fallen - 1e-3).abs() < 1e-3 * TOLERANCE, "{fallen}");
}

/// Contacts that are free for a thousand times as long as they hold, and break and re-form in phase: between two bursts all are
/// free, and nothing but the time changes.
#[test]
fn sliding_while_all_contacts_are_free_takes_no_steps() {
    let contacts = with(gaussian(1.0, 0.1), None, 0.0, 1e3.into());
    let velocity = 1.0;
    let times: Vec<f64> = [0.5, 1.0, 500.0, 1001.5, 1002.1, 1600.0, 2002.3, 2002.9, 2003.4, 2500.0].to_vec();
    let (transport, force, steps) = moved(&contacts, &[Piece { velocity, duration: 2600.0 }], &times);
    // Some 100 in each of three bursts of each of two solutions; steps as long as in bursts would be 10⁴ between two of them.
    assert!(steps < 1500, "{steps}");
    let pull = MasterEquation::at(contacts, &Initial::default(), velocity).unwrap().pull(2600.0).unwrap();
    for (time, force) in times.iter().zip(&force) {
        let off = (force - pull.force(velocity * time)).abs();
        // The tolerance.
        assert!(off < TOLERANCE, "{off:e} at {time}");
    }
    let energies = transport.energies();
    assert!((energies.broken - 3.0).abs() < TOLERANCE, "{}", energies.broken);
    // They are free but for the mean life of 1 in each of three bursts, and carry 0.1 while they slide.
    assert!((energies.sliding - 0.1 * (2600.0 - 3.0)).abs() < TOLERANCE, "{}", energies.sliding);
}
