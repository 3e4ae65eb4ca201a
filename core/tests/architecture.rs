//! The modules of `core/src` as ARCHITECTURE.md lists them: imports point down, and nothing is printed or read. Modules of the other
//! crates import each other in no circle.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What the core leaves to its front ends.
const FOREIGN: [&str; 6] = ["print!", "println!", "dbg!", "std::fs", "std::env", "std::process"];

/// The level whose modules may import each other.
const LOWEST: u32 = 0;

/// Names that more than one type has, and why.
const SHARED: [(&[&str], &str); 3] = [
    (
        &[
            "Ageing",
            "Block",
            "Contacts",
            "Drive",
            "Ensemble",
            "Fit",
            "Interface",
            "Law",
            "MasterEquation",
            "Pull",
            "Tabulated",
        ],
        "a table of a scenario has the name of what it describes",
    ),
    (&["Curve", "Event"], "of a block and of an interface"),
    (
        &["Cohort", "Gamma", "Gaussian", "Point", "Rectangular"],
        "a distribution and its closed forms; a point of a trace; a cohort at one velocity, and at any",
    ),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Levels by module, from the rows `| level | modules | … |` of the page.
fn levels() -> BTreeMap<String, u32> {
    let page = std::fs::read_to_string(root().join("../ARCHITECTURE.md")).unwrap();
    let mut levels = BTreeMap::new();
    for row in page.lines().filter_map(|line| line.strip_prefix("| ")) {
        let mut cells = row.split(" | ");
        let (Some(Ok(level)), Some(names)) = (cells.next().map(str::parse), cells.next()) else { continue };
        for module in names.split('`').skip(1).step_by(2) {
            levels.insert(module.to_owned(), level);
        }
    }
    levels
}

/// Every file of a folder and of those in it.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
    files
}

/// The code of a file, without comments.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).map(|line| format!("{line}\n")).collect()
}

/// The module of `core/src` to which a file belongs.
fn top_module(path: &Path) -> String {
    let first = path.strip_prefix(root().join("src")).unwrap().components().next().unwrap();
    first.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned()
}

/// The modules that `code` names behind `crate::`, in lists too.
fn imports(code: &str) -> Vec<String> {
    named_after(code, "crate::")
}

/// The names behind a path, in lists too.
fn named_after(code: &str, path: &str) -> Vec<String> {
    let whole = code.match_indices(path).filter(|(at, _)| !code[..*at].ends_with("::"));
    let starts = whole.map(|(at, found)| &code[at + found.len()..]);
    starts.flat_map(|rest| rest.strip_prefix('{').map_or_else(|| vec![name(rest)], listed)).collect()
}

/// The names at the outer level of a list in braces, after its opening one.
fn listed(list: &str) -> Vec<String> {
    let (mut depth, mut expected, mut names) = (1, true, Vec::new());
    for (at, letter) in list.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 1 => break,
            '}' => depth -= 1,
            ',' if depth == 1 => expected = true,
            _ if expected && !letter.is_whitespace() => {
                names.push(name(&list[at..]));
                expected = false;
            }
            _ => {}
        }
    }
    names
}

