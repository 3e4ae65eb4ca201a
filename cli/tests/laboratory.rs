//! Computed stick-slip beside measured events, where the folder of laboratory data is known.
//!
//! `ASPERITY_LAB_DATA` names the folder; without it there is nothing to compare with, and the test says so.

mod support;

use std::path::PathBuf;

use support::{Folder, scenarios};

/// Columns of a CSV file, chosen by their headers.
fn columns<const N: usize>(text: &str, names: [&str; N]) -> [Vec<f64>; N] {
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().expect("a header").split(',').collect();
    let places = names.map(|name| header.iter().position(|h| *h == name).expect(name));
    let mut columns = names.map(|_| Vec::new());
    for line in lines {
        let cells: Vec<_> = line.split(',').collect();
        for (column, &place) in columns.iter_mut().zip(&places) {
            column.push(cells[place].parse().expect("a number"));
        }
    }
    columns
}

fn mean_and_std(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (values.len() - 1) as f64).sqrt())
}

/// Stresses before and after an event, stress drops (MPa) and slips (mm) of a rock interface of 4 m: the scenario is
/// made to their size, so that computed means lie within the scatter of measured ones.
#[test]
fn stick_slip_has_the_size_of_measured_events() {
    let Some(data) = std::env::var_os("ASPERITY_LAB_DATA").filter(|name| !name.is_empty()).map(PathBuf::from)
    else {
        println!("skipped: ASPERITY_LAB_DATA is not set");
        return;
    };
    let file = data.join("stick-slip-events-okubo-2025/Macroscopic_stats_FB03_087.csv");
    let measured = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let measured = columns(
        &measured,
        [
            "macroshearstress_beforeevent[MPa]",
            "macroshearstress_afterevent[MPa]",
            "macroshearstress_drop[MPa]",
            "slip_mean[mm]",
        ],
    );
    let folder = Folder::new();
    let scenario = scenarios().join("laboratory.toml");
    folder.succeed(&["run", scenario.to_str().unwrap(), "--quiet", "-o", "laboratory"]);
    let names = ["force_before", "force_after", "drop", "slip"];
    for table in ["events.csv", "ensemble_events.csv"] {
        let events = std::fs::read_to_string(folder.path().join("laboratory").join(table)).unwrap();
        for ((name, computed), measured) in names.iter().zip(columns(&events, names)).zip(&measured) {
            let ((computed, _), (mean, std)) = (mean_and_std(&computed), mean_and_std(measured));
            println!("{table}: {name} {computed:.5}, measured {mean:.5} ± {std:.5}");
            assert!((computed - mean).abs() < std, "{table}: {name} {computed}, measured {mean} ± {std}");
        }
    }
}
