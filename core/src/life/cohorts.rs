//! The life of contacts at a velocity, as a sum of cohorts over the stretches at which contacts start.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use super::Life;
use super::Starts;
use super::athermal::begin;
use super::breaking_model::{BlurredEdge, BreakingModel, Cohort, SurvivalMoments};
use super::cells::{BULK, CELL, NEGLIGIBLE, RESOLUTION, with_atoms};
use super::layer::Layer;
use super::panels::{Domain, Panels};
use crate::Result;
use crate::contacts::{Contacts, Stiffness};
use crate::law::{Atom, Breakpoint, Law, SharedLaw};
use crate::monitor::{Cost, Watch};
use crate::numerics::order::sort_by_number;
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::volterra::Kernel;

/// Fraction of the remaining work that it takes to find the initial cells.
const OUTLINED: f64 = 0.1;

/// Contacts of a breaking model, by starting stretch.
#[derive(Debug, Clone)]
pub(super) struct Cohorts {
    model: Arc<dyn BreakingModel>,
    /// ν.
    starts: Layer,
    /// The cohorts of its point masses, in order.
    together: Vec<Arc<dyn Cohort>>,
    /// The cohorts of the Gauss points of its density, made when first needed.
    spread: HashMap<u64, OnceLock<Arc<dyn Cohort>>>,
    /// These cohorts with their weights, if they are few: then their breakpoints matter one by one.
    few: Vec<(f64, Arc<dyn Cohort>)>,
    reach: Reach,
}

/// The lengths on which survival moments vary with the start.
#[derive(Debug, Clone)]
pub(super) struct Reach {
    thresholds: SharedLaw,
    /// Breakpoints of P_c above 0.
    edges: Vec<f64>,
    /// Whether P_c ends at 0 so smoothly that its end does not matter.
    starts_smoothly: bool,
    reported: bool,
    resolution: f64,
}

impl Reach {
    /// Of survival moments that vary on the length `resolution`; if `reported`, panels of starts are cut where contacts reach an
    /// edge of P_c.
    pub(super) fn new(contacts: &Contacts, resolution: f64, reported: bool) -> Self {
        let thresholds = contacts.thresholds.clone();
        let edges =
            with_atoms(thresholds.as_ref()).iter().map(|b| b.position).filter(|&at| at > 0.0).collect();
        let starts_smoothly = starts_smoothly(thresholds.as_ref());
        Self { thresholds, edges, starts_smoothly, reported, resolution }
    }

    /// The density of starts on panels that resolve how survival moments vary with the start, to an error of each panel.
    pub(super) fn panels<'a>(&self, starts: &'a Layer, error: f64) -> Panels<'a> {
        let panels = Panels::new(&starts.density, 2.0 * CELL * self.resolution, NEGLIGIBLE);
        panels.merged(|low, high| self.length(low, high), error)
    }

    /// A length L such that survival moments of starts in [`low`, `high`] vary no faster than e^{−((r −
    /// r_0)/L)²}: a fraction of the scale of P_c, and of the distance to its breakpoints (among them 0,
    /// unless all thresholds are higher or P_c ends there smoothly); 0 if that is not known.
    fn length(&self, low: f64, high: f64) -> f64 {
        /// P_c may vary by so much faster than its resolution, on its steeper side.
        const STEEPER: f64 = 1.5;
        let beside = |&edge: &f64| match edge {
            _ if edge <= low => low - edge,
            _ if edge >= high && self.reported => edge - high,
            _ => 0.0,
        };
        let near_zero = !self.starts_smoothly && self.thresholds.cumulative(high) > NEGLIGIBLE;
        let lowest = if near_zero { low } else { f64::INFINITY };
        self.edges.iter().map(beside).fold(lowest.min(self.resolution), f64::min) / STEEPER
    }
}

/// Whether a distribution has an end at 0 that Gauss rules do not notice: a negligible density there, or a high power.
fn starts_smoothly(law: &dyn Law) -> bool {
    /// The rule of n points misses n^{−2α−2} of a power x^α (P. J. Davis and P. Rabinowitz, *Methods of Numerical
    /// Integration*, 1984, §4.6): 5e-17 for eight points.
    const HIGH: f64 = 8.0;
    let mean = law.mean();
    let is_smooth = |b: &Breakpoint| b.exponent >= HIGH || b.weight(mean) * mean <= NEGLIGIBLE;
    let ends: Vec<_> = law.breakpoints().into_iter().filter(|b| b.position == 0.0).collect();
    !ends.is_empty() && ends.iter().all(is_smooth) && law.atoms().iter().all(|atom| atom.position > 0.0)
}

