//! Run times of branches and of curves of orbits, as a table: `cargo run --release --example orbits`.
//!
//! Each time is the median of repeated runs in one process on one thread, from the first orbit to the last point,
//! with every event, row and multiplier, without files. `-- relay "40 zones"` runs these problems alone.
//!
//! Of a curve in two parameters it is the time from its event on the branch to both ends, without names beside it.

use std::time::Instant;

use brakewave::curve::search::find_of_system;
use brakewave::curve::{CurvePoint, CurveRun, PointType};
use brakewave::hybrid::OrbitRunner;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{
    Any, Continuation, CurveSection as Section, SystemCurveEvent, SystemProblem, parse_any,
};

/// That of the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Most runs of a branch, and seconds after which no further one begins.
const RUNS: usize = 50;
const SECONDS: f64 = 3.0;

/// Problem files of their own.
const PROBLEMS: [(&str, &str); 8] = [
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
    (
        "cubic spring at a stop",
        include_str!("../problems/duffing_wall.ron"),
    ),
];

/// A wave of the tube, whose guards and resets have the parameter of the branch.
const WAVE: &str = include_str!("../problems/wave_as_orbit.ron");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let own = PROBLEMS.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let others = [
        ("Duffing, 1e-15".to_owned(), duffing(1e-15)),
        ("Duffing, 1e-12".to_owned(), duffing(1e-12)),
        ("van der Pol".to_owned(), van_der_pol()),
        ("25 masses".to_owned(), masses(25)),
        ("Duffing, its folds".to_owned(), folds()),
        ("cubic spring, its grazes".to_owned(), grazes()),
        ("a wave".to_owned(), WAVE.to_owned()),
        ("a wave of fixed speed".to_owned(), wave_of_fixed_speed()),
    ];
    let zones = [2, 8, 40, 100].map(|count| (format!("{count} zones"), zones(count)));
    println!("| problem | states | points | events | ms | µs a point |\n|---|---|---|---|---|---|");
    for (name, text) in own.into_iter().chain(others).chain(zones) {
        if wanted.is_empty() || wanted.contains(&name) {
            println!("{}", timed(&name, &text)?);
        }
    }
    Ok(())
}

/// The line of a problem.
fn timed(name: &str, text: &str) -> Result<String, Box<dyn std::error::Error>> {
    let Any::System(problem) = parse_any(text, name)? else {
        return Err(format!("{name} has no system").into());
    };
    let (time, points, events) = match &problem.curve {
        Some(section) => curve_time(&problem, section)?,
        None => branch_time(&problem, problem.continuation(text, name)?)?,
    };
    let states = problem.system.source.states.len();
    Ok(format!(
        "| {name} | {states} | {points} | {events} | {time:.2} | {:.0} |",
        1e3 * time / points as f64
    ))
}

/// Milliseconds for a branch, its points and its events.
fn branch_time(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
) -> Result<(f64, usize, usize), Box<dyn std::error::Error>> {
    let begun = Instant::now();
    let (mut times, mut points, mut events) = (Vec::new(), 0, 0);
    while times.len() < RUNS && begun.elapsed().as_secs_f64() < SECONDS {
        let mut run = OrbitRunner::begin(problem, continuation, None)?;
        let begun = Instant::now();
        while run.progress().end.is_none() {
            run.step();
        }
        times.push(1e3 * begun.elapsed().as_secs_f64());
        (points, events) = (run.progress().points, run.progress().events);
    }
    Ok((median(times), points, events))
}

