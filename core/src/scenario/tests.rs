use super::*;
use crate::contacts::Stiffness;

fn scenario(thresholds: Law) -> Scenario {
    let contacts = Contacts { thresholds: Some(thresholds), ..Contacts::default() };
    Scenario { pull: Some(Pull::default()), ..Scenario::new(contacts) }
}

/// The key and what was found there.
fn refused(scenario: &Scenario) -> (String, String) {
    match scenario.build() {
        Err(Error::Invalid { key, found, .. }) => (key, found),
        other => panic!("{other:?}"),
    }
}

#[test]
fn areas_give_thresholds_and_stiffnesses() {
    let mut scenario = scenario(Law::zero());
    scenario.contacts.thresholds = None;
    scenario.contacts.areas = Some(Areas { law: Law::Point { at: 4.0 }, modulus: 2.0, strength: 3.0 });
    let contacts = scenario.build().unwrap().contacts;
    // A contact of area 4: k = 2√4 = 4 breaks at the force 3·4 = 12, so at the stretch 3 = k/κ.
    assert_eq!(contacts.thresholds.atoms()[0].position, 3.0);
    assert_eq!(contacts.stiffness, Stiffness::PerThreshold(4.0 / 3.0));
}

#[test]
fn errors_carry_the_whole_path_of_the_key() {
    let inner = Law::Mixture(vec![Component { weight: 1.0, law: Law::Gaussian { mean: 1.0, std: -0.1 } }]);
    let outer = Law::Mixture(vec![Component { weight: 1.0, law: inner }]);
    let key = "contacts.thresholds.mixture.0.law.mixture.0.law.gaussian.std";
    assert_eq!(refused(&scenario(outer)), (key.into(), "-0.1".into()));
}

#[test]
fn stretches_where_no_contact_survives_are_refused_unless_they_may_break_at_once() {
    let mut scenario = scenario(Law::Rectangular { min: 0.5, max: 1.0 });
    scenario.initial = Law::Point { at: 1.0 };
    assert_eq!(refused(&scenario).0, "initial");
    scenario.pull = Some(Pull { start: TaskStart::Relaxed, ..Pull::default() });
    scenario.build().unwrap();
    scenario.contacts.reforming = Law::Rectangular { min: 0.0, max: 2.0 };
    let (key, found) = refused(&scenario);
    assert_eq!(key, "contacts.reforming");
    assert!(
        found.starts_with("a fraction 0.5") && found.ends_with("of the contacts at or above it"),
        "{found}"
    );
    scenario.contacts.reforming = Law::Rectangular { min: 0.0, max: 0.9 };
    scenario.build().unwrap();
}

#[test]
fn a_task_that_would_not_fit_says_what_it_needs() {
    let mut scenario = scenario(Law::Point { at: 1.0 });
    scenario.pull = Some(Pull { points: 1 << 40, ..Pull::default() });
    assert_eq!(
        refused(&scenario),
        ("pull.points".into(), "1099511627776, which would need 360.0 TiB".into())
    );
}

#[test]
fn positions_reach_both_ends_exactly() {
    for (distance, points) in [(20.0, 2001), (0.3, 4), (1e-3, 2)] {
        let positions = Pull { distance, points, ..Pull::default() }.positions();
        assert_eq!((positions.len(), positions[0], positions[points - 1]), (points, 0.0, distance));
    }
}

#[test]
fn every_table_is_found_with_its_key() {
    let table = || Law::Tabulated(Tabulated { file: Some("measured.csv".into()), ..Tabulated::default() });
    let mut scenario = scenario(Law::Mixture(vec![Component { weight: 1.0, law: table() }]));
    scenario.initial = table();
    let keys: Vec<_> = scenario.tables().into_iter().map(|(key, _)| key).collect();
    assert_eq!(keys, ["contacts.thresholds.mixture.0.law.tabulated", "initial.tabulated"]);
    assert_eq!(refused(&scenario).1, "an unread file");
}

#[test]
fn labels_keep_compound_units_together() {
    let units = Units { length: "m/s".into(), force: "N".into(), time: String::new() };
    assert_eq!(units.label(crate::record::Quantity::Stiffness), "N/(m/s)");
    assert_eq!(units.label(crate::record::Quantity::Energy), "N·m/s");
    assert_eq!(units.label(crate::record::Quantity::Time), "1");
    assert_eq!(units.label(crate::record::Quantity::Area), "(m/s)²");
    let units = Units { length: "µm".into(), ..Units::default() };
    assert_eq!(units.label(crate::record::Quantity::Volume), "µm³");
    for quantity in crate::record::Quantity::ALL {
        assert_eq!(Units::default().label(quantity), "1");
    }
}

