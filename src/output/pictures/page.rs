//! What the page of a report takes from the pictures: axes, lines and marks of a branch, and what each
//! picture shows, in words.

use std::path::Path;

use super::codes::Codes;
use super::diagram::{pattern_between, same_leg};
use super::names::{event, event_mark, quantity};
use super::orbits::ordinate;
use super::simulation;
use super::tables::{Tables, column, kind};
use super::view::parameter_axis;
use crate::branch::row::WORD_COLUMNS;
use crate::orbit::EventType;
use crate::output::layout::{self, EIGENVALUES, MULTIPLIERS, SPECTRUM};
use crate::output::render::{Extent, Format, Pattern, number, path, range};
use crate::output::store::{FolderKind, StoreError};
use crate::problem::{Any, Plot, Problem, SystemPlot, SystemProblem, drawable_columns};
use crate::table::Table;
use crate::tube::model::Parameter;

/// A branch as the page draws it.
pub(crate) struct Drawn {
    pub branch: Table,
    /// Columns that can be drawn, the parameter first and then the one that is shown first.
    pub columns: Vec<Column>,
    /// Whether the axis of the parameter is logarithmic.
    pub logarithmic: bool,
    /// How the line from each point to the next is drawn.
    pub lines: Vec<&'static str>,
    /// Mark of each point: none where a branch that is left both ways begins.
    pub marks: Vec<String>,
    /// Short names of its sequences.
    pub codes: Codes,
    pub subject: PageSubject,
}

/// A column of a branch.
pub(crate) struct Column {
    pub name: String,
    pub caption: String,
    /// What stands for it in a sentence.
    pub symbol: String,
}

/// What the points of a branch are, and what is shown of one beside the diagram.
pub(crate) struct PageSubject {
    /// A point in a word.
    pub noun: &'static str,
    /// Columns of its profile: the place along it, what is drawn over that, the regime or mode.
    pub profile: Vec<String>,
    /// The table of its eigenvalues or multipliers.
    pub values: &'static str,
    pub beside: Vec<SidePicture>,
}

/// A picture beside the diagram.
pub(crate) struct SidePicture {
    pub name: &'static str,
    /// `along` a profile, a `phase` plane, a plane of values with the unit `circle` or the imaginary `axis`.
    pub shows: &'static str,
    pub x: String,
    /// One or more columns, with spaces between them.
    pub y: String,
    /// Columns that may be shown instead, in the same form.
    pub choices: String,
    pub captions: [&'static str; 2],
    /// In units of the page, where the width is 420.
    pub height: u16,
}

impl SidePicture {
    fn new(name: &'static str, shows: &'static str, [x, y]: [&str; 2], height: u16) -> SidePicture {
        SidePicture {
            name,
            shows,
            x: x.to_owned(),
            y: y.to_owned(),
            choices: String::new(),
            captions: ["", ""],
            height,
        }
    }

    fn captioned(self, captions: [&'static str; 2]) -> SidePicture {
        SidePicture { captions, ..self }
    }
}

impl PageSubject {
    /// What a problem follows.
    fn of(problem: &Any) -> PageSubject {
        let words = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        match problem {
            Any::Tube(_) => PageSubject {
                noun: "wave",
                profile: words(&["theta", "U", "V", "P", "regime"]),
                values: SPECTRUM,
                beside: vec![
                    SidePicture::new("wave", "along", ["theta", "U V"], 170)
                        .captioned(["θ", "displacement U (blue), V"]),
                    SidePicture::new("pressure", "along", ["theta", "P"], 130)
                        .captioned(["θ", "pressure P"]),
                    SidePicture::new("eigenvalues", "axis", ["re", "im"], 190)
                        .captioned(["Re λ", "Im λ"]),
                ],
            },
            Any::System(problem) if problem.equilibrium.is_some() => PageSubject {
                noun: "equilibrium",
                profile: Vec::new(),
                values: EIGENVALUES,
                beside: vec![
                    SidePicture::new("eigenvalues", "axis", ["re", "im"], 300)
                        .captioned(["Re λ", "Im λ"]),
                ],
            },
            Any::System(problem) => PageSubject::orbit(problem),
        }
    }

    /// A periodic orbit, with the states that the problem's own pictures show.
    fn orbit(problem: &SystemProblem) -> PageSubject {
        let states = &problem.system.source.states;
        let choices = states.join(" ");
        let plots = &problem.output.plots;
        let first = states.first().map_or("", String::as_str);
        let series = plots.iter().find_map(|plot| match plot {
            SystemPlot::Time(state) => Some(state.as_str()),
            _ => None,
        });
        let plane = plots.iter().find_map(|plot| match plot {
            SystemPlot::Phase(x, y) if states.contains(x) && states.contains(y) => {
                Some([x.as_str(), y.as_str()])
            }
            _ => None,
        });
        // one state alone has no phase plane
        let plane = plane.or(states.get(1).map(|second| [first, second]));
        let phase = plane.map(|plane| SidePicture::new("phase", "phase", plane, 260));
        let time = SidePicture::new("time", "along", ["time", series.unwrap_or(first)], 150);
        let chosen = phase.into_iter().chain([time]);
        let chosen = chosen.map(|picture| SidePicture {
            choices: choices.clone(),
            ..picture
        });
        let multipliers = SidePicture::new("multipliers", "circle", ["re", "im"], 260)
            .captioned(["Re μ", "Im μ"]);
        let ends = ["time".to_owned(), "mode".to_owned()];
        let [time, mode] = ends;
        PageSubject {
            noun: "orbit",
            profile: [time]
                .into_iter()
                .chain(states.clone())
                .chain([mode])
                .collect(),
            values: MULTIPLIERS,
            beside: chosen.chain([multipliers]).collect(),
        }
    }
}

/// Reads a branch.
///
/// # Errors
/// When a table is damaged.
pub(crate) fn drawn(folder: &Path, problem: &Any) -> Result<Drawn, StoreError> {
    let followed = match problem {
        Any::Tube(problem) => problem.parameter().column().to_owned(),
        Any::System(problem) => {
            let section = problem.continuation.as_ref();
            section.map_or_else(String::new, |section| section.parameter.clone())
        }
    };
    let tables = Tables::read(folder, &followed)?;
    let axis = parameter_axis(&tables);
    let branch = &tables.branch;
    let columns = columns(problem, &tables);
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
        codes: match problem {
            // regimes have words that everybody knows
            Any::Tube(_) => Codes::default(),
            Any::System(_) => Codes::of((0..branch.len()).map(|row| branch.text(row, "regimes"))),
        },
        subject: PageSubject::of(problem),
        branch: tables.branch,
    })
}

