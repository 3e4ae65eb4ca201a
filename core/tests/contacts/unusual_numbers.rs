//! Numbers that are no input of a scenario, handed to the crate itself: an error or a NaN, and no panic, loop or wrong number.

use std::sync::Arc;

use crate::common::sliders::chain;
use crate::common::{contacts, gaussian, initial, master, point, rectangular};
use asperity::block::{Block, Drive, Loading, PersistenceLimit, Regime, Slip};
use asperity::contacts::{Contacts, Stiffness, StiffnessTable};
use asperity::elastic::CellSlip;
use asperity::ensemble::{Disorder, Ensemble, Snapshots};
use asperity::exact::{self, ClosedForm};
use asperity::fit::{Measurement, SteadyRecord};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Law, Root, Tabulated, Truncated, expectation, maximum_likelihood};
use asperity::master::MasterEquation;
use asperity::numerics::powerlaw::fit_counts;
use asperity::random::{Purpose, Stream};
use asperity::record::{Column, Quantity, Record};
use asperity::{Error, Float};

#[test]
fn samples_whose_parameters_are_no_numbers_are_refused() {
    for (family, samples) in [
        ("gaussian", [1.0, 1.0 + 2.3e-16]),
        ("gaussian", [1e-200, 2e-200]),
        ("gaussian", [1e200, 2e200]),
        ("lognormal", [1e-300, 1e300]),
        ("lognormal", [1e-149, 1e149]),
    ] {
        let error = maximum_likelihood(family, &samples).unwrap_err().to_string();
        assert!(error.starts_with("samples: expected"), "{family} {samples:?}: {error}");
    }
    assert!(Tabulated::from_samples(&[1e200, 2e200]).is_err());
    assert!(Tabulated::from_density(&[(1.0, 1.0), (1e160, 1.0)]).is_err());
    assert!(Root::new(1e200, Arc::new(Gaussian::new(1.0, 0.1).unwrap())).is_err());
}

