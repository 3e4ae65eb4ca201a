//! Result folders: what is written reads back, and a folder is replaced whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::record::{Quantity, Record};
use asperity::scenario::Units;
use asperity::task::summary::{Extended, Friction, Numbers, PullNumbers, StaticFriction, Summary};
use asperity_runner::output::{self, Attachment, Error, Only, Outcome};
use netcdf_reader::NcFile;
use netcdf_writer::{NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions};

fn record(seed: u64) -> Record {
    let mut record = Record::default();
    let position: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i)).collect();
    let force = position.iter().map(|x| (x * (seed as f64 + 0.3)).sin() / 3.0).collect();
    record.push("position", "position of the slider's base", Quantity::Length, &["position"], position);
    record.push("force", "friction force", Quantity::Force, &["position"], force);
    record.push("breaking_rate", "breaking rate", Quantity::PerLength, &["position"], vec![1e-7 / 3.0; 40]);
    record.push("snapshot", "position", Quantity::Length, &["snapshot"], vec![0.0, 20.0]);
    record.push("stretch", "stretch", Quantity::Length, &["stretch"], vec![0.0, 0.5, 1.0]);
    let density = vec![0.0, f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, -0.0];
    record.push("stretch_density", "density", Quantity::PerLength, &["snapshot", "stretch"], density);
    record.push("breaking_atom_position", "position", Quantity::Length, &["breaking_atom"], vec![1.0]);
    record.push("breaking_atom_weight", "weight", Quantity::Number, &["breaking_atom"], vec![1.0 / 3.0]);
    record.push("contacts", "number of contacts", Quantity::Number, &[], vec![17.0]);
    record
}

fn outcome(seed: u64) -> Outcome {
    Outcome {
        scenario: format!("title = \"τ\"\n# {}\n", "long ".repeat(20_000)),
        summary: Summary {
            title: "τ, the title".into(),
            version: "0.1.0".into(),
            units: Units { length: "µm".into(), force: "MPa".into(), time: String::new() },
            accuracy: Some(1e-11),
            contacts: 1.0,
            background_force: None,
            normal_load: None,
            sample: None,
            seed: Some(u64::MAX - seed),
            disorder: None,
            numbers: Numbers::Pull(PullNumbers {
                derivatives: Vec::new(),
                friction: Friction {
                    static_friction: StaticFriction::Reached { force: 0.1 + 0.2, position: 1.0 / 3.0 },
                    kinetic_friction: 0.50125,
                    relaxation_length: Extended(20.270_485_418_3),
                    relaxation_length_paper: Extended(20.0),
                    critical_stiffness: Extended(f64::INFINITY),
                    friction_coefficients: None,
                },
                compare: None,
            }),
            warnings: Vec::new(),
        },
        record: record(seed),
    }
}

fn place() -> (tempfile::TempDir, PathBuf) {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path().join("out").join("run");
    (base, dir)
}

/// Every path under `dir`, with the contents of files.
fn contents(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.push((path.clone(), Vec::new()));
            found.extend(contents(&path));
        } else {
            let bytes = fs::read(&path).unwrap();
            found.push((path, bytes));
        }
    }
    found.sort();
    found
}

#[test]
fn what_is_written_reads_back_exactly() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let back = output::read(&dir).unwrap();
    assert_eq!(back, outcome(1));
    let bits = |o: &Outcome| {
        let values = o.record.variables.iter().flat_map(|v| &v.values);
        values.map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(bits(&back), bits(&outcome(1)));
}

/// `result.nc` with attributes and nothing else.
fn with_attributes(attributes: &[(&str, NcAttrValue)]) -> Vec<u8> {
    let mut file = NcFileBuilder::new();
    for (name, value) in attributes {
        file.add_attribute(*name, value.clone()).unwrap();
    }
    file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 }).unwrap().1
}

#[test]
fn a_file_states_its_form_and_one_of_a_later_form_is_refused() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let path = dir.join("result.nc");
    let file = NcFile::from_vec(fs::read(&path).unwrap()).unwrap();
    assert_eq!(file.global_attribute("format_version").unwrap().value.as_f64(), Some(output::FORMAT as f64));
    let later = [
        ("format_version", NcAttrValue::Int64s(vec![output::FORMAT + 1])),
        ("version", NcAttrValue::Chars("9.0.0".into())),
    ];
    fs::write(&path, with_attributes(&later)).unwrap();
    let error = output::read(&dir).unwrap_err();
    assert!(matches!(error, Error::Newer { .. }), "{error:?}");
    let text = error.to_string();
    assert!(text.contains("its format_version is 2, written by asperity 9.0.0; this version, "), "{text}");
    assert!(text.ends_with("reads 1 and below: install a later one"), "{text}");
    // Files of drafts before 0.1.0 state none.
    fs::write(&path, with_attributes(&[])).unwrap();
    assert!(output::read(&dir).unwrap().record.variables.is_empty());
}

