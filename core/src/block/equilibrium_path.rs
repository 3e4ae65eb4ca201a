//! The equilibrium path of a slider on the smooth interval ahead: where an equilibrium becomes unstable, and where the next
//! one is.

use crate::Result;
use crate::energy::ContactEnergies;
use crate::monitor::{Aside, Monitor, report};
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::roots::{brent_minimum, brent_root};
use crate::population::{Direction, Population, Response, SmoothInterval};

use super::Loading;

/// Derivatives of the drive below this fraction of the largest on the interval count as 0, given the accuracy of forces.
const MARGINAL: f64 = 1e-9;

/// A population under a loading, with the smooth interval ahead. Advances a ≥ 0 are measured in the direction of motion, and
/// drives have its sign, so that backward motion is the mirror image of forward motion.
pub(super) struct EquilibriumPath<'a> {
    population: &'a mut dyn Population,
    /// Monitor of long operations of the population.
    watch: Aside<'a>,
    pub loading: Loading,
    /// Background force B, against the direction of motion.
    background: f64,
    /// The part of the friction force that responses and drives leave out; see [`EquilibriumPath::shift`].
    shift: f64,
    /// Displacement of the slider while no contact was attached.
    pub carried: f64,
    pub direction: Direction,
    pub interval: SmoothInterval,
    /// Whether `interval` starts at the present state.
    current: bool,
    /// Response at the present position.
    pub here: Response,
    /// Position X of the slider.
    pub position: f64,
    /// Responses at the Gauss points of an interval on which the force is not linear.
    points: [Response; NODES],
}

impl<'a> EquilibriumPath<'a> {
    pub fn new(
        population: &'a mut dyn Population,
        (loading, background): (Loading, f64),
        direction: Direction,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let nothing = Response { force: 0.0, tangent: 0.0 };
        let interval = SmoothInterval { length: f64::INFINITY, straight: true, breaks: false };
        let position = population.position();
        let (here, points) = (nothing, [nothing; NODES]);
        let (carried, current) = (0.0, false);
        let watch = Aside { fraction: 0.0, monitor };
        let mut path = Self {
            population,
            watch,
            loading,
            background,
            shift: if loading == Loading::Force { 0.0 } else { background },
            carried,
            direction,
            interval,
            current,
            here,
            position,
            points,
        };
        path.find_interval(direction)?;
        Ok(path)
    }

    /// Reports the fraction done to the monitor, never less than before.
    pub fn report_progress(&mut self, fraction: f64) -> Result<()> {
        self.watch.fraction = fraction.clamp(self.watch.fraction, 1.0);
        report(self.watch.monitor, self.watch.fraction)
    }

    /// Computes the interval ahead in `direction`, unless it is known.
    pub fn find_interval(&mut self, direction: Direction) -> Result<()> {
        if self.current && self.direction == direction {
            return Ok(());
        }
        self.interval = self.population.smooth_interval(direction, &mut self.watch)?;
        (self.direction, self.current) = (direction, true);
        self.here = self.with_background(self.population.ahead(0.0));
        if !self.interval.straight {
            // Evaluated once for each interval: the search for stationary points and the integrals use them.
            for (i, t) in RULE.nodes.iter().enumerate() {
                self.points[i] = self.response(self.point(*t));
            }
        }
        Ok(())
    }

    /// Advances by `a`. `here` becomes the response at the end, before simultaneous breaks there.
    pub fn advance(&mut self, a: f64) -> Result<()> {
        self.here = self.response(a);
        self.current = false;
        self.population.advance(self.sign() * a)?;
        self.position = self.population.position() + self.carried;
        Ok(())
    }

    /// Moves the slider to `position` while no contact is attached.
    pub fn carry(&mut self, position: f64) {
        self.carried += position - self.position;
        self.position = position;
    }

    /// Makes the simultaneous breaks at the end of the interval.
    pub fn cross(&mut self) -> Result<()> {
        self.current = false;
        self.population.cross(&mut self.watch)
    }

    /// Breaks all contacts.
    pub fn reset(&mut self) -> Result<()> {
        self.current = false;
        self.population.reset(self.direction, &mut self.watch)
    }

