//! The distributions that describe the contacts, with what is dragged on their curves.

use asperity::record::Quantity;

use super::Known;
use crate::answer::{Density, StretchDistributions};
use crate::handles;
use crate::picture::{Curve, Form, Handle, Key, Panel, Pen, Series};
use crate::template;

/// Between two handles of one place, in pixels.
const APART: f64 = 12.0;

pub fn panel(known: &Known<'_>, found: &StretchDistributions) -> Panel {
    let laws: [(&str, &'static str, &str, &Density); 3] = [
        ("<i>P</i><sub>c</sub>", "blue", "thresholds", &found.thresholds),
        ("<i>R</i>", "green", "reforming", &found.reforming),
        ("<i>Q</i><sub>ini</sub>", "orange", "initial", &found.initial),
    ];
    let x = Series::of("stretches.law_stretch", &found.law_stretch);
    let curves = laws.map(|(label, color, name, density)| Curve {
        key: Key::new(label, color, Form::Line("")),
        x: x.clone(),
        y: Series::of(&format!("stretches.{name}.values"), &density.values),
    });
    let words = [("stretch x", Quantity::Length), ("probability density", Quantity::PerLength)];
    let mut pen = Pen::new(known.frame("laws", words, curves.into()));
    for (_, color, _, density) in laws {
        pen.stems(&density.at, &density.weights, color);
    }
    let all = handles::of_scenario(known.scenario);
    let add = all.iter().find(|handle| handle.node).map(|drawn| template::law(&drawn.key, "add", "$x"));
    let handles = apart(&pen, &all);
    let stems = Known::stems(&laws.map(|(_, _, _, density)| density));
    let mut panel = pen.panel("Distributions", &stems, handles);
    panel.columns.extend(laws.iter().flat_map(|(label, _, _, density)| known.masses(label, density)));
    panel.add = add.unwrap_or_default();
    panel
}

/// All handles. One that is over another stands below it, where its vertical place has no meaning, so that both can be taken.
fn apart(pen: &Pen<'_>, all: &[handles::LawHandle]) -> Vec<Handle> {
    let mut placed: Vec<Handle> = vec![];
    for of in all {
        let mut handle = draggable(pen, of);
        let covered = |at: [f64; 2]| {
            placed.iter().any(|other| (other.at[0] - at[0]).hypot(other.at[1] - at[1]) < APART / 2.0)
        };
        while !of.node && covered(handle.at) {
            handle.at[1] += APART;
        }
        placed.push(handle);
    }
    placed
}

/// A handle at its place on the curve, or at the top of its point mass.
fn draggable(pen: &Pen<'_>, of: &handles::LawHandle) -> Handle {
    let y = if of.weight > 0.0 { pen.stem(of.weight) } else { of.density };
    let number = of.handle;
    let to = format!("{{\"handle\":{number},\"stretch\":$x,\"density\":$y}}");
    let remove = if of.node { template::law(&of.key, "remove", &number.to_string()) } else { String::new() };
    pen.handle(of.stretch, y, template::law(&of.key, "move", &to), remove)
}
