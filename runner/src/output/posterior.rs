//! `posterior.nc`: draws from a posterior in the groups that ArviZ reads, `posterior` and `sample_stats`.

use netcdf_writer::{DimensionId, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions, VariableId};

use super::{Outcome, Result};

/// The bytes of `posterior.nc`; `None` where no draws were made.
pub(super) fn encode(outcome: &Outcome) -> Result<Option<Vec<u8>>> {
    let of = |name: &str| outcome.record.values(name);
    let found = outcome.summary.numbers.fit().and_then(|fit| fit.posterior.as_ref());
    let (Some(reported), Some(values), Some(log_density), Some(diverging), Some(steps)) = (
        found,
        of("posterior_value"),
        of("posterior_log_density"),
        of("posterior_diverging"),
        of("posterior_steps"),
    ) else {
        return Ok(None);
    };
    let mut file = NcFileBuilder::new();
    file.add_attribute("title", text(&outcome.summary.title))?;
    file.add_attribute("version", text(&outcome.summary.version))?;
    let shape = [reported.chains, reported.draws];
    let dimensions = group(&mut file, "posterior", shape)?;
    for (number, values) in reported.numbers.iter().zip(values.chunks_exact(reported.chains * reported.draws))
    {
        let id = file.add_variable_path::<f64>(format!("posterior/{}", number.key), &dimensions)?;
        file.write_variable(id, values)?;
    }
    let dimensions = group(&mut file, "sample_stats", shape)?;
    let describe = |file: &mut NcFileBuilder, id: VariableId, words: &str| {
        file.add_variable_attribute(id, "long_name", text(words))
    };
    let id = file.add_variable_path::<f64>("sample_stats/lp", &dimensions)?;
    file.write_variable(id, log_density)?;
    describe(&mut file, id, "logarithm of the posterior density")?;
    let id = file.add_variable_path::<i8>("sample_stats/diverging", &dimensions)?;
    file.write_variable(id, &diverging.iter().map(|&one| i8::from(one != 0.0)).collect::<Vec<_>>())?;
    describe(&mut file, id, "whether the path to the draw diverged")?;
    // xarray reads it as true and false.
    file.add_variable_attribute(id, "dtype", text("bool"))?;
    let id = file.add_variable_path::<i64>("sample_stats/n_steps", &dimensions)?;
    file.write_variable(id, &steps.iter().map(|&steps| steps as i64).collect::<Vec<_>>())?;
    describe(&mut file, id, "steps of the sampler to the draw")?;
    Ok(Some(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1))
}

/// A group with its dimensions `chain` and `draw`, and their coordinates.
fn group(file: &mut NcFileBuilder, name: &str, lengths: [usize; 2]) -> Result<Vec<DimensionId>> {
    file.add_group_attribute(name, "inference_library", text("nuts-rs"))?;
    let mut dimensions = Vec::new();
    for (dimension, length) in ["chain", "draw"].into_iter().zip(lengths) {
        let path = format!("{name}/{dimension}");
        let id = file.add_dimension_path(path.clone(), length as u64)?;
        let coordinate = file.add_variable_path::<i64>(path, &[id])?;
        file.write_variable(coordinate, &(0..length as i64).collect::<Vec<_>>())?;
        dimensions.push(id);
    }
    Ok(dimensions)
}

fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}