    /// Keeps contacts free that break from now on.
    pub fn hold(&mut self) -> Result<()> {
        self.current = false;
        self.population.hold()
    }

    /// Re-forms free contacts.
    pub fn release(&mut self) -> Result<()> {
        self.current = false;
        self.population.release(&mut self.watch)
    }

    /// Marks the state of the contacts.
    pub fn mark(&mut self) {
        self.population.mark();
    }

    /// Returns to the marked state.
    pub fn recall(&mut self) -> Result<()> {
        self.current = false;
        self.population.recall(&mut self.watch)?;
        self.position = self.population.position() + self.carried;
        Ok(())
    }

    /// Energies and breaks of the contacts.
    pub fn energies(&self) -> ContactEnergies {
        self.population.energies()
    }

    /// The advance of the Gauss point t of [−1, 1] on the interval.
    fn point(&self, t: f64) -> f64 {
        0.5 * self.interval.length * (1.0 + t)
    }

    pub fn sign(&self) -> f64 {
        self.direction.sign()
    }

    /// The response after an advance a.
    pub fn response(&self, a: f64) -> Response {
        if self.interval.straight {
            let Response { force, tangent } = self.here;
            return Response { force: force + self.sign() * a * tangent, tangent };
        }
        self.with_background(self.population.ahead(self.sign() * a))
    }

    /// What responses leave out of the friction force, and drives out of the spring force. Behind a spring it is B: then a
    /// slider that goes forward has the forces and the drives that it would have without a background force. An imposed force
    /// is complete.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// A response of the contacts with a background ±B that resists motion in the present direction, less the shift.
    fn with_background(&self, contacts: Response) -> Response {
        // In forward motion nothing is added that could be rounded.
        Response { force: contacts.force + (self.sign() * self.background - self.shift), ..contacts }
    }

    /// The whole friction force after an advance `a`.
    pub fn friction(&self, a: f64) -> f64 {
        self.response(a).force + self.shift
    }

    /// The whole friction force at rest at a fixed drive: there the background is what the balance of forces asks for, from
    /// −B to B.
    pub fn friction_at_rest(&self, drive: f64) -> f64 {
        let sliding = self.friction(0.0);
        if self.background == 0.0 {
            return sliding;
        }
        let contacts = sliding - self.sign() * self.background;
        let pull = self.loading.pull(drive, self.position, self.here.force) + self.shift;
        contacts + (pull - contacts).clamp(-self.background, self.background)
    }

    /// The whole force of the spring at a fixed drive, after an advance `a`.
    pub fn spring_force(&self, drive: f64, a: f64) -> f64 {
        let position = self.position + self.sign() * a;
        self.loading.pull(drive, position, self.response(a).force) + self.shift
    }

    /// Energy of the spring at a fixed drive, up to a constant.
    pub fn stored(&self, drive: f64, position: f64) -> f64 {
        // ½(p + B)²/K with p = K(X_T − X).
        let linear = match self.loading {
            Loading::Spring(_) => self.shift * (drive - position),
            Loading::Rigid | Loading::Force => 0.0,
        };
        self.loading.stored(drive, position) + linear
    }

    /// The equilibrium drive after an advance a, with the sign of the direction.
    pub fn drive(&self, a: f64) -> f64 {
        let sign = self.sign();
        sign * self.loading.drive(self.position + sign * a, self.response(a).force)
    }

    /// The equilibrium drive at the present position, with its own sign.
    pub fn drive_here(&self) -> f64 {
        self.loading.drive(self.position, self.here.force)
    }

    pub fn rise(&self, a: f64) -> f64 {
        self.loading.rise(self.response(a).tangent)
    }

    /// The net force in the direction of motion after an advance a, at a fixed drive.
    pub fn excess(&self, drive: f64, a: f64) -> f64 {
        let sign = self.sign();
        sign * self.loading.excess(drive, self.position + sign * a, self.response(a).force)
    }

