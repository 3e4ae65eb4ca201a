//! The panels of a picture in rows and columns, with labels that fit.

use kuva::render::figure::Figure;
use kuva::render::layout::{ComputedLayout, Layout};

use super::fitting;

/// The panels of a picture. Each takes one cell of a grid or several, which form a rectangle.
pub struct Grid {
    structure: Vec<Vec<usize>>,
    title: (String, u32),
    heights: Vec<f64>,
    widths: Vec<f64>,
    spacing: f64,
}

impl Grid {
    /// A panel in each cell, of this width and height.
    pub fn new(rows: usize, columns: usize, (width, height): (f64, f64)) -> Self {
        Self {
            structure: (0..rows * columns).map(|cell| vec![cell]).collect(),
            title: (String::new(), 0),
            heights: vec![height; rows],
            widths: vec![width; columns],
            spacing: 6.0,
        }
    }

    /// With the cells of each panel, counted row by row.
    pub fn with_structure(self, structure: Vec<Vec<usize>>) -> Self {
        Self { structure, ..self }
    }

    /// With a title of this font size.
    pub fn with_title(self, title: (String, u32)) -> Self {
        Self { title, ..self }
    }

    pub fn with_row_height(mut self, row: usize, height: f64) -> Self {
        self.heights[row] = height;
        self
    }

    pub fn with_column_width(mut self, column: usize, width: f64) -> Self {
        self.widths[column] = width;
        self
    }

    /// With another distance between cells.
    pub fn with_spacing(self, spacing: f64) -> Self {
        Self { spacing, ..self }
    }

    /// The picture without its panels, and their layouts with labels that fit.
    pub fn fitted(mut self, layouts: Vec<Layout>) -> (Figure, Vec<Layout>) {
        let layouts = layouts.into_iter().enumerate().map(|(panel, layout)| self.sized(panel, layout));
        let mut layouts: Vec<Layout> = layouts.map(fitting::upright).collect();
        (0..self.widths.len()).for_each(|column| self.widen_left(column, &mut layouts));
        let before: Vec<f64> = layouts.iter().map(bottom).collect();
        let layouts = layouts.into_iter().map(fitting::level).collect();
        let mut layouts = self.widened_right(layouts);
        (0..self.heights.len()).for_each(|row| self.widen_below(row, &before, &mut layouts));
        (self.figure(), layouts)
    }

    fn figure(self) -> Figure {
        let figure = Figure::new(self.heights.len(), self.widths.len())
            .with_structure(self.structure)
            .with_spacing(self.spacing);
        let heights = self.heights.into_iter().enumerate();
        let figure = heights.fold(figure, |figure, (row, height)| figure.with_row_height(row, height));
        let widths = self.widths.into_iter().enumerate();
        let figure = widths.fold(figure, |figure, (column, width)| figure.with_col_width(column, width));
        // The plot library leaves room above an empty title, too.
        match self.title.0.is_empty() {
            true => figure,
            false => figure.with_title(self.title.0).with_title_size(self.title.1),
        }
    }

    /// A layout with the size of its panel.
    fn sized(&self, panel: usize, layout: Layout) -> Layout {
        let extent = |sides: &[f64], place: &dyn Fn(usize) -> usize| {
            let places = self.structure[panel].iter().map(|&cell| place(cell));
            let (first, last) = (places.clone().min().unwrap_or(0), places.max().unwrap_or(0));
            sides[first..=last].iter().sum::<f64>() + self.spacing * (last - first) as f64
        };
        let columns = self.widths.len();
        let width = extent(&self.widths, &|cell| cell % columns);
        layout.with_width(width).with_height(extent(&self.heights, &|cell| cell / columns))
    }

    /// Gives the panels of a column, which begin together, room for the labels on the left.
    fn widen_left(&self, column: usize, layouts: &mut [Layout]) {
        let columns = self.widths.len();
        let begins =
            |panel: &usize| self.structure[*panel].iter().map(|cell| cell % columns).min() == Some(column);
        let panels: Vec<usize> = (0..layouts.len()).filter(begins).collect();
        let needed = |&panel: &usize| fitting::needed_on_the_left(&layouts[panel]);
        let Some(room) = panels.iter().filter_map(needed).reduce(f64::max) else { return };
        for panel in panels {
            let margin = &mut layouts[panel].force_margin_left;
            *margin = margin.map(|margin| margin.max(room));
        }
    }

    /// Gives the panels of the last column, which end together, room for the last label below, if it reaches beyond the picture.
    fn widened_right(&self, mut layouts: Vec<Layout>) -> Vec<Layout> {
        let columns = self.widths.len();
        let ends = |panel: &usize| self.structure[*panel].iter().any(|cell| cell % columns == columns - 1);
        let panels: Vec<usize> = (0..layouts.len()).filter(ends).collect();
        let needed = |&panel: &usize| fitting::needed_on_the_right(&layouts[panel]);
        let Some(room) = panels.iter().filter_map(needed).reduce(f64::max) else { return layouts };
        for panel in panels {
            let margin = &mut layouts[panel].force_margin_right;
            *margin = margin.map(|margin| margin.max(room));
        }
        layouts.into_iter().map(fitting::level).collect()
    }

    /// Gives the panels of a row, which end together, room for two lines below, if one has them. Their frames keep their heights.
    /// Labels of one line stand beside the first one of two.
    fn widen_below(&mut self, row: usize, before: &[f64], layouts: &mut [Layout]) {
        let columns = self.widths.len();
        let ends =
            |panel: &usize| self.structure[*panel].iter().map(|cell| cell / columns).max() == Some(row);
        let panels: Vec<usize> = (0..layouts.len()).filter(ends).collect();
        let is_long =
            |panel: usize, layouts: &[Layout]| fitting::has_two_lines(layouts[panel].x_label.as_deref());
        if !panels.iter().any(|&panel| is_long(panel, layouts)) {
            return;
        }
        let margin = panels.iter().map(|&panel| before[panel]).fold(0.0, f64::max);
        let line = fitting::line(layouts[panels[0]].label_size);
        self.heights[row] += line;
        for panel in panels {
            layouts[panel].force_margin_bottom = Some(margin + line);
            if !is_long(panel, layouts) {
                layouts[panel].x_label_offset.1 -= line;
            }
        }
    }
}

/// The lower margin of a panel.
fn bottom(layout: &Layout) -> f64 {
    ComputedLayout::from_layout(layout).margin_bottom
}
