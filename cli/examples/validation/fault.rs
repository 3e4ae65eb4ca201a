//! Interfaces over contacts that age: slow and fast fronts, recurrence against the loading rate, and healing.

use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Contacts, Initial, Rules};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{
    CellLoading, Event, RateDependentInterface, RateDependentInterfaceParameters, Slipped,
};
use asperity::history::{History, LoadPointSegment, Piece};
use asperity::master::Transport;
use asperity::rate_dependent::RateDependentContacts;
use asperity::shape::{Edges, Shape};

use crate::page::Page;
use crate::{gaussian, point};

const VISCOSITY: f64 = 1.0;
/// Velocity of the drive of the chain whose fronts are measured.
const SLOW: f64 = 1e-3;

fn ageing(std: f64) -> Contacts {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 }), ..Rules::default() };
    Contacts { rules, ..Contacts::new(gaussian(1.0, std), point(0.0)) }
}

/// A chain of cells alike.
fn chain(
    contacts: &Transport,
    number: usize,
    stiffness: f64,
    setting: RateDependentInterfaceParameters,
) -> RateDependentInterface {
    let cell = |_| Box::new(contacts.clone()) as Box<dyn RateDependentContacts>;
    let coupling = neighbours(Shape::Chain(number), Edges::Open, stiffness).expect("a chain");
    RateDependentInterface::new((0..number).map(cell).collect(), coupling, setting).expect("cells for each")
}

fn relaxed(contacts: &Contacts, tolerance: f64) -> Transport {
    let initial = Initial::default();
    Transport::new_with(contacts.clone(), &initial, tolerance, &mut ()).expect("contacts that are valid")
}

/// A quick run leaves out the smaller error of a step and holds between the first and the last.
pub fn section(page: Page, quick: bool) -> Page {
    healing(recurrence(fronts(page, quick)), quick)
}

fn fronts(mut page: Page, quick: bool) -> Page {
    page.text(
        "
## Interfaces over contacts that age

Contacts with logarithmic ageing (Δx_s = 0.05 per factor e of age, t₀ = 1) in the cells of a chain with η = 1. The first
chain has 20 cells with K_int = 25 and is pulled at one end by K_0 = 2 at v = 0.001 (σ = 0.1, the scenario `front-ageing`). From
the pulled end a slow front moves along the chain, behind which cells creep; when the creeping part is long enough, a fast front
runs to both ends. The slow front is where a cell has moved by 0.1 since the last event, its speed that between the cells 2 and 8
before the last of five events; the fast front is that of the event. No reference is known. With the error
of a step, in mean thresholds, the slow front changes by 1 %, and the fast one, which depends on where slip begins, by 2 %.
",
    );
    page.head(&[
        "error of a step",
        "slow front, cells per time",
        "fast front, cells per time",
        "recurrence in X_T",
    ]);
    for tolerance in if quick { vec![1e-4] } else { vec![1e-4, 1e-5] } {
        let [slow, fast, period] = speeds(tolerance);
        page.row(&[
            format!("{tolerance:.0e}"),
            format!("{slow:.5}"),
            format!("{fast:.2}"),
            format!("{period:.3}"),
        ]);
    }
    page.end();
    page
}

/// Speeds of the slow front before the fifth event and of the fast front of this event, and the recurrence.
fn speeds(tolerance: f64) -> [f64; 3] {
    /// Displacement by which the slow front has passed a cell.
    const PASSED: f64 = 0.1;
    let setting = RateDependentInterfaceParameters {
        loading: CellLoading::Edge,
        ..RateDependentInterfaceParameters::new(2.0, VISCOSITY, tolerance)
    };
    let mut chain = chain(&relaxed(&ageing(0.1), tolerance), 20, 25.0, setting);
    let large = |events: &[(Event, Vec<Slipped>)]| {
        events.iter().find(|(event, _)| event.cells == 20 && event.drop() > 0.5).map(|found| found.0)
    };
    let (mut drives, mut passed, mut begun) = (Vec::new(), [f64::NAN; 20], chain.positions());
    loop {
        let next = chain.drive() + 0.01;
        let events = chain.next(next, SLOW).expect("nothing stops it");
        for (j, position) in chain.positions().iter().enumerate() {
            if passed[j].is_nan() && position - begun[j] > PASSED {
                passed[j] = chain.time();
            }
        }
        let Some(event) = large(&events) else { continue };
        drives.push(event.drive);
        if drives.len() == 5 {
            let slow = 6.0 / (passed[8] - passed[2]);
            let fast = event.front_speed_right;
            return [slow, fast, drives[4] - drives[3]];
        }
        (passed, begun) = ([f64::NAN; 20], chain.positions());
    }
}