/// The columns that can be drawn over the parameter, which comes first: after it the one that a diagram shows, then the others that
/// are not the same at all points.
fn columns(problem: &Any, tables: &Tables) -> Vec<Column> {
    let branch = &tables.branch;
    let parameter = &tables.parameter;
    let (shown, all) = match problem {
        Any::Tube(_) => ("speed".to_owned(), drawable_columns()),
        Any::System(problem) => {
            let all = branch.columns().filter(|name| !WORD_COLUMNS.contains(name));
            let all = all.filter(|name| *name != "switches").map(str::to_owned);
            (ordinate(&problem.system.source, branch), all.collect())
        }
    };
    let varies = |name: &String| {
        let values = || {
            column(branch, name)
                .into_iter()
                .filter(|value| value.is_finite())
        };
        let first = values().next();
        values().any(|value| Some(value) != first) && range(values()).is_some()
    };
    let placed = |name: &String| [&shown, parameter].contains(&name);
    let others = all.into_iter().filter(|name| {
        !placed(name) && !["point", "label", "leg"].contains(&name.as_str()) && varies(name)
    });
    let named = [parameter.clone(), shown.clone()].into_iter().chain(others);
    let described = named.map(|name| match problem {
        Any::Tube(problem) => {
            let mut quantity = quantity(&name);
            quantity.dimensional = problem.output.rotation.is_some();
            let symbol = if name == "speed" { "c" } else { &name };
            Column {
                caption: quantity.caption(),
                symbol: symbol.to_owned(),
                name,
            }
        }
        Any::System(_) => Column {
            caption: tables.quantity(&name).caption(),
            symbol: name.clone(),
            name,
        },
    });
    described.collect()
}

/// The marks among these of points, each with its type, words, path and look, in the order of the types.
pub(crate) fn marks(present: &[String]) -> Vec<[String; 4]> {
    let drawn = EventType::ALL.into_iter().filter(|kind| {
        let name = kind.to_string();
        present.contains(&name)
    });
    let described = drawn.map(|kind| {
        let (path, look) = path(event_mark(kind));
        [
            kind.to_string(),
            event(kind).to_owned(),
            path,
            look.to_owned(),
        ]
    });
    described.collect()
}

/// What a picture of a folder shows.
pub(crate) fn description(
    picture: &str,
    kind: Option<FolderKind>,
    problem: Option<&Any>,
) -> String {
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
        (Some(FolderKind::Map), Some(map), _) => {
            let plane = plane([map.second.parameter, map.first.parameter]);
            format!("Sequences of regimes {plane}")
        }
        (Some(FolderKind::Curve), _, Some(curve)) => {
            let plane = plane([curve.parameters.0, curve.parameters.1]);
            format!("The curve of an event {plane}")
        }
        (Some(FolderKind::Accuracy), ..) => METHODS.to_owned(),
        (Some(FolderKind::Steady), ..) => {
            "Growth of the perturbations of steady sliding, by mode".to_owned()
        }
        (Some(FolderKind::Simulation), ..) => {
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
fn of_system(picture: &str, kind: Option<FolderKind>, problem: &SystemProblem) -> String {
    let is = |name: &str| layout::picture(name, Format::Svg) == picture;
    let states = &problem.system.source.states;
    let scanned = problem.scan.as_ref().map_or("", |scan| &scan.parameter);
    let branch = problem.continuation.as_ref();
    let parameter = branch.map_or("", |branch| branch.parameter.as_str());
    let first = states.first().map_or("", String::as_str);
    match kind {
        Some(FolderKind::Scan) if is(layout::SCANNED[0]) => {
            format!("What motions settle on: samples of {first} against {scanned}")
        }
        Some(FolderKind::Scan) if is(layout::SCANNED[1]) => {
            format!("Samples of {first} against {scanned}, and a branch over them")
        }
        Some(FolderKind::Scan) => format!("Samples of a state against {scanned}"),
        Some(FolderKind::Map) => {
            let axes = problem.map.iter().flat_map(|map| [&map.second, &map.first]);
            let axes: Vec<&str> = axes.map(|axis| axis.name()).collect();
            format!(
                "What motions settle on in the plane of {}",
                axes.join(" and ")
            )
        }
        Some(FolderKind::Simulation) if is(layout::OF_MOTION[0]) => {
            "The states over time".to_owned()
        }
        Some(FolderKind::Simulation) => "The first two states over each other".to_owned(),
        Some(FolderKind::Accuracy) => METHODS.to_owned(),
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
                Some(SystemPlot::Multipliers) => {
                    format!("Multipliers and the unit circle, and their moduli against {parameter}")
                }
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
