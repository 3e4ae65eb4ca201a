//! What the page shows of a scenario, as pictures.

mod chain;
mod creep;
mod force;
mod laws;
mod map;
mod motion;
mod stability;
mod stretches;

use asperity::record::{Quantity, Record};
use asperity::scenario::Scenario;

use crate::answer::{Answer, Computed, Density, WidthCurve};
use crate::picture::{Column, Curve, Form, Frame, Key, Labels, Panel, Series, plain};
use crate::request::View;

/// Height of a picture in pixels.
const HEIGHT: f64 = 215.0;

/// Least and largest width of a picture in pixels.
const WIDTHS: [f64; 2] = [150.0, 10_000.0];

/// What is known, of which a page shows pictures.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// What was asked for last.
    pub answer: &'a Answer,
    /// The motion or the task, which may be that of the scenario before.
    pub motion: Option<&'a Computed>,
    /// The map, which may be that of the scenario before.
    pub widths: Option<&'a WidthCurve>,
    /// The page.
    pub view: &'a View,
}

/// The pictures of what has changed.
pub fn panels(known: &Known<'_>) -> Vec<Panel> {
    let chain = known.scenario.interface.is_some();
    let force = known.answer.force.as_ref().map(|force| force::panel(known, force));
    let found = known.answer.stretches.as_ref();
    let laws = found.map(|found| laws::panel(known, found));
    let stretches = found.filter(|_| !chain).map(|found| stretches::panel(known, found));
    let map = known.widths.filter(|_| !chain).and_then(|curve| map::panel(known, curve));
    let computed = known.answer.block.as_ref().or(known.answer.task.as_ref());
    let motion = computed.and_then(|computed| motion::panel(known, &computed.record));
    let chain = computed.and_then(|computed| chain::panel(known, &computed.record));
    [force, laws, stretches, map, motion, chain].into_iter().flatten().collect()
}

impl Known<'_> {
    /// The labels of units.
    fn labels(&self) -> Labels<'_> {
        Labels(&self.scenario.units)
    }

    /// A picture with these words and quantities at its axes; the second of the words is not in the names of the numbers.
    fn frame<'a>(
        &self,
        id: &'static str,
        [x, y]: [(&str, Quantity); 2],
        curves: Vec<Curve<'a>>,
    ) -> Frame<'a> {
        let labels = self.labels();
        Frame {
            id,
            size: [self.view.width.clamp(WIDTHS[0], WIDTHS[1]), HEIGHT],
            words: [labels.at_axis(x.0, x.1), labels.at_axis(y.0, y.1)],
            names: [labels.with_unit(&plain(x.0), x.1), labels.with_unit("", y.1)],
            logarithmic: [false; 2],
            curves,
            field: None,
        }
    }

    /// A variable of the motion or the task.
    fn series<'a>(&self, record: &'a Record, name: &str) -> Series<'a> {
        let of = if self.answer.block.is_some() { "block" } else { "task" };
        let place = record.variables.iter().position(|variable| variable.name == name);
        let path = place.map(|place| format!("{of}.record.variables.{place}.values"));
        Series { values: motion::values(record, name).into(), of: path.unwrap_or_default() }
    }

    /// A column of values that are no curve.
    fn column(&self, words: &str, quantity: Quantity, values: Vec<f64>) -> Column {
        Series::own(values).column(self.labels().with_unit(words, quantity))
    }

    /// The entry of point masses in a legend, where there are some.
    fn stems(densities: &[&Density]) -> Vec<Key> {
        let there = densities.iter().any(|density| !density.at.is_empty());
        let words = "point masses: weight 1 is 0.9 of the axis";
        there.then(|| Key::new(words, "quiet", Form::Dots)).into_iter().collect()
    }

    /// Point masses as numbers.
    fn masses(&self, label: &str, Density { at, weights, .. }: &Density) -> Vec<Column> {
        if at.is_empty() {
            return vec![];
        }
        let places = format!("point masses of {}", plain(label));
        vec![
            self.column(&places, Quantity::Length, at.clone()),
            self.column("their weights", Quantity::Number, weights.clone()),
        ]
    }
}
