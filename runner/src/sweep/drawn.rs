//! What pictures show of a data set: of long dimensions some places, evenly spaced.

use std::io;

use super::dataset::{Axis, Dataset, Labelled, Values};

/// Largest number of places of a dimension: more than a picture has dots.
const MOST: usize = 2000;
/// Largest number of values of a variable, with all replicas.
const VALUES: usize = 16_000_000;
/// The dimension of replicas, over which pictures have means: none is left out.
const REPEAT: &str = "repeat";

/// The step from one shown place to the next along a dimension.
pub(super) fn step(axis: &Axis, replicas: usize) -> usize {
    let most = MOST.min((VALUES / replicas.max(1)).isqrt()).max(2);
    if axis.name == REPEAT { 1 } else { axis.length.div_ceil(most) }
}

/// Whether a variable is along so few dimensions that there is a picture of it.
pub(super) fn is_drawn(dimensions: &[String]) -> bool {
    dimensions.iter().filter(|name| *name != REPEAT).count() <= 2
}

/// Number of replicas.
pub(super) fn replicas<'a>(mut axes: impl Iterator<Item = &'a Axis>) -> usize {
    axes.find(|axis| axis.name == REPEAT).map_or(1, |axis| axis.length)
}

/// The places along dimensions with these lengths and steps in a row-major array, without the last dimension.
pub(super) fn rows(along: &[(usize, usize)]) -> Vec<usize> {
    let Some((_, leading)) = along.split_last() else { return vec![0] };
    leading.iter().fold(vec![0], |rows, &(length, step)| {
        let longer = |row: usize| (0..length).step_by(step).map(move |place| row * length + place);
        rows.into_iter().flat_map(longer).collect()
    })
}

impl Dataset {
    /// What pictures show of it, in memory.
    ///
    /// # Errors
    /// The system refuses to read curves.
    pub fn drawn(&self) -> io::Result<Self> {
        let replicas = replicas(self.dimensions());
        let shorter = |axes: &[Axis]| axes.iter().map(|axis| axis.thinned(step(axis, replicas))).collect();
        let drawn = self.variables.iter().filter(|variable| is_drawn(&variable.dimensions));
        let along = |variable: &Labelled| -> Vec<(usize, usize)> {
            let axis = |name: &String| self.dimensions().find(|axis| axis.name == *name);
            variable
                .dimensions
                .iter()
                .filter_map(axis)
                .map(|axis| (axis.length, step(axis, replicas)))
                .collect()
        };
        let thinned = |variable: &Labelled| {
            Ok(Labelled { values: variable.values.thinned(&along(variable))?, ..variable.labels() })
        };
        Ok(Self {
            axes: shorter(&self.axes),
            grids: shorter(&self.grids),
            variables: drawn.map(thinned).collect::<io::Result<_>>()?,
            ..self.labels()
        })
    }

    /// The same without dimensions and values.
    fn labels(&self) -> Self {
        let Self { title, hash, scenario, failed, .. } = self;
        Self {
            title: title.clone(),
            hash: hash.clone(),
            scenario: scenario.clone(),
            axes: Vec::new(),
            grids: Vec::new(),
            variables: Vec::new(),
            failed: *failed,
        }
    }
}

impl Axis {
    /// Every so many of its places.
    pub(super) fn thinned(&self, step: usize) -> Self {
        let thinned = |coordinate: &Labelled| {
            let values = match &coordinate.values {
                Values::Texts(texts) => Values::Texts(texts.iter().step_by(step).cloned().collect()),
                Values::Numbers(numbers) => Values::Numbers(numbers.iter().step_by(step).copied().collect()),
                stored @ Values::Stored(_) => stored.clone(),
            };
            Labelled { values, ..coordinate.labels() }
        };
        let coordinates = self.coordinates.iter().map(thinned).collect();
        Self { name: self.name.clone(), length: self.length.div_ceil(step), coordinates }
    }
}

impl Labelled {
    /// The same without values.
    fn labels(&self) -> Self {
        let Self { name, long_name, key, units, dimensions, .. } = self;
        Self {
            name: name.clone(),
            long_name: long_name.clone(),
            key: key.clone(),
            units: units.clone(),
            dimensions: dimensions.clone(),
            values: Values::Numbers(Vec::new()),
        }
    }
}

impl Values {
    /// Those at every so many places along dimensions with these lengths and steps.
    fn thinned(&self, along: &[(usize, usize)]) -> io::Result<Self> {
        let (length, step) = along.last().copied().unwrap_or((1, 1));
        let rows = rows(along);
        if let Self::Texts(texts) = self {
            let row = |&row: &usize| texts[row * length..][..length].iter().step_by(step).cloned();
            return Ok(Self::Texts(rows.iter().flat_map(row).collect()));
        }
        let mut found = Vec::new();
        for row in rows {
            found.extend(self.read(row * length, length)?.iter().step_by(step));
        }
        Ok(Self::Numbers(found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, length: usize) -> Axis {
        let coordinate = labelled(name, &[name], (0..length).map(|i| i as f64).collect());
        Axis { name: name.to_owned(), length, coordinates: vec![coordinate] }
    }

    fn labelled(name: &str, dimensions: &[&str], values: Vec<f64>) -> Labelled {
        Labelled {
            name: name.to_owned(),
            long_name: String::new(),
            key: name.to_owned(),
            units: String::new(),
            dimensions: dimensions.iter().map(|&name| name.to_owned()).collect(),
            values: Values::Numbers(values),
        }
    }

    /// Every value says where it is.
    #[test]
    fn every_so_many_places_are_shown_and_all_replicas() {
        let (cases, replicas, places) = (3, 2, 5000);
        let values = (0..cases * replicas * places).map(|i| i as f64).collect();
        let dataset = Dataset {
            title: String::new(),
            hash: String::new(),
            scenario: String::new(),
            axes: vec![axis("x", cases), axis("repeat", replicas)],
            grids: vec![axis("position", places)],
            variables: vec![
                labelled("force", &["x", "repeat", "position"], values),
                labelled("many", &["x", "y", "position"], Vec::new()),
            ],
            failed: 0,
        };
        let drawn = dataset.drawn().unwrap();
        let lengths: Vec<usize> = drawn.dimensions().map(|axis| axis.length).collect();
        assert_eq!(lengths, [3, 2, 1667]);
        assert_eq!(drawn.variables.len(), 1, "three dimensions are not drawn");
        let Values::Numbers(shown) = &drawn.variables[0].values else { panic!("numbers") };
        assert_eq!(shown.len(), 3 * 2 * 1667);
        // The second replica of the third case, at the place with number 3 · 10.
        assert_eq!(shown[(2 * 2 + 1) * 1667 + 10], f64::from((2 * 2 + 1) * 5000 + 30));
        let Values::Numbers(positions) = &drawn.grids[0].coordinates[0].values else { panic!("numbers") };
        assert_eq!(positions[10], 30.0);
    }
}
