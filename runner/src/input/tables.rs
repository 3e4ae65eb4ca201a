//! The files named in a scenario, read and inserted in place of their names.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scenario::{FitCurve, FitSource, Protocol, Scenario, Step, Tabulated};
use sha2::{Digest, Sha256};

use super::columns::{HAS_FILES, read, read_one_of};
use super::fault::Fault;
use super::short;

/// Replaces every `file` key by the content of the file, whose path is relative to `folder`; without a folder, no file is read.
pub fn inline(scenario: &mut Scenario, folder: Option<&Path>) -> Result<(), Fault> {
    for (key, table) in scenario.tables() {
        if let Some(file) = table.file.take_if(|_| table.samples.is_none() && table.stretch.is_none()) {
            let read = place(folder, &file).and_then(|path| law(table, &path));
            read.map_err(|fault| fault.under(&format!("{key}.file")))?;
        }
    }
    if let Some(table) = &mut scenario.contacts.stiffness_of_threshold
        && let Some(file) = table.file.take_if(|_| table.threshold.is_none() && table.stiffness.is_none())
    {
        let columns = place(folder, &file).and_then(|path| read(&path, &[&["threshold", "stiffness"]]));
        let key = "contacts.stiffness_of_threshold.file";
        let [threshold, stiffness] = exactly(columns.map_err(|fault| fault.under(key))?);
        (table.threshold, table.stiffness) = (Some(threshold), Some(stiffness));
    }
    let (velocities, holds) = (scenario.velocity_curve.is_some(), scenario.hold_curve.is_some());
    if let Some(compare) = &mut scenario.compare
        && compare.points().0.is_empty()
        && let Some(file) = compare.file.take_if(|_| compare.force.is_none())
    {
        let (name, along) = match (velocities, holds) {
            (true, _) => ("velocity", &mut compare.velocity),
            (_, true) => ("hold", &mut compare.hold),
            _ => ("position", &mut compare.position),
        };
        let columns = place(folder, &file).and_then(|path| read(&path, &[&[name, "force"]]));
        let [measured, force] = exactly(columns.map_err(|fault| fault.under("compare.file"))?);
        (*along, compare.force) = (Some(measured), Some(force));
    }
    if let Some(fit) = &mut scenario.fit {
        let own = Measured {
            file: &mut fit.file,
            source: &mut fit.source,
            position: &mut fit.position,
            drive: &mut fit.drive,
            force: &mut fit.force,
        };
        own.inline(folder).map_err(|fault| fault.under("fit.file"))?;
        for (c, curve) in fit.curve.iter_mut().enumerate() {
            let FitCurve { file, source, position, drive, force, .. } = curve;
            let measured = Measured { file, source, position, drive, force };
            measured.inline(folder).map_err(|fault| fault.under(&format!("fit.curve.{c}.file")))?;
        }
    }
    if let Some(steady) = scenario.fit.as_mut().and_then(|fit| fit.steady.as_mut())
        && let Some(file) = steady.file.take_if(|_| steady.position.is_none() && steady.force.is_none())
    {
        let layouts: [&[&str]; 2] = [&["position", "force"], &["force"]];
        let found =
            place(folder, &file).and_then(|path| Ok((read_one_of(&path, &layouts)?.1, source(&path, file)?)));
        let (mut columns, source) = found.map_err(|fault| fault.under("fit.steady.file"))?;
        steady.force = columns.pop();
        steady.position = columns.pop();
        steady.source = Some(source);
    }
    if let Some(curve) = scenario.fit.as_mut().and_then(|fit| fit.velocity_curve.as_mut())
        && let Some(file) = curve
            .file
            .take_if(|_| [&curve.velocity, &curve.force, &curve.error].iter().all(|list| list.is_none()))
    {
        let layouts: [&[&str]; 2] = [&["velocity", "force"], &["velocity", "force", "error"]];
        let found =
            place(folder, &file).and_then(|path| Ok((read_one_of(&path, &layouts)?.1, source(&path, file)?)));
        let (columns, source) = found.map_err(|fault| fault.under("fit.velocity_curve.file"))?;
        let mut columns = columns.into_iter();
        (curve.velocity, curve.force, curve.error) = (columns.next(), columns.next(), columns.next());
        curve.source = Some(source);
    }
    let scales = scenario.interface.as_mut().and_then(|interface| interface.disorder.as_mut());
    if let Some(scales) = scales
        && let Some(file) = scales.file.take_if(|_| scales.scale.is_none() && scales.std.is_none())
    {
        let columns = place(folder, &file).and_then(|path| read(&path, &[&["scale"]]));
        let [scale] = exactly(columns.map_err(|fault| fault.under("interface.disorder.file"))?);
        scales.scale = Some(scale);
    }
    if scenario.protocol.is_none()
        && let Some(file) = scenario.protocol_file.take()
    {
        let steps = place(folder, &file).and_then(|path| steps(&path));
        scenario.protocol = Some(Protocol(steps.map_err(|fault| fault.under("protocol_file"))?));
    }
    Ok(())
}

