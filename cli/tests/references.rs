//! Works are cited alike everywhere: what a link to a work says of it is what docs/references.bib says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A work of the bibliography: its fields, by name.
type Work = BTreeMap<String, String>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The pages under a folder, those in folders of it, too.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let inside = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let found = inside.flat_map(|path| if path.is_dir() { pages(&path) } else { vec![path] });
    found.filter(|path| path.extension().is_some_and(|end| end == "md")).collect()
}

/// Letters as they are read, without the braces and accents of LaTeX.
fn plain(text: &str) -> String {
    let accents = [(r#"{\"o}"#, "ö"), (r"{\o}", "ø"), ("--", "-"), ("{", ""), ("}", "")];
    accents.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// The works by the links that stand for them.
fn works() -> BTreeMap<String, Work> {
    let text = std::fs::read_to_string(root().join("docs/references.bib")).unwrap();
    let field = |line: &str| {
        let (name, value) = line.trim().split_once(" = {")?;
        Some((name.to_owned(), value.strip_suffix("},")?.to_owned()))
    };
    let entries = text.split("\n@").map(|entry| entry.lines().filter_map(field).collect::<Work>());
    let link =
        |work: &Work| work.get("url").cloned().unwrap_or_else(|| format!("https://doi.org/{}", work["doi"]));
    entries.map(|work| (link(&work), work)).collect()
}

/// Links with what they say: brackets in a target come in pairs.
fn links(text: &str) -> Vec<(String, String)> {
    let mut links = Vec::new();
    for (at, _) in text.match_indices("](http") {
        let before = &text[..at];
        let words = &before[before.rfind('[').unwrap() + 1..];
        let mut depth = 0;
        let target: String = text[at + 2..]
            .chars()
            .take_while(|&c| {
                depth += i32::from(c == '(') - i32::from(c == ')');
                depth >= 0
            })
            .collect();
        links.push((words.to_owned(), target));
    }
    links
}

/// The last name, and the initials of the others: "Feder, Hans Jacob S." or "H. J. S. Feder".
fn name(author: &str) -> (String, String) {
    let initials = |names: &str| {
        let parts = names.split([' ', '-', '.']).filter_map(|part| part.chars().next());
        parts.collect::<String>()
    };
    if let Some((last, first)) = author.split_once(", ") {
        return (last.to_owned(), initials(first));
    }
    let first: Vec<&str> = author.split(' ').take_while(|part| part.ends_with('.')).collect();
    let last: Vec<&str> = author.split(' ').skip(first.len()).collect();
    (last.join(" "), initials(&first.join(" ")))
}

/// The year of what a link says, if it says one.
fn year(words: &str) -> Option<&str> {
    words.split(|c: char| !c.is_ascii_digit()).rfind(|number| number.len() == 4)
}

/// What a link says of a work is true.
fn agrees(place: &str, words: &str, work: &Work) {
    if words.starts_with("doi:") {
        return;
    }
    if let Some(year) = year(words) {
        assert_eq!(year, work["year"], "{place}: the year of [{words}]");
    }
    let (others, words) = (words.contains("*et al.*"), words.replace(" *et al.*", ""));
    let title = words.split('*').nth(1);
    if let Some(title) = title {
        assert!(plain(&work["title"]).starts_with(title), "{place}: the title of [{words}]");
    }
    let reported = words.split(['*', '(']).next().unwrap().trim_end_matches([' ', ',']);
    let reported =
        year(reported).map_or(reported, |year| reported.trim_end_matches(year)).trim_end_matches([' ', ',']);
    if reported.is_empty() {
        return;
    }
    let authors = plain(&work["author"]);
    let known: Vec<_> = authors.split(" and ").map(name).collect();
    let reported: Vec<_> = reported.split(" and ").flat_map(|part| part.split(", ")).map(name).collect();
    assert!(
        reported.len() == known.len() || others && reported.len() < known.len(),
        "{place}: the authors of [{words}]"
    );
    for ((last, initials), (known, letters)) in reported.iter().zip(&known) {
        assert_eq!(last, known, "{place}: an author of [{words}]");
        assert!(initials.is_empty() || initials == letters, "{place}: the initials of {last}");
    }
}

#[test]
fn works_are_cited_as_the_bibliography_has_them() {
    let works = works();
    let mut cited = BTreeSet::new();
    let documents = pages(&root().join("docs")).into_iter().chain([root().join("README.md")]);
    for path in documents {
        let text = std::fs::read_to_string(&path).unwrap();
        for (words, target) in links(&text) {
            let place = format!("{}: {target}", path.display());
            if let Some(work) = works.get(&target) {
                agrees(&place, &words, work);
                cited.insert(target);
            } else {
                assert!(!target.contains("doi.org/"), "{place}: [{words}] is not in docs/references.bib");
            }
        }
    }
    assert!(cited.len() > 30, "only {cited:?}");
    let rest: Vec<_> = works.keys().filter(|link| !cited.contains(*link)).collect();
    assert!(rest.is_empty(), "cited nowhere: {rest:?}");
}

#[test]
fn other_names_years_and_titles_are_seen() {
    let works = works();
    let work = &works["https://doi.org/10.1130/GES02739.1"];
    let fails = |words: &str| std::panic::catch_unwind(|| agrees("here", words, work)).is_err();
    assert!(!fails("P. Giacomel, D. R. Faulkner, V. Lambert and M. J. Allen, 2024"));
    assert!(!fails("P. Giacomel *et al.* (2024)"));
    for wrong in [
        "M. M. Giacomel, D. R. Faulkner, V. Lambert and M. J. Allen, 2024",
        "P. Giacomel and D. R. Faulkner, 2024",
        "P. Giacomel *et al.* (2023)",
        "P. Giacomel *et al.*, *Another title* (2024)",
    ] {
        assert!(fails(wrong), "{wrong}");
    }
}
