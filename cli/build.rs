//! Lists the scenarios that the command has in it, and says where they and the notices are: beside this file, where `scenarios` and
//! `THIRD-PARTY.txt` are links in the repository and files in the published package. Git makes no links on
//! Windows; then they are one folder up.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let variable = |name| PathBuf::from(env::var_os(name).expect("Cargo sets the folders of a crate"));
    let here = variable("CARGO_MANIFEST_DIR");
    let shipped = if here.join("scenarios").is_dir() { here } else { here.join("..") };
    let scenarios = shipped.join("scenarios");
    fs::write(variable("OUT_DIR").join("shipped.rs"), list(&scenarios)?)?;
    println!("cargo::rustc-env=ASPERITY_SHIPPED={}", shipped.display());
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", scenarios.display());
    Ok(())
}

/// The files of a folder as an expression: each with its name and its text.
fn list(folder: &Path) -> io::Result<String> {
    let entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    let mut paths: Vec<_> = entries.iter().map(fs::DirEntry::path).filter(|path| path.is_file()).collect();
    paths.sort();
    let items = paths.iter().map(|path| {
        let name = path.file_name().unwrap_or_default();
        format!("    ({name:?}, include_str!({path:?})),\n")
    });
    Ok(format!("&[\n{}]\n", items.collect::<String>()))
}