/// The values of all curves of a life at one advance, summed over cohorts.
#[derive(Debug, Clone, Copy, Default)]
struct CohortSums {
    breaking: f64,
    survival: f64,
    stiffness: f64,
    force: f64,
    square: f64,
    energy: f64,
    /// ½k x² of breaking contacts, per unit advance.
    lost: f64,
}

/// The life of contacts of this breaking model whose starts are drawn from `starts`, as in
/// [`super::athermal`].
///
/// # Errors
/// Stopped by the monitor.
pub(super) fn of_cohorts(
    contacts: &Contacts,
    model: Arc<dyn BreakingModel>,
    starts: &dyn Law,
    conditional: bool,
    watch: &Watch<'_>,
) -> Result<Life> {
    let mut cohorts = Cohorts::new(contacts, model, starts, conditional, watch)?;
    let per_threshold = matches!(contacts.stiffness, Stiffness::PerThreshold(_));
    let panels = cohorts.panels();
    let at = |u: f64| watch.value(|| cohorts.sums(&panels, u, per_threshold, watch));
    let unbroken = if conditional { 1.0 } else { at(0.0).survival };
    let mut breakpoints = cohorts.breakpoints(watch);
    let stops = breakpoints.iter().map(|b| b.position).chain(cohorts.approaches(watch)).collect();
    let outline = Outline::new(&at, stops, contacts.thresholds.mean());
    let rounding = cohorts.model.rounding();
    // A jump whose effect over a cell is below the error of the model is noise between two
    // polynomials; as a breakpoint it would only cost cells.
    breakpoints.retain(|b| b.exponent != 0.0 || b.amplitude.abs() * outline.beside(b.position) >= rounding);
    watch.check()?;
    let edges = &outline.edges;
    let end = edges[edges.len() - 1];
    let made = cohorts.model.making_fraction() + OUTLINED * (1.0 - cohorts.model.making_fraction());
    // The curves are resolved from u = 0 on, twice where the stiffness has one of its own.
    let begun = if per_threshold { 0.5 * (1.0 + made) } else { made };
    let report_progress = |from: f64, to: f64, u: f64| {
        let passed = outline.edges.partition_point(|edge| *edge <= u) as f64 / outline.edges.len() as f64;
        watch.done(from + (to - from) * passed);
    };
    let reported = |u: f64| {
        report_progress(made, begun, u);
        at(u)
    };
    let model = &cohorts.model;
    // With k = κ h the stiffness changes by ageing even where nothing breaks, and needs cells of its own.
    let finer =
        per_threshold.then(|| stiffening(&reported, edges, contacts.thresholds.mean(), model.roughness()));
    let edges = finer.as_ref().unwrap_or(edges);
    // The first function decides on the cells: the breaking density, weighted by its effect on the results.
    // The others are integrals of it and smoother.
    let (curves, missed) = Piecewise::resolve_all(
        |u| {
            report_progress(begun, 1.0, u);
            let CohortSums { breaking, survival, force, square, energy, lost, .. } = at(u);
            [outline.weight(u) * breaking, breaking, survival, force, square, energy, lost]
        },
        edges,
        end,
        Resolution::Mean(RESOLUTION.max(model.roughness())),
    );
    let [_, breaking, survival, force, square, energy, lost] = curves;
    watch.cost(Cost::LifeCells, breaking.coefficients.len());
    begin(&mut breakpoints, &breaking, 0.0, 0.0);
    if 1.0 - unbroken > NEGLIGIBLE {
        breakpoints.push(Atom { position: 0.0, weight: 1.0 - unbroken }.into());
    }
    Breakpoint::sort(&mut breakpoints);
    let smoother: Vec<_> =
        breakpoints.iter().map(|&b| Breakpoint { exponent: b.exponent + 1.0, ..b }).collect();
    let kernel = |curve: Piecewise| Kernel::new(curve, smoother.clone());
    let breaking_energy = lost.integrated_from_end(0.0, &cohorts.simultaneous(per_threshold, watch));
    watch.check()?;
    drop(panels);
    // WebAssembly keeps memory that has been freed. Elsewhere a cohort that is needed later is computed again.
    if cfg!(not(target_family = "wasm")) && cohorts.model.is_large() {
        cohorts.spread.values_mut().for_each(|cohort| *cohort = OnceLock::new());
    }
    Ok(Life {
        survival: kernel(survival),
        force: kernel(force),
        square: kernel(square),
        energy: kernel(energy),
        breaking_energy: kernel(breaking_energy),
        breaking: Kernel::new(breaking, breakpoints),
        error: cohorts.model.error().max(missed),
        starts: Starts::Cohorts(Box::new(cohorts)),
        stiffness: contacts.stiffness.mean_weight(contacts.thresholds.as_ref()),
        wait: 0.0,
        waiting: None,
    })
}

