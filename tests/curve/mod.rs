//! Claims about curves of events in two parameters: closed forms of slip-stick waves, Hopf points
//! found again by the tracker of a branch, curves that meet, derivatives, the command line.

mod closed_form;
mod command;
mod connections;
mod contacts;
mod cusp;
mod equations;
mod equilibria;
mod grazes;
mod hopf;
mod meeting;
mod monitors;
mod regions;
mod resume;
mod shots;
mod shrinking;
mod systems;

use brakewave::branch::run::WaveRunner;
use brakewave::curve::search::find;
use brakewave::curve::start::{CurveStart, NoCurve};
use brakewave::curve::{CurveRun, WholeCurve, follow};
use brakewave::problem::{Problem, parse};

use crate::observed;

/// Mode 4 of the tube ν = 0.3, ξ = 1.5 with further sections.
fn tube(friction: f64, mismatch: f64, damping: f64, sections: &str) -> Problem {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: {friction}, \
         mismatch: {mismatch}, damping: (mass: {damping})), wave: (mode: 4, start: Fast), \
         {sections})"
    );
    parse(&text, "test").unwrap()
}

fn start(problem: &Problem) -> Result<CurveStart, NoCurve> {
    let (Some(continuation), Some(curve)) = (&problem.continuation, &problem.curve) else {
        panic!("the problem has no curve");
    };
    let begin = |problem: &Problem| WaveRunner::begin(problem, continuation, None);
    find(problem, curve, begin, &mut |_| ())
}

fn curve(problem: &Problem) -> WholeCurve {
    let start = start(problem).unwrap();
    follow(&start.system, start.event, &start.point, start.limits).unwrap()
}

/// A curve with nothing named beside it.
fn unnamed(problem: &Problem) -> WholeCurve {
    let start = start(problem).unwrap();
    let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
    while run.step().unwrap().is_some() {}
    run.unnamed()
}
