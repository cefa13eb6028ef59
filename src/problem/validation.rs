//! Checks of the values of a problem.

use std::fmt::Debug;
use std::path::PathBuf;

use super::error::excerpt;
use super::expectation::{MAX_EXPECTATIONS, MAX_EXPECTED_TOLERANCE};
use super::outline::Outline;
use super::simulation::{
    Body, Circle, MAX_COURANT, MAX_SAMPLES, MAX_SIMULATION_POINTS, MAX_SNAPSHOTS,
    MIN_GROWTH_POINTS, MIN_SIMULATION_POINTS, RingFriction, Simulation, SimulationStart,
};
use super::{
    Coefficients, Continuation, Curve, CurveEvent, Expectation, FrictionLaw, Impact, MAX_DEGREE,
    MAX_GRID, MAX_INTERVALS, MAX_MAP_POINTS, MAX_MODE, MAX_PROFILES, MAX_TOLERANCE,
    MAX_USER_POINTS, MAX_WORDS, Map, MapPoints, Method, Model, Output, Parameter, Plot, Problem,
    Sectors, StabilitySection, Start, Toward, Wave, is_text,
};
use crate::branch::EventType;
use crate::branch::row::drawable_columns;

/// Something wrong with the value at a path; see [`Outline::locate`].
pub(super) struct Complaint {
    pub path: String,
    pub message: String,
    pub help: String,
}

type Check = Result<(), Complaint>;

/// Refuses the first value of the problem that makes no sense.
pub(super) fn check(problem: &Problem, outline: &Outline) -> Check {
    let mode = problem.wave.mode;
    words(problem)?;
    model(&problem.model)?;
    wave(&problem.wave)?;
    if let Some(chosen) = problem.method {
        method(chosen, problem.model.friction_law)?;
    }
    if let Some(section) = &problem.continuation {
        range(section)?;
        first_point(section, &problem.model, &problem.wave.start)?;
        user_points(section, outline)?;
        steps(section)?;
        stops(section, problem.stability.as_ref())?;
    }
    if let Some(section) = &problem.stability {
        stability(section, mode)?;
    }
    if let Some(section) = &problem.map {
        map(section, &problem.model)?;
    }
    if let Some(section) = &problem.simulation {
        simulation(section, problem)?;
    }
    if let Some(section) = &problem.curve {
        curve(section, &problem.model, mode, outline)?;
    }
    output(problem)?;
    entries("expect", problem.expect.len(), MAX_EXPECTATIONS)?;
    for (index, event) in problem.expect.iter().enumerate() {
        expectation(&format!("expect.{index}"), event, problem)?;
    }
    Ok(())
}

fn refuse(path: &str, message: impl Into<String>, help: impl Into<String>) -> Check {
    Err(Complaint {
        path: path.to_owned(),
        message: message.into(),
        help: help.into(),
    })
}

/// Refuses the value at the path unless it holds to the rule.
fn admit(path: &str, value: impl Debug, holds: bool, rule: &str) -> Check {
    if holds {
        return Ok(());
    }
    // Messages name the fields only; the place tells the entry of a list.
    let is_field = |step: &&str| step.parse::<usize>().is_err();
    let fields: Vec<&str> = path.split('.').filter(is_field).collect();
    let (name, value) = (fields.join("."), excerpt(&format!("{value:?}")));
    refuse(
        path,
        format!("`{name}` is {value}, which is not admitted"),
        rule,
    )
}

/// Refuses NaN, the infinities, and a number that does not hold to the rule.
fn number(path: &str, value: f64, holds: bool, rule: &str) -> Check {
    if !value.is_finite() {
        return admit(path, value, false, &format!("{rule}, and finite"));
    }
    admit(path, value, holds, rule)
}