#[test]
fn contacts_are_counted_and_have_a_stiffness() {
    let good = contacts(&gaussian(1.0, 0.1), &point(0.0));
    for count in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let contacts = Contacts { count, ..good.clone() };
        assert!(MasterEquation::new(contacts, &initial(&point(0.0))).is_err(), "{count}");
    }
    for stiffness in [f64::NAN, -1.0, 0.0] {
        for stiffness in [Stiffness::Equal(stiffness), Stiffness::PerThreshold(stiffness)] {
            let contacts = Contacts { stiffness, ..good.clone() };
            assert!(MasterEquation::new(contacts, &initial(&point(0.0))).is_err());
        }
    }
    let table = |text: &str| serde_json::from_str::<StiffnessTable>(text);
    assert!(table(r#"{"rows":[]}"#).is_err() && table(r#"{"rows":[[2,1],[1,5]]}"#).is_err());
    let rows = table(r#"{"rows":[[1,1],[2,5]]}"#).unwrap();
    assert_eq!(rows, StiffnessTable::new(vec![(1.0, 1.0), (2.0, 5.0)]).unwrap());
}

#[test]
fn drives_are_finite() {
    let mut interface = chain(&exact_population(), 3, 1.0, 0.2, CellSlip::Overdamped, 1e-6);
    for drive in [f64::NAN, f64::INFINITY] {
        assert!(interface.run(drive, &mut |_, _| ()).is_err());
        assert!(interface.put(drive, &[0.0; 3]).is_err());
    }
    assert_eq!(interface.drive(), 0.0);
    let block = Block::new(Loading::Spring(0.1), Slip::Overdamped, None).unwrap();
    let drive = Drive { turning_points: vec![3.0], points: usize::MAX };
    let mut population = exact_population();
    let error = block.pull(&mut population, &drive).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
}

fn exact_population() -> impl asperity::population::Population + Clone {
    crate::common::curve::gaussian(0.1)
}

#[test]
fn positions_beyond_all_counting_are_refused() {
    let narrow = contacts(&gaussian(0.1, 0.01), &point(0.0));
    let ensemble = Ensemble::new(narrow, initial(&point(0.0)), 10, 1, Disorder::Annealed).unwrap();
    assert!(ensemble.pull(&[1e308]).unwrap_err().to_string().contains("breaks of a contact"));
    let snapshots = Snapshots { positions: vec![0.5], edges: vec![0.0, 0.5, 0.5, 1.0] };
    let error = ensemble.pull_with(&[1.0], &snapshots, &mut ()).unwrap_err().to_string();
    assert!(error.contains("0.5 twice"), "{error}");
    let pull = master(&gaussian(1.0, 0.1), &point(0.0), &point(0.0)).pull(2.0).unwrap();
    for position in [-3.0, 1e3, f64::NAN] {
        let values = [pull.force(position), pull.slope(position), pull.breaking_rate(position)];
        assert!(values.iter().all(|value| value.is_nan()), "{position}: {values:?}");
    }
    assert!(pull.force(2.0).is_finite());
    let forms: [Box<dyn ClosedForm>; 2] = [
        Box::new(exact::Rectangular { min: 0.5, max: 1.0 }),
        Box::new(exact::Gaussian { mean: 1.0, std: 0.1, initial_mean: 0.0, initial_std: 0.0 }),
    ];
    assert!(forms.iter().all(|form| form.force(1e12).is_nan() && form.slope(1e12).is_nan()));
}

#[test]
fn distributions_outside_of_their_range() {
    // Nearly all of the whole distribution is left out: what is drawn is in the rest.
    let law = Truncated::new(Arc::new(Gaussian::new(1.0, 0.01).unwrap()), 0.8).unwrap();
    let mut drawn = [0.0; 1000];
    law.fill(&mut Stream::new(1, Purpose::Sample, 0), &mut drawn);
    assert!(drawn.iter().all(|x| (0.7..0.8).contains(x)), "{drawn:?}");
    let law = rectangular(0.0, 1.0);
    for ends in [[2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::NAN]] {
        assert_eq!(expectation(law.as_ref(), ends, Ok::<_, Error>).unwrap(), 0.0);
    }
    let table = Tabulated::from_samples(&[0.5, 1.0, 2.0]).unwrap();
    assert_eq!([table.quantile(2.0), table.quantile(-1.0), table.upper_quantile(7.0)], [2.0, 0.5, 0.5]);
    assert_eq!(fit_counts(&[(1, u64::MAX), (2, 3), (3, 1)], 1, 10), None);
}

#[test]
fn searches_end() {
    // Persistent below a stiffness of 1, which no number of a resolution of 1e-17 encloses.
    let persistent = Regime::Persistent { slips: 9, period: 1.0, drop: 1.0, slip: 1.0, scatter: 0.0 };
    let regime = |stiffness: f64| Ok(if stiffness < 1.0 { persistent } else { Regime::Smooth { slid: 1.0 } });
    let found = PersistenceLimit::find([0.1, 10.0], 1e-17, regime).unwrap();
    assert!((found.persists, found.ended) == (1.0_f64.next_down(), 1.0), "{found:?}");
}

#[test]
fn records_of_nothing() {
    let column = Column::new("force", "friction force", Quantity::Force, &["point"]);
    assert_eq!(Record::declared(&[&[column]]).row("force", 0), None);
    let measured = Measurement::new(vec![], vec![1.0, 2.0, 3.0]);
    assert_eq!(measured.first_compliance(1.0), 0.01);
    assert_eq!(SteadyRecord { spacing: 0.1, forces: Vec::new() }.distance(), 0.0);
}

#[test]
fn times_rise_and_stay_finite() {
    let piece = |velocity: f64, duration: f64| Piece { velocity, duration };
    for pieces in [vec![piece(1e300, 1e300)], vec![piece(1.0, 1e300), piece(1.0, 1.0)]] {
        let error = History::new(pieces).unwrap_err().to_string();
        assert!(error.contains("a duration that numbers resolve"), "{error}");
    }
}

#[test]
fn errors_are_equal_to_themselves() {
    assert_eq!(Float(f64::NAN), Float(f64::NAN));
    assert_ne!(Float(0.0), Float(1.0));
}
