//! Which sliders stick and slip, how often, and whether for ever.

use std::sync::Arc;

use asperity::block::{Block, Drive, Loading, Slip, StickSlip};
use asperity::law::SharedLaw;
use kuva::plot::{BandPlot, LegendEntry};
use kuva::render::layout::TickFormat;
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::Page;
use crate::style::{self, BLACK, Plots, RED};
use crate::{gaussian, master, point};

/// σ/x̄ of the table.
const TABLE: [f64; 3] = [0.05, 0.1, 0.2];
/// Stiffnesses K/N⟨k⟩ of the table.
const STIFFNESSES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// Error of forces, x̄N⟨k⟩: slips are counted, no digits shown.
const TOLERANCE: f64 = 1e-8;
/// Slips after which drops have become constant, or have gone.
const SLIPS: usize = 40;
/// Width of the bracket of K_p, in units of K_c.
const BRACKET: f64 = 0.01;

/// Fewest slips of a class, and its colour (after ColorBrewer's YlGnBu).
const CLASSES: [(usize, &str, &str); 6] = [
    (1, "1 slip", "#FFFFCC"),
    (2, "2 to 3", "#C7E9B4"),
    (4, "4 to 9", "#7FCDBB"),
    (10, "10 to 29", "#41B6C4"),
    (30, "30 to 99", "#2C7FB8"),
    (100, "100 and more", "#253494"),
];

/// The contacts of one width of the law of thresholds, relaxed at X = 0.
struct Interface {
    law: SharedLaw,
    critical: f64,
}

impl Interface {
    fn new(width: f64) -> Self {
        let law = gaussian(1.0, width);
        let pull = master(&law, &point(0.0)).pull_with(3.0, TOLERANCE, &mut ()).expect("a short pull");
        Self { law, critical: pull.critical_stiffness() }
    }

    fn driven(&self, stiffness: f64, slip: Slip, distance: f64) -> StickSlip {
        let mut population =
            master(&self.law, &point(0.0)).population_with(TOLERANCE, &mut ()).expect("contacts");
        let block = Block::new(Loading::Spring(stiffness), slip, None).expect("a stiffness above 0");
        let drive = Drive { turning_points: vec![distance], points: 2 };
        block.pull(&mut population, &drive).expect("a drive")
    }

    /// Number of overdamped slips until sliding is smooth.
    fn slips(&self, stiffness: f64) -> usize {
        if stiffness >= self.critical {
            return 0;
        }
        // As many as while dips of F are apart, each a mean threshold long, and some more to be sure.
        let few = 1.0 / (2.0 * std::f64::consts::PI * (self.law.std() * (1.0 + stiffness)).powi(2));
        let distance = 1.3 * few + 10.0 + 1.0 / stiffness;
        self.driven(stiffness, Slip::Overdamped, distance).events.len()
    }

    /// The class of that number, if there is any slip.
    fn class(&self, stiffness: f64) -> Option<usize> {
        let slips = self.slips(stiffness);
        CLASSES.iter().rposition(|class| slips >= class.0)
    }

    /// Whether the drops of `arrest` tend to something.
    fn persists(&self, stiffness: f64) -> bool {
        let distance = (SLIPS + 2) as f64 * (1.0 + 1.0 / stiffness);
        let events = self.driven(stiffness, Slip::Arrest, distance).events;
        let late = events.get(SLIPS).map(|event| event.drop());
        let middle = events.get(SLIPS / 2).map(|event| event.drop());
        late.zip(middle).is_some_and(|(late, middle)| late > 0.99 * middle)
    }