/// Refuses control characters in what is shown or names a file; escapes bring them past the reader.
fn words(problem: &Problem) -> Check {
    let file = |path: &PathBuf| path.to_string_lossy().into_owned();
    let mut words: Vec<(&str, String)> = Vec::new();
    words.extend(problem.title.clone().map(|title| ("title", title)));
    if let Start::Restart { dir, .. } = &problem.wave.start {
        words.push(("wave.start.dir", file(dir)));
    }
    match problem.simulation.as_ref().map(|section| &section.start) {
        Some(SimulationStart::Wave { dir, .. }) => words.push(("simulation.start.dir", file(dir))),
        Some(SimulationStart::Profile { file: name, .. }) => {
            words.push(("simulation.start.file", file(name)));
        }
        _ => {}
    }
    if let Some(CurveEvent::Label { dir, .. }) = problem.curve.as_ref().map(|curve| &curve.event) {
        words.push(("curve.event.dir", file(dir)));
    }
    for (path, text) in words {
        let refused = |c: &char| matches!(c, '\n' | '\r') || !is_text(*c);
        if let Some(found) = text.chars().find(refused) {
            let message = format!(
                "`{path}` holds the control character U+{:04X}",
                u32::from(found)
            );
            return refuse(path, message, "write one line of text without it");
        }
        let rule = format!("write at most {MAX_WORDS} characters");
        admit(path, &text, text.chars().count() <= MAX_WORDS, &rule)?;
    }
    Ok(())
}

fn model(model: &Model) -> Check {
    for parameter in Parameter::ALL {
        if let Some(value) = model.value(parameter) {
            let (holds, rule) = parameter.admits(value);
            number(parameter.path(), value, holds, rule)?;
        }
    }
    friction_law(model.friction_law, model.impact)?;
    let Coefficients::Given { a, b, d, g, h } = model.coefficients else {
        return Ok(());
    };
    let coupled = "D must not be 0: without coupling there is no travelling wave";
    for (name, value, holds, rule) in [
        ("b", b, b > 0.0, "b must be greater than 0"),
        ("a", a, a > b, "a must be greater than b"),
        ("D", d, d != 0.0, coupled),
        ("g", g, g > 0.0, "g must be greater than 0"),
        ("h", h, h > 0.0, "h must be greater than 0"),
    ] {
        number(&format!("model.coefficients.{name}"), value, holds, rule)?;
    }
    Ok(())
}

fn friction_law(law: FrictionLaw, impact: Impact) -> Check {
    let rule = "static friction is at least kinetic friction: the ratio is at least 1";
    match law {
        FrictionLaw::Regularised { .. } if impact == Impact::Coulomb => refuse(
            "model.impact",
            "a `Coulomb` impact needs a friction law with a sliding direction",
            "leave out `impact`, or the `Regularised` friction law",
        ),
        FrictionLaw::Coulomb | FrictionLaw::Regularised { .. } => Ok(()),
        FrictionLaw::Static { ratio } => {
            number("model.friction_law.ratio", ratio, ratio >= 1.0, rule)
        }
        FrictionLaw::Stribeck { ratio, velocity } => {
            number("model.friction_law.ratio", ratio, ratio >= 1.0, rule)?;
            let rule = "the velocity over which friction falls must be greater than 0";
            number(
                "model.friction_law.velocity",
                velocity,
                velocity > 0.0,
                rule,
            )
        }
    }
}

fn method(method: Method, law: FrictionLaw) -> Check {
    match method {
        Method::Exact => {
            let exact = matches!(law, FrictionLaw::Coulomb | FrictionLaw::Static { .. });
            let rule = "this friction law depends on the velocity and has no closed form; write \
                        `Shooting(tolerance: 1e-12)` or `Collocation(intervals: 20, degree: 4)`";
            admit("method", method, exact, rule)
        }
        Method::Shooting { tolerance } => {
            let holds = (1e-14..=MAX_TOLERANCE).contains(&tolerance);
            let rule = format!("the tolerance must lie between 1e-14 and {MAX_TOLERANCE:?}");
            number("method.tolerance", tolerance, holds, &rule)
        }
        Method::Collocation { intervals, degree } => {
            let rule = format!("a zone has 2 to {MAX_INTERVALS} mesh intervals");
            let holds = (2..=MAX_INTERVALS).contains(&intervals);
            admit("method.intervals", intervals, holds, &rule)?;
            let rule = format!("an interval has 2 to {MAX_DEGREE} collocation points");
            admit(
                "method.degree",
                degree,
                (2..=MAX_DEGREE).contains(&degree),
                &rule,
            )
        }
    }
}

