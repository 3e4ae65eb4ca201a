//! The drives at which coupled contacts first break, against what mean field makes of their thresholds.

use std::sync::Arc;

use asperity::elastic::cells::scales;
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{CellLoading, CellSlip, Curves, Interface, InterfaceParameters};
use asperity::ensemble::Disorder;
use asperity::ensemble::lattice::{Edges, Lattice, LatticeCoupling, Shape};
use asperity::first_breaks::FirstBreaks;
use asperity::law::{Law, Renormalised, SharedLaw, critical_coupling, scattered};
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::Page;
use crate::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE, Plots};
use crate::{equal, gaussian, master, point, start, together};

/// Contacts: a power of 4, of which a square has whole sides.
const SIZE: usize = 1 << 16;

/// Whom a contact stretches when it breaks.
#[derive(Clone, Copy, PartialEq)]
enum Others {
    /// Its two neighbours on a chain.
    Chain,
    /// Its four neighbours on a square lattice.
    Square,
    /// All.
    All,
}

const KINDS: [(Others, &str, &str); 3] =
    [(Others::Chain, "2", GREEN), (Others::Square, "4", ORANGE), (Others::All, "all", BLACK)];

/// σ and κ/κ_c.
const CASES: [(f64, f64); 7] =
    [(0.05, 0.5), (0.1, 0.1), (0.1, 0.2), (0.1, 0.4), (0.1, 0.8), (0.1, 0.95), (0.2, 0.8)];

/// σ of the thresholds in a cell, and how far the scales of cells scatter.
const WIDTHS: (f64, f64) = (0.05, 0.1);
/// K_0 over N⟨k⟩.
const CONNECTION: f64 = 5.0;
/// K_int over N⟨k⟩.
const SPRINGS: [f64; 4] = [0.01, 1.0, 100.0, 10_000.0];
/// Interfaces of cells, each with its scales at other places.
const RUNS: u64 = 4;

impl Others {
    fn first_breaks(self, std: f64, coupling: f64) -> FirstBreaks {
        let thresholds = gaussian(1.0, std);
        let shape = match self {
            Self::Chain => Shape::Chain(SIZE),
            Self::Square => Shape::Square([SIZE.isqrt(); 2]),
            Self::All => return together::first_breaks(&thresholds, coupling, SIZE, 1),
        };
        let springs =
            LatticeCoupling::with_alpha(shape, Edges::Periodic, coupling / shape.neighbours() as f64);
        let lattice = Lattice::new(
            equal(&thresholds, &point(0.0)),
            start(&point(0.0)),
            &springs,
            1,
            Disorder::Annealed,
        );
        let drives = lattice.expect("relaxed contacts").first_breaks(&mut ()).expect("nothing stops it");
        FirstBreaks::of_contacts(&drives)
    }
}