fn recurrence(mut page: Page) -> Page {
    page.text(
        "
Stick-slip of a chain of four cells that are alike (σ = 0.1, K_0 = 0.05 per cell, K_int = 1), and of a block of the same stiffness per
contact, against the velocity of the load point: the recurrence in X_T and the drop of the force per cell, means of the fourth to
the eighth event. Slower loading gives contacts more time to age. Chain and block share the equation of motion, not the solver.
",
    );
    page.head(&["v", "recurrence, chain", "recurrence, block", "drop, chain", "drop, block"]);
    for velocity in [1e-5, 1e-4, 1e-3] {
        let (chain, block) = (of_chain(velocity), of_block(velocity));
        page.row(&[
            format!("{velocity:.0e}"),
            format!("{:.2}", chain.0),
            format!("{:.2}", block.0),
            format!("{:.2}", chain.1),
            format!("{:.2}", block.1),
        ]);
    }
    page.end();
    page
}

const SPRING: f64 = 0.05;
const ACCURATE: f64 = 1e-4;
/// Largest drive of the recurrence.
const FAR: f64 = 150.0;

/// Mean recurrence and drop of the fourth to the eighth of these events.
fn means(drives: &[f64], drops: &[f64]) -> (f64, f64) {
    ((drives[7] - drives[3]) / 4.0, drops[3..8].iter().sum::<f64>() / 5.0)
}

fn of_chain(velocity: f64) -> (f64, f64) {
    let setting = RateDependentInterfaceParameters::new(SPRING, VISCOSITY, ACCURATE);
    let mut chain = chain(&relaxed(&ageing(0.1), ACCURATE), 4, 1.0, setting);
    let mut events = Vec::new();
    while events.len() < 8 {
        let found = chain.next(FAR, velocity).expect("nothing stops it");
        assert!(!found.is_empty(), "stick-slip ends");
        events.extend(found.into_iter().map(|(event, _)| (event.drive, event.drop() / 4.0)));
    }
    let (drives, drops): (Vec<f64>, Vec<f64>) = events.into_iter().unzip();
    means(&drives, &drops)
}

fn of_block(velocity: f64) -> (f64, f64) {
    let block = Block::new(Loading::Spring(SPRING), Slip::Damped { damping: VISCOSITY }, None);
    let drive = History::new(vec![Piece { velocity, duration: FAR / velocity }]).expect("a velocity above 0");
    let contacts = relaxed(&ageing(0.1), ACCURATE);
    let run = block.expect("a stiffness above 0").follow_with(&contacts, &drive, &[0.0], ACCURATE, &mut ());
    let slips = run.expect("nothing stops it").slips;
    let drives: Vec<f64> = slips.iter().map(|slip| slip.before.drive).collect();
    let drops: Vec<f64> = slips.iter().map(|slip| slip.before.force - slip.after.force).collect();
    means(&drives, &drops)
}

fn healing(mut page: Page, quick: bool) -> Page {
    page.text(
        "
Healing: static friction per cell after a hold of a whole chain (four cells alike, σ = 0.25, K_0 = 200 per cell, v = 0.1 before and
after, from steady sliding), and of a rigid slider over the same contacts, which needs no equation of motion.
",
    );
    page.head(&["hold", "F_s, chain", "F_s, rigid slider"]);
    for hold in if quick { vec![1.0, 1e4] } else { vec![1.0, 10.0, 100.0, 1000.0, 1e4] } {
        let (chain, rigid) = healed(hold);
        page.row(&[hold.to_string(), format!("{chain:.4}"), format!("{rigid:.4}")]);
    }
    page.end();
    page
}

/// The largest force after a hold: of a chain, and of a rigid slider.
fn healed(hold: f64) -> (f64, f64) {
    const VELOCITY: f64 = 0.1;
    let contacts =
        Transport::steady_with(&ageing(0.25), VELOCITY, 1e-5, &mut ()).expect("contacts that are valid");
    let pieces = [(VELOCITY, 1.0), (0.0, hold), (VELOCITY, 15.0)];
    let pieces = pieces.map(|(velocity, duration)| Piece { velocity, duration });
    let history = History::new(pieces.to_vec()).expect("velocities and durations");
    let (from, to) = (history.knots()[2].0, history.duration());
    let times: Vec<f64> = (0..=1500).map(|k| (from + (to - from) * f64::from(k) / 1500.0).min(to)).collect();
    let setting = RateDependentInterfaceParameters::new(200.0, VISCOSITY, 1e-5);
    let mut chain = chain(&contacts, 4, 1.0, setting);
    let (origin, mut highest) = (chain.drive(), 0.0_f64);
    for (piece, knots) in history.pieces().iter().zip(history.knots()) {
        let &Piece { velocity, .. } = piece;
        let segment = LoadPointSegment { time: knots.0, drive: origin + knots.1, velocity, pulled: VELOCITY };
        let end = knots.0 + piece.duration;
        for &time in times.iter().filter(|time| **time >= knots.0 && **time <= end).chain([&end]) {
            while !chain.follow_with(&segment, time, &mut ()).expect("nothing stops it").is_empty() {}
            highest = highest.max(chain.force() / 4.0);
        }
    }
    let rigid = contacts.clone().follow(&history, &times).expect("nothing stops it").force;
    (highest, rigid.into_iter().fold(0.0, f64::max))
}