#[test]
fn a_summary_that_names_no_task_is_read_as_before() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let path = dir.join("summary.json");
    let text = fs::read_to_string(&path).unwrap();
    let without = text.replace("  \"task\": \"pull\",\n", "");
    assert_ne!(without, text);
    fs::write(&path, without).unwrap();
    assert_eq!(output::read(&dir).unwrap(), outcome(1));
}

#[test]
fn csv_holds_the_same_numbers() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let text = fs::read_to_string(dir.join("force.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("position,force,breaking_rate"));
    let force: Vec<f64> = lines.map(|l| l.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert_eq!(Some(force.as_slice()), outcome(1).record.values("force"));
    let atoms = fs::read_to_string(dir.join("atoms.csv")).unwrap();
    assert_eq!(atoms, "distribution,position,stretch,weight\nbreaking_rate,1,,0.3333333333333333\n");
}

#[test]
fn the_same_outcome_gives_the_same_bytes() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let first = contents(&dir);
    std::thread::sleep(std::time::Duration::from_millis(1100));
    output::write(&dir, &outcome(1), &[]).unwrap();
    assert_eq!(contents(&dir), first);
}

#[test]
fn our_own_folder_is_replaced_whole() {
    let (base, dir) = place();
    let picture = Attachment { name: "force.svg".into(), bytes: b"<svg/>".to_vec() };
    output::write(&dir, &outcome(1), &[picture]).unwrap();
    output::write(&dir, &outcome(2), &[]).unwrap();
    assert_eq!(output::read(&dir).unwrap(), outcome(2));
    assert!(!dir.join("force.svg").exists());
    assert_eq!(fs::read_dir(base.path().join("out")).unwrap().count(), 1);
}

#[test]
fn files_of_others_stay_in_a_folder_that_is_replaced() {
    let (base, dir) = place();
    let picture = Attachment { name: "force.svg".into(), bytes: b"<svg/>".to_vec() };
    output::write(&dir, &outcome(1), std::slice::from_ref(&picture)).unwrap();
    fs::write(dir.join("notes.txt"), "seen").unwrap();
    fs::create_dir(dir.join("drafts")).unwrap();
    fs::write(dir.join("drafts/force.svg"), "<svg></svg>").unwrap();
    let renamed = output::write(&dir, &outcome(2), &[]).unwrap().renamed;
    assert_eq!(renamed, []);
    assert_eq!(output::read(&dir).unwrap(), outcome(2));
    assert_eq!(fs::read_to_string(dir.join("notes.txt")).unwrap(), "seen");
    assert_eq!(fs::read_to_string(dir.join("drafts/force.svg")).unwrap(), "<svg></svg>");
    assert!(!dir.join("force.svg").exists(), "a picture of the run before");
    assert_eq!(fs::read_dir(base.path().join("out")).unwrap().count(), 1);
}

#[test]
fn files_that_were_changed_get_another_name() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    for (text, kept) in [("edited", "summary.json.kept"), ("again", "summary.json.kept2")] {
        fs::write(dir.join("summary.json"), text).unwrap();
        let renamed = output::write(&dir, &outcome(1), &[]).unwrap().renamed;
        let names: Vec<_> = renamed.iter().map(|file| (file.from.file_name(), file.to.file_name())).collect();
        assert_eq!(names, [(Some("summary.json".as_ref()), Some(kept.as_ref()))]);
        assert_eq!(fs::read_to_string(dir.join(kept)).unwrap(), text);
        assert_eq!(output::read(&dir).unwrap(), outcome(1));
    }
    assert_eq!(fs::read_to_string(dir.join("summary.json.kept")).unwrap(), "edited");
}

#[test]
fn files_that_were_changed_do_not_stay_beside_results_without_them() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    fs::write(dir.join("force.csv"), "edited").unwrap();
    let only = Only { csv: false, ..Only::ALL };
    let renamed = output::write_only(&dir, (&outcome(2), None), &[], only).unwrap().renamed;
    assert_eq!(renamed.len(), 1);
    assert!(!dir.join("force.csv").exists());
    assert_eq!(fs::read_to_string(dir.join("force.csv.kept")).unwrap(), "edited");
}

