//! What the page of a report takes from the pictures: axes, lines and marks of a branch, and what each
//! picture shows, in words.

use std::path::Path;

use super::diagram::{parameter_axis, pattern_between, same_leg};
use super::names::quantity;
use super::simulation;
use super::tables::{Tables, column, kind};
use crate::output::layout;
use crate::output::render::{Extent, Format, Pattern, number, range};
use crate::output::store::{Kind, StoreError};
use crate::problem::{Any, Plot, Problem, SystemPlot, SystemProblem, drawable_columns};
use crate::table::Table;
use crate::tube::model::Parameter;

/// A branch as the page draws it.
pub(crate) struct Drawn {
    pub branch: Table,
    /// Columns that can be drawn, the parameter first and then the speed, each with its caption.
    pub columns: Vec<(String, String)>,
    /// Whether the axis of the parameter is logarithmic.
    pub logarithmic: bool,
    /// How the line from each point to the next is drawn.
    pub lines: Vec<&'static str>,
    /// Mark of each point: none where a branch that is left both ways begins.
    pub marks: Vec<String>,
}

/// Reads a branch.
///
/// # Errors
/// When a table is damaged.
pub(crate) fn drawn(folder: &Path, problem: &Problem) -> Result<Drawn, StoreError> {
    let parameter = problem.parameter().column();
    let tables = Tables::read(folder, parameter)?;
    let axis = parameter_axis(&tables);
    let caption = |name: &str| {
        let mut quantity = quantity(name);
        quantity.dimensional = problem.output.rotation.is_some();
        (name.to_owned(), quantity.caption())
    };
    let branch = &tables.branch;
    let varies = |name: &String| {
        let values = || {
            column(branch, name)
                .into_iter()
                .filter(|value| value.is_finite())
        };
        let first = values().next();
        values().any(|value| Some(value) != first) && range(values()).is_some()
    };
    let others = drawable_columns().into_iter().filter(|name| {
        !["speed", parameter, "point", "label", "leg"].contains(&name.as_str()) && varies(name)
    });
    let columns = [parameter, "speed"].map(caption).into_iter();
    let columns = columns.chain(others.map(|name| caption(&name))).collect();
    let line = |row| match same_leg(branch, row).then(|| pattern_between(branch, row)) {
        Some(Pattern::Solid) => "solid",
        Some(Pattern::Dashed) => "dashed",
        Some(Pattern::Dotted) | None => "dotted",
    };
    let begun = tables.begun();
    let mark = |row| match kind(branch, row) {
        Some(_) if begun.contains(&branch.text(row, "label")) => String::new(),
        Some(kind) => kind.to_string(),
        None => String::new(),
    };
    Ok(Drawn {
        lines: (0..branch.len()).map(line).collect(),
        marks: (0..branch.len()).map(mark).collect(),
        columns,
        logarithmic: matches!(axis.extent, Extent::Logarithmic(_)),
        branch: tables.branch,
    })
}