#[test]
fn there_is_one_task() {
    let mut scenario = scenario(Law::Point { at: 1.0 });
    scenario.drive = Some(Drive::default());
    assert_eq!(refused(&scenario), ("drive".into(), "drive beside pull".into()));
    scenario.pull = None;
    scenario.build().unwrap();
    scenario.drive = None;
    assert_eq!(refused(&scenario), ("pull".into(), "none".into()));
}

#[test]
fn a_drive_turns_at_every_turning_point() {
    let mut scenario = scenario(Law::Point { at: 1.0 });
    scenario.pull = None;
    let mut drive = |turning_points: &[f64]| {
        scenario.drive = Some(Drive { turning_points: Some(turning_points.to_vec()), ..Drive::default() });
        scenario.clone()
    };
    drive(&[3.0, -1.0, 3.0]).build().unwrap();
    drive(&[-1.0]).build().unwrap();
    for (turns, key) in [
        (&[3.0, 4.0][..], "drive.turning_points.1"),
        (&[0.0], "drive.turning_points.0"),
        (&[1.0, 0.5, 0.25], "drive.turning_points.2"),
        (&[1.0, f64::NAN], "drive.turning_points.1"),
        (&[], "drive.turning_points"),
    ] {
        assert_eq!(refused(&drive(turns)).0, key, "{turns:?}");
    }
}

#[test]
fn a_block_needs_a_drive_that_moves_it() {
    let mut scenario = scenario(Law::Point { at: 1.0 });
    scenario.block = Some(Block { stiffness: 1.0, slip: Slip::Reset, slip_fraction: 0.05 });
    assert_eq!(refused(&scenario).0, "block");
    scenario.pull = None;
    scenario.drive = Some(Drive { force_to: Some(1.0), ..Drive::default() });
    assert_eq!(refused(&scenario).0, "block");
    scenario.drive = Some(Drive::default());
    scenario.build().unwrap();
    let mut block = |block: Block| {
        scenario.block = Some(block);
        refused(&scenario).0
    };
    let block_of = |stiffness, slip, slip_fraction| Block { stiffness, slip, slip_fraction };
    assert_eq!(block(block_of(0.0, Slip::Reset, 0.05)), "block.stiffness");
    assert_eq!(block(block_of(1.0, Slip::Reset, 0.0)), "block.slip_fraction");
    let inertial = |mass, damping| block_of(1.0, Slip::Inertial { mass, damping }, 0.05);
    assert_eq!(block(inertial(0.0, 0.0)), "block.slip.inertial.mass");
    assert_eq!(block(inertial(1.0, -1.0)), "block.slip.inertial.damping");
}

#[test]
fn contacts_that_know_time_need_a_velocity() {
    let mut scenario = scenario(Law::Gaussian { mean: 1.0, std: 0.1 });
    scenario.contacts.delay = Some(Delay::Time(0.1));
    assert_eq!(refused(&scenario), ("pull.velocity".into(), "none".into()));
    scenario.pull = Some(Pull { velocity: Some(1.0), ..Pull::default() });
    scenario.build().unwrap();
    scenario.contacts.delay = Some(Delay::Time(0.0));
    scenario.pull = Some(Pull::default());
    scenario.build().unwrap();
}

#[test]
fn a_ramp_is_where_it_should_be_at_the_end_of_each_piece() {
    let ramp = Step { velocity_to: Some(3.0), pieces: Some(4), ..Step::moving(1.0, 2.0) };
    let protocol =
        Protocol(vec![Step { distance: Some(5.0), duration: None, ..Step::moving(2.0, 0.0) }, ramp]);
    protocol.check().unwrap();
    let history = protocol.build().unwrap();
    assert_eq!((history.duration(), history.pieces().len()), (4.5, 5));
    for quarter in 1..=4 {
        let time = 0.5 * f64::from(quarter);
        // X = v t + ½ (v₁ − v) t²/duration, rounded
        let expected = 5.0 + time + 0.5 * time * time;
        assert!((history.position(2.5 + time) - expected).abs() < 1e-14);
    }
    let times = protocol.times();
    assert_eq!((times.len(), times[200], times[400]), (401, 2.5, 4.5));
    assert!(times.is_sorted_by(|a, b| a < b));
    // Points are on the ramp at evenly spaced times, also inside of pieces.
    for (i, &time) in times[200..].iter().enumerate() {
        let since = 0.01 * i as f64;
        assert!((history.position(time) - 5.0 - since - 0.5 * since * since).abs() < 1e-13, "{time}");
    }
}

