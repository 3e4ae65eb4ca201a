//! The critical stiffness over the width of the thresholds: stick-slip is below.

use asperity::record::Quantity;

use super::Known;
use crate::answer::WidthCurve;
use crate::picture::{Curve, Form, Key, Panel, Pen, Series};
use crate::template;
use crate::width;

pub fn panel(known: &Known<'_>, curve: &WidthCurve) -> Option<Panel> {
    let law = known.scenario.contacts.thresholds.as_ref()?;
    let std = width::of(law)?;
    let found = curve.critical_stiffness.iter().map(|stiffness| stiffness.0);
    // Where the force jumps it is infinite, and 0 where all springs slide smoothly: neither has a place.
    let stiffness: Vec<f64> =
        found.map(|found| if found.is_finite() && found > 0.0 { found } else { f64::NAN }).collect();
    let known_points = curve.width.iter().zip(&stiffness).map(|(&x, &y)| [x, y]);
    let points: Vec<[f64; 2]> = known_points.filter(|point| point[1] > 0.0).collect();
    let line = Curve {
        key: Key::new("<i>K</i><sub>c</sub>(σ)", "blue", Form::Line("")),
        x: Series::of("critical_stiffness.width", &curve.width),
        y: Series::own(stiffness),
    };
    let words = [(width::words(law), Quantity::Length), ("stiffness K", Quantity::Stiffness)];
    let mut frame = known.frame("map", words, vec![line]);
    frame.logarithmic = [true; 2];
    let mut pen = Pen::new(frame);
    let floor = pen.y.min;
    if let (Some(&[first, _]), Some(&[last, _])) = (points.first(), points.last()) {
        pen.area(&mut points.into_iter().chain([[last, floor], [first, floor]]), "slip");
        pen.text(1.15 * first, 2.0 * floor, "stick-slip");
    }
    let block = known.scenario.block.as_ref();
    let handles =
        block.map(|block| pen.handle(std, block.stiffness, template::width_and_stiffness(), String::new()));
    Some(pen.panel("Stick-slip below <i>K</i><sub>c</sub>", &[], handles.into_iter().collect()))
}