/// What a picture of a folder shows.
pub(crate) fn description(picture: &str, kind: Option<Kind>, problem: Option<&Any>) -> String {
    let problem = match problem {
        Some(Any::Tube(problem)) => problem,
        Some(Any::System(problem)) => return of_system(picture, kind, problem),
        None => return picture.to_owned(),
    };
    let caption = |parameter: Parameter| quantity(parameter.column()).caption();
    let parameter = caption(problem.parameter());
    let of_run = |plot: &Plot| {
        let several = format!("for several values of {parameter}");
        match plot {
            Plot::Diagram => format!("Branch diagram: {}", over("speed c", problem)),
            Plot::Column(name) => over(&quantity(name).caption(), problem),
            Plot::Pressure => format!("Contact pressure P along the wave, {several}"),
            Plot::Displacement => {
                format!("Gap U − δ along the wave and the zones of contact, {several}")
            }
            Plot::Wave => format!("Displacements V and U along the wave, {several}"),
            Plot::PhasePlane => format!("Velocity V\u{307} against displacement V, {several}"),
            Plot::Friction => {
                "Friction force Q with its bounds and sliding velocity along one wave".to_owned()
            }
            Plot::Spectrum => "Eigenvalues λ of perturbations in the complex plane".to_owned(),
            Plot::Multipliers => {
                "Floquet multipliers of perturbations and the unit circle".to_owned()
            }
        }
    };
    let plane = |parameters: [Parameter; 2]| {
        let [first, second] = parameters.map(caption);
        format!("in the plane of {first} and {second}")
    };
    let is = |name: &str| layout::picture(name, Format::Svg) == picture;
    match (kind, &problem.map, &problem.curve) {
        (Some(Kind::Map), Some(map), _) => {
            let plane = plane([map.second.parameter, map.first.parameter]);
            format!("Sequences of regimes {plane}")
        }
        (Some(Kind::Curve), _, Some(curve)) => {
            let plane = plane([curve.parameters.0, curve.parameters.1]);
            format!("The curve of an event {plane}")
        }
        (Some(Kind::Accuracy), ..) => METHODS.to_owned(),
        (Some(Kind::Steady), ..) => {
            "Growth of the perturbations of steady sliding, by mode".to_owned()
        }
        (Some(Kind::Simulation), ..) => {
            let known = layout::MOTION.iter().zip(simulation::SHOWN);
            let known = known.into_iter().find(|(name, _)| is(name));
            known.map_or(picture, |(_, shown)| shown).to_owned()
        }
        _ => {
            let plot = problem
                .output
                .plots
                .iter()
                .find(|plot| is(&layout::plot(plot)));
            plot.map_or_else(|| "A view of the branch".to_owned(), of_run)
        }
    }
}

/// What the picture of `accuracy` shows.
const METHODS: &str = "Error of each method against its run time";

/// The same of a system of one's own.
fn of_system(picture: &str, kind: Option<Kind>, problem: &SystemProblem) -> String {
    let is = |name: &str| layout::picture(name, Format::Svg) == picture;
    let states = &problem.system.source.states;
    let scanned = problem.scan.as_ref().map_or("", |scan| &scan.parameter);
    let branch = problem.continuation.as_ref();
    let parameter = branch.map_or("", |branch| branch.parameter.as_str());
    let first = states.first().map_or("", String::as_str);
    match kind {
        Some(Kind::Scan) if is(layout::SCANNED[0]) => {
            format!("What motions settle on: samples of {first} against {scanned}")
        }
        Some(Kind::Scan) => format!("Samples of {first} against {scanned}, and a branch over them"),
        Some(Kind::Map) => {
            let axes = problem.map.iter().flat_map(|map| [&map.second, &map.first]);
            let axes: Vec<&str> = axes.map(|axis| axis.name()).collect();
            format!(
                "What motions settle on in the plane of {}",
                axes.join(" and ")
            )
        }
        Some(Kind::Simulation) if is(layout::OF_MOTION[0]) => "The states over time".to_owned(),
        Some(Kind::Simulation) => "The first two states over each other".to_owned(),
        Some(Kind::Accuracy) => METHODS.to_owned(),
        _ => {
            let plots = problem.output.plots.iter();
            let plot = plots.into_iter().find(|plot| is(&layout::orbit_plot(plot)));
            match plot {
                Some(SystemPlot::Diagram) => {
                    format!("Branch diagram: greatest {first} against {parameter}")
                }
                Some(SystemPlot::Column(name)) => format!("{name} against {parameter}"),
                Some(SystemPlot::Phase(one, other)) => format!("{other} over {one} of some orbits"),
                Some(SystemPlot::Time(state)) => format!("{state} over time of some orbits"),
                Some(SystemPlot::Multipliers) => "Multipliers of an orbit".to_owned(),
                None => "A view of the branch".to_owned(),
            }
        }
    }
}

/// A column over the range of the branch.
fn over(column: &str, problem: &Problem) -> String {
    let parameter = quantity(problem.parameter().column()).caption();
    let range = problem.continuation.as_ref().map(|section| section.range);
    let range = range.map_or_else(String::new, |(low, high)| {
        let [low, high] = [low, high].map(|end| number::significant(end, 4));
        format!(" from {low} to {high}")
    });
    format!(
        "{column} against {parameter}{range}; solid where waves are stable, dashed where unstable, dotted where \
         that is not known"
    )
}
