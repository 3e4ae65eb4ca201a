//! Looking ahead on the way of a population: where a balance is lost, where it is found again.

use crate::Result;
use crate::monitor::{Aside, Monitor, report};
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::roots::{brent_minimum, brent_root};
use crate::population::{Books, Direction, Population, Response, Way};

use super::Loading;

/// A derivative of the drive that cannot be told from 0, of the largest on the way: forces are that accurate.
const MARGINAL: f64 = 1e-9;

/// A population and what pulls it, with the way ahead; advances a ≥ 0 are counted in the direction of motion, and
/// drives with its sign, so that backward motion is the mirror image of forward motion.
pub(super) struct EquilibriumPath<'a> {
    population: &'a mut dyn Population,
    /// Who is asked where the population takes long.
    watch: Aside<'a>,
    pub loading: Loading,
    /// How far the slider was moved while no contact held.
    pub carried: f64,
    pub direction: Direction,
    pub way: Way,
    /// Whether the way ahead is that from here.
    current: bool,
    /// The response here.
    pub here: Response,
    /// Where the slider is.
    pub position: f64,
    /// On a way that is not straight, the responses at its Gauss points.
    points: [Response; NODES],
}

impl<'a> EquilibriumPath<'a> {
    pub fn new(
        population: &'a mut dyn Population,
        loading: Loading,
        direction: Direction,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let nothing = Response { force: 0.0, tangent: 0.0 };
        let way = Way { length: f64::INFINITY, straight: true, breaks: false };
        let position = population.position();
        let (here, points) = (nothing, [nothing; NODES]);
        let (carried, current) = (0.0, false);
        let watch = Aside { fraction: 0.0, monitor };
        let mut look =
            Self { population, watch, loading, carried, direction, way, current, here, position, points };
        look.towards(direction)?;
        Ok(look)
    }

    /// Tells the monitor how much is done, or at least as much as before.
    pub fn tell(&mut self, fraction: f64) -> Result<()> {
        self.watch.fraction = fraction.clamp(self.watch.fraction, 1.0);
        report(self.watch.monitor, self.watch.fraction)
    }

    /// Looks ahead from here.
    pub fn towards(&mut self, direction: Direction) -> Result<()> {
        if self.current && self.direction == direction {
            return Ok(());
        }
        self.way = self.population.way(direction, &mut self.watch)?;
        (self.direction, self.current) = (direction, true);
        self.here = self.population.ahead(0.0);
        if !self.way.straight {
            for (i, t) in RULE.nodes.iter().enumerate() {
                self.points[i] = self.response(self.point(*t));
            }
        }
        Ok(())
    }

    /// Advances by `a`; the response here is then the one at the end, before anything breaks there.
    pub fn advance(&mut self, a: f64) -> Result<()> {
        self.here = self.response(a);
        self.current = false;
        self.population.advance(self.sign() * a)?;
        self.position = self.population.position() + self.carried;
        Ok(())
    }

    /// Moves the slider to `position` while no contact holds it.
    pub fn carry(&mut self, position: f64) {
        self.carried += position - self.position;
        self.position = position;
    }

    /// Breaks what stands at the end of the way.
    pub fn cross(&mut self) -> Result<()> {
        self.current = false;
        self.population.cross(&mut self.watch)
    }

    /// Breaks all contacts.
    pub fn reset(&mut self) -> Result<()> {
        self.current = false;
        self.population.reset(self.direction, &mut self.watch)
    }

    /// Lets what breaks stay free.
    pub fn hold(&mut self) -> Result<()> {
        self.current = false;
        self.population.hold()
    }

    /// Lets what is free re-form.
    pub fn release(&mut self) -> Result<()> {
        self.current = false;
        self.population.release(&mut self.watch)
    }

    /// Marks the state of the contacts.
    pub fn mark(&mut self) {
        self.population.mark();
    }

    /// Comes back to where the state was marked.
    pub fn recall(&mut self) -> Result<()> {
        self.current = false;
        self.population.recall(&mut self.watch)?;
        self.position = self.population.position() + self.carried;
        Ok(())
    }

    /// Energies and breaks of the contacts.
    pub fn books(&self) -> Books {
        self.population.books()
    }

    /// The Gauss point t of [−1, 1] on the way.
    fn point(&self, t: f64) -> f64 {
        0.5 * self.way.length * (1.0 + t)
    }

    pub fn sign(&self) -> f64 {
        self.direction.sign()
    }

    /// The response at a.
    pub fn response(&self, a: f64) -> Response {
        if self.way.straight {
            let Response { force, tangent } = self.here;
            return Response { force: force + self.sign() * a * tangent, tangent };
        }
        self.population.ahead(self.sign() * a)
    }

