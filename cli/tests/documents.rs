//! What the documents show is run: every scenario, command, output, key and link.
//!
//! Code blocks have a language. `toml` is a valid scenario; one that begins with `# NAME` is kept under that
//! name for the commands after it. `console` is commands (`$ …`) and what they print, to the letter; with `fails` behind
//! it, of the errors too, and the exit code is not 0. `sh` is a command whose `make` target exists. `rust` is run with the
//! documentation of the core, `python` with its `output` and `pycon` by python/tests and docs/test_pages.py.
//! `text` and `math` are not run; what begins with a brace is for the site, and `make docs` sees to it.

mod support;
#[path = "../examples/keys/table.rs"]
mod table;
#[path = "../examples/variables/page.rs"]
mod variables;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::{Folder, names, scenarios};

/// The folder of the project.
fn root() -> PathBuf {
    scenarios().parent().unwrap().to_owned()
}

/// Every document with its text, by path from the root.
fn documents() -> Vec<(String, String)> {
    let pages = |folder: &str| {
        let names = names(&root().join(folder)).into_iter().filter(|name| name.ends_with(".md"));
        names.map(|name| format!("{folder}{name}")).collect::<Vec<_>>()
    };
    let parts =
        names(&root().join("docs")).into_iter().filter(|name| root().join("docs").join(name).is_dir());
    let folders =
        ["".to_owned(), "docs/".to_owned()].into_iter().chain(parts.map(|name| format!("docs/{name}/")));
    let found: Vec<_> =
        folders.flat_map(|folder| pages(&folder)).map(|path| (path.clone(), document(&path))).collect();
    assert!(found.len() >= 7, "only {}", found.len());
    found
}

fn document(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

/// A block of code.
struct Block {
    /// Where it begins, `file:line`.
    place: String,
    /// The words behind the fence.
    language: String,
    text: String,
}

fn blocks(path: &str, text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut open = false;
    for (number, line) in text.lines().enumerate() {
        match line.strip_prefix("```") {
            Some(_) if open => open = false,
            Some(language) => {
                let place = format!("{path}:{}", number + 1);
                blocks.push(Block { place, language: language.to_owned(), text: String::new() });
                open = true;
            }
            None if open => blocks.last_mut().unwrap().text += &format!("{line}\n"),
            None => {}
        }
    }
    assert!(!open, "{path}: a block without end");
    blocks
}

/// An empty folder but for the shipped scenarios.
fn folder() -> Folder {
    let folder = Folder::new();
    let copy = folder.path().join("scenarios");
    std::fs::create_dir(&copy).unwrap();
    for name in names(&scenarios()).iter().filter(|name| name.contains('.')) {
        std::fs::copy(scenarios().join(name), copy.join(name)).unwrap();
    }
    folder
}

/// What a page shows, and what the command printed instead.
struct Difference {
    /// Where the block begins, and the command.
    place: String,
    shown: String,
    printed: String,
}

/// With `ASPERITY_UPDATE=1` pages are changed to what the commands print (`make outputs`).
#[test]
fn blocks_do_what_they_show() {
    let mut ran = BTreeMap::new();
    let mut all = Vec::new();
    for (path, text) in documents() {
        let mut different = Vec::new();
        let folder = folder();
        for Block { place, language, text } in blocks(&path, &text) {
            match language.as_str() {
                "toml" => makes_sense(&folder, &place, &text),
                "console" => different.extend(prints(&folder, &place, &text, true)),
                "console fails" => different.extend(prints(&folder, &place, &text, false)),
                "sh" => text.lines().for_each(|line| is_a_target(&place, line)),
                "rust" => assert!(document("core/src/lib.rs").contains(&path), "{place}: not run"),
                "python" | "output" | "pycon" | "text" | "math" => {}
                directive if directive.starts_with('{') => {}
                other => panic!("{place}: what kind of block is {other:?}?"),
            }
            *ran.entry(language).or_insert(0) += 1;
        }
        if std::env::var_os("ASPERITY_UPDATE").is_some() {
            let updated = different.drain(..).fold(text, |text, d| text.replacen(&d.shown, &d.printed, 1));
            std::fs::write(root().join(&path), updated).unwrap();
        }
        all.extend(different);
    }
    let reported = |d: &Difference| format!("{}\nshown:\n{}\nprinted:\n{}\n", d.place, d.shown, d.printed);
    assert!(
        all.is_empty(),
        "{}`make outputs` shows what is printed",
        all.iter().map(reported).collect::<String>()
    );
    for language in ["toml", "console", "console fails", "sh", "rust"] {
        assert!(ran.contains_key(language), "no {language} block at all: {ran:?}");
    }
}

fn makes_sense(folder: &Folder, place: &str, text: &str) {
    let name = text.lines().next().and_then(|line| line.strip_prefix("# ")).filter(|n| n.ends_with(".toml"));
    let name = name.unwrap_or("block.toml");
    folder.write(name, text);
    let output = folder.run(&["check", name]);
    assert!(output.status.success(), "{place}: {}", support::errors(&output));
}

/// Runs the commands of a block. Returns where they print something else than what is shown behind each, if anything is.
fn prints(folder: &Folder, place: &str, text: &str, succeeds: bool) -> Vec<Difference> {
    assert!(text.starts_with("$ "), "{place}: no command");
    let mut different = Vec::new();
    for part in format!("\n{text}").split("\n$ ").skip(1) {
        let (command, shown) = part.split_once('\n').unwrap_or((part, ""));
        let output = shell(folder, command);
        let (printed, errors) = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b)).into();
        assert_eq!(output.status.success(), succeeds, "{place}: {command}\n{errors}");
        if !shown.trim().is_empty() {
            let printed = if succeeds { printed } else { errors };
            let (shown, printed) = (trimmed(shown), trimmed(&printed));
            if shown != printed {
                different.push(Difference { place: format!("{place}: {command}"), shown, printed });
            }
        }
    }
    different
}