/// A measured curve in the scenario, which a file may give.
struct Measured<'a> {
    file: &'a mut Option<String>,
    source: &'a mut Option<FitSource>,
    position: &'a mut Option<Vec<f64>>,
    drive: &'a mut Option<Vec<f64>>,
    force: &'a mut Option<Vec<f64>>,
}

impl Measured<'_> {
    /// Replaces the file by its content, and notes which file it was.
    fn inline(self, folder: Option<&Path>) -> Result<(), Fault> {
        let Some(file) = self.file.take_if(|_| self.position.is_none() && self.drive.is_none()) else {
            return Ok(());
        };
        let path = place(folder, &file)?;
        let layouts: [&[&str]; 2] = [&["position", "force"], &["drive", "force"]];
        let (layout, columns) = read_one_of(&path, &layouts)?;
        let [position, force] = exactly(columns);
        *(if layout == 0 { self.position } else { self.drive }) = Some(position);
        *self.force = Some(force);
        *self.source = Some(source(&path, file)?);
        Ok(())
    }
}

/// Where a file is, unless there is no folder or no file system.
fn place(folder: Option<&Path>, file: &str) -> Result<PathBuf, Fault> {
    let refused =
        || Fault::new("the values themselves, since no files are read here", &format!("\"{}\"", short(file)));
    Ok(folder.filter(|_| HAS_FILES).ok_or_else(refused)?.join(file))
}

/// Which file was read.
fn source(path: &Path, name: String) -> Result<FitSource, Fault> {
    if !HAS_FILES {
        unreachable!("no file has a place without a file system");
    }
    let bytes = fs::read(path);
    let bytes = bytes.map_err(|why| Fault::new("a file that can be read", &why.to_string()))?;
    let digits = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(FitSource { name, sha256: digits })
}

/// The steps of a protocol, one per row.
fn steps(path: &Path) -> Result<Vec<Step>, Fault> {
    let columns = read(path, &[&["duration", "velocity"], &["duration", "velocity", "points"]])?;
    let step = |row: usize| {
        let step = Step::moving(columns[1][row], columns[0][row]);
        // An invalid number of points becomes 0, which is refused together with the other values.
        columns.get(2).map_or(step.clone(), |points| Step { points: points[row] as usize, ..step })
    };
    Ok((0..columns[0].len()).map(step).collect())
}

fn law(table: &mut Tabulated, path: &Path) -> Result<(), Fault> {
    let mut columns = read(path, &[&["stretch", "density"], &["sample"]])?;
    if columns.len() == 1 {
        table.samples = columns.pop();
    } else {
        let [stretch, density] = exactly(columns);
        (table.stretch, table.density) = (Some(stretch), Some(density));
    }
    Ok(())
}

fn exactly<const N: usize>(columns: Vec<Vec<f64>>) -> [Vec<f64>; N] {
    columns.try_into().expect("the number of columns was checked")
}
