//! Scenarios and tables as text, on cases drawn by proptest: what is written is read as the same. Cases are the same every time;
//! one that failed is kept in `properties.regressions` and tried first.

use std::path::Path;

use asperity_runner::{input, output};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(22),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    }
}

/// A number with all its digits, over ten decades.
fn number() -> impl Strategy<Value = f64> {
    (-5.0..5.0_f64).prop_map(|exponent| 10f64.powf(exponent))
}

/// The text of a distribution.
fn law() -> BoxedStrategy<String> {
    let one = |name: &'static str, keys: [&'static str; 2]| {
        (number(), number())
            .prop_map(move |(a, b)| format!("{{ {name} = {{ {} = {a:?}, {} = {b:e} }} }}", keys[0], keys[1]))
    };
    let rectangular = (number(), number())
        .prop_map(|(a, b)| format!("{{ rectangular = {{ min = {a}, max = {} }} }}", a + b));
    let series = (number(), -0.9..0.9_f64).prop_map(|(a, slope)| {
        format!("{{ series = {{ boundaries = [0, {a}, {}], coefficients = [[1, {slope}], [1]] }} }}", 2.0 * a)
    });
    let samples = prop::collection::vec(number(), 1..6)
        .prop_map(|samples| format!("{{ tabulated.samples = {samples:?} }}"));
    let simple = prop_oneof![
        one("gaussian", ["mean", "std"]),
        one("gamma", ["mean", "std"]),
        (number(), 0.01..3.0_f64).prop_map(|(mean, width)| {
            format!("{{ lognormal = {{ mean = {mean}, std = {} }} }}", width * mean)
        }),
        (0.3..50.0_f64, number())
            .prop_map(|(shape, scale)| format!("{{ weibull = {{ shape = {shape}, scale = {scale} }} }}")),
        number().prop_map(|at| format!("{{ point.at = {at} }}")),
        number().prop_map(|mean| format!("{{ exponential.mean = {mean} }}")),
        rectangular,
        series,
        samples,
    ]
    .boxed();
    let mixed = (simple.clone(), simple.clone(), 1..99_u32).prop_map(|(a, b, percent)| {
        let weight = f64::from(percent) / 100.0;
        format!(
            "{{ mixture = [{{ weight = {weight}, law = {a} }}, {{ weight = {}, law = {b} }}] }}",
            1.0 - weight
        )
    });
    prop_oneof![4 => simple, 1 => mixed].boxed()
}

/// The text of a task.
fn task() -> impl Strategy<Value = String> {
    prop_oneof![
        (number(), 2..5000_usize, prop::collection::vec(0.0..1.0_f64, 0..4)).prop_map(|(distance, points, mut parts)| {
            parts.sort_by(f64::total_cmp);
            parts.dedup();
            let at: Vec<_> = parts.iter().map(|part| part * distance).collect();
            format!("pull = {{ distance = {distance}, points = {points}, snapshots = {at:?} }}")
        }),
        (number(), number()).prop_map(|(a, by)| format!("velocity_curve = {{ from = {a}, to = {}, points = 3 }}", a * (1.0 + by))),
        (number(), number()).prop_map(|(distance, stiffness)| {
            format!("drive = {{ distance = {distance} }}\nblock = {{ stiffness = {stiffness}, slip = 'overdamped' }}")
        }),
        (number(), number()).prop_map(|(velocity, duration)| {
            format!("protocol = [{{ velocity = {velocity}, duration = {duration} }}, {{ hold = {duration} }}]")
        }),
    ]
}

/// Rules of time, a title with letters that TOML escapes, units.
fn rest() -> impl Strategy<Value = String> {
    let title =
        "[ -~äµ\\n\\t\"'\\\\]{0,20}".prop_map(|title| format!("title = {}\n", toml::Value::from(title)));
    let heat = (number(), number()).prop_map(|(energy, rate)| {
        format!("contacts.temperature = {{ energy = {energy}, attempt_rate = {rate} }}\n")
    });
    let ageing = (number(), number()).prop_map(|(growth, time)| {
        format!("contacts.ageing.logarithmic = {{ growth = {growth}, time = {time} }}\n")
    });
    let count = number().prop_map(|count| format!("contacts.count = {count}\n"));
    let maybe = |text: BoxedStrategy<String>| prop::option::of(text).prop_map(Option::unwrap_or_default);
    (title, maybe(heat.boxed()), maybe(ageing.boxed()), maybe(count.boxed()))
        .prop_map(|(title, heat, ageing, count)| title + &heat + &ageing + &count)
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn scenarios_are_read_as_they_are_written(
        rest in rest(), thresholds in law(), reforming in prop::option::of(law()), task in task(),
    ) {
        let reforming = reforming.map(|law| format!("contacts.reforming = {law}\n")).unwrap_or_default();
        let text = format!("{rest}contacts.thresholds = {thresholds}\n{reforming}{task}\n");
        // Some combinations are refused, such as contacts that re-form above their thresholds; those are not the subject.
        let first = input::parse(&text, "drawn", Path::new(""), &[]);
        prop_assume!(first.is_ok());
        let first = first.unwrap();
        let written = input::to_text(&first.scenario);
        let second = input::parse(&written, "written", Path::new(""), &[]);
        let second = second.unwrap_or_else(|error| panic!("{error}\n{text}\n{written}"));
        prop_assert_eq!(&second.scenario, &first.scenario, "{}", text);
        prop_assert_eq!(input::to_text(&second.scenario), written);
    }

    #[test]
    fn numbers_are_read_as_they_are_written(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        let back: f64 = output::shortest(value).parse().unwrap();
        prop_assert!(back.to_bits() == bits || value.is_nan() && back.is_nan(), "{}", output::shortest(value));
    }
}

proptest! {
    // Files are written.
    #![proptest_config(config(50))]

    #[test]
    fn tables_are_read_as_they_are_written(
        steps in prop::collection::vec(number(), 2..30), forces in prop::collection::vec(-1e3..1e3_f64, 30),
    ) {
        let rises = |at: &mut f64, by: &f64| { *at += by; Some(*at) };
        let positions: Vec<f64> = steps.iter().scan(0.0, rises).collect();
        let forces = &forces[..positions.len()];
        let row = |(x, f): (&f64, &f64)| format!("{},{}\n", output::shortest(*x), output::shortest(*f));
        let table: String = positions.iter().zip(forces).map(row).collect();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("curve.csv"), format!("position,force\n{table}")).unwrap();
        let text = "contacts.thresholds.point.at = 1\n[pull]\n[compare]\nfile = 'curve.csv'\n";
        let read = input::parse(text, "drawn", folder.path(), &[]).unwrap_or_else(|error| panic!("{error}\n{table}"));
        let compare = read.scenario.compare.unwrap();
        prop_assert_eq!(compare.position.as_deref(), Some(&positions[..]));
        prop_assert_eq!(compare.force.as_deref(), Some(forces));
    }
}
