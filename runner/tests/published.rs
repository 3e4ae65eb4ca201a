//! Published results, computed by the shipped scenarios: the page `docs/gallery.md` states these numbers, and no others.

use std::path::Path;

use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity::task::summary::{Friction, StaticFriction};
use asperity_runner::{input, output::Outcome};

/// The scenario, without the ensemble beside it.
fn run(name: &str, overrides: &[&str]) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(format!("{name}.toml"));
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let scenario = Scenario { ensemble: None, ..input::read(&path, &overrides).unwrap().scenario };
    asperity_runner::run(&scenario, &mut ()).unwrap()
}

fn column<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

/// The page says this.
#[track_caller]
fn reported(text: &str) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/gallery.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(text), "docs/gallery.md does not say: {text}");
}

/// Braun and Peyrard (2008), Fig. 2.
#[test]
fn first_loading() {
    let outcome = run("fig2", &[]);
    let friction: &Friction = outcome.summary.numbers.friction().unwrap();
    let StaticFriction::Reached { force, position } = friction.static_friction else { panic!("no maximum") };
    let kinetic = friction.kinetic_friction;
    reported(&format!("F reaches {force:.4} at X = {position:.4}, and tends to {kinetic:.5}"));
    // Over the last two oscillations.
    let record = &outcome.record;
    let late = column(record, "position").iter().zip(column(record, "force")).filter(|(x, _)| **x >= 18.0);
    let [low, high] = late.fold([f64::INFINITY, 0.0], |[low, high], (_, &f)| [f.min(low), f.max(high)]);
    reported(&format!("at X = 20, where the picture ends, between {low:.2} and {high:.2}"));
    // (1 + σ²)/2 for thresholds of the width σ = 0.05, but for the mass of a Gaussian below 0.
    assert!((friction.kinetic_friction - 0.5 * (1.0 + 0.05 * 0.05)).abs() < 1e-12);
}

/// Braun and Peyrard (2011): friction rises with velocity where contacts break by temperature.
#[test]
fn friction_rises_with_velocity() {
    let record = run("velocity-curve-thermal", &[]).record;
    let (velocity, all) = (column(&record, "velocity"), column(&record, "kinetic_friction"));
    assert!(all.chunks(velocity.len()).all(|curve| curve.windows(2).all(|pair| pair[1] > pair[0])));
    // The lowest temperature comes first. Two points make a decade.
    let slope = all[4] - all[2];
    let creep = &column(&record, "creep_friction")[..velocity.len()];
    let off = creep.iter().zip(all).map(|(law, force)| (law / force - 1.0).abs());
    let off = off.filter(|off| off.is_finite()).fold(0.0, f64::max);
    reported(&format!(
        "by {slope:.4} per decade at v = 10⁻⁷ to 10⁻⁶, and the law of slow creep holds to {:.1} %",
        100.0 * off
    ));
}

/// Braun and Peyrard (2011): friction falls with velocity where contacts re-form late.
#[test]
fn a_delay_makes_a_maximum() {
    let record = run("velocity-curve-delay", &[]).record;
    let (velocity, force) = (column(&record, "velocity"), column(&record, "kinetic_friction"));
    let top = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b])).unwrap();
    assert!(top > 0 && force[..=top].is_sorted() && force[top..].iter().rev().is_sorted());
    reported(&format!("highest, {:.3}, at v = {:.3}", force[top], velocity[top]));
    // Contacts live for the mean threshold 1 and are free for vτ = v.
    let closed = |v: f64| 0.5 * (1.0 + 0.05 * 0.05) / (1.0 + v);
    let fast = velocity.iter().zip(force).filter(|(v, _)| **v >= 1.0);
    let off = fast.map(|(&v, force)| (force / closed(v) - 1.0).abs()).fold(0.0, f64::max);
    reported(&format!("from v = 1 on to {:.1} %", 100.0 * off));
}

/// Braun and Peyrard (2011): friction falls with velocity where contacts age.
#[test]
fn ageing_weakens_with_velocity() {
    let record = run("velocity-curve-ageing", &[]).record;
    let (velocity, force) = (column(&record, "velocity"), column(&record, "kinetic_friction"));
    let top = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b])).unwrap();
    assert!(force[..=top].is_sorted() && force[top..].iter().rev().is_sorted());
    let last = force[force.len() - 1];
    reported(&format!(
        "highest, {:.3}, at v = {:.2}, and falls to {last:.3} at v = 10",
        force[top], velocity[top]
    ));
    reported(&format!("{:.3} at v = 0.01", force[0]));
}

/// Dieterich (1979): static friction grows as the logarithm of the time of a hold.
#[test]
fn static_friction_heals() {
    let summary = serde_json::to_value(&run("healing", &[]).summary).unwrap();
    let number = |name: &str| 100.0 * summary["hold_curve"][name].as_f64().unwrap();
    reported(&format!("by {:.1} % of kinetic friction per factor of ten", number("healing_relative")));
    reported(&format!("to {:.1} % of its range", number("residual_relative")));
}

/// Dieterich (1979), Ruina (1983): steps of the velocity.
#[test]
fn velocity_steps_evolve() {
    let summary = serde_json::to_value(&run("velocity-step", &[]).summary).unwrap();
    let number = |step: usize, name: &str| summary["steps"][step]["rate_state"][name].as_f64().unwrap();
    reported(&format!(
        "to {:.1} % and {:.1} % of its range",
        100.0 * number(1, "residual_relative"),
        100.0 * number(2, "residual_relative")
    ));
    assert!((1..=2).all(|step| number(step, "b") > number(step, "a")));
    let [a, b] = ["a", "b"].map(|name| [1, 2].map(|step| number(step, name)));
    reported(&format!("{:.3} and {:.4} beside b = {:.3} and {:.3}", a[0], a[1], b[0], b[1]));
    // Without a direct effect friction falls from the step up on.
    let maximum = |step: usize| summary["steps"][step]["peak"]["force"].as_f64().unwrap();
    let end = summary["steps"][0]["force"].as_f64().unwrap();
    assert!((maximum(1) - end).abs() < 1e-4, "{} {end}", maximum(1));
}

