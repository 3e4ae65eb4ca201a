//! Makes `docs/validation`: what is known to be true against what the program says, in tables and pictures.
//!
//! `cargo run --release --package asperity-cli --example validation` computes everything and writes the page;
//! its test recomputes what is quick, and compares it with the page.

mod agreement;
#[path = "../../src/figure/clip.rs"]
#[allow(dead_code)]
mod clip;
mod closed;
mod cost;
#[path = "../../src/figure/curve.rs"]
#[allow(dead_code)]
mod curve;
mod fault;
mod interface;
mod lattice;
#[path = "../../src/figure/legend.rs"]
#[allow(dead_code)]
mod legend;
#[path = "../../src/figure/letters.rs"]
#[allow(dead_code)]
mod letters;
mod page;
mod relaxation;
mod renormalised;
#[path = "../../src/figure/room.rs"]
#[allow(dead_code)]
mod room;
mod scatter;
#[path = "../../src/figure/simplify.rs"]
#[allow(dead_code)]
mod simplify;
mod speed;
mod stability;
#[path = "../../src/figure/style.rs"]
#[allow(dead_code)]
mod style;
mod time;
#[path = "../../../core/tests/common/together.rs"]
mod together;
#[path = "../../src/figure/typography.rs"]
#[allow(dead_code)]
mod typography;
#[path = "../../../core/tests/common/ways.rs"]
mod ways;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::{Gaussian, Point, Rectangular, SharedLaw};
use asperity::master::MasterEquation;

use page::Page;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/validation")
}

fn main() -> std::io::Result<()> {
    let page = Page::default();
    let page = closed::section(agreement::section(relaxation::section(cost::section(page, false))));
    let page = lattice::section(scatter::section(stability::section(page, false), false), false);
    let page = fault::section(interface::section(renormalised::section(page, false)), false);
    let page = speed::section(time::section(page, false));
    page.write(&folder())
}

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).expect("a mean of 0 or above, a std above 0"))
}

fn rectangular(min: f64, max: f64) -> SharedLaw {
    Arc::new(Rectangular::new(min, max).expect("a minimum below the maximum"))
}

fn point(at: f64) -> SharedLaw {
    Arc::new(Point::new(at).expect("a point at 0 or above"))
}

/// Contacts of equal stiffness, N_c⟨k⟩ = 1.
fn equal(thresholds: &SharedLaw, reforming: &SharedLaw) -> Contacts {
    let (thresholds, reforming) = (thresholds.clone(), reforming.clone());
    Contacts::new(thresholds, reforming)
}

fn start(law: &SharedLaw) -> Initial {
    Initial { law: law.clone(), start: Start::Conditional }
}

/// The master equation of contacts that re-form at 0.
fn master(thresholds: &SharedLaw, initial: &SharedLaw) -> MasterEquation {
    MasterEquation::new(equal(thresholds, &point(0.0)), &start(initial)).expect("thresholds above 0")
}

/// 0, `step`, … `last`.
fn grid(last: f64, step: f64) -> Vec<f64> {
    (0..=(last / step).round() as usize).map(|i| i as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything but times and the finest grids.
    #[test]
    fn the_page_says_what_the_program_finds() {
        let page =
            closed::section(agreement::section(relaxation::section(cost::section(Page::default(), true))));
        let page = lattice::section(scatter::section(stability::section(page, true), true), true);
        let page = fault::section(interface::section(renormalised::section(page, true)), true);
        let page = time::section(page, true);
        let written = std::fs::read_to_string(folder().join("index.md")).unwrap();
        let missing: Vec<&str> = page.lasting().filter(|line| !written.contains(line)).collect();
        assert!(page.lasting().count() > 100);
        assert!(
            missing.is_empty(),
            "not in docs/validation/index.md; `make validation` writes it:\n{}",
            missing.join("\n")
        );
    }
}