fn name(text: &str) -> String {
    text.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

/// What is wrong with `from` using `to`, if anything.
fn objection(levels: &BTreeMap<String, u32>, from: &str, to: &str) -> Option<String> {
    let (Some(&above), Some(&below)) = (levels.get(from), levels.get(to)) else {
        return Some(format!("{from} uses {to}: one of them is not in ARCHITECTURE.md"));
    };
    let down = below < above || from == to || (above, below) == (LOWEST, LOWEST);
    (!down).then(|| format!("{from} on level {above} uses {to} on level {below}"))
}

#[test]
fn imports_point_down() {
    let levels = levels();
    assert!(levels.len() > 10, "too few names in ARCHITECTURE.md: {levels:?}");
    let mut objections = Vec::new();
    for path in sources(&root().join("src")) {
        let from = top_module(&path);
        if from == "lib" {
            continue;
        }
        // What the crate shows at its top is `error`.
        let names = imports(&code(&path)).into_iter().map(|to| match to.as_str() {
            "Error" | "Float" | "Result" => "error".to_owned(),
            _ => to,
        });
        let found = names.filter_map(|to| objection(&levels, &from, &to));
        objections.extend(found.map(|objection| format!("{}: {objection}", path.display())));
    }
    assert!(objections.is_empty(), "{}", objections.join("\n"));
}

/// The modules of a folder, each with its files.
fn modules(folder: &Path) -> BTreeMap<String, Vec<PathBuf>> {
    let mut modules: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for path in sources(folder) {
        let first = path.strip_prefix(folder).unwrap().components().next().unwrap();
        let name = first.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned();
        modules.entry(name).or_default().push(path);
    }
    modules.remove("mod");
    modules
}

/// The modules of `folder` that a file in it or below imports, those of its tests aside.
fn siblings(folder: &Path, path: &Path) -> Vec<String> {
    let inside = folder.strip_prefix(root().join("src")).unwrap();
    let inside = inside.components().map(|part| format!("{}::", part.as_os_str().to_str().unwrap()));
    named_in(folder, path, &format!("crate::{}", inside.collect::<String>()))
}

/// The names behind the path of `folder` in a file in it or below, those of its tests aside.
fn named_in(folder: &Path, path: &Path, absolute: &str) -> Vec<String> {
    let code = code(path);
    let own = code.split("#[cfg(test)]").next().unwrap_or_default();
    let below = path.strip_prefix(folder).unwrap();
    let depth =
        below.components().count() - usize::from(below.file_name().is_some_and(|name| name == "mod.rs"));
    let mut found = named_after(own, &"super::".repeat(depth));
    found.extend(named_after(own, absolute));
    found
}

#[test]
fn modules_of_a_folder_do_not_import_each_other_both_ways() {
    let mut folders: Vec<PathBuf> = sources(&root().join("src"))
        .into_iter()
        .filter_map(|path| path.parent().map(Path::to_owned))
        .filter(|folder| *folder != root().join("src"))
        .collect();
    folders.sort();
    folders.dedup();
    let mut circles = Vec::new();
    for folder in folders {
        let modules = modules(&folder);
        let uses = |from: &str, to: &str| {
            modules[from].iter().any(|path| siblings(&folder, path).iter().any(|name| name == to))
        };
        let names: Vec<&String> = modules.keys().collect();
        for (i, one) in names.iter().enumerate() {
            for other in &names[i + 1..] {
                if uses(one, other) && uses(other, one) {
                    circles.push(format!("{}: {one} and {other}", folder.display()));
                }
            }
        }
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

/// The modules that are left once those which use none of the others are taken away, again and again.
fn in_circles(mut uses: BTreeMap<String, Vec<String>>) -> Vec<String> {
    while let Some(lowest) =
        uses.iter().find(|(from, all)| !all.iter().any(|to| to != *from && uses.contains_key(to)))
    {
        let lowest = lowest.0.clone();
        uses.remove(&lowest);
    }
    uses.into_keys().collect()
}

/// For each module of another crate those it imports, its tests aside.
fn used_in_crate(source: &Path) -> BTreeMap<String, Vec<String>> {
    let mut all = modules(source);
    // They declare the modules.
    all.retain(|name, _| !["lib", "main"].contains(&name.as_str()));
    let used =
        |files: Vec<PathBuf>| files.iter().flat_map(|path| named_in(source, path, "crate::")).collect();
    all.into_iter().map(|(name, files)| (name, used(files))).collect()
}

#[test]
fn modules_of_other_crates_are_in_no_circle() {
    for name in ["runner", "engine", "cli", "python"] {
        let uses = used_in_crate(&root().join("..").join(name).join("src"));
        assert!(uses.values().any(|used| !used.is_empty()), "{name}: no imports were found");
        assert_eq!(
            in_circles(uses),
            [""; 0],
            "{name}: these modules import each other in a circle, or one that does"
        );
    }
}

#[test]
fn circles_are_found() {
    let uses = [("a", "b"), ("b", "c"), ("c", "b"), ("d", "x")];
    let uses = uses.map(|(from, to)| (from.to_owned(), vec![to.to_owned()]));
    assert_eq!(in_circles(uses.into()), ["a", "b", "c"]);
}

#[test]
fn the_core_neither_prints_nor_opens_files() {
    for path in sources(&root().join("src")) {
        let code = code(&path);
        let found = FOREIGN.iter().find(|word| code.contains(*word));
        assert_eq!(found, None, "{}", path.display());
    }
}

/// The names of the types that `code` defines, but for those of its tests.
fn types(code: &str) -> Vec<String> {
    let own = code.split("#[cfg(test)]").next().unwrap_or_default();
    let kinds = ["struct ", "enum ", "trait ", "type ", "union "];
    let defined = |line: &str| {
        let line = line.strip_prefix("pub").map_or(line, |rest| match rest.strip_prefix('(') {
            Some(rest) => rest.split_once(')').map_or("", |(_, rest)| rest),
            None => rest,
        });
        kinds.iter().find_map(|kind| line.trim_start().strip_prefix(kind)).map(name)
    };
    // Those in macros are indented; what else is indented belongs to a trait.
    let outer = |line: &&str| !line.starts_with(' ') || line.trim_start().starts_with("pub enum ");
    own.lines().filter(outer).map(str::trim_start).filter_map(defined).collect()
}

#[test]
fn a_type_has_a_name_of_its_own() {
    let mut places: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for path in sources(&root().join("src")) {
        for found in types(&code(&path)) {
            places.entry(found).or_default().push(path.clone());
        }
    }
    let twice: Vec<&str> =
        places.iter().filter(|(_, paths)| paths.len() > 1).map(|(name, _)| name.as_str()).collect();
    let mut allowed: Vec<&str> = SHARED.iter().flat_map(|(names, _)| names.iter().copied()).collect();
    allowed.sort_unstable();
    // A name that no longer has two meanings leaves the list.
    assert_eq!(twice, allowed, "{places:#?}");
}

/// Types with which users begin, each with the file whose documentation shows its use.
const ENTRIES: [(&str, &str); 23] = [
    ("MasterEquation", "master/mod.rs"),
    ("Pull", "master/pull.rs"),
    ("SteadyState", "master/steady.rs"),
    ("Relaxation", "master/relaxation.rs"),
    ("Transport", "master/transport/mod.rs"),
    ("Ensemble", "ensemble/mod.rs"),
    ("Lattice", "ensemble/lattice/mod.rs"),
    ("Block", "block/mod.rs"),
    ("BlockSimulation", "block/simulation.rs"),
    ("Interface", "elastic/mod.rs"),
    ("RateDependentInterface", "elastic/rate_dependent/mod.rs"),
    ("Fit", "fit/mod.rs"),
    ("SteadyFit", "fit/steady/mod.rs"),
    ("VelocityCurveFit", "fit/velocity_curve/mod.rs"),
    ("Scenario", "scenario/mod.rs"),
    ("Life", "life/mod.rs"),
    ("Gaussian", "exact/gaussian.rs"),
    ("FirstBreaks", "first_breaks.rs"),
    ("History", "history/mod.rs"),
    ("VelocityStep", "rate_state/velocity_step.rs"),
    ("Healing", "rate_state/healing.rs"),
    ("Record", "record.rs"),
    ("Stream", "random.rs"),
];

/// The documentation of a type that `text` defines, and that of its module.
fn documentation<'a>(text: &'a str, wanted: &str) -> impl Iterator<Item = &'a str> {
    let lines: Vec<&str> = text.lines().collect();
    let kinds = ["pub struct ", "pub enum ", "pub trait "];
    let named = |line: &&str| {
        kinds.iter().filter_map(|kind| line.strip_prefix(kind)).any(|rest| name(rest) == wanted)
    };
    let at = lines.iter().position(named).unwrap_or_else(|| panic!("no {wanted}"));
    let own = lines[..at]
        .iter()
        .rev()
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("///"));
    let own: Vec<&str> = own.collect();
    own.into_iter().chain(text.lines().filter_map(|line| line.strip_prefix("//!")))
}

