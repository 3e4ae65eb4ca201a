//! The text of the page of variables.

use asperity::record::{CsvTable, Quantity, Record, Variable};
use asperity::task;

const HEAD: &str = "\
# Variables of `result.nc`

What each task records, from the declarations in the code (`asperity::task::columns`; `make variables` writes this page). The \
CSV tables have the same names; those of each task are below it. What was not asked for is not there. Every variable has its `long_name` and its `units` \
([labels](how-to/units.md), `1` where it is dimensionless); `scenario` is the scenario as text.
";

/// The headings of tasks that are not called like their table.
const TASKS: [(&str, &str); 5] = [
    (
        "interface_drive",
        "[drive] with [interface], and [[protocol]] with [interface] over time-dependent contacts",
    ),
    ("interface_drive of contacts", "[drive] with [interface] of contacts coupled one by one"),
    (
        "interface_drive of contacts in time",
        "[drive] or [[protocol]] with [interface] of time-dependent contacts coupled one by one",
    ),
    ("protocol", "[[protocol]]"),
    ("block_protocol", "[[protocol]] with [block], and [drive] with [block] over time-dependent contacts"),
];

/// The page.
pub fn page() -> String {
    let mut page = HEAD.to_owned();
    for (task, record) in task::columns() {
        let heading = TASKS.into_iter().find(|(name, _)| *name == task);
        let heading = heading.map_or_else(|| format!("[{task}]"), |(_, heading)| heading.to_owned());
        page +=
            &format!("\n## `{heading}`\n\n| variable | along | quantity | meaning |\n|---|---|---|---|\n");
        record.variables.iter().for_each(|variable| page += &row(variable));
        task::tables().filter(|table| is_of(table, &record)).for_each(|table| page += &listed(table));
    }
    page
}

/// Whether a result may have a table: all of its columns are among the variables.
fn is_of(table: &CsvTable, record: &Record) -> bool {
    table.columns.iter().all(|column| record.get(column.name).is_some())
}

/// A table in CSV with its columns.
fn listed(table: &CsvTable) -> String {
    let columns: Vec<_> = table.columns.iter().map(|column| format!("`{}`", column.name)).collect();
    format!("\n`{}`: {}.\n", table.file, columns.join(", "))
}

fn row(variable: &Variable) -> String {
    let along: Vec<_> = variable.dimensions.iter().map(|dimension| format!("`{dimension}`")).collect();
    let quantity = match variable.quantity {
        Quantity::PerLength => "1/length",
        Quantity::PerTime => "1/time",
        Quantity::Stiffness => "force/length",
        other => other.name(),
    };
    format!("| `{}` | {} | {quantity} | {} |\n", variable.name, along.join(", "), variable.long_name)
}