fn wave(Wave { mode, start }: &Wave) -> Check {
    let rule = format!("the mode is the number of waves around the circumference, 1 to {MAX_MODE}");
    admit("wave.mode", mode, (1..=MAX_MODE).contains(mode), &rule)?;
    if let Start::Restart { dir, .. } = start {
        let rule = "name the directory with the results of an earlier run";
        admit("wave.start.dir", dir, !dir.as_os_str().is_empty(), rule)?;
    }
    Ok(())
}

fn range(section: &Continuation) -> Check {
    let (lower, upper) = section.range;
    for (path, end) in [
        ("continuation.range.0", lower),
        ("continuation.range.1", upper),
    ] {
        let (holds, rule) = section.parameter.admits(end);
        number(path, end, holds, rule)?;
    }
    let rule = "write the lower end first and the upper end, which must be greater, second";
    admit("continuation.range", section.range, lower < upper, rule)
}

/// Refuses a parameter that the model does not have.
fn absent(path: &str, parameter: Parameter) -> Check {
    let column = parameter.column();
    if parameter == Parameter::Smoothing {
        return refuse(
            path,
            format!("`{column}` is unknown: the friction law has no smoothing"),
            "use `friction_law: Regularised(epsilon: 0.02)`, or another parameter",
        );
    }
    refuse(
        path,
        format!("`{column}` is unknown: the coefficients are `Given`"),
        "use `coefficients: Geometry(nu: .., xi: .., gamma: ..)`, or another parameter: Mismatch, \
         Friction, MassDamping or StiffnessDamping",
    )
}

fn first_point(section: &Continuation, model: &Model, start: &Start) -> Check {
    let column = section.parameter.column();
    let Some(value) = model.value(section.parameter) else {
        return absent("continuation.parameter", section.parameter);
    };
    // A restart brings its own parameters, and so does a Hopf point.
    match start {
        Start::Restart { .. } => return Ok(()),
        Start::Hopf => {
            let only = section.parameter.beyond_hopf();
            let holds = [Toward::Both, only].contains(&section.toward);
            let rule = format!(
                "waves exist on one side of the Hopf point only: write `toward: {only:?}`, or leave \
                 it out"
            );
            return admit("continuation.toward", section.toward, holds, &rule);
        }
        Start::Fast | Start::Slow => {}
    }
    let (lower, upper) = section.range;
    let begins = format!("the branch starts at {column} = {value:?}");
    if !(lower..=upper).contains(&value) {
        return refuse(
            "continuation.range",
            format!("{begins}, outside the range from {lower:?} to {upper:?}"),
            format!("widen the range or change `{column}` in the model"),
        );
    }
    let (edge, opposite) = match section.toward {
        Toward::Down if value == lower => ("lower", "Up"),
        Toward::Up if value == upper => ("upper", "Down"),
        _ => return Ok(()),
    };
    refuse(
        "continuation.toward",
        format!("{begins}, the {edge} end of the range, which has nothing in this direction"),
        format!("write `toward: {opposite}`, or move this end of the range"),
    )
}

fn user_points(section: &Continuation, outline: &Outline) -> Check {
    let (lower, upper) = section.range;
    let column = section.parameter.column();
    let rule = format!("user points must lie within the range from {lower:?} to {upper:?}");
    let names = outline.entries("continuation.stop_at");
    entries(
        "continuation.stop_at",
        section.stop_at.len(),
        MAX_USER_POINTS,
    )?;
    for (index, (&value, name)) in section.stop_at.iter().zip(names).enumerate() {
        let path = format!("continuation.stop_at.{index}");
        if let Some(name) = name.filter(|name| *name != column) {
            let name = excerpt(name);
            return refuse(
                &path,
                format!("the user point names `{name}`, but the branch is in `{column}`"),
                format!("write `({column}: {value:?})` or the bare number"),
            );
        }
        number(&path, value, (lower..=upper).contains(&value), &rule)?;
        // the list is short, and -0 is 0
        if section.stop_at[..index].contains(&value) {
            return twice(&path, value);
        }
    }
    Ok(())
}

/// Refuses a list without end.
fn entries(path: &str, count: usize, most: usize) -> Check {
    if count <= most {
        return Ok(());
    }
    let message = format!("`{path}` has {count} entries");
    refuse(path, message, format!("write at most {most}"))
}

