//! The master equation against the reference values of the theory: truncated laws, to the digits given.

use crate::common::{contacts, gamma, gaussian, initial, lognormal, master, point, rectangular, weibull};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Pull};

/// Half a unit of the twelfth decimal, and what a pull at tolerance 1e-12 leaves out.
const DIGITS_12: f64 = 2e-12;

fn pull(thresholds: &SharedLaw, start: &SharedLaw, distance: f64) -> (MasterEquation, Pull) {
    let master = master(thresholds, &point(0.0), start);
    let pull = master.pull_with(distance, 1e-12, &mut ()).unwrap();
    (master, pull)
}

fn close(got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "got {got:.15}, expected {expected:.15}");
}

#[test]
fn figure_2_of_the_paper() {
    let (master, pull) = pull(&gaussian(1.0, 0.05), &gaussian(0.1, 0.025), 20.0);
    let peak = pull.static_friction().unwrap();
    // The place of a maximum is known to √ of the accuracy of F' over F'' only through the root of F'.
    close(peak.position, 0.791_756_131_650, DIGITS_12);
    close(peak.value, 0.868_081_709_809, DIGITS_12);
    close(pull.critical_stiffness(), 6.143_821_037, 1e-9);
    close(master.steady_state().kinetic_friction(), 0.50125, 1e-14);
    let series = [
        0.100_003_345_862,
        0.190_395_432_031,
        0.280_110_096_859,
        0.370_025_968_369,
        0.460_006_757_758,
        0.549_857_345_825,
        0.636_463_437_465,
        0.701_137_321_308,
        0.704_984_384_674,
        0.628_336_170_384,
        0.505_942_921_504,
    ];
    for (k, expected) in series.into_iter().enumerate() {
        close(pull.force(1.09 * k as f64), expected, DIGITS_12);
    }
    close(pull.force(5.0), 0.297_307_166, 1e-9);
    close(pull.force(20.0), 0.432_329_275, 1e-9);
}

#[test]
fn gaussian_thresholds_from_rest() {
    let cases = [
        (0.05, 0.900_697_239_825_0, 0.879_959_269_992_9, 6.988_800_539_548),
        (0.1, 0.844_164_290_757_6, 0.796_436_015_077_0, 3.009_222_675_584),
        (0.2, 0.805_269_941_673_8, 0.689_819_391_690_6, 1.035_755_493_940),
    ];
    for (std, position, force, stiffness) in cases {
        let (_, pull) = pull(&gaussian(1.0, std), &point(0.0), 20.0);
        let peak = pull.static_friction().unwrap();
        close(peak.position, position, DIGITS_12);
        close(peak.value, force, DIGITS_12);
        // F' loses two digits to the differentiation of a polynomial of degree 15.
        close(pull.critical_stiffness(), stiffness, 2e-10);
    }
    let (_, pull) = pull(&gaussian(1.0, 0.1), &point(0.0), 25.0);
    let curve = [
        (0.9, 0.765_541_818_520_46),
        (1.0, 0.539_894_228_039_77),
        (2.18, 0.294_094_321_796_25),
        (5.45, 0.463_377_602_580_74),
        (21.8, 0.509_403_089_703_44),
    ];
    for (position, force) in curve {
        // The values are of the law that is not truncated: 1e-23 apart.
        close(pull.force(position), force, DIGITS_12);
    }
}

#[test]
fn steady_states() {
    let kinetic = |thresholds: &SharedLaw, reforming: &SharedLaw| {
        master(thresholds, reforming, &point(0.0)).steady_state().kinetic_friction()
    };
    let rest = point(0.0);
    close(kinetic(&gaussian(1.0, 0.2), &rest), 0.519_999_994_053_1, 1e-13);
    close(kinetic(&rectangular(0.8, 1.2), &rectangular(0.0, 0.2)), 5.0 / 9.0, 1e-14);
    close(kinetic(&rectangular(0.4, 1.6), &rectangular(0.0, 0.6)), 0.717_312_661_498_708, 1e-13);
    close(kinetic(&point(1.0), &rest), 0.5, 1e-15);
    for law in [gamma(1.0, 0.3), weibull(2.0, 1.0), weibull(0.7, 1.0), lognormal(1.0, 1.0)] {
        // ⟨x²⟩/(2⟨x⟩): moments in closed form, against integrals over the life.
        let expected = law.upper_moment(2, -1.0) / (2.0 * law.mean());
        close(kinetic(&law, &rest), expected, 2e-12 * expected);
    }
}