/// Initial cell boundaries, and the scales by which errors are judged.
struct Outline {
    edges: Vec<f64>,
    /// About ∫U du, U the survival.
    mean: f64,
    /// About ∫u U du.
    lived: f64,
}

impl Outline {
    /// Boundaries from 0 to where survival is negligible, with a limited loss of contacts per cell, each cell
    /// at most as wide as all before it; and at `stops`.
    fn new(at: &impl Fn(f64) -> CohortSums, mut stops: Vec<f64>, mean: f64) -> Self {
        let start = at(0.0);
        let rate = start.breaking / start.survival;
        let first =
            if rate.is_finite() { mean.min(1.0 / rate.max(f64::MIN_POSITIVE)) / 8.0 } else { mean / 8.0 };
        stops.retain(|&u| u > 0.0);
        stops.sort_by(f64::total_cmp);
        // The range of a life is not known in advance: at low velocities temperature breaks
        // contacts decades below their thresholds, and ageing carries them beyond. Cells that
        // double in width find the end in a logarithmic number of evaluations.
        let (mut edges, mut next, mut sums) = (vec![(0.0, start.survival)], first, [0.0; 4]);
        // Cells double in width unless too many contacts would break in one of them.
        loop {
            let (before, left) = edges[edges.len() - 1];
            let stop =
                stops[stops.partition_point(|&u| u <= before)..].first().copied().unwrap_or(f64::INFINITY);
            // A cell that would end just beyond a breakpoint ends on it.
            let to = if stop < 1.25 * next { stop } else { next };
            // Sums that are no numbers never converge; they are reported as what they are.
            if !to.is_finite() {
                break;
            }
            let here = at(to);
            let first = edges.len();
            split(at, [(before, left), (to, here.survival)], start.survival, &mut edges);
            for k in first..edges.len() {
                let ((low, more), (high, less)) = (edges[k - 1], edges[k]);
                sums[0] += 0.5 * (high - low) * (more + less);
                sums[1] += 0.5 * (high - low) * (low * more + high * less);
            }
            for (sum, last) in sums[2..].iter_mut().zip([here.force, here.square]) {
                *sum += (to - before) * last;
            }
            let rest = [here.survival, to * here.survival, here.force, here.square];
            // Survival, first moment, force and its square: every integral that a result is made of
            // must have converged.
            if rest.iter().zip(sums).all(|(rest, sum)| to * rest <= NEGLIGIBLE * sum) {
                break;
            }
            next = if to >= next { 2.0 * to } else { next };
        }
        let [mean, lived, ..] = sums;
        // What has been split may be negligible long before the end of the cell.
        let matters = |&(u, left): &(f64, f64)| {
            let rest = u * left;
            rest > NEGLIGIBLE * mean
                || u * rest > NEGLIGIBLE * lived
                || u * u * rest > NEGLIGIBLE * lived * (lived / mean)
        };
        edges.truncate(edges.iter().rposition(matters).map_or(2, |last| last + 2));
        Self { edges: edges.into_iter().map(|edge| edge.0).collect(), mean, lived }
    }

