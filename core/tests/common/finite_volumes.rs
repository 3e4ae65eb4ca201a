//! A time step of a Fokker–Planck equation by finite volumes above an absorbing boundary that may rise: a reference
//! that shares no code with the solvers.
//!
//! Two stages, u₁ = A₁m and A₂[(1 + √2)u₁ − √2m] with A = (1 − γtL)⁻¹, γ = 1 − 1/√2, for the boundary
//! after γt and after t: L-stable and of second order (R. Alexander, SIAM J. Numer. Anal. 14, 1006 (1977)). Where this
//! makes a mass negative, it is corrected towards backward Euler, which cannot, by limiting the flux between the two
//! (S. T. Zalesak, J. Comput. Phys. 31, 335 (1979)).

use std::sync::Arc;

use asperity::contacts::ThresholdFokkerPlanck;

const SQRT_2: f64 = std::f64::consts::SQRT_2;
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The Bernoulli function z/(e^z − 1).
fn bernoulli(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { z / z.exp_m1() }
}

/// No boundary.
pub const NO_FLOOR: (f64, f64) = (f64::NEG_INFINITY, f64::NEG_INFINITY);

/// Less than this fraction of a cell above the boundary counts as none.
const SLIVER: f64 = 1e-9;

/// The operator L = D∂_h[U' + ∂_h] on equal cells, with reflecting ends.
#[derive(Debug, Clone)]
pub struct Diffusion {
    low: f64,
    width: f64,
    /// D.
    pub diffusion: f64,
    /// U_{i+1} − U_i, for each cell but the last.
    rises: Vec<f64>,
    /// Rate at which mass goes from a cell to the next one up; 0 for the last.
    pub up: Vec<f64>,
    /// Rate at which mass goes from a cell to the next one down; 0 for the first.
    pub down: Vec<f64>,
}

impl Diffusion {
    /// The operator on cells of one `width` from `low` on, one for each value of the `potential`: −ln of the
    /// stationary mass of the cell, up to a constant. All values must be finite, and D > 0.
    pub fn new(low: f64, width: f64, potential: &[f64], diffusion: f64) -> Self {
        let rises: Vec<f64> = potential.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rate = diffusion / (width * width);
        let up = rises.iter().map(|&rise| rate * bernoulli(rise)).chain([0.0]).collect();
        let down = [0.0].into_iter().chain(rises.iter().map(|&rise| rate * bernoulli(-rise))).collect();
        Self { low, width, diffusion, rises, up, down }
    }

    /// The operator of thresholds on `cells` equal cells.
    pub fn of(maturing: &ThresholdFokkerPlanck, cells: usize) -> Self {
        let ((low, high), potential) = (maturing.support, maturing.potential());
        let width = (high - low) / cells as f64;
        let values: Vec<f64> = (0..cells).map(|i| potential.at(low + (i as f64 + 0.5) * width)).collect();
        Self::new(low, width, &values, maturing.diffusion)
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.up.len()
    }

    /// Width of a cell.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The lower edge of a cell; `edge(cells())` is the upper end.
    pub fn edge(&self, cell: usize) -> f64 {
        self.low + cell as f64 * self.width
    }

    /// The middle of a cell.
    pub fn centre(&self, cell: usize) -> f64 {
        self.low + (cell as f64 + 0.5) * self.width
    }

    /// The middles of all cells.
    pub fn middles(&self) -> Vec<f64> {
        (0..self.cells()).map(|cell| self.centre(cell)).collect()
    }

    /// Slope U' of the potential at a cell.
    pub fn slope(&self, cell: usize) -> f64 {
        let rise = self.rises.get(cell).or(self.rises.last());
        rise.map_or(0.0, |rise| rise / self.width)
    }
}

/// A step of one duration.
pub struct DiffusionStep {
    operator: Arc<Diffusion>,
    duration: f64,
    elimination: Elimination,
}

/// Work space of steps.
#[derive(Default)]
pub struct Work {
    first: Vec<f64>,
    second: Vec<f64>,
}

impl DiffusionStep {
    pub fn new(operator: &Arc<Diffusion>, duration: f64) -> Self {
        let elimination = Elimination::new(operator, GAMMA * duration);
        Self { operator: operator.clone(), duration, elimination }
    }

