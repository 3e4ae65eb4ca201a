//! Draws from the posterior of a fit, as columns.

use crate::record::{Column, Quantity, Record};

const NUMBER: Column = Column::new(
    "posterior_number",
    "place of the number among those of fit.posterior in the summary",
    Quantity::Count,
    &["posterior_number"],
);
const CHAIN: Column = Column::new("chain", "number of the chain", Quantity::Count, &["chain"]);
const DRAW: Column = Column::new("draw", "number of the draw in its chain", Quantity::Count, &["draw"]);
const VALUE: Column = Column::new(
    "posterior_value",
    "number in a draw from the posterior, in its own unit",
    Quantity::Number,
    &["posterior_number", "chain", "draw"],
);
const LOG_DENSITY: Column = Column::new(
    "posterior_log_density",
    "logarithm of the posterior density at a draw",
    Quantity::Number,
    &["chain", "draw"],
);
const DIVERGING: Column = Column::new(
    "posterior_diverging",
    "1 where the path to a draw diverged",
    Quantity::Flag,
    &["chain", "draw"],
);
const STEPS: Column =
    Column::new("posterior_steps", "steps of the sampler to a draw", Quantity::Count, &["chain", "draw"]);

pub(super) const COLUMNS: [Column; 7] = [NUMBER, CHAIN, DRAW, VALUE, LOG_DENSITY, DIVERGING, STEPS];

/// Adds draws to the record of a fit: `values` of each number, one chain after the other, and for each draw, in the same order, the
/// logarithm of the density, whether its path diverged (1 or 0), and its steps.
pub fn record_posterior(record: &mut Record, chains: usize, values: &[Vec<f64>], draws: [Vec<f64>; 3]) {
    let count = |n: usize| (0..n).map(|i| i as f64).collect::<Vec<f64>>();
    record.add(NUMBER, count(values.len()));
    record.add(CHAIN, count(chains));
    record.add(DRAW, count(draws[0].len() / chains));
    record.add(VALUE, values.concat());
    let [log_density, diverging, steps] = draws;
    record.add(LOG_DENSITY, log_density);
    record.add(DIVERGING, diverging);
    record.add(STEPS, steps);
}
