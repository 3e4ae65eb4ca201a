//! Where the scenarios and notices are that the command has in it: beside this file, where `scenarios` and
//! `THIRD-PARTY.txt` are links in the repository and files in the published package. Git makes no links on
//! Windows; then they are one folder up.

use std::env;
use std::path::PathBuf;

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("Cargo names the folder of the crate"));
    let shipped = if here.join("scenarios").is_dir() { here } else { here.join("..") };
    println!("cargo::rustc-env=ASPERITY_SHIPPED={}", shipped.display());
    println!("cargo::rerun-if-changed=build.rs");
}
