//! Pictures in shades of grey.

use kuva::render::color::Color;

use super::style::{BLUE, GREEN, ORANGE, RED};

/// Shades of the colours of curves, darker for those that matter more; by their luminance three of them would be alike.
const SHADES: [(&str, &str); 4] =
    [(BLUE, "#202020"), (RED, "#606060"), (GREEN, "#8a8a8a"), (ORANGE, "#a6a6a6")];

/// The picture with every colour as a shade of grey: another colour by its luminance.
pub fn shaded(svg: &str) -> String {
    let mut parts = svg.split("\"#");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        text += "\"";
        match part.split_once('"').and_then(|(colour, rest)| Some((shade(colour)?, rest))) {
            Some((shade, rest)) => text += &format!("{shade}\"{rest}"),
            None => text += &format!("#{part}"),
        }
    }
    text
}

/// The shade of a colour of six hexadecimal digits.
fn shade(digits: &str) -> Option<String> {
    let part = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    if digits.len() != 6 {
        return None;
    }
    let [shade, ..] = shade_of([part(0)?, part(2)?, part(4)?]);
    Some(format!("#{}", format!("{shade:02x}").repeat(3)))
}

/// Red, green and blue of a colour, in shades of grey if asked for; `None` for no colour.
pub fn rgb(colour: &Color, grey: bool) -> Option<[u8; 3]> {
    let Color::Rgb(red, green, blue) = *colour else { return None };
    Some(if grey { shade_of([red, green, blue]) } else { [red, green, blue] })
}

/// The shade of a colour.
fn shade_of(rgb: [u8; 3]) -> [u8; 3] {
    let is =
        |colour: &str| colour.eq_ignore_ascii_case(&format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]));
    let known = SHADES.iter().find(|(colour, _)| is(colour));
    let known = known.and_then(|(_, shade)| u8::from_str_radix(&shade[1..3], 16).ok());
    [known.unwrap_or_else(|| luminance(rgb)); 3]
}

/// The luminance of a colour, by ITU-R BT.601.
fn luminance(rgb: [u8; 3]) -> u8 {
    let [red, green, blue] = rgb.map(f64::from);
    (0.299 * red + 0.587 * green + 0.114 * blue).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_shades_and_all_else_stays() {
        let svg =
            "<a href=\"#top\" fill=\"#0072b2\" stroke=\"#FF0000\">#0072B2 \"#</a><rect fill=\"#ffffff\"/>";
        let grey =
            "<a href=\"#top\" fill=\"#202020\" stroke=\"#4c4c4c\">#0072B2 \"#</a><rect fill=\"#ffffff\"/>";
        assert_eq!(shaded(svg), grey);
    }
}