/// Refuses an entry that stands in its list already.
fn twice(path: &str, entry: impl Debug) -> Check {
    let message = format!("{} is listed twice", excerpt(&format!("{entry:?}")));
    refuse(path, message, "list each once")
}

fn steps(section: &Continuation) -> Check {
    step_lengths(
        "continuation",
        [section.ds, section.ds_min, section.ds_max],
        section.tolerance,
    )?;
    let Some(points) = section.max_points else {
        return Ok(());
    };
    let rule = "a branch has at least 1 point";
    admit("continuation.max_points", points, points >= 1, rule)
}

fn stops(section: &Continuation, stability: Option<&StabilitySection>) -> Check {
    let stops = &section.stop_after;
    for (index, stop) in stops.iter().enumerate() {
        let path = format!("continuation.stop_after.{index}");
        looked_for(&format!("{path}.event"), stop.event, None, stability)?;
        let rule = "`count: 1` ends the branch at the first event of this type";
        admit(&format!("{path}.count"), stop.count, stop.count >= 1, rule)?;
        if stops[..index].iter().any(|other| other.event == stop.event) {
            return twice(&format!("{path}.event"), stop.event);
        }
    }
    Ok(())
}

/// Refuses events of a spectrum that is not computed.
fn looked_for(
    path: &str,
    event: EventType,
    wanted: Option<usize>,
    stability: Option<&StabilitySection>,
) -> Check {
    let Some(sectors) = stability.map(|section| &section.sectors) else {
        return if event.of_spectrum() {
            let message = format!("no {event} is found without the section `stability`");
            refuse(path, message, "add `stability: (sectors: All)`")
        } else {
            Ok(())
        };
    };
    match (sectors, wanted) {
        (Sectors::Only(list), Some(sector)) if !list.contains(&sector) => refuse(
            path,
            format!("`stability.sectors` leaves out sector {sector}"),
            "add it there, or write `All`",
        ),
        _ => Ok(()),
    }
}

/// Checks steps [ds, ds_min, ds_max] and tolerance of a section.
fn step_lengths(section: &str, [ds, ds_min, ds_max]: [f64; 3], tolerance: f64) -> Check {
    let [ds, ds_min, ds_max] = [("ds", ds), ("ds_min", ds_min), ("ds_max", ds_max)];
    for (name, step) in [ds, ds_min, ds_max] {
        let rule = "step sizes must be greater than 0";
        number(&format!("{section}.{name}"), step, step > 0.0, rule)?;
    }
    for ((low_name, low), (high_name, high)) in [(ds_min, ds_max), (ds_min, ds), (ds, ds_max)] {
        if low > high {
            return refuse(
                &format!("{section}.{low_name}"),
                format!("`{low_name}` is {low:?} but `{high_name}` is {high:?}"),
                "choose ds_min <= ds <= ds_max",
            );
        }
    }
    let holds = tolerance > 0.0 && tolerance <= MAX_TOLERANCE;
    let rule = format!("the tolerance must be greater than 0 and at most {MAX_TOLERANCE:?}");
    number(&format!("{section}.tolerance"), tolerance, holds, &rule)
}

fn curve(section: &Curve, model: &Model, mode: u32, outline: &Outline) -> Check {
    let rule = "`index: 1` is the first event of this type along the branch";
    admit("curve.index", section.index, section.index >= 1, rule)?;
    sector("curve.sector", section.sector, mode)?;
    let is_hopf = section.event == CurveEvent::HB;
    if outline.has("curve.sector") && !is_hopf {
        return refuse(
            "curve.sector",
            "`curve.sector` is given for an event that has none, or whose label says it",
            "leave it out, or follow an HB",
        );
    }
    if outline.has("curve.index") && section.event.kind().is_none() {
        return refuse(
            "curve.index",
            "`curve.index` is given beside a label",
            "leave it out: the label names one event",
        );
    }
    let (first, second) = section.parameters;
    let sides = [(first, section.range.0), (second, section.range.1)];
    for (side, (parameter, range)) in sides.into_iter().enumerate() {
        if model.value(parameter).is_none() {
            return absent(&format!("curve.parameters.{side}"), parameter);
        }
        for (end, value) in [range.0, range.1].into_iter().enumerate() {
            let (holds, rule) = parameter.admits(value);
            number(&format!("curve.range.{side}.{end}"), value, holds, rule)?;
        }
        let rule = "write the lower end first and the upper end, which must be greater, second";
        admit(
            &format!("curve.range.{side}"),
            range,
            range.0 < range.1,
            rule,
        )?;
    }
    let rule = "the two parameters of a curve must be different";
    admit("curve.parameters.1", second, first != second, rule)?;
    step_lengths(
        "curve",
        [section.ds, section.ds_min, section.ds_max],
        section.tolerance,
    )?;
    let points = section.max_points;
    let rule = "a curve has at least 1 point";
    admit("curve.max_points", points, points >= 1, rule)
}

