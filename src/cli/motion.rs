//! `brakewave simulate` for a system of one's own.

use std::fmt::Write;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::Task;
use super::progress::drive;
use super::summary::flows;
use super::{stopped, titled};
use crate::affine::course::Course;
use crate::messages::halt;
use crate::output::motion::MotionFolder;
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::store::FolderKind;
use crate::problem::SystemProblem;

/// Computes the motion and writes it as it goes on.
pub(super) fn simulate(
    task: &Task,
    problem: &SystemProblem,
    text: &str,
) -> Result<VerbExit, VerbFailure> {
    let name = task.name();
    let section = problem.simulation(text, &name)?;
    let system = &problem.system;
    let affine = system.at(&problem.values(), &[]).map_err(Usage::NoSystem)?;
    let start = problem.beginning();
    let start = start.and_then(|start| start.place(system, &affine));
    let start = start.ok_or(Usage::NoBeginning)?;
    // a damped spring without a force is open before its gap and behind it; what contradicts a state was refused with the file
    let start = system.fitting(&affine, start.clone()).unwrap_or(start);
    let out = task.folder("_simulation");
    let store = task.open_system(&out, FolderKind::Simulation, problem)?;
    let mut folder = MotionFolder::create(&store, problem)?;
    let mut course = Course::new(&affine, start, section.duration, section.samples);
    let mut stop = None;
    drive(task.quiet, || {
        match course.next() {
            None => return Ok(None),
            Some(Ok(seen)) => folder.write(&seen)?,
            Some(Err(reason)) => {
                stop = Some(reason);
                return Ok(None);
            }
        }
        let time = course.place().time;
        Ok(Some((time / section.duration, format!("t = {time:.4}"))))
    })?;
    pictures::motion::draw(&store, problem, Format::Svg)?;
    let place = course.place();
    let mut words = format!(
        "{} switches by t = {}, where it is in the mode {}:",
        folder.switched,
        place.time,
        system.mode_name(place.mode)
    );
    for (name, value) in system.source.states.iter().zip(&place.state) {
        // writing to a string does not fail
        let _ = write!(words, " {name} = {value:.6}");
    }
    words.push('\n');
    words.push_str(&flows(system, &affine));
    task.say(&titled(problem.title.as_deref(), &words), "results", &out)?;
    match stop {
        None => Ok(VerbExit::Done),
        Some(reason) => stopped(&halt(system, &reason)),
    }
}
