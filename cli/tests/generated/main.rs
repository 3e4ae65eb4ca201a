//! Scenarios drawn from the schema: whatever is asked for, the program answers, or refuses with a reason.
//!
//! A case is its number. `make fuzz CASE=1234` checks and runs one; `make fuzz` draws further ones for an hour, and leaves
//! those that fail in `target/fuzz`.

#![allow(missing_docs)]

mod agreement;
mod campaign;
mod child;
mod distributions;
mod found;
mod grid;
mod pairs;
mod prediction;
mod quantities;
mod random;
mod rules;
mod scenario;
mod verdict;

use std::time::{Duration, Instant};

use campaign::{Count, Task};
use pairs::Pairs;
use scenario::Schema;

/// Cases that are checked, from the number 0 on, and run, from a number on that no check has. There are to be a hundred of the
/// latter once those of `known.txt` are mended.
const CHECKS: usize = 300;
const RUNS: usize = 24;
const FIRST_RUN: u64 = 1_000_000;
/// Pulls by the master equation and by an ensemble, from a number on.
const BOTH: usize = 8;
const FIRST_BOTH: u64 = 2_000_000;
/// The first number of a fuzz campaign where none is given.
const FIRST_FUZZ: u64 = 10_000_000;

fn schema() -> Schema {
    Schema::of_types()
}

/// A number in the environment.
fn given(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}: a whole number")))
}

/// Of tables that go together, and of others.
fn checked(schema: &Schema) -> impl Iterator<Item = scenario::Case> {
    Pairs::new(schema, 0, 2).take(CHECKS / 2).chain(Pairs::new(schema, 1, 2).take(CHECKS / 2))
}

#[test]
fn generated_scenarios_are_accepted_or_refused() {
    let schema = schema();
    let cases: Vec<_> = checked(&schema).collect();
    let count = campaign::judge(&cases, Task::Check);
    println!("{count}");
    // Tables that go together, every other one, are mostly accepted.
    assert!(count.accepted > CHECKS / 5, "{count}");
    assert!(count.refused > CHECKS / 5, "{count}");
    count.assert_none_failed();
}

#[test]
fn generated_scenarios_run_to_numbers() {
    let schema = schema();
    let known = campaign::known();
    let (skipped, cases): (Vec<_>, Vec<_>) =
        Pairs::new(&schema, FIRST_RUN, 2).take(RUNS).partition(|case| known.contains(&case.number));
    let count = campaign::judge(&cases, Task::Run);
    println!("{count}; {} known to fail and not run: {:?}", skipped.len(), numbers(&skipped));
    count.assert_none_failed();
}

/// Pulls of contacts without time dependence, which are quick, by both solvers.
#[test]
fn the_master_equation_and_the_ensemble_agree() {
    let schema = schema();
    let both = |case: &scenario::Case| {
        let in_time =
            ["temperature", "ageing", "delay"].iter().any(|rule| case.given(&format!("contacts.{rule}")));
        case.has(":alternative = pull")
            && case.given("ensemble")
            && !case.has("ensemble.disorder = quenched")
            && !in_time
    };
    let cases: Vec<_> =
        (FIRST_BOTH..).step_by(2).map(|number| schema.case(number)).filter(both).take(BOTH).collect();
    let (known, cases): (Vec<_>, Vec<_>) =
        cases.into_iter().partition(|case| campaign::known().contains(&case.number));
    let count = campaign::judge(&cases, Task::Run);
    println!("{count}; known to fail and not run: {:?}", numbers(&known));
    count.assert_none_failed();
    assert!(count.deviations.len() >= BOTH / 4, "{count}");
}

#[test]
fn the_cases_have_every_option_and_nearly_all_pairs() {
    let schema = schema();
    let cases: Vec<_> = checked(&schema).collect();
    let missing: Vec<_> =
        schema.options().into_iter().filter(|option| !cases.iter().any(|case| case.has(option))).collect();
    assert!(missing.is_empty(), "options that no case has: {missing:?}");
    let many: Vec<_> = (0..3000).map(|number| schema.case(number)).collect();
    let (seen, all) = (pairs::in_cases(&cases), pairs::in_cases(&many));
    println!("{CHECKS} cases have {seen} pairs of options; 3000 drawn at random have {all}");
    // Most of those that are left out are of options that few scenarios can have.
    assert!(seen as f64 > 0.8 * all as f64, "{seen} of {all}");
}

