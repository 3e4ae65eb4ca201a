//! Symbols of quantities in italics with their subscripts, and minus signs, in the texts of an SVG picture.

use std::fmt::Write;

use super::style;

/// Letters that are symbols of quantities where they stand alone.
const SYMBOLS: &str = "FKNPQSTVXkqtuvxκ";
/// Size of a subscript and its distance below the line, relative to the size of the text.
const SMALL: f64 = 0.72;
const LOWERED: f64 = 0.22;

/// A piece of a text.
#[derive(Debug, PartialEq, Eq)]
enum Piece<'a> {
    Upright(&'a str),
    Symbol(&'a str),
    Subscript(&'a str),
}

/// The picture with its texts typeset, but for `title`, which is the user's.
pub fn typeset(svg: &str, title: &str) -> String {
    let title = escaped(title);
    let mut out = String::with_capacity(svg.len() + svg.len() / 8);
    let mut rest = svg;
    while let Some(start) = rest.find("<text ") {
        let Some(open) = rest[start..].find('>').map(|end| start + end + 1) else { break };
        let Some(close) = rest[open..].find("</text>").map(|end| open + end) else { break };
        out += &rest[..open];
        let content = &rest[open..close];
        if content == title {
            out += content;
        } else {
            out += &marked_up(content, font_size(&rest[start..open]));
        }
        rest = &rest[close..];
    }
    out + rest
}

fn escaped(text: &str) -> String {
    let marks = [('&', "&amp;"), ('<', "&lt;"), ('>', "&gt;"), ('"', "&quot;"), ('\'', "&apos;")];
    marks.into_iter().fold(text.to_owned(), |text, (mark, escaped)| text.replace(mark, escaped))
}

fn font_size(tag: &str) -> f64 {
    let value = tag.split("font-size=\"").nth(1).and_then(|rest| rest.split('"').next());
    value.and_then(|value| value.parse().ok()).unwrap_or(12.0)
}

/// A piece of a text as it is drawn.
#[derive(Debug, PartialEq)]
pub struct Span {
    pub text: String,
    pub is_italic: bool,
    pub size: f64,
    /// Distance of its line below that of the text.
    pub lowered: f64,
}

/// The pieces of a text of this size as they are drawn.
pub fn spans(text: &str, size: f64) -> Vec<Span> {
    let span = |text: String, is_italic| Span { text, is_italic, size, lowered: 0.0 };
    let drawn = |piece| match piece {
        Piece::Upright(text) => span(numbers(text), false),
        Piece::Symbol(text) => span(text.to_owned(), true),
        Piece::Subscript(text) => {
            Span { size: SMALL * size, lowered: LOWERED * size, ..span(text.to_owned(), false) }
        }
    };
    pieces(text).into_iter().map(drawn).collect()
}

/// A text with its symbols marked up for SVG.
fn marked_up(text: &str, size: f64) -> String {
    let mut out = String::new();
    let mut lowered = 0.0;
    for span in spans(text, size) {
        let mut attributes = String::new();
        if span.is_italic {
            attributes += " font-style=\"italic\"";
        }
        if span.size != size {
            attributes += &format!(" font-size=\"{:.2}\"", span.size);
        }
        if span.lowered != lowered {
            attributes += &format!(" dy=\"{:.2}\"", span.lowered - lowered);
        }
        lowered = span.lowered;
        let written = match attributes.as_str() {
            "" => write!(out, "{}", span.text),
            _ => write!(out, "<tspan{attributes}>{}</tspan>", span.text),
        };
        // Writing to a string does not fail.
        written.unwrap_or_default();
    }
    out
}

/// Hyphens before digits as minus signs, and 2e-3 as 2 × 10⁻³.
fn numbers(text: &str) -> String {
    let ends = |c: char| c.is_whitespace() || "(),;:=".contains(c);
    text.split_inclusive(ends)
        .map(|word| {
            let (word, end) = word.split_at(word.trim_end_matches(ends).len());
            style::typeset_number(word).unwrap_or_else(|| word.to_owned()) + end
        })
        .collect()
}

/// The pieces of a text. A letter that stands alone is a symbol, but not after a number or in parentheses that follow a space:
/// there it is a unit. `A_b` is a symbol with a subscript.
fn pieces(text: &str) -> Vec<Piece<'_>> {
    let (mut pieces, mut start, mut unit) = (Vec::new(), 0, false);
    let mut at = 0;
    while let Some(letter) = text[at..].chars().next() {
        let (before, after) = (&text[..at], &text[at + letter.len_utf8()..]);
        match letter {
            // The second line of a label may begin with its unit.
            '(' if before.is_empty() || before.ends_with(' ') => unit = true,
            ')' => unit = false,
            _ => {}
        }
        let next = at + letter.len_utf8();
        let begins = !before.ends_with(|c: char| c.is_alphanumeric() || c == '&' || c == '_');
        let subscript = after.strip_prefix('_').map_or("", |rest| {
            let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
            &rest[..end]
        });
        let alone =
            !after.starts_with(|c: char| (c.is_alphanumeric() && !is_raised_or_lowered(c)) || c == '_');
        let symbol = begins && !unit && letter.is_alphabetic();
        let counted = before.trim_end().ends_with(|c: char| c.is_ascii_digit());
        if symbol && (!subscript.is_empty() || alone && SYMBOLS.contains(letter) && !counted) {
            if start < at {
                pieces.push(Piece::Upright(&text[start..at]));
            }
            pieces.push(Piece::Symbol(&text[at..next]));
            start = next;
            if !subscript.is_empty() {
                start = next + 1 + subscript.len();
                pieces.push(Piece::Subscript(&text[next + 1..start]));
            }
            at = start;
        } else {
            at = next;
        }
    }
    if start < text.len() {
        pieces.push(Piece::Upright(&text[start..]));
    }
    pieces
}

/// Subscripts and superscripts of Unicode, as in X₁ and q².
fn is_raised_or_lowered(c: char) -> bool {
    matches!(c, '⁰'..='₎' | '²' | '³' | '¹')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symbols(text: &str) -> Vec<String> {
        let all = pieces(text).into_iter();
        all.filter_map(|piece| match piece {
            Piece::Symbol(text) => Some(text.to_owned()),
            Piece::Subscript(text) => Some(format!("_{text}")),
            Piece::Upright(_) => None,
        })
        .collect()
    }

    #[test]
    fn symbols_are_distinguished_from_words_and_units() {
        for (text, expected) in [
            ("Load-point displacement X_T (m)", &["X", "_T"][..]),
            ("Kinetic friction F_k (N)", &["F", "_k"]),
            ("Friction force F (N)", &["F"]),
            ("(N)", &[]),
            ("spring force K(X_T − X)", &["K", "X", "_T", "X"]),
            ("Q(x; X) (1/µm)", &["Q", "x", "X"]),
            ("static 0.8 N", &[]),
            ("v = 0.1 m/s → 1 m/s", &["v"]),
            ("Position X₁", &["X"]),
            ("breaks of single contacts, 1/q²", &["q"]),
            ("ensemble, N = 400", &["N"]),
            ("A&lt;B &amp; x", &["x"]),
            ("thermal_energy", &[]),
            ("gaussian.std", &[]),
        ] {
            assert_eq!(symbols(text), expected, "{text}");
        }
    }

    #[test]
    fn subscripts_are_lowered_and_what_follows_is_not() {
        let got = marked_up("X_T = -3", 10.0);
        let expected = "<tspan font-style=\"italic\">X</tspan><tspan font-size=\"7.20\" dy=\"2.20\">T</tspan><tspan dy=\"-2.20\"> = −3</tspan>";
        assert_eq!(got, expected);
    }

    #[test]
    fn numbers_have_powers_of_ten() {
        for (text, expected) in [
            ("1e-2", "10⁻²"),
            ("-2.5e-3 m", "−2.5 × 10⁻³ m"),
            ("= -3, 4", "= −3, 4"),
            ("slide-2", "slide-2"),
            ("1e6", "10⁶"),
            ("inf", "inf"),
        ] {
            assert_eq!(numbers(text), expected);
        }
    }

    /// The plot library writes quotation marks as entities, too.
    #[test]
    fn a_title_with_quotation_marks_stays_as_it_is() {
        let svg = "<text font-size=\"15\">&quot;X&quot; &amp; F&apos;</text>";
        assert_eq!(typeset(svg, "\"X\" & F'"), svg);
    }

    #[test]
    fn the_title_stays_as_it_is() {
        let svg = "<text font-size=\"12\">X &amp; Y</text><text font-size=\"12\">Time t</text>";
        let got = typeset(svg, "X & Y");
        assert!(
            got.contains(">X &amp; Y</text>") && got.contains("<tspan font-style=\"italic\">t</tspan>"),
            "{got}"
        );
    }
}