    /// The width of the narrower cell beside a boundary.
    fn beside(&self, edge: f64) -> f64 {
        let next = self.edges.partition_point(|&e| e <= edge);
        let before = self.edges[..next].iter().rev().find(|&&e| e < edge).map_or(edge, |low| edge - low);
        self.edges.get(next).map_or(before, |high| before.min(high - edge))
    }

    /// The weight of errors of the breaking density at the advance u: breaking there changes ∫U, ∫u U and U
    /// by as much.
    fn weight(&self, advance: f64) -> f64 {
        1.0 + advance / self.mean + 0.5 * advance * advance / self.lived
    }
}

/// Cell boundaries that also resolve the stiffness, which ageing changes while nothing breaks.
fn stiffening(at: &impl Fn(f64) -> CohortSums, edges: &[f64], mean: f64, roughness: f64) -> Vec<f64> {
    let resolution = Resolution::Relative { fraction: roughness.max(1e-13), negligible: mean };
    Piecewise::resolve(|u| at(u).stiffness, edges, edges[edges.len() - 1], resolution).boundaries
}

/// Adds the end of a cell, and boundaries inside it wherever the loss of contacts is too large for one cell.
fn split(
    at: &impl Fn(f64) -> CohortSums,
    [low, high]: [(f64, f64); 2],
    whole: f64,
    edges: &mut Vec<(f64, f64)>,
) {
    const PART: f64 = 0.2;
    const NARROWEST: f64 = 1e-13;
    if low.1 - high.1 > PART * whole && high.0 - low.0 > NARROWEST * high.0 {
        let middle = 0.5 * (low.0 + high.0);
        let middle = (middle, at(middle).survival);
        split(at, [low, middle], whole, edges);
        return split(at, [middle, high], whole, edges);
    }
    edges.push(high);
}

impl Cohorts {
    fn new(
        contacts: &Contacts,
        model: Arc<dyn BreakingModel>,
        starts: &dyn Law,
        conditional: bool,
        watch: &Watch<'_>,
    ) -> Result<Self> {
        let starts = Layer::placed(contacts, starts, conditional, BULK);
        let together =
            starts.point_masses.iter().map(|point_mass| model.cohort(point_mass.position, watch)).collect();
        let reach = Reach::new(contacts, model.resolution(), model.tells_of_edges());
        let mut cohorts = Self { model, starts, together, spread: HashMap::new(), few: Vec::new(), reach };
        /// For more cohorts their breakpoints are too small to matter, and too many.
        const FEW: usize = 8;
        let everywhere =
            Domain { low: f64::NEG_INFINITY, high: f64::INFINITY, cuts: Vec::new(), steep: Vec::new() };
        let (mut points, mut spread) = (Vec::new(), HashMap::new());
        let panels = cohorts.panels();
        panels.each(everywhere, |r, weight| points.push((r, weight)));
        panels.all(|r| {
            spread.insert(f64::to_bits(r), OnceLock::new());
        });
        let (count, finished) = (points.len() as f64, AtomicUsize::new(0));
        let make = |(): &mut (), number: usize| {
            let cohort = cohorts.model.cohort(points[number].0, watch);
            let finished = finished.fetch_add(1, Ordering::Relaxed) + 1;
            watch.done(cohorts.model.making_fraction() * finished as f64 / count);
            cohort
        };
        // Cohorts do not depend on each other, and each is a solution of a partial differential
        // equation or a table: threads share them.
        let found = watch.share(points.len(), || (), make)?;
        watch.cost(Cost::LifeCohorts, points.len());
        if points.len() <= FEW && !cohorts.model.tells_of_edges() {
            cohorts.few = points.iter().map(|point| point.1).zip(found.iter().cloned()).collect();
        }
        spread
            .extend(points.iter().map(|point| point.0.to_bits()).zip(found.into_iter().map(OnceLock::from)));
        cohorts.spread = spread;
        Ok(cohorts)
    }

