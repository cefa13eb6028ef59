//! Run times, as a table: `cargo run --release --example timing`.
//!
//! Each time is the median of repeated runs in one process on one thread, from the problem to the
//! last point, without files.

use std::time::Instant;

use brakewave::begin::first_wave;
use brakewave::continuation::Settings as Steps;
use brakewave::follow::{Follower, Settings, Status};
use brakewave::model::coefficients::Geometry;
use brakewave::model::{Model, Source};
use brakewave::problem::{Impact, Parameter};
use brakewave::wave::start::{Which, slip_stick};

const MODE: u32 = 4;

fn model() -> Model {
    Model {
        source: Source::Geometry(Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        }),
        friction: 0.5,
        mismatch: 0.2,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        impact: Impact::Frictionless,
    }
}

/// A branch to follow: the work whose time is taken.
struct Work {
    name: &'static str,
    model: Model,
    parameter: Parameter,
    range: (f64, f64),
    up: bool,
    which: Which,
    steps: Steps,
}

/// What one run found.
struct Outcome {
    points: usize,
    events: usize,
    newton: usize,
    /// Largest relative error of c and of the zone lengths, where there is a closed form.
    error: f64,
}

fn run(work: &Work, measure: bool) -> Outcome {
    let width = work.range.1 - work.range.0;
    let (wave, point) = first_wave(
        &work.model,
        work.parameter,
        MODE,
        work.which,
        width,
        work.steps,
    )
    .expect("the wave exists");
    let settings = Settings {
        range: work.range,
        stop_at: Vec::new(),
        continuation: work.steps,
    };
    let mut follower = Follower::new(wave, &point, work.up, settings).expect("a regular start");
    let mut outcome = Outcome {
        points: 1,
        events: 0,
        newton: 0,
        error: 0.0,
    };
    loop {
        let (found, status) = follower.step();
        outcome.points += found.len();
        for point in &found {
            outcome.events += usize::from(point.kind.is_some());
            outcome.newton += point.node.newton;
            // beyond the fold the wave is the slow one
            if measure && point.wave.signature.len() == 2 && outcome.events == 0 {
                let model = work.model.with(work.parameter, point.parameter);
                if let Ok(exact) = slip_stick(&model, MODE, work.which) {
                    let zones = point.wave.unpack(&point.node.point);
                    let speed = point.wave.speed_at(&point.node.point);
                    for (found, exact) in [
                        (speed, exact.speed),
                        (zones[0][2] * speed, exact.slip * exact.speed),
                        (zones[1][2] * speed, exact.stick * exact.speed),
                    ] {
                        outcome.error = outcome.error.max((found / exact - 1.0).abs());
                    }
                }
            }
        }
        if status != Status::Going {
            return outcome;
        }
    }
}

fn main() {
    let steps = Steps {
        ds: 0.01,
        ds_min: 1e-12,
        ds_max: 0.01,
        tolerance: 1e-10,
    };
    let work = [
        Work {
            name: "slip-stick in f, 0.2 to 1.0",
            model: model().with(Parameter::Friction, 0.2),
            parameter: Parameter::Friction,
            range: (0.2, 1.0),
            up: true,
            which: Which::Fast,
            steps: Steps {
                ds: 0.011,
                ds_max: 0.011,
                ..steps
            },
        },
        Work {
            name: "mode 4 in δ, 0.2 to 0.001",
            model: model(),
            parameter: Parameter::Mismatch,
            range: (0.001, 0.2),
            up: false,
            which: Which::Fast,
            steps,
        },
        Work {
            name: "mode 4 in δ, slow wave, all of 0.5 to 6",
            model: model().with(Parameter::Mismatch, 0.8),
            parameter: Parameter::Mismatch,
            range: (0.5, 6.0),
            up: false,
            which: Which::Slow,
            steps,
        },
        Work {
            name: "mode 4 in f, 0.2 to 3, round the folds",
            model: model().with(Parameter::Friction, 0.2),
            parameter: Parameter::Friction,
            range: (0.2, 3.0),
            up: true,
            which: Which::Fast,
            steps,
        },
    ];
    println!(
        "{:<42} {:>7} {:>7} {:>7} {:>10} {:>10} {:>9}",
        "branch", "points", "events", "newton", "time/ms", "µs/point", "error"
    );
    for work in work {
        let outcome = run(&work, true);
        let mut times: Vec<f64> = (0..51)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(run(&work, false));
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let time = times[times.len() / 2];
        println!(
            "{:<42} {:>7} {:>7} {:>7} {:>10.3} {:>10.2} {:>9.1e}",
            work.name,
            outcome.points,
            outcome.events,
            outcome.newton,
            time,
            1e3 * time / outcome.points as f64,
            outcome.error
        );
    }
}