    /// Whether the equilibrium drive increases ahead. If its derivative is marginal here, the first Gauss point decides.
    pub fn rises(&self) -> bool {
        let rise = self.loading.rise(self.here.tangent);
        if self.interval.straight || !self.is_marginal(rise) {
            return rise > 0.0;
        }
        self.loading.rise(self.points[0].tangent) > 0.0
    }

    /// Whether a derivative of the drive on the interval is 0 within the accuracy of forces.
    fn is_marginal(&self, rise: f64) -> bool {
        let rises = self.points.iter().map(|point| self.loading.rise(point.tangent).abs());
        rise.abs() <= MARGINAL * rises.fold(0.0, f64::max)
    }

    /// The first stationary point a ≥ `from` of the equilibrium drive, which increases (or decreases) from there; `None` if
    /// the interval has none.
    ///
    /// The derivative is known at the Gauss points. A pair of zeros between two of them is searched for where the parabola
    /// through three points comes close to 0.
    pub fn turn(&self, from: f64, rising: bool) -> Option<f64> {
        if self.interval.straight {
            return None;
        }
        let sign = if rising { 1.0 } else { -1.0 };
        let height = |a: f64| sign * self.rise(a);
        let precision = 1e-9 * self.interval.length;
        let start = (from, height(from));
        let inner = RULE.nodes.iter().zip(&self.points);
        let inner = inner.map(|(t, point)| (self.point(*t), sign * self.loading.rise(point.tangent)));
        let end = (self.interval.length, height(self.interval.length));
        let (mut before, mut last) = (start, start);
        // Signs at the Gauss points bracket every zero, except for pairs of zeros between two of them.
        for next in inner.chain([end]).filter(|next| next.0 > from) {
            if next.1 < 0.0 {
                // A derivative that is 0 at `from` and already negative here has its maximum in between.
                let top = if last.0 == from && self.is_marginal(start.1) {
                    brent_minimum(|a| -height(a), from, next.0, precision).0
                } else {
                    last.0
                };
                return Some(brent_root(height, top, next.0, 0.0).unwrap_or(from));
            }
            if dips(before, last, next) {
                let (lowest, value) = brent_minimum(height, before.0, next.0, precision);
                if value < 0.0 {
                    return brent_root(height, before.0, lowest, 0.0);
                }
            }
            (before, last) = (last, next);
        }
        None
    }

    /// The a in [from, to] at which the equilibrium drive, which increases there, is `drive` (signed); the nearer end if
    /// rounding puts the solution outside.
    pub fn reaches(&self, drive: f64, from: f64, to: f64) -> f64 {
        if self.interval.straight {
            let a = (drive - self.drive(from)) / self.loading.rise(self.here.tangent);
            return (from + a).clamp(from, to);
        }
        let missing = |a: f64| self.drive(a) - drive;
        // Rounding may put the drive at `from` beyond the value asked for, which would leave
        // Brent's method no sign change.
        if missing(from) >= 0.0 {
            return from;
        }
        brent_root(missing, from, to, 0.0).unwrap_or(to)
    }

    /// ∫_0^a of a function of position and response that is linear where the force is linear.
    pub fn integral(&self, a: f64, f: impl Fn(f64, Response) -> f64) -> f64 {
        let sign = self.sign();
        let at = |a: f64| f(self.position + sign * a, self.response(a));
        if self.interval.straight {
            return 0.5 * a * (at(0.0) + at(a));
        }
        if a < self.interval.length {
            return RULE.integrate(0.0, a, at);
        }
        // The responses at the Gauss points of the whole interval are known already.
        let known = |i: usize| f(self.position + sign * self.point(RULE.nodes[i]), self.points[i]);
        0.5 * a * (0..NODES).map(|i| RULE.weights[i] * known(i)).sum::<f64>()
    }
}

/// Whether the parabola through three points falls below half the middle value.
fn dips(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> bool {
    if !(b.1 < a.1 && b.1 < c.1) {
        return false;
    }
    // Divided differences of Newton's form: the parabola's minimum follows from slope and curvature
    // at b.
    let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
    let curvature = (right - left) / (c.0 - a.0);
    let slope = left + curvature * (b.0 - a.0);
    b.1 - slope * slope / (4.0 * curvature) < 0.5 * b.1
}
