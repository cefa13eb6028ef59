//! Run times of branches of orbits, as a table: `cargo run --release --example orbits`.
//!
//! Each time is the median of repeated runs in one process on one thread, from the first orbit to the last point,
//! with every event, row and multiplier, without files. `-- relay "ten masses"` runs these problems alone.

use std::time::Instant;

use brakewave::hybrid::Runner;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, parse_any};

/// Most runs of a branch, and seconds after which no further one begins.
const RUNS: usize = 50;
const SECONDS: f64 = 3.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| problem | states | points | events | ms | ms for 100 points |\n|---|---|---|---|---|---|"
    );
    for (name, text) in [
        (
            "impact oscillator",
            include_str!("../problems/impact_oscillator.ron"),
        ),
        (
            "friction oscillator",
            include_str!("../problems/friction_oscillator.ron"),
        ),
        ("Chua's circuit", include_str!("../problems/chua.ron")),
        ("relay", include_str!("../problems/relay.ron")),
        (
            "buck converter",
            include_str!("../problems/buck_converter.ron"),
        ),
        (
            "bouncing ball",
            include_str!("../problems/bouncing_ball.ron"),
        ),
        ("ten masses", include_str!("../problems/chain.ron")),
    ] {
        if !wanted.is_empty() && !wanted.iter().any(|one| one == name) {
            continue;
        }
        let Any::System(problem) = parse_any(text, name)? else {
            continue;
        };
        let continuation = problem.continuation(text, name)?;
        let begun = Instant::now();
        let (mut times, mut points, mut events) = (Vec::new(), 0, 0);
        while times.len() < RUNS && begun.elapsed().as_secs_f64() < SECONDS {
            let mut run = Runner::begin(&problem, continuation, None)?;
            let begun = Instant::now();
            while run.progress().end.is_none() {
                run.step();
            }
            times.push(1e3 * begun.elapsed().as_secs_f64());
            (points, events) = (run.progress().points, run.progress().events);
        }
        times.sort_by(f64::total_cmp);
        let time = times[times.len() / 2];
        let states = problem.system.source.states.len();
        println!(
            "| {name} | {states} | {points} | {events} | {time:.2} | {:.2} |",
            100.0 * time / points as f64
        );
    }
    Ok(())
}