    /// Advances masses while the boundary rises from one position to another; returns the mass it absorbs. There is no
    /// mass below it.
    pub fn advance(&self, masses: &mut [f64], floor: (f64, f64), work: &mut Work) -> f64 {
        work.first.resize(masses.len(), 0.0);
        work.second.resize(masses.len(), 0.0);
        let from = place(&self.operator, floor.0).0;
        if from == masses.len() {
            return 0.0;
        }
        let Work { first, second } = work;
        let [early, late] = self.cuts(floor, from);
        let once = self.elimination.solve(&self.operator, &early, masses, first);
        for (second, (first, mass)) in
            second[from..].iter_mut().zip(first[from..].iter().zip(&masses[from..]))
        {
            *second = (1.0 + SQRT_2) * first - SQRT_2 * mass;
        }
        let twice = self.elimination.solve(&self.operator, &late, second, first);
        let absorbed = (1.0 + SQRT_2) * once + twice;
        if first[from..].iter().chain([&absorbed]).any(|&mass| mass < 0.0) {
            return self.limited(masses, floor, from, work);
        }
        masses[from..].copy_from_slice(&first[from..]);
        absorbed
    }

    /// The boundary at the two stages. What the second stage passes of a cell is what is still to be passed after the
    /// first one, extrapolated like the masses.
    fn cuts(&self, (start, end): (f64, f64), from: usize) -> [Cut; 2] {
        let middle = if start == end { end } else { start + GAMMA * (end - start) };
        let early = |edge: f64| (middle - edge.max(start)).max(0.0);
        let late = |edge: f64| (end - edge.max(middle)).max(0.0) - SQRT_2 * early(edge);
        [Cut::at(&self.operator, middle, from, early), Cut::at(&self.operator, end, from, late)]
    }

    /// The step by backward Euler, corrected towards the masses in `work.first` as far as none turns negative.
    fn limited(&self, masses: &mut [f64], floor: (f64, f64), from: usize, work: &mut Work) -> f64 {
        let euler = Elimination::new(&self.operator, self.duration);
        let Work { first, second } = work;
        let cut = Cut::at(&self.operator, floor.1, from, |edge| floor.1 - edge.max(floor.0));
        let absorbed = euler.solve(&self.operator, &cut, masses, second);
        let flow = correct(&second[from..], &mut first[from..], &mut masses[from..], absorbed);
        absorbed * (1.0 - flow / absorbed.max(f64::MIN_POSITIVE))
    }
}

/// Writes into `out` the masses `safe`, corrected towards `better` by limited fluxes between neighbours, so that none is
/// below 0. Returns the flux up into the lowest cell, out of what has been `lost` below it. `better` is overwritten.
fn correct(safe: &[f64], better: &mut [f64], out: &mut [f64], lost: f64) -> f64 {
    let flows = better;
    let mut flow = 0.0;
    for (better, safe) in flows.iter_mut().zip(safe).rev() {
        flow += *better - safe;
        *better = flow;
    }
    let above = |i: usize| flows.get(i + 1).copied().unwrap_or(0.0);
    let fraction = |held: f64, wanted: f64| if wanted > held { held / wanted } else { 1.0 };
    let giving = |i: usize| fraction(safe[i], (-flows[i]).max(0.0) + above(i).max(0.0));
    let allowed = |i: usize| {
        let giver = if flows[i] <= 0.0 { Some(i) } else { i.checked_sub(1) };
        flows[i] * giver.map_or_else(|| fraction(lost, flows[i]), giving)
    };
    let mut over = 0.0;
    for i in (0..safe.len()).rev() {
        let flow = allowed(i);
        out[i] = (safe[i] + flow - over).max(0.0);
        over = flow;
    }
    over
}

/// The elimination of (1 − aL)u = m from the top down, done once for all boundaries: a boundary changes its own cell and
/// the next one only.
struct Elimination {
    a: f64,
    cells: Vec<Factor>,
}

#[derive(Clone, Copy, Default)]
struct Factor {
    /// a l_i/d_i: what the cell hands down.
    handed: f64,
    /// 1 − a l_i/d_i.
    kept: f64,
    /// 1/d_i.
    inverse: f64,
    /// a r_{i−1}/d_i.
    lifted: f64,
}