/// Refuses a Bloch sector beyond half the mode: it is the conjugate of another one.
fn sector(path: &str, sector: usize, mode: u32) -> Check {
    let last = mode as usize / 2;
    let rule = format!("the sectors of mode {mode} run from 0 to {last}");
    admit(path, sector, sector <= last, &rule)
}

fn sectors(path: &str, sectors: &Sectors, mode: u32) -> Check {
    let Sectors::Only(list) = sectors else {
        return Ok(());
    };
    let rule = "name at least one sector, e.g. `Only([0])`, or write `All`";
    admit(path, list, !list.is_empty(), rule)?;
    // A list longer than there are sectors fails on one of its first entries.
    for (index, &entry) in list.iter().enumerate() {
        let path = format!("{path}.0.{index}");
        sector(&path, entry, mode)?;
        if list[..index].contains(&entry) {
            let message = format!("sector {entry} is listed twice");
            return refuse(&path, message, "list each sector once");
        }
    }
    Ok(())
}

fn stability(section: &StabilitySection, mode: u32) -> Check {
    sectors("stability.sectors", &section.sectors, mode)?;
    let kept = section.eigenvalues;
    let rule = "keep at least 1 eigenvalue, or leave out the section `stability`";
    admit("stability.eigenvalues", kept, kept >= 1, rule)?;
    let highest = section.max_frequency;
    let rule = "the highest frequency must be greater than 0";
    number("stability.max_frequency", highest, highest > 0.0, rule)
}

fn map(section: &Map, model: &Model) -> Check {
    for (side, axis) in [("first", &section.first), ("second", &section.second)] {
        if model.value(axis.parameter).is_none() {
            return absent(&format!("map.{side}.parameter"), axis.parameter);
        }
        let (lower, upper) = axis.range;
        for (end, value) in [lower, upper].into_iter().enumerate() {
            let (holds, rule) = axis.parameter.admits(value);
            number(&format!("map.{side}.range.{end}"), value, holds, rule)?;
        }
        let rule = "write the lower end first and the upper end, which must be greater, second";
        admit(
            &format!("map.{side}.range"),
            axis.range,
            lower < upper,
            rule,
        )?;
    }
    let parameter = section.second.parameter;
    let rule = "the two parameters of a map must be different";
    let differ = section.first.parameter != parameter;
    admit("map.second.parameter", parameter, differ, rule)?;
    match section.points {
        MapPoints::Grid { rows, columns } => {
            let rule = format!("a grid has 2 to {MAX_GRID} of them");
            for (name, value) in [("rows", rows), ("columns", columns)] {
                let holds = (2..=MAX_GRID).contains(&value);
                admit(&format!("map.points.{name}"), value, holds, &rule)?;
            }
            let rule = format!("a map has at most {MAX_MAP_POINTS} points");
            let holds = rows.saturating_mul(columns) <= MAX_MAP_POINTS;
            admit("map.points", section.points, holds, &rule)?;
        }
        MapPoints::QuasiRandom { count } => {
            let rule = format!("a map has 1 to {MAX_MAP_POINTS} points");
            let holds = (1..=MAX_MAP_POINTS).contains(&count);
            admit("map.points.count", count, holds, &rule)?;
        }
    }
    let starts = &section.starts;
    let rule = "name Fast, Slow or both, each once";
    admit("map.starts", starts, !starts.is_empty(), rule)?;
    for (index, start) in starts.iter().enumerate() {
        let known = matches!(start, Start::Fast | Start::Slow) && !starts[..index].contains(start);
        admit(&format!("map.starts.{index}"), start, known, rule)?;
    }
    Ok(())
}

