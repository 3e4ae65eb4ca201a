//! F(X) of a rigid slider, with its deviation, its highest point and the line of the spring at the first instability.

use asperity::record::Quantity;
use asperity::task::summary::SliderState;

use super::Known;
use crate::answer::ForceCurve;
use crate::digits::{brief, rounded};
use crate::picture::{Column, Curve, Form, Key, Panel, Pen, Series, Stroke, escaped};

pub fn panel(known: &Known<'_>, force: &ForceCurve) -> Panel {
    let x = Series::of("force.position", &force.position);
    let kinetic = vec![force.kinetic_friction; force.position.len()];
    let curve = |label, color, form, y| Curve { key: Key::new(label, color, form), x: x.clone(), y };
    let curves = vec![
        curve("<i>F</i>(<i>X</i>)", "blue", Form::Line(""), Series::of("force.force", &force.force)),
        curve("<i>F</i><sub>k</sub>", "green", Form::Line("6 4"), Series::own(kinetic)),
    ];
    let words = [("position X of the slider", Quantity::Length), ("friction force F", Quantity::Force)];
    let mut pen = Pen::new(known.frame("force", words, curves));
    let mut keys = vec![];
    if let Some(std) = &force.force_std {
        band(&mut pen, force, std);
        let label = "± deviation, <i>N</i><sub>c</sub> contacts";
        keys.push(Key::new(label, "band", Form::Band));
    }
    let spring = spring(known);
    if let Some((first, stiffness)) = spring {
        let down = [[first.position, first.force], [first.position + first.force / stiffness, 0.0]];
        pen.line(&mut down.into_iter(), Stroke::line("orange", "1.5", "3 3"));
        keys.push(Key::new("spring", "orange", Form::Line("3 3")));
    }
    if let Some(peak) = &force.static_friction {
        pen.dots(&mut [[peak.position, peak.value]].into_iter(), "blue", 4.0, false);
        keys.push(Key::new("<i>F</i><sub>s</sub>", "blue", Form::Dots));
    }
    if known.view.readings {
        pen.readings();
        keys.push(Key::new("readings", "ink", Form::Dots));
    }
    let position = known.answer.stretches.as_ref().map(|found| found.position);
    if let Some(x) = position {
        let ends = [[x, pen.y.min], [x, pen.y.max]];
        pen.line(&mut ends.into_iter(), Stroke::line("quiet", "1", ""));
    }
    let mut panel = pen.panel(&title(known, force), &keys, vec![]);
    panel.columns.extend(columns(known, force, spring.map(|(first, _)| first)));
    panel.scrub = true;
    panel
}

fn title(known: &Known<'_>, force: &ForceCurve) -> String {
    let unit = escaped(&known.labels().unit(Quantity::Velocity));
    let at = |velocity| format!(" at <i>v</i> = {}{unit}", brief(rounded(velocity, 4)));
    "Friction force".to_owned() + &force.velocity.map_or(String::new(), at)
}

/// The slider at its first instability, and the stiffness of the spring.
fn spring(known: &Known<'_>) -> Option<(SliderState, f64)> {
    let stiffness = known.scenario.block.as_ref()?.stiffness;
    let first = known.motion?.summary.numbers.sliding()?.first_instability?;
    Some((first, stiffness))
}

fn band(pen: &mut Pen<'_>, force: &ForceCurve, std: &[f64]) {
    let edge = |sign: f64| move |i: usize| [force.position[i], force.force[i] + sign * std[i]];
    let all = 0..std.len();
    pen.area(&mut all.clone().map(edge(1.0)).chain(all.rev().map(edge(-1.0))), "band");
}

fn columns(known: &Known<'_>, force: &ForceCurve, first: Option<SliderState>) -> Vec<Column> {
    let mut found = vec![];
    if let Some(std) = &force.force_std {
        let name = known.labels().with_unit("standard deviation of F", Quantity::Force);
        found.push(Series::of("force.force_std", std).column(name));
    }
    let mut pair = |[across, up]: [&str; 2], x, y| {
        found.push(known.column(across, Quantity::Length, vec![x]));
        found.push(known.column(up, Quantity::Force, vec![y]));
    };
    if let Some(peak) = &force.static_friction {
        pair(["X_s", "F_s"], peak.position, peak.value);
    }
    if let Some(first) = first {
        pair(["X at the first instability", "F there"], first.position, first.force);
    }
    found
}