fn warnings(scenario: &Scenario) -> Vec<String> {
    scenario.build().unwrap_or_else(|error| panic!("{error}")).warnings
}

#[test]
fn warnings_say_what_will_surprise() {
    let mut scenario = scenario(Law::Gaussian { mean: 1.0, std: 0.1 });
    assert_eq!(warnings(&scenario), [""; 0]);
    let pull = scenario.pull.take().unwrap();
    scenario.pull = Some(Pull { velocity: Some(2.0), ..pull });
    assert!(warnings(&scenario)[0].starts_with("pull.velocity: nothing in [contacts] depends on time"));
    scenario.pull = None;
    scenario.hold_curve = Some(HoldCurve { from: 1.0, to: 10.0, points: 3, velocity: 1.0 });
    assert!(warnings(&scenario)[0].starts_with("hold_curve: nothing in [contacts] depends on time"));
    let mature = Law::Gaussian { mean: 0.5, std: 0.1 };
    scenario.contacts.ageing = Some(Ageing::FrozenRank { mature, time: 1.0 });
    assert!(warnings(&scenario)[0].starts_with("contacts.ageing: the mature thresholds are weaker"));
}

#[test]
fn keys_without_effect_are_named() {
    let pulled = scenario(Law::Gaussian { mean: 1.0, std: 0.1 });
    let pull = Pull { velocity: Some(2.0), ..pulled.pull.clone().unwrap() };
    let block = Block { stiffness: 1.0, slip: Slip::Overdamped, slip_fraction: 0.2 };
    let curve = VelocityCurve::between(1.0, 10.0);
    let png = Figure { dpi: 600.0, formats: vec![FigureFormat::Pdf], ..Figure::default() };
    let mut one_by_one = Interface { disorder: None, contacts: PerCell::One, ..cells() };
    one_by_one.slip = None;
    let lattice =
        Scenario { pull: None, drive: Some(Drive::default()), interface: Some(one_by_one), ..pulled.clone() };
    let alike = Interface {
        disorder: Some(Scales { std: Some(0.0), seed: Some(3), ..Scales::default() }),
        ..cells()
    };
    for (key, scenario) in [
        ("pull.velocity", Scenario { pull: Some(pull), ..pulled.clone() }),
        ("contacts.delay.time", {
            let contacts = Contacts { delay: Some(Delay::Time(0.0)), ..pulled.contacts.clone() };
            Scenario { contacts, ..pulled.clone() }
        }),
        ("initial", {
            let initial = Law::Point { at: 0.1 };
            Scenario { pull: None, velocity_curve: Some(curve), initial, ..pulled.clone() }
        }),
        ("block.slip_fraction", {
            Scenario { pull: None, drive: Some(Drive::default()), block: Some(block), ..pulled.clone() }
        }),
        ("interface.disorder.seed", Scenario { interface: Some(alike), ..lattice.clone() }),
        ("master_equation.tolerance", {
            Scenario { master_equation: MasterEquation { tolerance: Some(1e-8) }, ..lattice.clone() }
        }),
        ("figure.dpi", Scenario { figure: png.clone(), ..pulled.clone() }),
        ("figure", Scenario { figure: Figure { formats: Vec::new(), ..png }, ..pulled.clone() }),
    ] {
        let warnings = warnings(&scenario);
        assert!(
            warnings.iter().any(|warning| warning.starts_with(&format!("{key}: "))),
            "{key}: {warnings:?}"
        );
    }
    for quiet in [pulled, lattice] {
        assert_eq!(warnings(&quiet), [""; 0]);
    }
}

/// A drive of contacts that are coupled one by one.
fn one_by_one(contacts: Contacts) -> Scenario {
    let interface = Interface { disorder: None, contacts: PerCell::One, ..cells() };
    let drive = Drive { velocity: Some(1.0), ..Drive::default() };
    Scenario { pull: None, drive: Some(drive), interface: Some(interface), ..Scenario::new(contacts) }
}