/// Braun, Barel and Urbakh (2009): slips end inside the chain, ever farther from the pulled end.
#[test]
fn precursors_of_a_chain_pulled_at_its_edge() {
    let record = run("precursors-edge", &[]).record;
    let (events, cells) = (column(&record, "slipped_event"), column(&record, "slipped_cell"));
    let drives = column(&record, "event_drive");
    let reach = |event: usize| {
        let slipped = events.iter().zip(cells).filter(|(e, _)| **e == event as f64);
        slipped.map(|(_, cell)| cell + 1.0).fold(0.0, f64::max)
    };
    let reaches: Vec<f64> = (0..drives.len()).map(reach).collect();
    let whole = reaches.iter().position(|reach| *reach >= 30.0).unwrap_or(reaches.len());
    let records = reaches[..whole].iter().scan(0.0, |most: &mut f64, &reach| {
        let more = reach > *most;
        *most = most.max(reach);
        Some(more)
    });
    let records = records.filter(|more| *more).count();
    assert_eq!(column(&record, "event_epicentre")[0], 0.0);
    let last = reaches[..whole].iter().copied().fold(0.0, f64::max);
    reported(&format!(
        "{whole} slips end inside it, {records} of them farther than all before, the last at cell {last} of 30"
    ));
}

/// Amundsen et al. (2015): fronts in a chain of blocks, faster where the force before the slip is higher.
#[test]
fn fronts_in_a_chain_with_inertia() {
    let front = |overrides: &[&str]| {
        let outcome = run("front-waves", overrides);
        let catalogue = serde_json::to_value(&outcome.summary.numbers).unwrap()["catalogue"].clone();
        let number = |name: &str| catalogue[name].as_f64().unwrap();
        let drive = catalogue["largest"]["drive"].as_f64().unwrap();
        (drive, number("front_speed"), number("wave_speed"))
    };
    let (drive, speed, waves) = front(&[]);
    let ratio = speed / waves;
    reported(&format!("runs at {speed:.1} cells per time, {ratio:.2} of the speed of waves"));
    let scale: Vec<_> = (0..100).map(|cell| if cell < 9 { "0.7" } else { "1.0" }).collect();
    let shorter = format!("interface.disorder={{scale=[{}]}}", scale.join(","));
    let (later, faster, _) = front(&[&shorter]);
    assert!(later > drive && faster > speed, "{drive} {speed}, {later} {faster}");
    reported(&format!("it begins at the drive {later:.2} instead of {drive:.2} and runs at {faster:.1}."));
}

/// Thøgersen et al. (2014): slow slip after fast slip.
#[test]
fn slow_slip_after_fast_slip() {
    let record = run("slow-slip", &[]).record;
    let (time, velocity) = (column(&record, "time"), column(&record, "velocity"));
    let peak = (0..time.len()).max_by(|&a, &b| velocity[a].total_cmp(&velocity[b])).unwrap();
    // The time at which V/v has fallen to a ratio, its logarithm linear between two steps.
    let falls_to = |ratio: f64| {
        let after = (peak..time.len()).find(|&k| velocity[k] < 1e-3 * ratio).unwrap();
        let [before, now] = [velocity[after - 1], velocity[after]].map(f64::ln);
        let part = (before - (1e-3 * ratio).ln()) / (before - now);
        time[after - 1] + part * (time[after] - time[after - 1]) - time[peak]
    };
    let (fast, slow) = (falls_to(100.0), falls_to(10.0));
    reported(&format!(
        "rises to {:.1} thousand and falls below 100 within {fast:.1} units of time",
        velocity[peak]
    ));
    reported(&format!("The next factor of ten takes {:.1}.", slow - fast));
}

/// Hergarten and Neugebauer (2002): foreshocks and aftershocks in the automaton of Olami, Feder and Christensen.
#[test]
fn earthquakes_cluster() {
    let record = run("ofc", &[]).record;
    let [drive, size, epicentre] =
        ["event_drive", "event_size", "event_epicentre"].map(|name| column(&record, name));
    // The catalogue is from 300 to 320; windows before and after a main shock lie in it.
    let mains: Vec<usize> =
        (0..drive.len()).filter(|&k| size[k] >= 30.0 && (301.0..319.0).contains(&drive[k])).collect();
    let (row, column) = (|at: f64| (at / 64.0).floor(), |at: f64| at % 64.0);
    let near = |k: usize, main: usize| {
        let [a, b] = [epicentre[k], epicentre[main]];
        (row(a) - row(b)).abs() <= 8.0 && (column(a) - column(b)).abs() <= 8.0
    };
    let count = |low: f64, high: f64| {
        let of = |&main: &usize| {
            // Events are in the order of the drive.
            let [from, to] = [low, high].map(|by| drive.partition_point(|&at| at < drive[main] + by));
            (from..to).filter(|&k| k != main && near(k, main)).count()
        };
        mains.iter().map(of).sum::<usize>() as f64
    };
    let mean = count(-1.0, 1.0) / 2.0;
    let rates = |window: f64| [count(-window, 0.0), count(0.0, window)].map(|count| count / (window * mean));
    let ([before, after], far) = (rates(1e-3), rates(0.1));
    reported(&format!("{before:.1} times as often just before and {after:.1} times just after"));
    reported(&format!("{:.2} and {:.2} times", far[0], far[1]));
}