    /// The density of starts on panels that resolve how survival moments vary with the start.
    fn panels(&self) -> Panels<'_> {
        /// Error of a merged panel: rounding.
        const LEFT_OUT: f64 = 1e-16;
        self.reach.panels(&self.starts, LEFT_OUT)
    }

    /// The sums at an advance.
    fn sums(&self, panels: &Panels<'_>, advance: f64, per_threshold: bool, watch: &Watch<'_>) -> CohortSums {
        let mut sums = CohortSums::default();
        for (point_mass, cohort) in self.point_masses() {
            sums.add(
                cohort.survival_moments(advance, watch),
                point_mass.weight,
                point_mass.position + advance,
                per_threshold,
            );
        }
        if self.starts.is_pointed() {
            return sums;
        }
        let passing = self.model.passing(advance);
        for pass in passing.iter().filter(|pass| pass.weight > 0.0) {
            // Contacts of different starts meet one threshold at different advances: a point mass
            // of thresholds becomes a density of breaks, starts × speed at which the starts pass
            // it.
            let weight = self.starts.density_at(pass.start) * pass.weight * pass.speed;
            sums.add_broken(weight, pass.start + advance, per_threshold);
        }
        let domain = Domain {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            cuts: passing.iter().map(|pass| pass.start).collect(),
            steep: Vec::new(),
        };
        panels.each(domain, |r, weight| {
            sums.add(self.survival_moments(r, advance, watch), weight, r + advance, per_threshold);
        });
        sums
    }

    /// Survival moments of contacts formed at a stretch; cached for the Gauss points of the starts.
    fn survival_moments(&self, start: f64, advance: f64, watch: &Watch<'_>) -> SurvivalMoments {
        let make = || self.model.cohort(start, watch);
        watch.value(|| match self.spread.get(&start.to_bits()) {
            Some(known) => known.get_or_init(make).survival_moments(advance, watch),
            None => make().survival_moments(advance, watch),
        })
    }

    /// ∫ of the density of starts below x times a function that is smooth between `cuts`.
    fn below(&self, x: f64, cuts: &[f64], of: impl Fn(f64) -> f64) -> f64 {
        let panels = self.panels();
        let domain = Domain { low: f64::NEG_INFINITY, high: x, cuts: cuts.to_vec(), steep: Vec::new() };
        let mut sum = 0.0;
        panels.each(domain, |start, weight| sum += weight * of(start));
        sum
    }

    /// Breakpoints and point masses of the breaking density for u > 0.
    fn breakpoints(&self, watch: &Watch<'_>) -> Vec<Breakpoint> {
        let mut out = Vec::new();
        let point_masses =
            self.starts.point_masses.iter().map(|point_mass| point_mass.weight).zip(&self.together);
        for (weight, cohort) in point_masses.chain(self.few.iter().map(|(weight, cohort)| (*weight, cohort)))
        {
            let scaled = |b: Breakpoint| Breakpoint { amplitude: b.amplitude * weight, ..b };
            out.extend(cohort.breakpoints(watch).into_iter().map(scaled));
        }
        for start in &self.starts.breakpoints {
            let met = self.model.cohort(start.position, watch).breakpoints(watch);
            out.extend(
                met.into_iter().map(|b| Breakpoint { position: b.position, ..b.convolve(start.mirrored()) }),
            );
        }
        // At u = 0 only those that jumps of derivatives do not describe.
        out.retain(|b| b.position > 0.0 || b.is_steep());
        out
    }

    /// Cell boundaries before blurred edges, whose changes wide cells would miss.
    fn approaches(&self, watch: &Watch<'_>) -> impl Iterator<Item = f64> {
        let edged = self.starts.breakpoints.iter().map(|start| self.model.cohort(start.position, watch));
        let all = self.together.iter().cloned().chain(edged);
        all.flat_map(|cohort| cohort.blurred_edges()).flat_map(BlurredEdge::approach)
    }

    /// The point masses of the starts, with their cohorts.
    fn point_masses(&self) -> impl Iterator<Item = (&super::PointMass, &Arc<dyn Cohort>)> {
        self.starts.point_masses.iter().zip(&self.together)
    }

    /// Those at or below a stretch x.
    fn point_masses_up_to(&self, x: f64) -> impl Iterator<Item = (&super::PointMass, &Arc<dyn Cohort>)> {
        self.point_masses().filter(move |(point_mass, _)| point_mass.position <= x)
    }

    /// Point masses of the energy lost.
    fn simultaneous(&self, per_threshold: bool, watch: &Watch<'_>) -> Vec<(f64, f64)> {
        let mut out = Vec::new();
        for (point_mass, cohort) in self.point_masses() {
            for met in cohort.breakpoints(watch).into_iter().filter(Breakpoint::is_atom) {
                let stretch = point_mass.position + met.position;
                let power = if per_threshold { 3 } else { 2 };
                out.push((met.position, 0.5 * point_mass.weight * met.amplitude * stretch.powi(power)));
            }
        }
        sort_by_number(&mut out, |item| item.0);
        out
    }

    /// Density at stretch x of contacts that formed u ago.
    pub(super) fn density(&self, x: f64, advance: f64, watch: &Watch<'_>) -> f64 {
        let start = x - advance;
        let density = self.starts.density_at(start);
        if density == 0.0 { 0.0 } else { density * self.survival_moments(start, advance, watch).unbroken[0] }
    }

    /// Stretches of the contacts that formed u ago at point masses, with the surviving fraction.
    pub(super) fn atoms<'a>(&'a self, advance: f64, watch: &'a Watch<'_>) -> impl Iterator<Item = Atom> + 'a {
        self.point_masses().map(move |(point_mass, cohort)| Atom {
            position: point_mass.position + advance,
            weight: point_mass.weight * cohort.survival_moments(advance, watch).unbroken[0],
        })
    }

    /// Density at stretch x of contacts that have formed at the rate `rate(advance)`, not smooth at starts in
    /// `cuts`.
    pub(super) fn standing(&self, x: f64, rate: impl Fn(f64) -> f64, cuts: &[f64], watch: &Watch<'_>) -> f64 {
        let one = |(point_mass, cohort): (&super::PointMass, &Arc<dyn Cohort>)| {
            let advance = x - point_mass.position;
            point_mass.weight * cohort.survival_moments(advance, watch).unbroken[0] * rate(advance)
        };
        let left = |r: f64| self.survival_moments(r, x - r, watch).unbroken[0] * rate(x - r);
        self.point_masses_up_to(x).map(one).sum::<f64>() + self.below(x, cuts, left)
    }
}