    /// K_p/K_c, the largest stiffness of persistent stick-slip by `arrest`.
    fn persistent(&self) -> f64 {
        let (mut low, mut high) = (0.1, 0.8);
        while high - low > BRACKET {
            let middle = 0.5 * (low + high);
            if self.persists(middle * self.critical) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

pub fn section(mut page: Page, quick: bool) -> Page {
    page.text(
        "
## Stick-slip: for how long?

A slider of stiffness K over contacts with Gaussian thresholds, at stretch 0 at X = 0. Above $K_c$ = −min F' it slides
smoothly. Below, with the slip rule `overdamped`, it slips a finite number of times. With the rule `arrest` it slips for
ever below $K_p$ (drops after 40 slips equal those after 20 to 1 %), and a finite number of times above.
",
    );
    let stiffnesses = STIFFNESSES.map(|stiffness| format!("overdamped slips, K = {stiffness}"));
    let mut columns = vec!["σ/x̄", "$K_c$"];
    columns.extend(stiffnesses.iter().map(String::as_str));
    columns.push("$K_p/K_c$");
    page.head(&columns);
    for width in TABLE {
        let interface = Interface::new(width);
        let mut cells = vec![width.to_string(), format!("{:.4}", interface.critical)];
        cells.extend(STIFFNESSES.map(|stiffness| interface.slips(stiffness).to_string()));
        cells.push(format!("{:.2}", interface.persistent()));
        page.row(&cells);
    }
    page.end();
    page.text(
        "
The number of slips decreases as the square of the width: each round of breaks spreads the phases of the contacts,
and when they are out of step no minimum of F is steep enough. [The page on stick-slip](../stick-slip.md) explains it.
",
    );
    if !quick {
        let caption = "Number of overdamped slips over the width of the thresholds and the stiffness of the slider; above the black line sliding is smooth, below the red one stick-slip by the rule `arrest` persists.";
        page.picture("stability", caption, picture());
    }
    page
}

/// `count` + 1 values, evenly on a logarithmic axis.
fn spread(low: f64, high: f64, count: u32) -> Vec<f64> {
    (0..=count).map(|i| low * (high / low).powf(f64::from(i) / f64::from(count))).collect()
}

fn picture() -> Scene {
    let (widths, stiffnesses) = (spread(0.03, 0.4, 40), spread(0.05, 20.0, 44));
    let (mut plots, mut lines) = (Plots::new(), (Vec::new(), Vec::new()));
    for (i, pair) in widths.windows(2).enumerate() {
        let width = (pair[0] * pair[1]).sqrt();
        let interface = Interface::new(width);
        lines.0.push((width, interface.critical));
        if i % 4 == 0 {
            lines.1.push((width, interface.persistent() * interface.critical));
        }
        let classes: Vec<_> =
            stiffnesses.windows(2).map(|row| interface.class((row[0] * row[1]).sqrt())).collect();
        // Cells overlap a little, lest gaps be seen between them.
        let sides = vec![pair[0], (1.01 * pair[1]).min(widths[widths.len() - 1])];
        let mut from = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            plots.extend(run[0].map(|class| {
                let band = BandPlot::new(sides.clone(), vec![stiffnesses[from]; 2], vec![stiffnesses[to]; 2]);
                Plot::Band(band.with_color(CLASSES[class].2).with_opacity(1.0))
            }));
            from = to;
        }
    }
    plots.push(line(lines.0, BLACK, 2.0, None));
    plots.push(line(lines.1, RED, 2.0, Some("8 5")));
    let mut legend: Vec<LegendEntry> = CLASSES.iter().map(|class| style::area(class.1, class.2)).collect();
    legend.push(style::line("K_c: smooth above", BLACK, None));
    legend.push(style::line("K_p: arrest persists below", RED, Some("8 5")));
    let layout = style::layout((0.03, 0.4), (0.05, 20.0))
        .with_log_scale()
        .with_tick_format(TickFormat::Custom(Arc::new(style::digits)))
        .with_x_label("Coefficient of variation σ/x̄ of the thresholds")
        .with_y_label("Stiffness of the slider K/N⟨k⟩");
    placed(render_multiple(plots, layout), &legend, &[0])
}