/// Runs a line in bash, with this build as `asperity` and for `cargo run --release --`.
fn shell(folder: &Folder, line: &str) -> std::process::Output {
    let program = Path::new(env!("CARGO_BIN_EXE_asperity")).parent().unwrap();
    let paths = std::env::join_paths(
        [program.to_owned()].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    );
    let line = line.replace("cargo run --release --", "asperity");
    let mut bash = Command::new("bash");
    bash.args(["-c", &line]).current_dir(folder.path()).env("PATH", paths.unwrap()).output().unwrap()
}

/// Lines without the blanks at their ends, and without empty ones at either end.
fn trimmed(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_matches('\n').to_owned()
}

fn is_a_target(place: &str, line: &str) {
    let mut words = line.split_whitespace();
    if words.next() == Some("make") {
        let target = words.next().unwrap();
        assert!(
            document("Makefile").lines().any(|l| l.starts_with(&format!("{target}:"))),
            "{place}: {line}"
        );
    }
}

#[test]
fn two_commands_do_all_and_ci_runs_the_second() {
    let readme = blocks("README.md", &document("README.md"));
    let set_up: Vec<_> = readme.iter().filter(|block| block.language == "sh").collect();
    assert_eq!(set_up.len(), 1, "one block of commands");
    let commands: Vec<_> =
        set_up[0].text.lines().map(|line| line.split('#').next().unwrap().trim()).collect();
    assert_eq!(commands, ["cargo run --release -- run scenarios/fig2.toml", "make test"]);
    assert_eq!(document(".ci/run").lines().last(), Some(commands[1]));
    // What the first prints is shown, and so compared.
    assert!(
        readme.iter().any(|b| b.language == "console" && b.text.starts_with(&format!("$ {}\n", commands[0])))
    );
}

#[test]
fn links_lead_somewhere() {
    for (path, text) in documents() {
        let folder = root().join(&path).parent().unwrap().to_owned();
        let targets = text.split("](").skip(1).map(|rest| rest.split(')').next().unwrap());
        for target in targets.filter(|target| !target.contains("://") && !target.starts_with('#')) {
            let file = target.split('#').next().unwrap();
            assert!(folder.join(file).exists(), "{path}: {target} is not there");
        }
    }
}

