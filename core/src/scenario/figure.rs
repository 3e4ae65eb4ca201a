//! `[figure]`: how the pictures of a run are drawn.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::positive;
use crate::Result;

/// How pictures are drawn. It changes no result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Figure {
    /// File formats of the pictures: `"svg"`, `"png"`, `"pdf"`; with `[]` none are drawn. SVG takes a fifth of the time of PNG.
    pub formats: Vec<FigureFormat>,
    /// Width of a picture in mm, such as 86 for a column; without it 175.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub width: Option<f64>,
    /// Height in mm of a picture of one panel, with its title and its legend; without it 8/11 of the width. Other pictures
    /// are taller or lower in the same proportion.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub height: Option<f64>,
    /// Font size of the labels of axes in points, above 0; without it, letters grow with the width, to 11 points at 175 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub font_size: Option<f64>,
    /// Whether the title of the scenario stands above pictures.
    pub title: bool,
    /// Whether pictures are drawn in shades of grey.
    pub grey: bool,
    /// Dots per inch of PNG pictures, above 0: 200 for screens, 300 and more for print.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub dpi: f64,
}

/// A file format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FigureFormat {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Network Graphics, in dots.
    Png,
    /// Portable Document Format, a page of the size of the picture.
    Pdf,
}

impl FigureFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Svg, Self::Png, Self::Pdf];

    /// Its name, and the ending of names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }
}

impl Default for Figure {
    fn default() -> Self {
        Self {
            formats: vec![FigureFormat::Svg],
            width: None,
            height: None,
            font_size: None,
            title: true,
            grey: false,
            dpi: 200.0,
        }
    }
}

impl Figure {
    /// Whether pictures are drawn in the usual way.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        let sizes = [("width", self.width), ("height", self.height), ("font_size", self.font_size)];
        for (key, value) in sizes.into_iter().chain([("dpi", Some(self.dpi))]) {
            value.map_or(Ok(()), |value| positive(key, value).map(|_| ()))?;
        }
        Ok(())
    }
}
