//! `[drive]`: the slider's top is moved, its bottom follows through the block.
use super::Setting;
use crate::summary::Summary;
use asperity::Result;
use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::scenario;
pub fn run(
    _setting: &Setting<'_>,
    _task: &scenario::Drive,
    _monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    todo!()
}
