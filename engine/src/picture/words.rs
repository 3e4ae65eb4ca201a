//! Words at axes and in legends, and the units in them.

use asperity::record::Quantity;
use asperity::scenario::Units;

/// Text within an element.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&#38;").replace('<', "&#60;").replace('>', "&#62;").replace('"', "&#34;")
}

/// Words with marks of HTML as plain text, such as F_s.
pub fn plain(html: &str) -> String {
    let mut text = html.replace("<sub>", "_");
    for mark in ["<i>", "</i>", "</sub>"] {
        text = text.replace(mark, "");
    }
    text
}

/// The same in SVG.
pub fn symbols(html: &str) -> String {
    html.replace("<i>", "<tspan font-style=\"italic\">")
        .replace("</i>", "</tspan>")
        .replace("<sub>", "<tspan dy=\"3\" font-size=\"8\">")
        .replace("</sub>", "</tspan><tspan dy=\"-3\">\u{200b}</tspan>")
}

/// The labels of the units of a scenario.
#[derive(Debug, Clone, Copy)]
pub struct Labels<'a>(pub &'a Units);

impl Labels<'_> {
    /// The label of the unit, after a blank; empty without one.
    pub fn unit(self, quantity: Quantity) -> String {
        let label = self.0.label(quantity);
        if label == "1" { String::new() } else { format!(" {label}") }
    }

    /// Words with the unit of a quantity.
    pub fn with_unit(self, words: &str, quantity: Quantity) -> String {
        let label = self.0.label(quantity);
        if label == "1" { words.to_owned() } else { format!("{words} ({label})") }
    }

    /// The same for a picture.
    pub fn at_axis(self, words: &str, quantity: Quantity) -> String {
        words.to_owned() + &escaped(&self.with_unit("", quantity))
    }
}
