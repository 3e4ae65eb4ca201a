//! Keys that are valid and change nothing, as far as they can be found without computing anything.

use super::{Block, Delay, Figure, FigureFormat, Law, PerCell, Scenario};
use crate::contacts::Contacts;

impl Scenario {
    /// The keys without effect, each with the reason.
    pub(super) fn without_effect(&self, contacts: &Contacts) -> Vec<String> {
        let inertial = self.interface.as_ref().is_some_and(|own| own.mass.is_some());
        let timeless = contacts.rules.first().is_none() && !inertial;
        let tables =
            [self.velocities(timeless), self.initial_stretches(), self.simulation(), self.pictures()];
        tables.into_iter().flatten().map(|(key, reason)| format!("{key}: {reason}")).collect()
    }

    fn velocities(&self, timeless: bool) -> Vec<Reason> {
        let velocities = [
            ("pull.velocity", self.pull.as_ref().and_then(|task| task.velocity)),
            ("drive.velocity", self.drive.as_ref().and_then(|task| task.velocity)),
            ("spectrum.velocity", self.spectrum.as_ref().and_then(|task| task.velocity)),
            ("fit.velocity", self.fit.as_ref().and_then(|task| task.velocity)),
        ];
        let given = velocities.iter().filter(|(_, velocity)| timeless && velocity.is_some());
        let reason = "nothing in [contacts] depends on time: the velocity has no effect";
        let mut found: Vec<Reason> = given.map(|(key, _)| (*key, reason)).collect();
        if self.contacts.delay == Some(Delay::Time(0.0)) {
            found.push(("contacts.delay.time", "a delay of 0 has no effect"));
        }
        if self.contacts.free_friction.is_some_and(|friction| friction.is_none()) {
            found.push(("contacts.free_friction", "a force of 0 has no effect"));
        }
        found
    }

    fn initial_stretches(&self) -> Vec<Reason> {
        // The stability of a velocity curve has the critical stiffness of a first pull.
        let curve = self.velocity_curve.as_ref().is_some_and(|curve| !curve.stability);
        let steady = curve || self.hold_curve.is_some() || self.spectrum.is_some();
        let given = steady && self.initial != Law::zero();
        given
            .then_some(("initial", "the task begins in steady sliding: the table has no effect"))
            .into_iter()
            .collect()
    }

    /// Keys of simulated contacts and of random numbers.
    fn simulation(&self) -> Vec<Reason> {
        let mut found = Vec::new();
        if self.fit.is_some() && self.ensemble.is_some() {
            found.push(("ensemble", "[fit] simulates no contacts: the table has no effect"));
        }
        let fraction = self.block.as_ref().map_or(Block::SLIP_FRACTION, |block| block.slip_fraction);
        if fraction != Block::SLIP_FRACTION && self.ensemble.is_none() {
            found.push((
                "block.slip_fraction",
                "it reports events of an ensemble: without [ensemble] it has no effect",
            ));
        }
        let Some(interface) = &self.interface else { return found };
        if interface.disorder.as_ref().is_some_and(|own| own.seed.is_some() && own.std.unwrap_or(0.0) == 0.0)
        {
            found.push(("interface.disorder.seed", "no scale factors are drawn: the seed has no effect"));
        }
        if interface.contacts == PerCell::One && self.master_equation.tolerance.is_some() {
            found.push((
                "master_equation.tolerance",
                "contacts coupled one by one are simulated: the tolerance has no effect",
            ));
        }
        found
    }

    /// Keys of pictures that are not drawn.
    fn pictures(&self) -> Vec<Reason> {
        let (figure, usual) = (&self.figure, Figure::default());
        if figure.formats.is_empty() && *figure != (Figure { formats: Vec::new(), ..usual.clone() }) {
            return vec![("figure", "no formats, no pictures: the other keys have no effect")];
        }
        let dots = figure.formats.contains(&FigureFormat::Png) || figure.dpi == usual.dpi;
        if dots {
            Vec::new()
        } else {
            vec![(
                "figure.dpi",
                "only PNG has dots, and \"png\" is not in figure.formats: the key has no effect",
            )]
        }
    }
}

/// A key and the reason why it changes nothing.
type Reason = (&'static str, &'static str);
