//! Computed stick-slip beside measured events, where the folder of laboratory data is known.
//!
//! `ASPERITY_LAB_DATA` names the folder; without it there is nothing to compare with, and the test says so.

mod support;

use std::path::PathBuf;

use asperity::rate_state::{MeasuredVelocityStep, StepReading};

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

/// Intercept and slope of a line by least squares, each with its standard error.
fn line(x: &[f64], y: &[f64]) -> [(f64, f64); 2] {
    let n = x.len() as f64;
    let (x_mean, y_mean) = (mean_and_std(x).0, mean_and_std(y).0);
    let squares: f64 = x.iter().map(|x| (x - x_mean).powi(2)).sum();
    let slope = x.iter().zip(y).map(|(x, y)| (x - x_mean) * y).sum::<f64>() / squares;
    let intercept = y_mean - slope * x_mean;
    let left: f64 = x.iter().zip(y).map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    let variance = left / (n - 2.0);
    let errors = [variance * (1.0 / n + x_mean * x_mean / squares), variance / squares].map(f64::sqrt);
    [(intercept, errors[0]), (slope, errors[1])]
}

/// The numbers of `docs/undetermined.md`: a catalogue knows the ends of each loading only, and the last one is where the block
/// fails. A loading at a constant rate would make the rise of the stress proportional to the waiting time; it hardly depends on it.
#[test]
fn a_catalogue_of_events_does_not_determine_the_stiffness_of_loading() {
    let Some(data) = std::env::var_os("ASPERITY_LAB_DATA").filter(|name| !name.is_empty()).map(PathBuf::from)
    else {
        println!("skipped: ASPERITY_LAB_DATA is not set");
        return;
    };
    let file = data.join("stick-slip-events-okubo-2025/Macroscopic_stats_FB03_087.csv");
    let catalogue = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let names = [
        "event_starttime[s]",
        "macroshearstress_beforeevent[MPa]",
        "macroshearstress_afterevent[MPa]",
        "macroshearstress_drop[MPa]",
        "slip_mean[mm]",
    ];
    let [time, before, after, drop, slip] = columns(&catalogue, names);
    let waits: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rises: Vec<f64> = before[1..].iter().zip(&after).map(|(before, after)| before - after).collect();
    let rates: Vec<f64> = rises.iter().zip(&waits).map(|(rise, wait)| rise / wait).collect();
    let [at_once, rate] = line(&waits, &rises);
    println!("rises {at_once:?} MPa and {rate:?} MPa/s, rates {:?}", mean_and_std(&rates));
    // Numbers of the page, to half of their last digits.
    let reported = |found: f64, page: f64, digit: f64| (found - page).abs() < 0.5 * digit;
    assert!(reported(at_once.0, 0.0170, 1e-4) && reported(at_once.1, 0.0006, 1e-4), "{at_once:?}");
    assert!(reported(rate.0, 0.00074, 1e-5) && reported(rate.1, 0.00014, 1e-5), "{rate:?}");
    assert!(reported(mean_and_std(&rates).0, 0.0057, 1e-4), "{rates:?}");
    let [_, stiffness] = line(&slip, &drop);
    let [offset, of_most] = line(&slip[1..], &drop[1..]);
    println!("drop over slip {stiffness:?}, without the first event {of_most:?} beside {offset:?}");
    assert!(reported(stiffness.0, 0.588, 1e-3) && reported(stiffness.1, 0.014, 1e-3), "{stiffness:?}");
    assert!(reported(of_most.0, 0.675, 1e-3) && reported(of_most.1, 0.035, 1e-3), "{of_most:?}");
}

/// Columns of a tab-separated file, in order.
fn tabs<const N: usize>(text: &str) -> [Vec<f64>; N] {
    let mut columns = [const { Vec::new() }; N];
    for line in text.lines().skip(1) {
        for (column, cell) in columns.iter_mut().zip(line.split('\t')) {
            column.push(cell.trim().parse().expect("a number"));
        }
    }
    columns
}

/// Means of rows, so many at a time.
fn averaged(values: &[f64], many: usize) -> Vec<f64> {
    values.chunks_exact(many).map(|part| part.iter().sum::<f64>() / many as f64).collect()
}