#[test]
fn one_version_is_reported_everywhere() {
    let version = env!("CARGO_PKG_VERSION");
    assert!(document("CITATION.cff").contains(&format!("\nversion: {version}\n")));
    let changelog = document("CHANGELOG.md");
    assert!(changelog.contains(&format!("## [{version}]")) || changelog.contains("## [Unreleased]"));
}

/// The first cells of the rows of tables that begin with code, with the second ones.
fn rows(page: &str) -> BTreeMap<String, String> {
    let cells = page.lines().filter_map(|line| line.strip_prefix("| `"));
    let row = |line: &str| {
        let (key, rest) = line.split_once("` |").unwrap_or_else(|| panic!("not a key alone: {line}"));
        (key.to_owned(), rest.split(" |").next().unwrap().trim().to_owned())
    };
    cells.map(row).collect()
}

#[test]
fn the_tables_of_keys_are_those_of_the_schema() {
    let schema = asperity_runner::input::schema();
    let page = document("docs/scenarios.md");
    let known: usize = table::keys(&schema).iter().map(|keys| keys.len()).sum();
    assert!(known > 80, "only {known}");
    assert_eq!(table::page(&page, &schema), page, "`make keys` writes them anew");
}

#[test]
fn the_page_of_variables_is_that_of_the_declarations() {
    assert_eq!(document("docs/variables.md"), variables::page(), "`make variables` writes it anew");
}

#[test]
fn the_glossary_names_what_there_is() {
    let places =
        ["docs/scenarios.md", "docs/variables.md", "python/asperity/_core.pyi"].map(document).concat();
    let shipped = names(&scenarios());
    let glossary = document("docs/glossary.md");
    let code: Vec<&str> =
        glossary.lines().skip(3).flat_map(|line| line.split('`').skip(1).step_by(2)).collect();
    assert!(code.len() > 40, "only {code:?}");
    for name in code {
        let word = name.split(" = ").next().unwrap().trim_matches(['[', ']']).rsplit('.').next().unwrap();
        let known = places.contains(word) || shipped.contains(&format!("{word}.toml"));
        assert!(known, "docs/glossary.md: there is no {name}");
    }
}

#[test]
fn the_table_of_laws_is_complete() {
    let schema = asperity_runner::input::schema();
    let laws = schema["$defs"]["Law"]["oneOf"].as_array().unwrap();
    let known: Vec<_> = laws
        .iter()
        .map(|law| law["required"][0].as_str().unwrap().to_owned())
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .collect();
    let shown: Vec<_> = rows(&document("docs/laws.md")).into_keys().collect();
    assert_eq!(shown, known);
}

/// `.ci/figures.py` compares those that scenarios draw.
#[test]
fn pictures_of_pages_can_be_scaled_and_are_typeset() {
    for folder in ["docs/figures/", "docs/validation/"] {
        let pictures: Vec<_> =
            names(&root().join(folder)).into_iter().filter(|name| name.ends_with(".svg")).collect();
        assert!(pictures.len() > 8, "only {pictures:?} in {folder}");
        for name in pictures {
            let picture = document(&format!("{folder}{name}"));
            let (head, _) = picture[picture.find("<svg").unwrap()..].split_once('>').unwrap();
            assert!(head.contains("viewBox="), "{folder}{name} has no viewBox");
            // Tags aside, a text has symbols with subscripts, powers and minus signs.
            for text in picture.split("<text ").skip(1) {
                let text = &text[text.find('>').unwrap() + 1..text.find("</text>").unwrap()];
                let letters =
                    text.split('<').map(|piece| piece.rsplit('>').next().unwrap()).collect::<String>();
                let is_plain = letters.contains(['_', '^']) || letters.starts_with('-');
                assert!(!is_plain, "{folder}{name}: {letters}");
            }
        }
    }
}
