//! The motion of the slider, or the result of the task where it is another one.

use asperity::record::{Quantity, Record, Variable};

use super::{Known, creep, stability};
use crate::digits::rounded;
use crate::picture::{Curve, Form, Key, Panel, Pen, Series, escaped};

/// What is drawn of a task.
pub struct Kind {
    title: &'static str,
    /// The variables along the axes.
    x: &'static str,
    y: &'static str,
    logarithmic: [bool; 2],
    /// Words at the vertical axis; those of its variable where they are empty.
    words: &'static str,
}

const fn kind(
    title: &'static str,
    [x, y]: [&'static str; 2],
    logarithmic: [bool; 2],
    words: &'static str,
) -> Kind {
    Kind { title, x, y, logarithmic, words }
}

/// The first of these whose variables a record has is drawn.
const KINDS: [Kind; 9] = [
    kind("Friction against velocity", ["velocity", "kinetic_friction"], [true, false], ""),
    kind("Healing", ["hold", "static_friction"], [true, false], ""),
    kind("Noise of the force", ["wave_number", "spectrum"], [true, true], "power spectrum of F"),
    kind("Creep", ["creep_time", "creep_position"], [true, false], "slip since the end of loading"),
    kind("Stick-slip", ["velocity", "persistent_stiffness"], [true, true], "stiffness K"),
    kind("Stick-slip", ["stiffness", "stick_slip"], [true, false], "none 0, transient 1, persistent 2"),
    kind("Motion of the slider", ["time", "force"], [false, false], ""),
    kind("Motion of the slider", ["drive", "spring_force"], [false, false], ""),
    kind("Motion of the slider", ["drive", "force"], [false, false], ""),
];
const COLORS: [&str; 3] = ["blue", "orange", "green"];
const DASHES: [&str; 4] = ["", "6 4", "2 3", "8 3 2 3"];

/// The colour of a curve, and the dash of those after the last colour.
pub fn style(i: usize) -> (&'static str, Form) {
    (COLORS[i % COLORS.len()], Form::Line(DASHES[i / COLORS.len() % DASHES.len()]))
}

/// The values of a variable, none without it.
pub fn values<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.values(name).unwrap_or_default()
}

pub fn panel(known: &Known<'_>, record: &Record) -> Option<Panel> {
    let (kind, [x, y]) = KINDS.iter().find_map(|kind| Some((kind, both(record, kind)?)))?;
    let mut curves = match kind.y {
        "creep_position" => creep::curves(record, known.labels()),
        "persistent_stiffness" => stability::curves(record),
        "kinetic_friction" if record.get("temperature").is_some() => temperatures(known, record),
        _ => vec![single(known, record, kind)],
    };
    curves.iter_mut().for_each(|curve| placed(curve, kind.logarithmic));
    let words = if kind.words.is_empty() { &y.long_name } else { kind.words };
    let mut frame = known.frame("motion", [(&x.long_name, x.quantity), (words, y.quantity)], curves);
    frame.logarithmic = kind.logarithmic;
    let mut pen = Pen::new(frame);
    let events = [if kind.x == "time" { "event_time" } else { "event_drive" }, "event_force_before"];
    let [at, force] = events.map(|name| values(record, name));
    let mut keys = vec![];
    if !at.is_empty() {
        pen.dots(&mut at.iter().zip(force).map(|(&x, &y)| [x, y]), "orange", 3.0, false);
        keys.push(Key::new("slips", "orange", Form::Dots));
    }
    let mut panel = pen.panel(kind.title, &keys, vec![]);
    for variable in events.into_iter().filter_map(|name| record.get(name)) {
        let name = known.labels().with_unit(&variable.long_name, variable.quantity);
        panel.columns.push(known.series(record, &variable.name).column(name));
    }
    Some(panel)
}

/// The variables along the axes, with as many values as there are of the first one, or rows of so many.
fn both<'a>(record: &'a Record, kind: &Kind) -> Option<[&'a Variable; 2]> {
    let (x, y) = (record.get(kind.x)?, record.get(kind.y)?);
    let rows = y.dimensions.len() > 1 && y.values.len().is_multiple_of(x.values.len().max(1));
    (!x.values.is_empty() && (x.values.len() == y.values.len() || rows)).then_some([x, y])
}

/// A curve of friction against velocity for each temperature.
fn temperatures<'a>(known: &Known<'_>, record: &'a Record) -> Vec<Curve<'a>> {
    let velocities = values(record, "velocity");
    let rows = values(record, "kinetic_friction").chunks(velocities.len().max(1));
    let unit = escaped(&known.labels().unit(Quantity::Energy));
    let curve = |(i, (row, temperature)): (usize, (&'a [f64], &f64))| {
        let (color, form) = style(i);
        let label = format!("<i>T</i> = {}{unit}", rounded(*temperature, 4));
        let x = known.series(record, "velocity");
        Curve { key: Key::new(&label, color, form), x, y: Series::own(row.to_vec()) }
    };
    rows.zip(values(record, "temperature")).enumerate().map(curve).collect()
}

fn single<'a>(known: &Known<'_>, record: &'a Record, kind: &Kind) -> Curve<'a> {
    let label = record.get(kind.y).map_or("", |variable| &variable.long_name);
    let form = if kind.y == "stick_slip" { Form::Dots } else { Form::Line("") };
    Curve {
        key: Key::new(label, "blue", form),
        x: known.series(record, kind.x),
        y: known.series(record, kind.y),
    }
}

/// Leaves out what has no place on logarithmic axes.
fn placed(curve: &mut Curve<'_>, logarithmic: [bool; 2]) {
    if logarithmic == [false; 2] {
        return;
    }
    let there = |value: f64, axis: usize| value.is_finite() && (value > 0.0 || !logarithmic[axis]);
    let all = curve.x.values.iter().zip(&*curve.y.values).filter(|(x, _)| there(**x, 0));
    let (x, y) = all.map(|(&x, &y)| (x, if there(y, 1) { y } else { f64::NAN })).unzip();
    (curve.x, curve.y) = (Series::own(x), Series::own(y));
}

/// What a quantity of the axis of a motion is.
pub fn along(name: &str) -> Quantity {
    if name == "time" { Quantity::Time } else { Quantity::Length }
}