#[test]
fn types_with_which_users_begin_show_their_use() {
    for (name, file) in ENTRIES {
        let text = std::fs::read_to_string(root().join("src").join(file)).unwrap();
        let blocks = documentation(&text, name).filter(|line| line.trim() == "```").count();
        assert!(blocks >= 2, "the documentation of {name} in {file} has no example");
    }
}

#[test]
fn types_are_found() {
    let code = "pub struct One<T>(T);\nenum Two {}\npub(super) trait Three {\n    type Four;\n}\ntype Five = u8;\n#[cfg(test)]\nstruct Six;";
    assert_eq!(types(code), ["One", "Two", "Three", "Five"]);
}

#[test]
fn imports_are_found_and_upward_ones_refused() {
    let code = "use crate::{Error, law::{Law, Point}, master};\nlet x = crate::life::Life;";
    assert_eq!(imports(code), ["Error", "law", "master", "life"]);
    let levels = levels();
    for (from, to) in [("law", "master"), ("ensemble", "master"), ("numerics", "law"), ("law", "cellar")] {
        assert!(objection(&levels, from, to).is_some(), "{from} uses {to}");
    }
    for (from, to) in [("master", "life"), ("law", "law"), ("numerics", "monitor")] {
        assert_eq!(objection(&levels, from, to), None);
    }
}