pub fn section(mut page: Page, quick: bool) -> Page {
    page.text(
        "
## Renormalised thresholds

The accuracy of mean field: 65536 contacts with Gaussian thresholds, at stretch 0 at first. Each transfers the fraction κ of
the force that it releases, in equal parts to two neighbours on a chain, to four on a square lattice (periodic edges), or to
all others (contacts under one slider on a spring). *Distance* is the Kolmogorov–Smirnov distance between the measured
distribution of the drives at which contacts first break and the distribution P_c of their thresholds, or P_eff, which [mean field](../theory.md#renormalised-thresholds) predicts.
For independent contacts the random distance is 0.003.
",
    );
    page.head(&[
        "σ",
        "κ/κ_c",
        "κ",
        "neighbours",
        "mean",
        "std",
        "mean of P_eff",
        "std of P_eff",
        "distance from P_c",
        "from P_eff",
    ]);
    for (std, near) in CASES {
        let thresholds = gaussian(1.0, std);
        let coupling = near * critical_coupling(thresholds.as_ref());
        let law = Renormalised::new(thresholds.clone(), coupling).expect("a coupling below the critical one");
        for (others, name, _) in KINDS {
            // Every break of these counts as a first one.
            if others == Others::All && std > 0.1 {
                continue;
            }
            let found = others.first_breaks(std, coupling);
            let four = |value: f64| format!("{value:.4}");
            let numbers = [found.mean(), found.std(), law.mean(), law.std()].map(four);
            let distances = [thresholds.as_ref(), &law as &dyn Law].map(|law| four(found.distance(law)));
            let cells = [std.to_string(), near.to_string(), four(coupling), name.to_owned()];
            page.row(&[&cells[..], &numbers, &distances].concat());
        }
    }
    page.end();
    page.text(
        "
For contacts that stretch all others mean field is exact, except for random deviations, which grow towards κ_c. For the
others it holds as long as κ is small compared with κ_c. At a fifth of it the measured distribution is nine (two neighbours)
and twenty (four) times closer to P_eff than to P_c, at two fifths three and seven times, at four fifths about as close and
twice. For weak coupling the deviation with four neighbours is about half of that with two. First breaks have a broader
distribution than in mean field and occur later: contacts that still hold tend to have neighbours that hold.
",
    );
    if !quick {
        let caption = "First breaks at σ = 0.1 and κ = 0.8 κ_c, of contacts that stretch two neighbours, four, or all others, with the distribution of their thresholds and that of mean field.";
        page.picture("renormalised", caption, picture(0.1, 0.8));
    }
    cells(page)
}

/// Cells on springs, from soft to stiff.
fn cells(mut page: Page) -> Page {
    let thresholds: SharedLaw =
        Arc::new(scattered(gaussian(1.0, WIDTHS.0).as_ref(), WIDTHS.1).expect("a law without point masses"));
    let coupling = 1.0 / (1.0 + CONNECTION);
    let law = Renormalised::new(thresholds.clone(), coupling).expect("a coupling below the critical one");
    let alone = critical_coupling(gaussian(1.0, WIDTHS.0).as_ref());
    page.text(&format!(
        "
Cells of many contacts, with thresholds of σ = {} times a scale factor of the cell, with springs K_int to their neighbours and
K_0 = {CONNECTION} N⟨k⟩ to the drive: κ = {coupling:.4}, above κ_c = {alone:.4} of a single cell, below {:.4} of all contacts together.
Scale factors have a standard deviation of {}; those of 256 cells are evenly spaced quantiles of their distribution at random positions, drawn
{RUNS} times. P_eff has the mean {:.4} and the standard deviation {:.4}.
",
        WIDTHS.0,
        critical_coupling(thresholds.as_ref()),
        WIDTHS.1,
        law.mean(),
        law.std(),
    ));
    page.head(&["cells", "K_int/N⟨k⟩", "mean", "std", "distance from P_c", "from P_eff"]);
    for (shape, name) in [(Shape::Chain(256), "chain"), (Shape::Square([16; 2]), "lattice")] {
        for springs in SPRINGS {
            let runs: Vec<_> = (1..=RUNS).map(|seed| breaks_of_cells(shape, springs, seed)).collect();
            let found = FirstBreaks::together(&runs);
            let distances = [thresholds.as_ref(), &law as &dyn Law].map(|law| found.distance(law));
            let numbers = [found.mean(), found.std(), distances[0], distances[1]].map(|x| format!("{x:.4}"));
            page.row(&[&[name.to_owned(), springs.to_string()], &numbers[..]].concat());
        }
    }
    page.end();
    page.text(
        "
Stiffly coupled cells are one slider, and mean field is exact except for the tails of the scale factors, which 256 cells do
not have; a chain must be stiffer than a lattice for this. Softly coupled cells break one by one, each in a slip event, at
drives that scatter as their scale factors do.
",
    );
    page
}

/// Quantiles of the law of scales, by the ranks of scales drawn at random.
fn spread(cells: usize, seed: u64) -> Vec<f64> {
    let drawn = scales(cells, WIDTHS.1, seed).expect("scales above 0");
    let mut order: Vec<usize> = (0..cells).collect();
    order.sort_by(|&i, &j| drawn[i].total_cmp(&drawn[j]));
    let law = gaussian(1.0, WIDTHS.1);
    let mut scales = drawn;
    for (rank, cell) in order.into_iter().enumerate() {
        scales[cell] = law.quantile((rank as f64 + 0.5) / cells as f64);
    }
    scales
}

fn breaks_of_cells(shape: Shape, springs: f64, seed: u64) -> FirstBreaks {
    let thresholds = gaussian(1.0, WIDTHS.0);
    let population =
        master(&thresholds, &point(0.0)).population_with(1e-10, &mut ()).expect("a tolerance that is kept");
    let cells = Curves::new(&population, shape.size()).and_then(|c| c.scaled(spread(shape.size(), seed)));
    let springs = neighbours(shape, Edges::Periodic, springs).expect("springs");
    let setting = InterfaceParameters {
        connection: CONNECTION,
        loading: CellLoading::Uniform,
        slip: CellSlip::Overdamped,
        viscosity: None,
        drive_tolerance: 1e-6,
        area: None,
    };
    let interface = Interface::new(Box::new(cells.expect("as many scales as cells")), springs, setting);
    let found = interface.expect("cells as coupled").first_breaks(
        thresholds.as_ref(),
        1.0 / (1.0 + CONNECTION),
        &mut (),
    );
    found.expect("nothing stops it")
}

fn picture(std: f64, near: f64) -> Scene {
    let thresholds = gaussian(1.0, std);
    let coupling = near * critical_coupling(thresholds.as_ref());
    let law = Renormalised::new(thresholds.clone(), coupling).expect("a coupling below the critical one");
    let (low, high, bins) = (0.6, 1.3, 70);
    let edges: Vec<f64> = (0..=bins).map(|i| low + (high - low) * f64::from(i) / f64::from(bins)).collect();
    let smooth =
        |law: &dyn Law| (0..=1400).map(|i| low + f64::from(i) * 5e-4).map(|x| (x, law.density(x))).collect();
    let mut plots: Plots =
        vec![line(smooth(thresholds.as_ref()), GREY, 1.8, Some("8 5")), line(smooth(&law), BLUE, 2.0, None)];
    let mut legend =
        vec![style::line("thresholds, P_c", GREY, Some("8 5")), style::line("mean field, P_eff", BLUE, None)];
    for (others, name, color) in KINDS {
        let densities = others.first_breaks(std, coupling).densities(&edges);
        let points =
            edges.windows(2).zip(densities).map(|(ends, density)| (0.5 * (ends[0] + ends[1]), density));
        plots.push(Plot::Scatter(ScatterPlot::new().with_data(points).with_color(color).with_size(2.6)));
        legend.push(style::marker(format!("stretching {name}"), color, MarkerShape::Circle));
    }
    let layout = style::layout((low, high), (0.0, 21.0))
        .with_x_label("Drive X")
        .with_y_label("Density of contacts that break first");
    placed(render_multiple(plots, layout), &legend, &[0])
}