#[test]
fn contacts_coupled_one_by_one_name_the_reason_for_which_they_are_refused() {
    let mature = Law::Gaussian { mean: 1.5, std: 0.2 };
    let ageing = Ageing::MeanField { mature, diffusion: 0.01 };
    // The closure is refused, and not what it would need elsewhere.
    for thresholds in [Law::Point { at: 1.0 }, Law::Gaussian { mean: 1.0, std: 0.1 }] {
        let contacts =
            Contacts { thresholds: Some(thresholds), ageing: Some(ageing.clone()), ..Contacts::default() };
        let mut described = one_by_one(contacts);
        for ensemble in [None, Some(Ensemble::default())] {
            described.ensemble = ensemble;
            assert_eq!(refused(&described), ("contacts.ageing.mean_field".into(), "a closure".into()));
        }
    }
    let law = Law::Gaussian { mean: 1.0, std: 0.1 };
    let growing =
        Contacts { thresholds: Some(law.clone()), stiffness_per_threshold: Some(1.0), ..Contacts::default() };
    let (key, found) = refused(&one_by_one(growing));
    assert_eq!((key.as_str(), found.as_str()), ("contacts.stiffness_per_threshold", "k = κ x_s"));
    let areas = Contacts { areas: Some(Areas { law, modulus: 1.0, strength: 1.0 }), ..Contacts::default() };
    let (key, found) = refused(&one_by_one(areas));
    assert_eq!((key.as_str(), found.as_str()), ("contacts.areas", "areas, from which follows k = κ x_s"));
}

/// Cells of many contacts that differ by chance.
fn cells() -> Interface {
    Interface {
        cells: vec![4, 4],
        contacts: PerCell::Many,
        connection: 4.0,
        coupling: Elasticity::Neighbours { stiffness: 1.0 },
        edges: Edges::Periodic,
        loading: CellLoading::Uniform,
        slip: None,
        viscosity: None,
        disorder: Some(Scales { std: Some(0.1), ..Scales::default() }),
        areas: None,
        drive_tolerance: Interface::DRIVE_TOLERANCE,
        catalogue_from: 0.0,
        mass: None,
        slip_rates: None,
        main_shocks: None,
    }
}

fn renormalised(interface: Interface) -> Scenario {
    let thresholds = Law::Gaussian { mean: 1.0, std: 0.1 };
    let task = Renormalisation { runs: 3, ..Renormalisation::default() };
    Scenario { pull: None, renormalisation: Some(task), interface: Some(interface), ..scenario(thresholds) }
}

#[test]
fn first_breaks_of_cells_are_those_of_many_alike_contacts_under_one_drive() {
    assert!(renormalised(cells()).build().is_ok());
    let given = Scales { scale: Some(vec![1.0; 16]), ..Scales::default() };
    for (interface, key) in [
        (Interface { loading: CellLoading::Edge, ..cells() }, "interface.loading"),
        (Interface { viscosity: Some(1.0), ..cells() }, "interface.viscosity"),
        (Interface { disorder: None, ..cells() }, "interface.disorder"),
        (Interface { disorder: Some(given), ..cells() }, "interface.disorder"),
    ] {
        assert_eq!(refused(&renormalised(interface)).0, key);
    }
    let few = Scenario {
        ensemble: Some(Ensemble { size: Some(10), ..Ensemble::default() }),
        ..renormalised(cells())
    };
    assert_eq!(refused(&few).0, "ensemble");
    let with = |change: fn(&mut Contacts)| {
        let mut scenario = renormalised(cells());
        change(&mut scenario.contacts);
        refused(&scenario).0
    };
    assert_eq!(with(|contacts| contacts.delay = Some(Delay::Time(1.0))), "contacts.delay");
    let correlated = |contacts: &mut Contacts| contacts.stiffness_per_threshold = Some(1.0);
    assert_eq!(with(correlated), "contacts.stiffness_per_threshold");
    // The scales of the third run have the last seed that there is not.
    let last = Scales { std: Some(0.1), seed: Some(i64::MAX as u64 - 1), ..Scales::default() };
    let (key, found) = refused(&renormalised(Interface { disorder: Some(last), ..cells() }));
    assert_eq!((key.as_str(), found.as_str()), ("interface.disorder.seed", "9223372036854775808"));
}

#[test]
fn the_share_of_cells_is_that_of_their_stiffnesses() {
    let mut described = renormalised(cells());
    described.contacts.count = 3.0;
    described.contacts.stiffness = Some(0.5);
    let contacts = described.build().unwrap().contacts;
    let share = cells().mean_field_coupling(&contacts).unwrap();
    assert!((share - 1.5 / 5.5).abs() < 1e-15);
    // Variances of a product: σ² + s²(1 + σ²), but for the 1e-23 of thresholds below 0.
    let law = cells().thresholds(&contacts).unwrap();
    assert!((law.std() - (0.01_f64 + 0.01 * 1.01).sqrt()).abs() < 1e-11);
}
