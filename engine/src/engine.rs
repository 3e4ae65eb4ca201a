//! Answers to requests, with what the last ones have solved.

use asperity::monitor::{Aside, Monitor, Part as Share};
use asperity::record::Quantity;
use asperity::scenario::{Drive, Scenario};
use asperity::{Error, Result, task};
use asperity_runner::input::{self, Diagnostic, Input};

use crate::answer::{Answer, Computed, WidthCurve};
use crate::edit::changed;
use crate::limits::Limits;
use crate::panels::{self, Known};
use crate::picture::Labels;
use crate::request::{Part, Request, View};
use crate::shown::Shown;
use crate::solved::{Solved, has_pull};
use crate::{controls, numbers, sheet, width_curve};

/// Points of the trace of a block.
const POINTS: usize = 1001;

/// Answers requests. It keeps its last solutions, so that what does not change them costs no solution.
#[derive(Debug, Default)]
pub struct Engine {
    limits: Option<Limits>,
    solved: Option<Solved>,
    widths: Option<(String, WidthCurve)>,
    motion: Option<(String, Computed)>,
    sheet: &'static str,
}

impl Engine {
    /// An engine that refuses scenarios beyond limits.
    pub fn limited(limits: Limits) -> Self {
        Self { limits: Some(limits), ..Self::default() }
    }

    /// The answer to a request as JSON, as JSON.
    pub fn answer_json(&mut self, request: &[u8], monitor: &mut dyn Monitor) -> Vec<u8> {
        let answer = match serde_json::from_slice(request) {
            Ok(request) => self.answer(&request, monitor),
            Err(error) => Answer::failed(String::new(), format!("the request is invalid: {error}")),
        };
        answer.to_json()
    }

    /// The answer to a request. Errors are parts of it; once the monitor stops the work, what is missing is absent.
    pub fn answer(&mut self, request: &Request, monitor: &mut dyn Monitor) -> Answer {
        let text = match changed(&request.text, &request.changes) {
            Ok(text) => text,
            Err(message) => return Answer::failed(request.text.clone(), message),
        };
        let mut answer = Answer { text, ..Answer::default() };
        let input = match self.read(&answer.text, monitor) {
            Ok(Some(input)) => input,
            Ok(None) => return Answer { stopped: true, ..answer },
            Err(error) => return Answer { invalid: Some(error.as_ref().into()), ..answer },
        };
        // Progress is that of the parts that take long, each of which counts the same.
        let share = 1.0 / request.parts.iter().filter(|part| part.is_long()).count().max(1) as f64;
        let mut done = 0.0;
        for &part in &request.parts {
            let own = if part.is_long() { share } else { 0.0 };
            let monitor: &mut dyn Monitor = &mut Share::new(&mut *monitor, done, own);
            done += own;
            match self.add(part, &input.scenario, (request, monitor), &mut answer) {
                Ok(()) => {}
                Err(Error::Stopped) => {
                    answer.stopped = true;
                    break;
                }
                // The error would be of a pull that the scenario does not have.
                Err(_) if !part.is_long() && !has_pull(&input.scenario) => {}
                Err(error) => answer.failures.push(sentence(part, &error)),
            }
        }
        if let Some(view) = &request.view {
            answer.view = Some(self.shown(&input.scenario, (request, view), &answer));
        }
        answer.scenario = Some(Box::new(input.scenario));
        answer
    }

    /// A valid scenario within the limits; none where the monitor stopped the check.
    fn read(
        &self,
        text: &str,
        monitor: &mut dyn Monitor,
    ) -> std::result::Result<Option<Input>, Box<Diagnostic>> {
        let mut input = input::read_complete(text, "scenario")?;
        let allowed = self.limits.map_or(Ok(()), |limits| limits.check(&input.scenario));
        match allowed.and_then(|()| input.check(&mut Aside { fraction: 0.0, monitor })) {
            Ok(()) => Ok(Some(input)),
            Err(Error::Stopped) => Ok(None),
            Err(error) => Err(input.diagnose(&error)),
        }
    }

    /// What a page shows of an answer, and of what was computed last until the new is there.
    fn shown(&mut self, scenario: &Scenario, (request, view): (&Request, &View), answer: &Answer) -> Shown {
        let sheet = sheet::name(scenario);
        // What was computed last is not shown on another sheet.
        let stays = request.preview && self.sheet == sheet;
        self.sheet = sheet;
        let motion = self.motion.as_ref().filter(|_| stays).map(|(_, motion)| motion);
        let motion = answer.block.as_ref().or(answer.task.as_ref()).or(motion);
        let widths = self.widths.as_ref().filter(|_| stays).map(|(_, widths)| widths);
        let widths = answer.critical_stiffness.as_ref().or(widths);
        let known = Known { scenario, answer, motion, widths, view };
        Shown {
            sheet,
            details: sheet::details(scenario),
            controls: controls::rows(scenario),
            panels: panels::panels(&known),
            numbers: numbers::rows(scenario, answer.force.as_ref(), request.preview, motion),
            length: Labels(&scenario.units).unit(Quantity::Length),
        }
    }

    /// Adds a part to an answer.
    fn add(
        &mut self,
        part: Part,
        scenario: &Scenario,
        (request, monitor): (&Request, &mut dyn Monitor),
        answer: &mut Answer,
    ) -> Result<()> {
        match part {
            Part::Force => {
                answer.force =
                    Some(self.solved(scenario, request.preview, monitor)?.force(request.preview, monitor)?);
            }
            Part::Stretches => {
                let solved = self.solved(scenario, request.preview, monitor)?;
                answer.stretches = Some(solved.stretches(request.position)?);
            }
            Part::CriticalStiffness => answer.critical_stiffness = Some(self.widths(scenario, monitor)?),
            Part::Block => {
                let block = block(scenario);
                answer.block = block.map(|scenario| self.computed(&scenario, monitor)).transpose()?;
            }
            Part::Task => answer.task = Some(self.computed(scenario, monitor)?),
        }
        Ok(())
    }

    fn solved(&mut self, scenario: &Scenario, preview: bool, monitor: &mut dyn Monitor) -> Result<&Solved> {
        let before = self.solved.take();
        Ok(self.solved.insert(Solved::of(scenario, preview, before, monitor)?))
    }

    fn widths(&mut self, scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<WidthCurve> {
        let description = width_curve::description(scenario);
        if let Some((_, known)) = self.widths.as_ref().filter(|(of, _)| *of == description) {
            return Ok(known.clone());
        }
        let curve = width_curve::width_curve(scenario, monitor)?;
        self.widths = Some((description, curve.clone()));
        Ok(curve)
    }

    /// The result of the task of `scenario`, which a page may ask for again to draw it in another size.
    fn computed(&mut self, scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Computed> {
        let description = serde_json::to_string(scenario).unwrap_or_default();
        if let Some((_, known)) = self.motion.as_ref().filter(|(of, _)| *of == description) {
            return Ok(known.clone());
        }
        let (summary, record) = task::run(scenario, monitor)?;
        let found = Computed::new(summary, record);
        self.motion = Some((description, found.clone()));
        Ok(found)
    }
}

/// The scenario of the motion of the block of `scenario` along its drive, by the master equation alone; none without `[block]` and `[drive]`.
fn block(scenario: &Scenario) -> Option<Scenario> {
    let (Some(_), Some(drive)) = (&scenario.block, &scenario.drive) else { return None };
    let drive = Drive { points: POINTS, ..drive.clone() };
    Some(Scenario { drive: Some(drive), ensemble: None, ..scenario.clone() })
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
