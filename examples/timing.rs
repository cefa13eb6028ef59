//! Run times, as a table: `cargo run --release --example timing`.
//!
//! Each time is the median of repeated runs in one process on one thread, from the problem to the
//! last point, without files.

use std::time::Instant;

use brakewave::branch::first_wave::first_wave;
use brakewave::branch::orbit::Follower;
use brakewave::continuation::Steps;
use brakewave::discretised;
use brakewave::orbit::follow::Limits;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::spectrum::{SpectrumRequest, spectrum};
use brakewave::tube::wave::start::{Which, slip_stick};

const MODE: u32 = 4;

fn model() -> Model {
    Model::tube(
        Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        },
        0.5,
        0.2,
    )
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
    let settings = Limits {
        range: work.range,
        stop_at: Vec::new(),
        steps: work.steps,
    };
    let mut follower = Follower::new(wave, &point, work.up, settings).expect("a regular start");
    let mut outcome = Outcome {
        points: 1,
        events: 0,
        newton: 0,
        error: 0.0,
    };
    loop {
        let (found, end) = follower.step();
        outcome.points += found.len();
        for point in &found {
            outcome.events += usize::from(point.kind().is_some());
            outcome.newton += point.node.newton;
            // beyond the fold the wave is the slow one
            if measure && point.orbit.signature.len() == 2 && outcome.events == 0 {
                let model = work.model.with(work.parameter, point.parameter);
                if let Ok(exact) = slip_stick(&model, MODE, work.which) {
                    let zones = point.orbit.unpack(&point.node.point);
                    let speed = point.orbit.speed_at(&point.node.point);
                    for (found, exact) in [
                        (speed, exact.speed),
                        (zones[0].duration * speed, exact.slip * exact.speed),
                        (zones[1].duration * speed, exact.stick * exact.speed),
                    ] {
                        outcome.error = outcome.error.max((found / exact - 1.0).abs());
                    }
                }
            }
        }
        if end.is_some() {
            return outcome;
        }
    }
}

/// Median of repeated runs, in milliseconds.
fn median(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..repetitions)
        .map(|_| {
            let start = Instant::now();
            work();
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[repetitions / 2]
}

fn main() {
    branches();
    println!();
    spectra();
}

/// The whole spectrum of one wave in all four sectors, against the dense discretised calculation.
fn spectra() {
    /// Leading eigenvalues of the sectors 0, 1, 2, computed by an independent program.
    const EXACT: [(f64, f64); 3] = [
        (0.04965063748184, 2.541566892289),
        (0.1279698868278, 1.319591652955),
        (0.107573000269, 0.8365151274592),
    ];
    const POINTS: usize = 200;
    let request = SpectrumRequest {
        sectors: (0..4).collect(),
        eigenvalues: 6,
        max_frequency: 60.0,
    };
    let steps = Steps {
        ds: 0.01,
        ds_min: 1e-12,
        ds_max: 0.01,
        tolerance: 1e-10,
    };
    println!(
        "{:<58} {:>8} {:>10} {:>10}",
        "spectrum, all four sectors", "found", "time/ms", "error"
    );
    for mismatch in [0.2, 0.08, 0.045, 0.02] {
        let model = model().with(Parameter::Mismatch, mismatch);
        let (wave, point) = first_wave(&model, Parameter::Mismatch, MODE, Which::Fast, 0.2, steps)
            .expect("the wave exists");
        let compute = || {
            let characteristic = Characteristic::new(&wave, &point).expect("it is linearised");
            spectrum(&characteristic, &request, None)
        };
        let found = compute();
        assert!(found.complete);
        let count: usize = found.sectors.iter().map(|one| one.eigenvalues.len()).sum();
        let time = median(21, || {
            std::hint::black_box(compute());
        });
        let error = if mismatch == 0.2 {
            let worst = EXACT
                .iter()
                .zip(&found.sectors)
                .map(|((re, im), sector)| {
                    sector
                        .eigenvalues
                        .iter()
                        .map(|one| (one.re - re).hypot(one.im - im))
                        .fold(f64::INFINITY, f64::min)
                })
                .fold(0.0, f64::max);
            format!("{worst:10.1e}")
        } else {
            String::new()
        };
        println!(
            "{:<58} {count:>8} {time:>10.3} {error}",
            format!("exact, |Im λ| ≤ 60, δ = {mismatch}, {}", wave.signature)
        );
    }
    let settings = discretised::RingSettings {
        points: POINTS,
        ..discretised::RingSettings::default()
    };
    let ring = discretised::solve(&model(), MODE, &settings).expect("the ring has this wave");
    let mut error = 0.0_f64;
    let mut count = 0;
    for (sector, (re, im)) in EXACT.iter().enumerate() {
        let values = ring
            .eigenvalues(sector as u32, 60.0, usize::MAX)
            .expect("eigenvalues");
        let nearest = values
            .iter()
            .map(|value| (value.re - re).hypot(value.im - im))
            .fold(f64::INFINITY, f64::min);
        error = error.max(nearest);
        count += values.len();
    }
    let time = median(5, || {
        for sector in 0..MODE {
            std::hint::black_box(ring.multipliers(sector).expect("multipliers"));
        }
    });
    println!(
        "{:<58} {count:>8} {time:>10.3} {error:10.1e}",
        format!(
            "dense, {POINTS} points per wavelength, ε = {}, eigenvalues only",
            settings.epsilon
        )
    );
}

fn branches() {
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
        let time = median(51, || {
            std::hint::black_box(run(&work, false));
        });
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
