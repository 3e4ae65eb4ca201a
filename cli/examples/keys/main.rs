//! Writes the tables of keys of `docs/scenarios.md` from the documentation of the types that scenarios are read into.

mod table;

use asperity_runner::input;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/scenarios.md");

fn main() -> std::io::Result<()> {
    std::fs::write(PAGE, table::page(&std::fs::read_to_string(PAGE)?, &input::schema()))
}