fn simulation(section: &Simulation, problem: &Problem) -> Check {
    let mode = problem.wave.mode;
    let rule = format!(
        "a simulation has {MIN_SIMULATION_POINTS} to {MAX_SIMULATION_POINTS} points around"
    );
    let resolved =
        |points: usize| (MIN_SIMULATION_POINTS..=MAX_SIMULATION_POINTS).contains(&points);
    let around = match section.body {
        Body::Ring {
            points, friction, ..
        } => {
            admit("simulation.body.points", points, resolved(points), &rule)?;
            if let RingFriction::Tanh { epsilon } = friction {
                let rule = "the width of the transition must be greater than 0";
                let path = "simulation.body.friction.epsilon";
                number(path, epsilon, epsilon > 0.0, rule)?;
            }
            points
        }
        Body::Annulus { around, across } => {
            admit("simulation.body.around", around, resolved(around), &rule)?;
            let rule = format!(
                "an annulus has at least 2 elements across, and at most \
                 {MAX_SIMULATION_POINTS} elements in all"
            );
            let holds = across >= 2 && across <= MAX_SIMULATION_POINTS / around;
            admit("simulation.body.across", across, holds, &rule)?;
            if matches!(problem.model.coefficients, Coefficients::Given { .. }) {
                return refuse(
                    "simulation.body",
                    "an annulus needs a geometry, but the coefficients are `Given`",
                    "write `coefficients: Geometry(nu: .., xi: .., gamma: ..)`, or simulate a `Ring`",
                );
            }
            around
        }
    };
    match &section.start {
        SimulationStart::SteadySliding => {}
        SimulationStart::Wave { dir, .. } => {
            let rule = "name the directory with the results of a run";
            let path = "simulation.start.dir";
            admit(path, dir, !dir.as_os_str().is_empty(), rule)?;
        }
        SimulationStart::Profile { speed, .. } => {
            let rule = "the speed of a wave is not 0";
            number("simulation.start.speed", *speed, *speed != 0.0, rule)?;
        }
    }
    let from_wave = section.start != SimulationStart::SteadySliding;
    if from_wave && matches!(section.body, Body::Annulus { .. }) {
        return refuse(
            "simulation.start",
            "an annulus cannot begin with a wave: the table holds its contact line only",
            "write `start: SteadySliding` with a perturbation",
        );
    }
    let waves = match section.circle {
        Circle::Whole => 1,
        Circle::Wavelength => mode,
    };
    if from_wave && section.circle == Circle::Whole && !around.is_multiple_of(mode as usize) {
        let rule = format!("{mode} waves need a multiple of {mode} points to be alike");
        return admit("simulation.body.points", around, false, &rule);
    }
    if let Some(perturbation) = section.perturbation {
        let highest = (around as u64 * u64::from(waves) / 4) as u32;
        let holds = perturbation.mode <= highest && perturbation.mode.is_multiple_of(waves);
        let rule = match section.circle {
            Circle::Whole => format!("the points resolve the modes 0 to {highest}"),
            Circle::Wavelength => format!(
                "one wavelength of mode {mode} holds multiples of {mode}, here up to {highest}; \
                 write `circle: Whole` for others"
            ),
        };
        let path = "simulation.perturbation.mode";
        admit(path, perturbation.mode, holds, &rule)?;
        let path = "simulation.perturbation.amplitude";
        number(
            path,
            perturbation.amplitude,
            true,
            "an amplitude is a number",
        )?;
    }
    let (duration, every) = (section.duration, section.every);
    let rule = "the time simulated must be greater than 0";
    number("simulation.duration", duration, duration > 0.0, rule)?;
    let holds = every > 0.0 && every <= duration && duration / every <= MAX_SAMPLES as f64;
    let rule = format!(
        "the time between samples must be greater than 0, at most the duration, and leave at most \
         {MAX_SAMPLES} samples"
    );
    number("simulation.every", every, holds, &rule)?;
    let courant = section.courant;
    let holds = courant > 0.0 && courant <= MAX_COURANT;
    let rule = format!("the Courant number must be greater than 0 and at most {MAX_COURANT}");
    number("simulation.courant", courant, holds, &rule)?;
    let snapshots = section.snapshots;
    let rule = format!("ask for at most {MAX_SNAPSHOTS} snapshots");
    let path = "simulation.snapshots";
    admit(path, snapshots, snapshots <= MAX_SNAPSHOTS, &rule)?;
    if let Some(growth) = &section.growth {
        if !from_wave {
            return refuse(
                "simulation.growth",
                "there is no wave whose perturbations could grow",
                "write `start: Wave(dir: \"results/x\", label: 3)`, or remove `growth`",
            );
        }
        let per_wave = match section.circle {
            Circle::Whole => around / mode as usize,
            Circle::Wavelength => around,
        };
        let rule = format!("growth needs at least {MIN_GROWTH_POINTS} points per wavelength");
        let holds = per_wave >= MIN_GROWTH_POINTS;
        admit("simulation.body.points", around, holds, &rule)?;
        sectors("simulation.growth.sectors", &growth.sectors, mode)?;
        let rule = "Arnoldi's method needs at least 2 pairs of runs, and 1000 are plenty";
        let path = "simulation.growth.pairs";
        admit(path, growth.pairs, (2..=1000).contains(&growth.pairs), rule)?;
        let amplitude = growth.amplitude;
        let rule = "the difference of the runs must be greater than 0 and small, at most 0.1";
        let holds = amplitude > 0.0 && amplitude <= 0.1;
        number("simulation.growth.amplitude", amplitude, holds, rule)?;
    }
    if problem.model.damping.stiffness != 0.0 && matches!(section.body, Body::Annulus { .. }) {
        let rule = "an annulus has no stiffness-proportional damping; leave it out, use `mass`, or \
                    simulate a `Ring`";
        return admit(
            "model.damping.stiffness",
            problem.model.damping.stiffness,
            false,
            rule,
        );
    }
    if problem.model.friction_law != FrictionLaw::Coulomb {
        return refuse(
            "model.friction_law",
            "`model.friction_law` is not Coulomb's, and no other is simulated",
            "leave it out; a ring has `friction: Tanh(epsilon: 0.01)` in its section",
        );
    }
    if problem.model.impact == Impact::Coulomb {
        return refuse(
            "model.impact",
            "`model.impact` is Coulomb, which is not simulated",
            "write `impact: Frictionless` in a file with a section `simulation`",
        );
    }
    Ok(())
}