/// Two measured steps up, read from 100 µm before to 300 µm after the step, and drawn beside a computed one. Basalt
/// (3 → 10 µm/s) peaks at once and falls back to where it was, with a and b of about 0.008 and D_c of some
/// µm, as of many rocks; sepiolite (0.2 → 2 µm/s) strengthens, so slowly that its loading, of unknown
/// stiffness, hides a direct effect. Errors of white noise are smaller than those with drift, most of all
/// those of F₀ and a − b.
#[test]
fn measured_velocity_steps_are_read_and_drawn_beside_a_computed_one() {
    let Some(data) = std::env::var_os("ASPERITY_LAB_DATA").filter(|name| !name.is_empty()).map(PathBuf::from)
    else {
        println!("skipped: ASPERITY_LAB_DATA is not set");
        return;
    };
    let folder = Folder::new();
    let scenario = scenarios().join("velocity-step.toml");
    for (name, speeds, many, strengthens) in [
        ("velstep3_TR2_exp013_sepiolite.txt", (0.2, 2.0), 20, true),
        ("velstep4_BRAVA_expb819_basalt.txt", (3.0, 10.0), 10, false),
    ] {
        let file = data.join("velocity-steps-giacomel-2024").join(name);
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let [time, way, friction, _] = tabs::<4>(&text);
        let [time, way, friction] = [time, way, friction].map(|column| averaged(&column, many));
        let between = f64::sqrt(speeds.0 * speeds.1);
        let fast = |i: &usize| (way[i + 1] - way[*i]) / (time[i + 1] - time[*i]) > between;
        let step = (0..way.len() - 1).find(fast).expect("a step");
        let near: Vec<usize> =
            (0..way.len()).filter(|&i| (-100.0..=300.0).contains(&(way[i] - way[step]))).collect();
        let position: Vec<f64> = near.iter().map(|&i| way[i] - way[step]).collect();
        let force: Vec<f64> = near.iter().map(|&i| friction[i]).collect();
        let read = |drift: bool| {
            let reading = StepReading { drift, ..StepReading::default() };
            MeasuredVelocityStep::read(&position, &force, speeds.1 / speeds.0, &reading, &mut ()).unwrap()
        };
        let (read, white) = (read(true), read(false));
        println!("{name}: a {:?}, b {:?}, a - b {:?}", read.direct, read.evolution, read.steady);
        println!("D_c {:?}, with white noise {:?}", read.distance, white.distance);
        println!(
            "F_0 {:?}, {:?}, whiteness {:?}, {:?}",
            read.before, white.before, read.whiteness, white.whiteness
        );
        assert!(read.before.error > 3.0 * white.before.error, "{name}: {read:?}");
        if strengthens {
            assert!(read.steady.value > 4.0 * read.steady.error && read.peak == 0.0, "{name}: {read:?}");
        } else {
            assert!(read.steady.value.abs() < 2.0 * read.steady.error, "{name}: {read:?}");
            assert!(read.direct.value > 4.0 * read.direct.error, "{name}: {read:?}");
            assert!((5.5..8.0).contains(&read.distance.value), "{name}: {read:?}");
            assert!((0.4..0.7).contains(&read.distance.error), "{name}: {read:?}");
            assert!(white.distance.error < 0.8 * read.distance.error, "{name}: {white:?}");
        }
        // in units of the scenario: its step is at X = 10, a mean threshold stands for 10 µm
        let rows = way.iter().zip(&friction).map(|(x, f)| (10.0 + (x - way[step]) / 10.0, f));
        let rows = rows.filter(|row| (9.0..=20.0).contains(&row.0));
        let table: String = rows.map(|(x, f)| format!("{x},{f}\n")).collect();
        folder.write("step.csv", &format!("position,force\n{table}"));
        folder.write("step.toml", &std::fs::read_to_string(&scenario).unwrap());
        folder.succeed(&["run", "step.toml", "--quiet", "--set", "compare.file=\"step.csv\""]);
        let picture = std::fs::read_to_string(folder.path().join("out/step/velocity_step.svg")).unwrap();
        for text in ["rate-and-state fit", ">measured<", "fit of measured"] {
            assert!(picture.contains(text), "{name}: {text}");
        }
        let summary = std::fs::read_to_string(folder.path().join("out/step/summary.json")).unwrap();
        assert!(summary.contains("\"measured\""), "{summary}");
    }
}
