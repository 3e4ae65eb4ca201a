//! Writes `docs/variables.md`, the variables of results by task.

mod page;

fn main() -> std::io::Result<()> {
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/variables.md"), page::page())
}
