//! The distribution of stretches at a position, and in steady sliding.

use asperity::record::Quantity;

use super::Known;
use crate::answer::StretchDistributions;
use crate::picture::{Curve, Form, Key, Panel, Pen, Series};

pub fn panel(known: &Known<'_>, found: &StretchDistributions) -> Panel {
    let x = Series::of("stretches.stretch", &found.stretch);
    let density = Series::of("stretches.density.values", &found.density.values);
    let steady = Series::of("stretches.steady.values", &found.steady.values);
    let curve = |label, color, form, y| Curve { key: Key::new(label, color, form), x: x.clone(), y };
    let curves = vec![
        curve("<i>Q</i>(<i>x</i>; <i>X</i>)", "blue", Form::Line(""), density),
        curve("<i>Q</i><sub>s</sub>, in steady sliding", "green", Form::Line("6 4"), steady),
    ];
    let words = [("stretch x", Quantity::Length), ("probability density", Quantity::PerLength)];
    let mut pen = Pen::new(known.frame("stretches", words, curves));
    pen.stems(&found.density.at, &found.density.weights, "blue");
    let mut panel = pen.panel("Stretches at <i>X</i>", &Known::stems(&[&found.density]), vec![]);
    panel.columns.push(known.column("position X", Quantity::Length, vec![found.position]));
    panel.columns.extend(known.masses("<i>Q</i>", &found.density));
    panel
}