fn output(problem: &Problem) -> Check {
    let Output {
        plots, profiles, ..
    } = &problem.output;
    let rule = format!("ask for at most {MAX_PROFILES} profiles");
    admit(
        "output.profiles",
        profiles,
        *profiles <= MAX_PROFILES,
        &rule,
    )?;
    let columns = drawable_columns();
    for (index, plot) in plots.iter().enumerate() {
        let path = format!("output.plots.{index}");
        if let Plot::Column(name) = plot {
            let rule = format!(
                "name a column of branch.csv, e.g. `Column(\"amplitude\")`; it has {}",
                columns.join(", ")
            );
            admit(&path, plot, columns.contains(name), &rule)?;
        }
        if plots[..index].contains(plot) {
            return twice(&path, plot);
        }
        if let Some((needed, help)) = lacks(plot, problem) {
            let message = format!("the plot {plot:?} shows nothing without {needed}");
            return refuse(&path, message, help);
        }
    }
    Ok(())
}

/// What a plot shows but the problem does not ask for, and how to ask for it.
fn lacks(plot: &Plot, problem: &Problem) -> Option<(&'static str, &'static str)> {
    let stability = (
        "the section `stability`",
        "add `stability: (sectors: All)`, or leave out the plot",
    );
    let profiles = (
        "profiles",
        "add `profiles: 9` to `output`, or leave out the plot",
    );
    let (needed, given) = match plot {
        Plot::Diagram => return None,
        Plot::Spectrum | Plot::Multipliers => (stability, problem.stability.is_some()),
        Plot::Pressure | Plot::Displacement | Plot::PhasePlane | Plot::Friction => {
            (profiles, problem.output.profiles > 0)
        }
        Plot::Column(name) => match name.as_str() {
            "unstable" | "lead_re" | "lead_im" | "lead_sector" => {
                (stability, problem.stability.is_some())
            }
            "condition" | "expected_error" => (
                (
                    "`conditioning`",
                    "add `conditioning: true` to `output`, or leave out the plot",
                ),
                problem.output.conditioning,
            ),
            name => {
                // a restart brings its own model
                let known = |parameter| problem.model.value(parameter).is_some();
                let restarts = matches!(problem.wave.start, Start::Restart { .. });
                (
                    (
                        "this parameter in the model",
                        "use `coefficients: Geometry(..)` for gamma, nu and xi, `friction_law: \
                         Regularised(..)` for smoothing, or leave out the plot",
                    ),
                    restarts || Parameter::from_column(name).is_none_or(known),
                )
            }
        },
    };
    (!given).then_some(needed)
}

