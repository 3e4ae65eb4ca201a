//! The forces along a chain of cells at its drives or times, with the large events.

use asperity::record::{Quantity, Record};

use super::motion::{along, values};
use super::{Known, WIDTHS};
use crate::picture::{Column, Field, Panel, Pen, Stroke};

/// Height of the picture in pixels.
const HEIGHT: f64 = 280.0;
/// An event is large if this part of the cells slipped.
const LARGE: f64 = 1.0 / 20.0;

/// Where an event was, and the cells that slipped.
struct Event {
    at: f64,
    first: f64,
    last: f64,
    count: usize,
}

/// None where cells are no chain.
pub fn panel(known: &Known<'_>, record: &Record) -> Option<Panel> {
    let axis = if values(record, "map_time").is_empty() { "drive" } else { "time" };
    let (at, cell) = (values(record, &format!("map_{axis}")), values(record, "cell"));
    let force = record.values("cell_force")?;
    if cell.is_empty() || at.is_empty() {
        return None;
    }
    let cells = cell.len();
    let labels = known.labels();
    let mut frame = known.frame("chain", [(axis, along(axis)), ("cell", Quantity::Number)], vec![]);
    frame.size = [known.view.whole.clamp(WIDTHS[0], WIDTHS[1]), HEIGHT];
    let ends = [[at[0], at[at.len() - 1]], [0.0, cells as f64]];
    let words = labels.at_axis("force of a cell", Quantity::Force);
    frame.field = Some(Field { at, cells, values: force, ends, words });
    let mut pen = Pen::new(frame);
    let events = large_events(record, axis, cells);
    for event in &events {
        let down = [[event.at, event.first], [event.at, event.last + 1.0]];
        pen.line(&mut down.into_iter(), Stroke::line("ink", "1.25", ""));
    }
    let mut panel = pen.panel("Forces along the chain, and large events", &[], vec![]);
    let (rows, numbers) = (force.len(), (0..cells).map(|cell| cell as f64));
    let of_event = |of: fn(&Event) -> f64| events.iter().map(of).collect();
    panel.columns = vec![
        Column { times: cells, rows, ..known.column(axis, along(axis), at.to_vec()) },
        Column { rows, ..known.column("cell", Quantity::Number, numbers.collect()) },
        known.series(record, "cell_force").column(labels.with_unit("force of a cell", Quantity::Force)),
        known.column(&format!("{axis} of a large event"), along(axis), of_event(|event| event.at)),
        known.column("its first cell", Quantity::Number, of_event(|event| event.first)),
        known.column("its last cell", Quantity::Number, of_event(|event| event.last)),
    ];
    Some(panel)
}

fn large_events(record: &Record, axis: &str, cells: usize) -> Vec<Event> {
    let at = values(record, &format!("event_{axis}"));
    let [event, cell] = ["slipped_event", "slipped_cell"].map(|name| values(record, name));
    let begin = |&at: &f64| Event { at, first: f64::INFINITY, last: 0.0, count: 0 };
    let mut events: Vec<Event> = at.iter().map(begin).collect();
    for (&number, &cell) in event.iter().zip(cell) {
        let Some(event) = events.get_mut((number as usize).wrapping_sub(1)) else { continue };
        (event.first, event.last) = (event.first.min(cell), event.last.max(cell));
        event.count += 1;
    }
    events.retain(|event| event.count > 0 && event.count as f64 >= LARGE * cells as f64);
    events
}
