//! The slip under each constant force since the end of loading, and where the slider fails.

use asperity::record::{Quantity, Record};

use super::motion::{style, values};
use crate::digits::rounded;
use crate::picture::{Curve, Form, Key, Labels, Series, escaped};

pub fn curves<'a>(record: &'a Record, labels: Labels<'_>) -> Vec<Curve<'a>> {
    let points = values(record, "creep_fraction").len();
    let [time, position] = ["creep_time", "creep_position"].map(|name| values(record, name));
    let loaded = values(record, "loaded_position");
    let unit = escaped(&labels.unit(Quantity::Force));
    // The first point is that of loading.
    let own = |i: usize| i * points + 1..(i + 1) * points;
    let curve = |(i, &force): (usize, &f64)| {
        let (color, form) = style(i);
        let slip = position[own(i)].iter().map(|x| x - loaded[i]).collect();
        let label = format!("slip at <i>F</i> = {}{unit}", rounded(force, 4));
        let x = Series { values: time[own(i)].into(), of: String::new() };
        Curve { key: Key::new(&label, color, form), x, y: Series::own(slip) }
    };
    let mut curves: Vec<Curve<'_>> = values(record, "imposed_force").iter().enumerate().map(curve).collect();
    curves.extend(failures(record));
    curves
}

/// The times of failure, and the slips until then.
fn failures(record: &Record) -> Option<Curve<'_>> {
    let [time, last, loaded] =
        ["failure_time", "final_position", "loaded_position"].map(|name| values(record, name));
    let slip = last.iter().zip(loaded).map(|(last, loaded)| last - loaded).collect();
    let x = Series { values: time.into(), of: String::new() };
    let key = Key::new("failure", "ink", Form::Dots);
    time.iter().any(|time| time.is_finite()).then(|| Curve { key, x, y: Series::own(slip) })
}
