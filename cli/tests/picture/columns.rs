//! Pictures of the width of a journal column: everything is in the picture, and no text covers another.

use super::support::{Folder, names};

/// Least part of a letter's height or width by which texts overlap.
const ROUNDING: f32 = 0.5;

/// Draws the pictures of a result anew for a column, with letters of the usual size of journals and of 10 pt, and checks them.
pub fn check(folder: &Folder, scenario: &str) {
    for size in ["8", "10"] {
        check_at(folder, scenario, size);
    }
}

fn check_at(folder: &Folder, scenario: &str, size: &str) {
    folder.succeed(&[
        "plot",
        "out",
        "--figures",
        "svg",
        "--figure-width",
        "86",
        "--figure-font-size",
        size,
        "--no-title",
    ]);
    let out = folder.path().join("out");
    for name in names(&out).into_iter().filter(|name| name.ends_with(".svg")) {
        let svg = std::fs::read_to_string(out.join(&name)).unwrap();
        let place = format!("{scenario}: {name} in a column, {size} pt");
        let drawn = super::tree(&svg);
        super::inside(&place, &drawn);
        apart(&place, &drawn);
    }
}

/// The texts of a picture do not cover each other.
pub fn apart(place: &str, tree: &usvg::Tree) {
    let mut texts = Vec::new();
    collect(tree.root(), &mut texts);
    for (i, (text, at)) in texts.iter().enumerate() {
        for (other, there) in &texts[i + 1..] {
            let across = at.right().min(there.right()) - at.left().max(there.left());
            let down = at.bottom().min(there.bottom()) - at.top().max(there.top());
            assert!(across < ROUNDING || down < ROUNDING, "{place}: {text} covers {other}");
        }
    }
}

/// Texts with the bounds of their letters.
fn collect(group: &usvg::Group, texts: &mut Vec<(String, usvg::Rect)>) {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => collect(group, texts),
            usvg::Node::Text(text) => {
                let words: String = text.chunks().iter().map(|chunk| chunk.text()).collect();
                // The bounds of the letters; those of the text have room for the highest ones.
                let at = text.flattened().bounding_box().transform(text.abs_transform());
                texts.extend(at.map(|at| (words, at)));
            }
            _ => {}
        }
    }
}
