//! Published results, computed by the shipped scenarios: the numbers of agreement on the page `docs/gallery.md`.

use std::path::Path;

use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity_runner::{input, output::Outcome};

fn run(name: &str, overrides: &[&str]) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(format!("{name}.toml"));
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let scenario = Scenario { ensemble: None, ..input::read(&path, &overrides).unwrap().scenario };
    asperity_runner::run(&scenario, &mut ()).unwrap()
}

fn column<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn look() {
    let thermal = run("velocity-curve-thermal", &[]).record;
    let (v, f, c) = (
        column(&thermal, "velocity"),
        column(&thermal, "kinetic_friction"),
        column(&thermal, "creep_friction"),
    );
    for t in 0..3 {
        let at = |k: usize| (v[k], f[t * v.len() + k], c[t * v.len() + k]);
        println!("{:?}", (0..v.len()).map(at).collect::<Vec<_>>());
    }
    let delay = run("velocity-curve-delay", &[]).record;
    let (v, f) = (column(&delay, "velocity"), column(&delay, "kinetic_friction"));
    println!("delay {:?}", v.iter().zip(f).collect::<Vec<_>>());
    let ageing = run("velocity-curve-ageing", &["velocity_curve.points=4"]).record;
    println!(
        "ageing {:?}",
        column(&ageing, "velocity").iter().zip(column(&ageing, "kinetic_friction")).collect::<Vec<_>>()
    );
    println!("healing {}", serde_json::to_string(&run("healing", &[]).summary).unwrap());
    println!("step {}", serde_json::to_string(&run("velocity-step", &[]).summary).unwrap());
    let chain = run("precursors-edge", &[]).record;
    let events: Vec<_> = ["event_drive", "event_force_before", "event_cells", "event_epicentre"]
        .map(|name| column(&chain, name))
        .to_vec();
    for k in 0..events[0].len() {
        if events[2][k] > 0.0 {
            print!("({:.2} {:.3} {} {}) ", events[0][k], events[1][k], events[2][k], events[3][k]);
        }
    }
    println!();
    let ofc = run("ofc", &[]).record;
    let (drive, size) = (column(&ofc, "event_drive"), column(&ofc, "event_size"));
    println!("ofc {} events", drive.len());
    let at = column(&ofc, "event_epicentre");
    let near = |a: f64, b: f64| {
        let (a, b) = (a as i64, b as i64);
        ((a / 64 - b / 64).abs()).max((a % 64 - b % 64).abs()) <= 8
    };
    for least in [30.0, 100.0, 300.0] {
        let mains: Vec<usize> =
            (0..drive.len()).filter(|&k| size[k] >= least && drive[k] > 301.0 && drive[k] < 319.0).collect();
        let long: f64 =
            mains.iter().map(|&m| (0..drive.len()).filter(|&k| near(at[k], at[m])).count()).sum::<usize>()
                as f64
                / 20.0;
        for window in [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3] {
            let count = |low: f64, high: f64| {
                mains
                    .iter()
                    .map(|&m| {
                        drive
                            .iter()
                            .enumerate()
                            .filter(|&(k, &d)| {
                                k != m && d > drive[m] + low && d <= drive[m] + high && near(at[k], at[m])
                            })
                            .count()
                    })
                    .sum::<usize>() as f64
                    / (window * long)
            };
            println!(
                "{least} {} mains, window {window}: before {:.2}, after {:.2}",
                mains.len(),
                count(-window, 0.0),
                count(0.0, window)
            );
        }
    }
}