#[test]
fn a_case_is_its_number() {
    let (one, other) = (schema(), schema());
    for number in [0, 1, 1234, FIRST_RUN] {
        assert_eq!(one.case(number).text(), other.case(number).text());
    }
    assert_ne!(one.case(2).text(), one.case(4).text());
}

/// The list of cases that are known to fail stays true when the schema grows.
#[test]
fn a_new_key_leaves_the_rest_of_a_case_as_it_is() {
    let old = schema();
    let mut grown = schema();
    grown.add_key("Contacts", "polished");
    let mut given = 0;
    for number in (0..40).chain(FIRST_RUN..FIRST_RUN + 40) {
        let mut case = grown.case(number);
        given += usize::from(case.remove("contacts", "polished"));
        assert_eq!(case.text(), old.case(number).text(), "{number}");
    }
    assert!(given > 10, "{given}");
}

/// `make fuzz CASE=1234`
#[test]
#[ignore = "for `make fuzz CASE=1234`"]
fn one_case() {
    let case = schema().case(given("ASPERITY_CASE").expect("ASPERITY_CASE: the number of a case"));
    println!("{}", case.text());
    let count = campaign::judge(&[case], Task::Run);
    println!("{count}");
    count.assert_none_failed();
}

/// `make fuzz`
#[test]
#[ignore = "for `make fuzz`, takes an hour"]
fn campaign() {
    let (begun, length) =
        (Instant::now(), Duration::from_secs(given("ASPERITY_FUZZ_SECONDS").unwrap_or(3600)));
    let (schema, mut number) = (schema(), given("ASPERITY_FUZZ_FROM").unwrap_or(FIRST_FUZZ));
    let mut count = Count::default();
    while begun.elapsed() < length {
        let cases: Vec<_> = (number..number + 16).map(|number| schema.case(number)).collect();
        count.add(campaign::judge(&cases, Task::Run));
        number += 16;
        println!("up to case {number}: {count}");
    }
    count.assert_none_failed();
}

/// Of the grid of distributions, tasks, temperatures and rules of ageing, so many, spread evenly.
const OF_THE_GRID: usize = 20;
/// Seconds of the processor after which they are asked to stop: the first word of progress comes after 10 s.
const SOON: f64 = 12.0;
/// The same where there is more time.
const LATER: f64 = 30.0;

/// All combinations, neighbours differing in each value: by steps of a number that shares no factor with theirs.
fn spread() -> Vec<u64> {
    (0..grid::COUNT).map(|k| (k * 1_048_573) % grid::COUNT).collect()
}

#[test]
fn combinations_end_within_their_limits() {
    let failures = grid::judge(&spread()[..OF_THE_GRID], SOON);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// `make grid`
#[test]
#[ignore = "for `make grid`, takes hours"]
fn all_combinations() {
    let numbers: Vec<u64> = match given("ASPERITY_CASE") {
        Some(number) => {
            println!("{}", grid::Combination::of(number).text);
            vec![number]
        }
        None => part(spread()),
    };
    let failures = grid::judge(&numbers, LATER);
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), numbers.len(), failures.join("\n"));
}

/// The i-th of n parts, where ASPERITY_PART is `i/n`, i from 0 on.
fn part(numbers: Vec<u64>) -> Vec<u64> {
    let Ok(part) = std::env::var("ASPERITY_PART") else { return numbers };
    let (number, of) = part.split_once('/').expect("ASPERITY_PART: i/n");
    let [number, of] =
        [number, of].map(|text| text.parse::<usize>().expect("ASPERITY_PART: whole numbers i/n"));
    numbers[number * numbers.len() / of..(number + 1) * numbers.len() / of].to_vec()
}

fn numbers(cases: &[scenario::Case]) -> Vec<u64> {
    cases.iter().map(|case| case.number).collect()
}