#[test]
fn results_without_what_is_read_say_so() {
    let (_base, dir) = place();
    for only in [Only { json: false, ..Only::ALL }, Only { netcdf: false, ..Only::ALL }] {
        output::write_only(&dir, (&outcome(1), None), &[], only).unwrap();
        let refused = output::read(&dir).unwrap_err().to_string();
        let file = if only.json { "result.nc" } else { "summary.json" };
        assert!(refused.contains(&format!("{file}: cannot read: not in this folder")), "{refused}");
    }
}

#[test]
fn an_empty_folder_is_taken() {
    let (base, dir) = place();
    fs::create_dir_all(&dir).unwrap();
    output::check(&dir).unwrap();
    assert_eq!(output::write(&dir, &outcome(1), &[]).unwrap().renamed, []);
    assert_eq!(output::read(&dir).unwrap(), outcome(1));
    assert_eq!(fs::read_dir(base.path().join("out")).unwrap().count(), 1);
}

#[test]
fn a_folder_that_does_not_list_its_files_is_refused() {
    let (base, dir) = place();
    fs::create_dir_all(&dir).unwrap();
    fs::write(dir.join(".asperity"), "made by asperity 0.1.0\n").unwrap();
    fs::write(dir.join("force.csv"), "mine or not").unwrap();
    let before = contents(base.path());
    assert!(matches!(output::check(&dir), Err(Error::Foreign { .. })));
    assert!(matches!(output::write(&dir, &outcome(1), &[]), Err(Error::Foreign { .. })));
    assert_eq!(contents(base.path()), before);
}

/// In a container every run has the same process number.
#[test]
fn what_a_killed_run_left_is_in_nobodys_way() {
    let (base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let left = base.path().join("out").join(format!(".run.{}-0.partial", std::process::id()));
    fs::create_dir(&left).unwrap();
    fs::write(left.join("summary.json"), "half").unwrap();
    output::check(&dir).unwrap();
    output::write(&dir, &outcome(2), &[]).unwrap();
    assert_eq!(output::read(&dir).unwrap(), outcome(2));
}

#[test]
fn what_others_made_is_refused_and_left_alone() {
    let (base, dir) = place();
    fs::create_dir_all(&dir).unwrap();
    fs::write(dir.join("thesis.tex"), "years of work").unwrap();
    let file = base.path().join("file");
    fs::write(&file, "a file").unwrap();
    let before = contents(base.path());
    for target in [&dir, &file] {
        assert!(matches!(output::check(target), Err(Error::Foreign { .. })));
        assert!(matches!(output::write(target, &outcome(1), &[]), Err(Error::Foreign { .. })));
    }
    assert_eq!(contents(base.path()), before);
}

#[test]
fn a_failing_write_leaves_everything_as_it_was() {
    let (base, dir) = place();
    let twice = Attachment { name: "summary.json".into(), bytes: Vec::new() };
    let nowhere = Attachment { name: "no/such/folder.svg".into(), bytes: Vec::new() };
    for bad in [twice, nowhere] {
        assert!(matches!(output::write(&dir, &outcome(1), &[bad]), Err(Error::System { .. })));
        assert_eq!(fs::read_dir(base.path()).unwrap().count(), 0);
    }
    output::write(&dir, &outcome(1), &[]).unwrap();
    let before = contents(base.path());
    let nowhere = Attachment { name: "no/such/folder.svg".into(), bytes: Vec::new() };
    output::write(&dir, &outcome(2), &[nowhere]).unwrap_err();
    assert_eq!(contents(base.path()), before);
}

#[test]
fn a_parent_that_is_a_file_is_an_error_that_names_it() {
    let (base, _) = place();
    fs::write(base.path().join("file"), "").unwrap();
    let error = output::check(&base.path().join("file").join("run")).unwrap_err();
    assert!(matches!(error, Error::System { .. }));
    assert!(error.to_string().contains("file"), "{error}");
}

#[test]
fn checking_leaves_no_trace() {
    let (base, dir) = place();
    output::check(&dir).unwrap();
    assert_eq!(fs::read_dir(base.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn a_link_to_our_folder_stays_a_link() {
    let (base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    let link = base.path().join("latest");
    std::os::unix::fs::symlink(&dir, &link).unwrap();
    output::write(&link, &outcome(2), &[]).unwrap();
    assert!(link.is_symlink());
    assert_eq!(output::read(&dir).unwrap(), outcome(2));
}

#[test]
fn a_broken_result_file_is_named() {
    let (_base, dir) = place();
    output::write(&dir, &outcome(1), &[]).unwrap();
    fs::write(dir.join("result.nc"), "no").unwrap();
    let error = output::read(&dir).unwrap_err();
    assert!(matches!(&error, Error::Malformed { path, .. } if path.ends_with("result.nc")), "{error}");
}
