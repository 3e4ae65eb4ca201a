//! The variables that each task may record, collected from the column declarations of the tasks.

use super::{
    COMPARED, distribution, drive, ensemble, hold_curve, in_time, interface, pull, renormalisation, sliding,
    velocity_curve,
};
use crate::block::{Slide, StickSlip};
use crate::record::{Column, Record};

/// The variables of each task, without values: what its [`Output`](super::Output) may hold. The names of tasks are those of
/// [`Numbers`](super::summary::Numbers). Contacts coupled one by one have an entry of their own.
pub fn columns() -> Vec<(&'static str, Record)> {
    let of = |lists: &[&[Column]]| {
        let mut record = Record::default();
        lists.iter().flat_map(|list| list.iter()).for_each(|column| record.add(*column, Vec::new()));
        record
    };
    let [motion, slips] = StickSlip::columns();
    let mut driven = sliding::joined(motion, slips);
    let ensemble = prefixed(&driven, "ensemble_");
    driven.variables.extend(of(&[&sliding::COLUMNS[..5], &drive::COLUMNS]).variables);
    driven.variables.extend(ensemble.variables);
    driven.variables.extend(of(&[&sliding::COLUMNS[5..]]).variables);
    let [motion, slips] = Slide::columns();
    let mut block_in_time = sliding::joined(motion, slips);
    let ensemble = prefixed(&block_in_time, "ensemble_");
    block_in_time.variables.extend(ensemble.variables);
    let [cells, contacts] = interface::columns();
    vec![
        ("pull", of(&[&pull::COLUMNS, &COMPARED, &distribution::COLUMNS, &ensemble::COLUMNS])),
        ("drive", driven),
        ("interface_drive", cells),
        ("interface_drive of contacts", contacts),
        ("protocol", of(&[&in_time::COLUMNS, &COMPARED])),
        ("block_protocol", block_in_time),
        ("velocity_curve", of(&[&velocity_curve::COLUMNS])),
        ("hold_curve", of(&[&hold_curve::COLUMNS])),
        ("renormalisation", of(&[&renormalisation::COLUMNS])),
    ]
}

/// The variables of `record` with `prefix` before their names and the names of their dimensions.
fn prefixed(record: &Record, prefix: &str) -> Record {
    let mut variables = record.variables.clone();
    for variable in &mut variables {
        variable.name.insert_str(0, prefix);
        variable.dimensions.iter_mut().for_each(|dimension| dimension.insert_str(0, prefix));
    }
    Record { variables }
}
