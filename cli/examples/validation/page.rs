//! A page of text, tables and pictures.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::render::layout::TickFormat;
use kuva::render::render::Scene;

use crate::clip::cut;
use crate::{style, typography};

const HEAD: &str = "\
<!-- Written by `make validation`: change cli/examples/validation instead. -->
# Validation

The accuracy of the numbers, and their cost. `make validation` computes everything on this page; a test recomputes
all of it except times, the finest grids and most ensembles in time. Lengths are in units of the mean threshold x̄, forces in
units of N⟨k⟩x̄. Times are CPU seconds on the machine that made this page; only their ratios are meaningful.
";

/// What a page is made of.
enum Line {
    /// The same on any machine.
    Lasting(String),
    /// With times.
    Timed(String),
}

/// A page and its pictures.
#[derive(Default)]
pub struct Page {
    lines: Vec<Line>,
    pictures: Vec<(String, String)>,
}

impl Page {
    /// Lines that are the same on any machine.
    pub fn text(&mut self, text: &str) {
        self.lines.extend(text.trim_matches('\n').lines().map(|line| Line::Lasting(line.to_owned())));
        self.lines.push(Line::Lasting(String::new()));
    }

    /// The head of a table.
    pub fn head(&mut self, columns: &[&str]) {
        let rule = columns.iter().enumerate().map(|(i, _)| if i == 0 { "---" } else { "---:" });
        let rule = rule.collect::<Vec<_>>().join(" | ");
        self.lines.push(Line::Lasting(format!("| {} |", columns.join(" | "))));
        self.lines.push(Line::Lasting(format!("| {rule} |")));
    }

    /// A row of a table.
    pub fn row(&mut self, cells: &[String]) {
        self.lines.push(Line::Lasting(format!("| {} |", cells.join(" | "))));
    }

    /// A row of a table that holds times.
    pub fn timed_row(&mut self, cells: &[String]) {
        self.lines.push(Line::Timed(format!("| {} |", cells.join(" | "))));
    }

    /// Ends a table.
    pub fn end(&mut self) {
        self.lines.push(Line::Lasting(String::new()));
    }

    /// A picture with its caption.
    pub fn picture(&mut self, name: &str, caption: &str, scene: Scene) {
        let scene = cut(scene);
        let drawn = with_view_box(&SvgBackend::new().render_scene(&scene));
        self.pictures.push((format!("{name}.svg"), typography::typeset(&drawn, "")));
        self.text(&format!("![{caption}]({name}.svg)\n\n*{caption}*"));
    }

    /// What is the same on any machine.
    #[cfg(test)]
    pub fn lasting(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().filter_map(|line| match line {
            Line::Lasting(line) if !line.is_empty() => Some(line.as_str()),
            _ => None,
        })
    }

    /// Writes `index.md` and the pictures.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        fs::create_dir_all(folder)?;
        for (name, picture) in &self.pictures {
            fs::write(folder.join(name), picture)?;
        }
        let mut text = HEAD.to_owned();
        for Line::Lasting(line) | Line::Timed(line) in &self.lines {
            text += &format!("\n{line}");
        }
        fs::write(folder.join("index.md"), text.trim_end().to_owned() + "\n")
    }
}

/// A picture that can be scaled. Its size is read from its head, where it is rounded.
fn with_view_box(picture: &str) -> String {
    let value = |name: &str| {
        let (_, after) = picture.split_once(&format!("{name}=\"")).expect("a size");
        after.split_once('"').expect("a quote").0
    };
    let height = format!("height=\"{}\"", value("height"));
    let scaled = format!("{height} viewBox=\"0 0 {} {}\"", value("width"), value("height"));
    picture.replacen(&height, &scaled, 1)
}

/// A number with two digits, as a power of ten where it is small.
pub fn small(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}") }
}

/// The power of ten that bounds an error, not below what roundings do: the same on any machine.
pub fn below(error: f64) -> String {
    let exponent = error.abs().max(1e-12).log10().ceil();
    format!("< 1e{exponent:.0}")
}

/// Ticks of an axis that shows exponents of ten.
pub fn decades() -> TickFormat {
    TickFormat::Custom(Arc::new(style::power))
}