#[test]
fn stiffness_that_grows_with_the_threshold() {
    let per_threshold = |thresholds: &SharedLaw| {
        let mut contacts = contacts(thresholds, &point(0.0));
        contacts.stiffness = asperity::contacts::Stiffness::PerThreshold(1.0 / thresholds.mean());
        MasterEquation::new(contacts, &initial(&point(0.0))).unwrap()
    };
    for law in [gaussian(1.0, 0.2), gamma(1.0, 0.4), rectangular(0.5, 1.5)] {
        // ⟨x³⟩/(2⟨x⟩) with κ⟨x⟩ = 1.
        let expected = law.upper_moment(3, -1.0) / (2.0 * law.mean() * law.mean());
        close(per_threshold(&law).steady_state().kinetic_friction(), expected, 1e-12);
    }
    let master = per_threshold(&gaussian(1.0, 0.2));
    let pull = master.pull_with(5.0, 1e-12, &mut ()).unwrap();
    close(pull.static_friction().unwrap().value, 0.735, 5e-4);
    // Before anything breaks every contact pulls with its own k, of mean 1.
    close(pull.force(0.1), 0.1, 1e-6);
}

#[test]
fn static_friction_over_kinetic_never_exceeds_two() {
    // Farkas, Dahmen and Wolf (2005), for contacts that start relaxed.
    for (std, ratio) in [(0.001, 1.992_540), (0.05, 1.755_530), (0.1, 1.577_101)] {
        let (master, pull) = pull(&gaussian(1.0, std), &point(0.0), 1.5);
        let got = pull.static_friction().unwrap().value / master.steady_state().kinetic_friction();
        close(got, ratio, 1e-6);
    }
}

#[test]
fn identical_contacts_repeat_for_ever() {
    let (master, pull) = pull(&point(1.0), &point(0.0), 100.0);
    for x in [0.0, 0.25, 0.999, 7.5, 99.9] {
        close(pull.force(x), x % 1.0, 1e-12);
    }
    // At the break itself, the value after it.
    close(pull.force(37.0), 0.0, 1e-12);
    assert_eq!(pull.static_friction().unwrap().position, 1.0);
    assert_eq!(pull.critical_stiffness(), f64::INFINITY);
    assert_eq!(pull.breaking_atoms().len(), 100);
    assert_eq!(master.relaxation().unwrap().length(), f64::INFINITY);
    let state = pull.stretch_density(12.25, &[0.1, 0.5]).unwrap();
    assert_eq!(state.density, [0.0, 0.0]);
    assert_eq!(state.atoms.len(), 1);
    close(state.atoms[0].position, 0.25, 1e-12);
    close(state.atoms[0].weight, 1.0, 1e-14);
}

#[test]
fn a_rising_force_has_no_static_friction() {
    let (_, pull) = pull(&crate::common::exponential(1.0), &point(0.0), 40.0);
    assert_eq!(pull.static_friction(), None);
    let (_, short) = self::pull(&gaussian(1.0, 0.05), &point(0.0), 0.5);
    assert_eq!(short.static_friction(), None);
    // K_c is that of the whole pull, however short the part asked for.
    close(short.critical_stiffness(), 6.988_800_539_548, 2e-10);
}

/// Thresholds broader than exponential ones: the hazard falls, and F' > 0 everywhere. Its rounding is no stiffness.
#[test]
fn a_force_that_never_falls_has_no_critical_stiffness() {
    for (law, tolerance) in [(gamma(1.0, 1.2), 1e-8), (gamma(1.0, 1.0), 1e-10)] {
        let pull = master(&law, &point(0.0), &point(0.0)).pull_with(5.0, tolerance, &mut ()).unwrap();
        assert_eq!(pull.critical_stiffness(), 0.0);
    }
}
