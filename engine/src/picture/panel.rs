//! What a page shows: a picture, what can be dragged in it, and its numbers.

use serde::Serialize;

use super::axis::Axis;

/// A picture with what a page needs to drag points in it and to save its numbers.
#[derive(Debug, Serialize)]
pub struct Panel {
    /// The name of its place in the page.
    pub id: &'static str,
    /// Its title in HTML.
    pub title: String,
    /// The elements of the picture.
    pub svg: String,
    /// Width and height of the picture in pixels.
    pub size: [f64; 2],
    /// The plot within it: left, top, width and height.
    pub plot: [f64; 4],
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What can be dragged.
    pub handles: Vec<Handle>,
    /// Whether the position is where the plot is clicked.
    pub scrub: bool,
    /// What a double click changes; empty for nothing. `$x` stands for the value on the horizontal axis.
    pub add: String,
    /// What is drawn, as numbers.
    pub columns: Vec<Column>,
}

/// A point that can be dragged.
#[derive(Debug, Clone, Serialize)]
pub struct Handle {
    /// Its place in the picture in pixels.
    pub at: [f64; 2],
    /// What it changes, in JSON; `$x` and `$y` stand for the values on the axes.
    pub change: String,
    /// What a double click changes; empty for nothing.
    pub remove: String,
}

/// A column of numbers.
#[derive(Debug, Serialize)]
pub struct Column {
    /// Its name with its unit.
    pub name: String,
    /// Where the answer has the values, such as `force.position`; empty where they are here.
    pub of: String,
    /// The values; null where there is none.
    pub values: Vec<f64>,
    /// How often each value follows itself.
    pub times: usize,
    /// How many rows there are; the values begin again until then.
    pub rows: usize,
}