/// Milliseconds for a curve, its points and those of codimension two.
fn curve_time(
    problem: &SystemProblem,
    section: &Section<String, SystemCurveEvent>,
) -> Result<(f64, usize, usize), Box<dyn std::error::Error>> {
    let continuation = problem.continuation.as_ref().ok_or("no branch")?;
    let begin = |problem: &SystemProblem| OrbitRunner::begin(problem, continuation, None);
    let start = find_of_system(problem, section, begin, &mut |_| ())?;
    let begun = Instant::now();
    let (mut times, mut points, mut events) = (Vec::new(), 0, 0);
    while times.len() < RUNS && begun.elapsed().as_secs_f64() < SECONDS {
        let begun = Instant::now();
        let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits)?;
        while run.step()?.is_some() {}
        times.push(1e3 * begun.elapsed().as_secs_f64());
        let curve = run.unnamed();
        let is_two = |point: &&CurvePoint| !matches!(point.kind, None | Some(PointType::One(_)));
        events = curve.points.iter().filter(is_two).count();
        points = curve.points.len();
    }
    Ok((median(times), points, events))
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The same wave with its speed held: its period follows.
fn wave_of_fixed_speed() -> String {
    let (text, _) = WAVE.split_once("    output:").unwrap_or((WAVE, ""));
    let text = text.replace(r#", period: "2*pi/(n*c)", free: "c""#, "");
    text.replace(r#""n": 4.0, "#, "") + ")"
}

/// A hardening oscillator round both folds of its resonance, integrated to a tolerance.
fn duffing(tolerance: f64) -> String {
    format!(
        r#"(
        system: (
            states: ["x", "v"],
            parameters: {{"w": 2.2, "c": 0.1, "A": 0.3}},
            forcing: "w",
            modes: {{"flow": (rates: {{"x": "v", "v": "A*cos(phase) - c*v - x - x^3"}})}},
            flow_tolerance: {tolerance:e},
        ),
        orbit: (start: Simulate(mode: "flow", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
        continuation: (parameter: "w", range: (1.2, 2.2), toward: Down),
        stability: (),
    )"#
    )
}

/// The folds of that oscillator in the amplitude of the force and its frequency.
fn folds() -> String {
    with_curve(
        &duffing(1e-15),
        r#"event: LP, parameters: ("A", "w"), range: ((0.25, 0.35), (1.25, 1.45))"#,
    )
}

/// The grazes of the cubic spring at its stop in the same two parameters.
fn grazes() -> String {
    let file = include_str!("../problems/duffing_wall.ron");
    let (head, _) = file.split_once("    expect:").unwrap_or((file, ""));
    with_curve(
        &format!("{head})"),
        r#"event: GR, parameters: ("A", "w"), range: ((0.05, 2.0), (0.8, 1.6))"#,
    )
}

/// A problem file with a curve.
fn with_curve(text: &str, curve: &str) -> String {
    let head = text.trim_end().trim_end_matches(')');
    format!("{head}\n    curve: ({curve}),\n)")
}

/// A relaxation oscillation, in two modes that meet at y = 0.
fn van_der_pol() -> String {
    r#"(
        system: (
            states: ["x", "y"],
            parameters: {"mu": 1.0},
            define: {"rate": "mu*(1 - x^2)*y - x"},
            modes: {
                "up": (rates: {"x": "y", "y": "rate"}, until: [(zero: "y", to: "down")]),
                "down": (rates: {"x": "y", "y": "rate"}, until: [(zero: "-y", to: "up")]),
            },
        ),
        orbit: (start: Simulate(mode: "down", state: {"x": 1.0, "y": -0.1}, settle: 100)),
        continuation: (parameter: "mu", range: (1.0, 10.0), toward: Up),
        stability: (),
    )"#
    .to_owned()
}

/// An oscillator pushed by another force in each of so many parts of a period that a clock counts.
fn zones(count: usize) -> String {
    let mode = |index: usize| {
        let force = 0.5 * ((7 * index % 5) as f64 - 2.0) + 0.1;
        let end = (index + 1) as f64 / count as f64;
        let (next, reset) = match index + 1 == count {
            true => (0, r#", reset: {"s": "s - 1"}"#),
            false => (index + 1, ""),
        };
        format!(
            r#""m{index}": (rates: {{"x": "v", "v": "A*({force}) - c*v - 4*x", "s": "1"}},
                until: [(zero: "{end} - s", to: "m{next}"{reset})]),"#
        )
    };
    let modes: String = (0..count).map(mode).collect();
    format!(
        r#"(
        system: (states: ["x", "v", "s"], parameters: {{"A": 1.0, "c": 0.3}}, modes: {{{modes}}}),
        orbit: (start: Simulate(mode: "m0", state: {{"x": 0.0, "v": 0.0, "s": 0.0}}, settle: 60)),
        continuation: (parameter: "c", range: (0.3, 1.0), toward: Up, max_points: 100),
        stability: (),
    )"#
    )
}

/// A chain of so many masses like that of the problem file, with more damping.
fn masses(count: usize) -> String {
    let all = |of: &dyn Fn(usize) -> String| -> String {
        let parts: Vec<String> = (1..=count).map(of).collect();
        parts.join(", ")
    };
    let force = |k: usize| match k {
        1 => r#""f1": "-x1 - b*v1""#.to_owned(),
        _ => format!(r#""f{k}": "x{0} - x{k} + b*(v{0} - v{k})""#, k - 1),
    };
    let rate = |k: usize| {
        let drive = if k == 1 { "A*cos(phase) + " } else { "" };
        let next = if k < count {
            format!(" - f{}", k + 1)
        } else {
            String::new()
        };
        format!(r#""x{k}": "v{k}", "v{k}": "{drive}f{k}{next} - m*v{k}""#)
    };
    format!(
        r#"(
        system: (
            states: [{}, {}],
            parameters: {{"A": 1.2, "w": 0.42, "b": 0.2, "m": 0.1, "d": 0.1, "e": 0.8}},
            forcing: "w",
            define: {{{}}},
            modes: {{"free": (
                rates: {{{}}},
                until: [(zero: "d - x{count}", to: "free", reset: {{"v{count}": "-e*v{count}"}})],
            )}},
        ),
        orbit: (start: Simulate(mode: "free", settle: 400, state: {{{}}})),
        continuation: (parameter: "A", range: (0.1, 1.2), toward: Down, max_points: 100),
        stability: (),
    )"#,
        all(&|k| format!(r#""x{k}""#)),
        all(&|k| format!(r#""v{k}""#)),
        all(&force),
        all(&rate),
        all(&|k| format!(r#""x{k}": 0.0, "v{k}": 0.0"#)),
    )
}