impl Cohorts {
    /// Density at x of the stretches at which contacts break, without point masses.
    pub(super) fn breaking(&self, x: f64, watch: &Watch<'_>) -> f64 {
        let one = |(point_mass, cohort): (&super::PointMass, &Arc<dyn Cohort>)| {
            point_mass.weight * cohort.survival_moments(x - point_mass.position, watch).breaking[0]
        };
        let met = |r: f64| self.survival_moments(r, x - r, watch).breaking[0];
        self.point_masses_up_to(x).map(one).sum::<f64>() + self.below(x, &[], met)
    }

    /// Stretches at which contacts that formed at point masses break simultaneously.
    pub(super) fn breaking_stretch_atoms(&self, watch: &Watch<'_>) -> Vec<Atom> {
        let of = |(point_mass, cohort): (&super::PointMass, &Arc<dyn Cohort>)| {
            let (position, weight) = (point_mass.position, point_mass.weight);
            let met = cohort.breakpoints(watch).into_iter().filter(Breakpoint::is_atom);
            met.map(move |b| Atom { position: position + b.position, weight: weight * b.amplitude })
                .collect::<Vec<_>>()
        };
        self.point_masses().flat_map(of).collect()
    }
}

impl CohortSums {
    /// Adds the surviving and the breaking contacts of a cohort at the stretch x.
    fn add(&mut self, survival_moments: SurvivalMoments, weight: f64, x: f64, per_threshold: bool) {
        let [unbroken, first, second] = survival_moments.unbroken.map(|sum| weight * sum);
        let [breaking, breaking_first] = survival_moments.breaking.map(|sum| weight * sum);
        let (stiffness, squared, lost) =
            if per_threshold { (first, second, breaking_first) } else { (unbroken, unbroken, breaking) };
        self.breaking += breaking;
        self.survival += unbroken;
        self.stiffness += stiffness;
        self.force += x * stiffness;
        self.square += x * x * squared;
        self.energy += 0.5 * x * x * stiffness;
        self.lost += 0.5 * x * x * lost;
    }

    /// Adds contacts that break at the threshold x.
    fn add_broken(&mut self, weight: f64, x: f64, per_threshold: bool) {
        self.breaking += weight;
        self.lost += 0.5 * x * x * weight * if per_threshold { x } else { 1.0 };
    }
}
