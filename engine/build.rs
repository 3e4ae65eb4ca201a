//! Where the page of the explorer is: beside this file, where `explorer` is a link in the repository and a folder in the
//! published package. Git makes no links on Windows; then it is one folder up.

use std::env;
use std::path::PathBuf;

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("Cargo names the folder of the crate"));
    let shipped = if here.join("explorer").is_dir() { here } else { here.join("..") };
    println!("cargo::rustc-env=ASPERITY_SHIPPED={}", shipped.display());
    println!("cargo::rerun-if-changed=build.rs");
}
