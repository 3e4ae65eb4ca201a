//! Answers to requests, with what the last ones have solved.

use std::path::Path;

use asperity::scenario::{Drive, Scenario};
use asperity::{Error, Result, task};
use asperity_runner::input;

use crate::answer::{Answer, Computed, Invalid, WidthCurve};
use crate::edit::changed;
use crate::request::{Part, Request};
use crate::solved::Solved;
use crate::width_curve;

/// Points of the trace of a block.
const POINTS: usize = 1001;

/// Answers requests. It keeps its last solutions, so that what does not change them costs no solution.
#[derive(Debug, Default)]
pub struct Engine {
    solved: Option<Solved>,
    widths: Option<(String, WidthCurve)>,
}

impl Engine {
    /// The answer to a request as JSON, as JSON.
    pub fn answer_json(&mut self, request: &[u8]) -> Vec<u8> {
        let answer = match serde_json::from_slice(request) {
            Ok(request) => self.answer(&request),
            Err(error) => {
                Answer { failures: vec![format!("the request is invalid: {error}")], ..Answer::default() }
            }
        };
        serde_json::to_vec(&answer).unwrap_or_default()
    }

    /// The answer to a request. Errors are parts of it.
    pub fn answer(&mut self, request: &Request) -> Answer {
        let text = match changed(&request.text, &request.changes) {
            Ok(text) => text,
            Err(message) => {
                return Answer { text: request.text.clone(), failures: vec![message], ..Answer::default() };
            }
        };
        let input = input::parse(&text, "scenario", Path::new(""), &[]);
        let mut answer = Answer { text, ..Answer::default() };
        match input {
            Err(error) => answer.invalid = Some(Invalid::from(error.as_ref())),
            Ok(input) => {
                for &part in &request.parts {
                    if let Err(error) = self.add(part, &input.scenario, request, &mut answer) {
                        answer.failures.push(sentence(part, &error));
                    }
                }
                answer.scenario = Some(Box::new(input.scenario));
            }
        }
        answer
    }

    /// Adds a part to an answer.
    fn add(&mut self, part: Part, scenario: &Scenario, request: &Request, answer: &mut Answer) -> Result<()> {
        match part {
            Part::Force => answer.force = Some(self.solved(scenario, request.preview)?.force()?),
            Part::Stretches => {
                answer.stretches = Some(self.solved(scenario, request.preview)?.stretches(request.position)?);
            }
            Part::CriticalStiffness => answer.critical_stiffness = Some(self.widths(scenario)?),
            Part::Block => answer.block = block(scenario)?,
            Part::Task => answer.task = Some(computed(scenario)?),
        }
        Ok(())
    }

    fn solved(&mut self, scenario: &Scenario, preview: bool) -> Result<&Solved> {
        let before = self.solved.take();
        Ok(self.solved.insert(Solved::of(scenario, preview, before)?))
    }

    fn widths(&mut self, scenario: &Scenario) -> Result<WidthCurve> {
        let description = width_curve::description(scenario);
        if let Some((_, known)) = self.widths.as_ref().filter(|(of, _)| *of == description) {
            return Ok(known.clone());
        }
        let curve = width_curve::width_curve(scenario)?;
        self.widths = Some((description, curve.clone()));
        Ok(curve)
    }
}

/// The motion of the block of `scenario` along its drive, by the master equation alone; none without `[block]` and `[drive]`.
fn block(scenario: &Scenario) -> Result<Option<Computed>> {
    let (Some(_), Some(drive)) = (&scenario.block, &scenario.drive) else { return Ok(None) };
    let drive = Drive { points: POINTS, ..drive.clone() };
    computed(&Scenario { drive: Some(drive), ensemble: None, ..scenario.clone() }).map(Some)
}

fn computed(scenario: &Scenario) -> Result<Computed> {
    let (summary, record) = task::run(scenario, &mut ())?;
    Ok(Computed { summary, record })
}

fn sentence(part: Part, error: &Error) -> String {
    let what = match part {
        Part::Force => "the force",
        Part::Stretches => "the stretches",
        Part::CriticalStiffness => "the critical stiffness",
        Part::Block => "the motion of the block",
        Part::Task => "the task",
    };
    format!("{what}: {error}")
}
