//! How long a case may take, and how much memory.

use super::child::Limits;
use super::scenario::Case;

const MEBIBYTE: u64 = 1 << 20;

/// A check reads the scenario and builds its distributions, which keep a few thousand numbers each: some milliseconds, and
/// 10 MiB. The slowest distributions are those of areas and those renormalised by a coupling, of which nodes are found by
/// quadrature, in up to half a second. Address space holds the program itself, 20 MiB, too.
pub const CHECK: Limits = Limits { seconds: 2, bytes: 256 * MEBIBYTE, patience: None };

/// What a run may take, of a case whose numbers are small: at most 30 points, 2000 contacts, 64 cells, 6 runs, 3 steps.
///
/// Tables and pictures take a second and 60 MiB, mostly for the pictures. What is solved then takes as many solutions of the
/// master equation as there are velocities and temperatures, and holds; each is one of some hundred to some ten thousand
/// cells of 16 terms, in 0.01 s for contacts without time, 0.1 s where thresholds are followed rank by rank, some seconds
/// where they diffuse. Limits are ten times that: the machine of a test is not known.
pub fn run(case: &Case) -> Limits {
    let each = if case.has("contacts.ageing = smoluchowski") {
        5.0
    } else if ["temperature", "ageing", "delay"].iter().any(|rule| case.given(&format!("contacts.{rule}"))) {
        1.0
    } else {
        0.2
    };
    // A block or an interface in time of which the error is asked for is followed thrice.
    let moved = case.given("block") || case.given("interface");
    let thrice = if moved && case.given("master_equation.tolerance") { 3.0 } else { 1.0 };
    let seconds = thrice * (10.0 + each * case.solutions() as f64);
    Limits { seconds: seconds.min(60.0) as u64, bytes: 1024 * MEBIBYTE, patience: None }
}