fn expectation(path: &str, event: &Expectation, problem: &Problem) -> Check {
    let model = &problem.model;
    let kind = event.event;
    if let Some(entry) = event.sector {
        sector(&format!("{path}.sector"), entry, problem.wave.mode)?;
    }
    looked_for(
        &format!("{path}.event"),
        kind,
        event.sector,
        problem.stability.as_ref(),
    )?;
    let tolerance = event.tolerance;
    let rule = format!(
        "the tolerance must be greater than 0 and at most {MAX_EXPECTED_TOLERANCE:?}; it is \
         relative, or absolute where the expected value is 0"
    );
    number(
        &format!("{path}.tolerance"),
        tolerance,
        tolerance > 0.0 && tolerance <= MAX_EXPECTED_TOLERANCE,
        &rule,
    )?;
    for (name, given) in [
        ("sector", event.sector.is_some()),
        ("omega", event.omega.is_some()),
    ] {
        if given && !kind.of_spectrum() {
            let message = format!("`{name}` is expected of a {kind}, which has none");
            return refuse(
                &format!("{path}.{name}"),
                message,
                "leave it out, or expect an HB or a BP",
            );
        }
    }
    if let Some(label) = event.label {
        let rule = "labels run from 1";
        admit(&format!("{path}.label"), label, label >= 1, rule)?;
    }
    let numbers = event.numbers();
    if numbers.is_empty() {
        return refuse(
            path,
            format!("nothing to compare this {kind} event with"),
            "add at least one number: speed, omega, mismatch, friction, mass_damping, \
             stiffness_damping, gamma, nu, xi or smoothing",
        );
    }
    for &(name, value) in &numbers {
        let path = format!("{path}.{name}");
        number(&path, value, true, "the expected value must be a number")?;
        if let Some(known) = Parameter::from_column(name)
            && model.value(known).is_none()
        {
            return absent(&path, known);
        }
    }
    match &problem.continuation {
        Some(section) => fallible(path, event, section, &problem.wave.start),
        None => Ok(()),
    }
}

/// Refuses an expectation that every branch of the problem meets.
fn fallible(path: &str, event: &Expectation, section: &Continuation, start: &Start) -> Check {
    let column = section.parameter.column();
    let numbers = event.numbers();
    let varies = |name: &str| name == column || Parameter::from_column(name).is_none();
    // a restart brings values that are not in the file
    let restarts = matches!(start, Start::Restart { .. });
    if !restarts && !numbers.iter().any(|(name, _)| varies(name)) {
        return refuse(
            path,
            format!(
                "only values of the model are expected of this {} event, and a branch in `{column}` \
                 keeps them",
                event.event
            ),
            format!("add `{column}` or `speed`, which the branch changes"),
        );
    }
    let (lower, upper) = section.range;
    for (name, value) in numbers.into_iter().filter(|(name, _)| *name == column) {
        let [least, most] = event.admitted(value);
        if least <= lower && most >= upper {
            return refuse(
                &format!("{path}.tolerance"),
                format!(
                    "with this tolerance `{name}` may be anything from {least:?} to {most:?}, which \
                     is the whole range"
                ),
                "take a smaller tolerance",
            );
        }
    }
    Ok(())
}