impl Elimination {
    fn new(operator: &Diffusion, a: f64) -> Self {
        let mut cells = vec![Factor::default(); operator.cells()];
        let mut kept = 0.0;
        for i in (0..operator.cells()).rev() {
            let (rest, down) = (1.0 + a * operator.up[i] * kept, a * operator.down[i]);
            let inverse = 1.0 / (rest + down);
            let below = if i > 0 { operator.up[i - 1] } else { 0.0 };
            kept = rest * inverse;
            cells[i] = Factor { handed: down * inverse, kept, inverse, lifted: a * below * inverse };
        }
        Self { a, cells }
    }

    /// Writes (1 − aL)⁻¹ `right` into `out`; returns what the boundary absorbs.
    fn solve(&self, operator: &Diffusion, cut: &Cut, right: &[f64], out: &mut [f64]) -> f64 {
        let (a, j, top) = (self.a, cut.cell, operator.cells() - 1);
        let below: f64 = right[cut.from..j].iter().sum();
        out[cut.from..j].fill(0.0);
        if j > top {
            return below;
        }
        let loss = a * cut.loss + cut.passed;
        if j == top {
            out[j] = right[j] / (1.0 + loss);
            return below + loss * out[j];
        }
        let mut carried = 0.0;
        for ((out, right), factor) in
            out[j + 1..].iter_mut().zip(&right[j + 1..]).zip(&self.cells[j + 1..]).rev()
        {
            *out = right + carried;
            carried = factor.handed * *out;
        }
        let above = if j + 1 == top { 0.0 } else { operator.up[j + 1] * self.cells[j + 2].kept };
        let rest = 1.0 + a * above;
        let next = rest + a * cut.down;
        let lowest = 1.0 + a * cut.up * rest / next + loss;
        out[j] = (right[j] + a * cut.down / next * out[j + 1]) / lowest;
        out[j + 1] = (out[j + 1] + a * cut.up * out[j]) / next;
        let mut lower = out[j + 1];
        for (out, factor) in out[j + 2..].iter_mut().zip(&self.cells[j + 2..]) {
            lower = factor.inverse * *out + factor.lifted * lower;
            *out = lower;
        }
        below + loss * out[j]
    }
}

/// The lowest cell above a boundary, and the rates that the boundary changes.
struct Cut {
    /// The lowest cell that holds mass before; what is below the cell that is cut is absorbed.
    from: usize,
    /// The cell that is cut; as many as there are cells, if nothing is above the boundary.
    cell: usize,
    /// Rate from it to the next cell up.
    up: f64,
    /// Rate from that one down.
    down: f64,
    /// Rate at which its mass diffuses into the boundary.
    loss: f64,
    /// What the boundary has passed of it, over what is left.
    passed: f64,
}

impl Cut {
    /// The cut by a boundary that was in cell `from` before; `travel(e)` is how far it has risen above e.
    ///
    /// The density is 0 at the boundary, the flux through it that of Scharfetter and Gummel over half of what is left of
    /// the cell, s: 2D/s² per mass without a slope. Towards the next cell the distance is (s + Δ)/2.
    fn at(operator: &Diffusion, floor: f64, from: usize, travel: impl Fn(f64) -> f64) -> Self {
        if floor < operator.edge(0) {
            let down = operator.down.get(1).copied().unwrap_or(0.0);
            return Self { from: 0, cell: 0, up: operator.up[0], down, loss: 0.0, passed: 0.0 };
        }
        let (cell, width) = place(operator, floor);
        if cell == operator.cells() {
            return Self { from, cell, up: 0.0, down: 0.0, loss: 0.0, passed: 0.0 };
        }
        let (slope, half) = (operator.slope(cell), 0.5 * width);
        let loss = operator.diffusion / (half * width) * bernoulli(-slope * half);
        let passed = travel(operator.edge(cell)) / width;
        if cell + 1 == operator.cells() {
            return Self { from, cell, up: 0.0, down: 0.0, loss, passed };
        }
        let distance = half + 0.5 * operator.width();
        let (rate, rise) = (operator.diffusion / distance, slope * distance);
        let (up, down) = (rate * bernoulli(rise) / width, rate * bernoulli(-rise) / operator.width());
        Self { from, cell, up, down, loss, passed }
    }
}

/// The lowest cell above a boundary, and what is left of its width.
fn place(operator: &Diffusion, floor: f64) -> (usize, f64) {
    let cells = ((floor - operator.edge(0)) / operator.width()).max(0.0);
    let cell = (cells + SLIVER).floor().min(operator.cells() as f64);
    (cell as usize, (cell + 1.0 - cells).clamp(SLIVER, 1.0) * operator.width())
}