    /// The drive in balance at a, with the sign of the direction.
    pub fn drive(&self, a: f64) -> f64 {
        let sign = self.sign();
        sign * self.loading.drive(self.position + sign * a, self.response(a).force)
    }

    /// The drive in balance here, with its own sign.
    pub fn drive_here(&self) -> f64 {
        self.loading.drive(self.position, self.here.force)
    }

    pub fn rise(&self, a: f64) -> f64 {
        self.loading.rise(self.response(a).tangent)
    }

    /// The force that drives the motion at a, at a given drive (of either sign).
    pub fn excess(&self, drive: f64, a: f64) -> f64 {
        let sign = self.sign();
        sign * self.loading.excess(drive, self.position + sign * a, self.response(a).force)
    }

    /// Whether the drive in balance rises ahead of here; where it is marginal, at the first point of the way.
    pub fn rises(&self) -> bool {
        let rise = self.loading.rise(self.here.tangent);
        if self.way.straight || !self.is_marginal(rise) {
            return rise > 0.0;
        }
        self.loading.rise(self.points[0].tangent) > 0.0
    }

    /// Whether a derivative of the drive on a smooth way cannot be told from 0.
    fn is_marginal(&self, rise: f64) -> bool {
        let rises = self.points.iter().map(|point| self.loading.rise(point.tangent).abs());
        rise.abs() <= MARGINAL * rises.fold(0.0, f64::max)
    }

    /// The first a ≥ `from` at which the drive, which rises (or falls) from there, ceases to; `None` where that is
    /// not on the way.
    ///
    /// The derivative is known at the Gauss points; a dip between them is looked for where a parabola through three
    /// of them comes close to 0.
    pub fn turn(&self, from: f64, rising: bool) -> Option<f64> {
        if self.way.straight {
            return None;
        }
        let sign = if rising { 1.0 } else { -1.0 };
        let height = |a: f64| sign * self.rise(a);
        let precision = 1e-9 * self.way.length;
        let start = (from, height(from));
        let inner = RULE.nodes.iter().zip(&self.points);
        let inner = inner.map(|(t, point)| (self.point(*t), sign * self.loading.rise(point.tangent)));
        let end = (self.way.length, height(self.way.length));
        let (mut before, mut last) = (start, start);
        for next in inner.chain([end]).filter(|next| next.0 > from) {
            if next.1 < 0.0 {
                // What begins at a zero, and is past the next one already, has its height between.
                let top = if last.0 == from && self.is_marginal(start.1) {
                    brent_minimum(|a| -height(a), from, next.0, precision).0
                } else {
                    last.0
                };
                return Some(brent_root(height, top, next.0, 0.0).unwrap_or(from));
            }
            if dips(before, last, next) {
                let (bottom, value) = brent_minimum(height, before.0, next.0, precision);
                if value < 0.0 {
                    return brent_root(height, before.0, bottom, 0.0);
                }
            }
            (before, last) = (last, next);
        }
        None
    }

    /// The a in [from, to] at which the drive in balance, rising there, is `drive` (signed); an end where it is
    /// there already, or not yet, by rounding.
    pub fn reaches(&self, drive: f64, from: f64, to: f64) -> f64 {
        if self.way.straight {
            let a = (drive - self.drive(from)) / self.loading.rise(self.here.tangent);
            return (from + a).clamp(from, to);
        }
        let missing = |a: f64| self.drive(a) - drive;
        if missing(from) >= 0.0 {
            return from;
        }
        brent_root(missing, from, to, 0.0).unwrap_or(to)
    }

    /// ∫_0^a of a function of position and response that is linear on a straight way.
    pub fn integral(&self, a: f64, f: impl Fn(f64, Response) -> f64) -> f64 {
        let sign = self.sign();
        let at = |a: f64| f(self.position + sign * a, self.response(a));
        if self.way.straight {
            return 0.5 * a * (at(0.0) + at(a));
        }
        if a < self.way.length {
            return RULE.integrate(0.0, a, at);
        }
        let known = |i: usize| f(self.position + sign * self.point(RULE.nodes[i]), self.points[i]);
        0.5 * a * (0..NODES).map(|i| RULE.weights[i] * known(i)).sum::<f64>()
    }
}

/// Whether a smooth positive curve through three points may come close to 0 between them.
fn dips(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> bool {
    if !(b.1 < a.1 && b.1 < c.1) {
        return false;
    }
    let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
    let curvature = (right - left) / (c.0 - a.0);
    let slope = left + curvature * (b.0 - a.0);
    b.1 - slope * slope / (4.0 * curvature) < 0.5 * b.1
}
