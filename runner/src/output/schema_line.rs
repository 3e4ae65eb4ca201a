//! The first line of written scenarios, by which editors find their JSON Schema. It names a file, as editors read no other
//! address without a network, and is left out where there is none.

use std::path::Path;

use super::NewFile;

/// The usual name of a file with the output of `asperity schema`.
const FILE: &str = "asperity.schema.json";
/// What the line begins with. To TOML it is a comment.
const KEY: &str = "#:schema ";

/// A scenario as a file of the folder `dir`. It names the schema in the nearest folder around it, relative to `dir`.
pub(crate) fn scenario_file<'a>(dir: &Path, name: impl Into<String>, text: &str) -> NewFile<'a> {
    NewFile::of(name, line(dir).unwrap_or_default() + text)
}

fn line(dir: &Path) -> Option<String> {
    let dir = std::path::absolute(dir).ok()?;
    let above = dir.ancestors().position(|folder| folder.join(FILE).is_file())?;
    Some(format!("{KEY}{}{FILE}\n", "../".repeat(above)))
}

/// A scenario as it was computed, from the text of its file.
pub(crate) fn without_schema(text: String) -> String {
    match text.split_once('\n') {
        Some((line, rest)) if line.starts_with(KEY) => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_schema_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let results = folder.path().join("out/fig2");
        let line = || line(&results);
        // A schema above the temporary folder would be another.
        let without = line();
        std::fs::write(folder.path().join(FILE), "{}").unwrap();
        assert_eq!(line().as_deref(), Some("#:schema ../../asperity.schema.json\n"));
        std::fs::create_dir_all(folder.path().join("out")).unwrap();
        std::fs::write(folder.path().join("out").join(FILE), "{}").unwrap();
        assert_eq!(line().as_deref(), Some("#:schema ../asperity.schema.json\n"));
        assert_eq!(without, None);
    }

    #[test]
    fn the_line_is_no_part_of_the_scenario() {
        assert_eq!(without_schema("#:schema a.json\n[pull]\n".into()), "[pull]\n");
        assert_eq!(without_schema("# a pull\n[pull]\n".into()), "# a pull\n[pull]\n");
    }
}
