//! The event that a curve begins with, found on a branch.

use crate::branch::SavedWave;
use crate::branch::run::{End, Item, RunError, Runner};
use crate::continuation::Steps;
use crate::continuation::newton;
use crate::linalg::{self, Vector};
use crate::model::Parameter;
use crate::model::Sectors;
use crate::orbit::EventType;
use crate::orbit::legs::Run as _;
use crate::problem::{self, Problem, StabilitySection};
use crate::wave::Wave;
use crate::wave::admissibility::{Margin, Watch, examine};

use super::system::{Condition, EventSystem};
use super::{Limits, Singular};

/// Why there is no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoCurve {
    /// The branch does not begin.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The branch has no such event.
    #[error(
        "the branch has {found} events of the kind asked for, {wanted}, and not number {index}{end}"
    )]
    NotFound {
        /// Kind asked for.
        wanted: String,
        /// Number asked for.
        index: usize,
        /// How many there are.
        found: usize,
        /// Why the branch went no further.
        end: String,
    },
    /// The label is no event that has a curve.
    #[error("label {label} is of type {kind}; curves follow LP, GR, RV, CO, ST and HB")]
    Kind {
        /// Label.
        label: usize,
        /// Its type.
        kind: EventType,
    },
    /// The event lies outside the ranges of the curve.
    #[error(
        "the event lies at {name} = {value}, outside the range from {low} to {high} of the curve; \
         widen it"
    )]
    Outside {
        /// Parameter.
        name: &'static str,
        /// Its value at the event.
        value: f64,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The equations of the event cannot be posed or solved.
    #[error("the curve cannot begin: {0}")]
    Singular(#[from] Singular),
}

/// An event ready to be followed.
#[derive(Clone, Debug)]
pub struct Start {
    /// Its type.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem,
    /// Their solution on the branch.
    pub point: Vector,
    /// How far to follow.
    pub limits: Limits,
}

/// A scaled margin below this vanishes at a located event.
const VANISHED: f64 = 1e-9;

/// Follows the branch of a problem, which `begin` begins, to the event that its curve begins with. `watch`
/// sees the branch after every step.
///
/// # Errors
/// When the branch does not begin or does not have the event, when that lies outside the ranges,
/// or when its equations are singular.
pub fn find(
    problem: &Problem,
    curve: &problem::Curve,
    begin: impl FnOnce(&Problem) -> Result<Runner, RunError>,
    watch: &mut dyn FnMut(&Runner),
) -> Result<Start, NoCurve> {
    let mut plain = problem.clone();
    plain.output.profiles = 0;
    plain.output.conditioning = false;
    // spectra are wanted for the sake of Hopf points only, in their sector only
    let section = problem.stability.clone();
    let section = section.unwrap_or_else(|| StabilitySection::of(&problem.model));
    let of_sector = StabilitySection {
        sectors: Sectors::Only(vec![curve.sector]),
        ..section
    };
    let event = curve.event.kind();
    plain.stability = (event == Some(EventType::HB)).then_some(of_sector);
    let mut branch = begin(&plain)?;
    let mut found = 0;
    while branch.progress().end.is_none() {
        watch(&branch);
        for item in branch.step() {
            if event.is_some() && item.point.kind == event {
                found += 1;
                if found == curve.index {
                    return of_branch(&item, curve);
                }
            }
        }
    }
    let mut wanted = event.map_or_else(String::new, |event| event.to_string());
    if event == Some(EventType::HB) {
        wanted.push_str(&format!(" of sector {}", curve.sector));
    }
    Err(NoCurve::NotFound {
        wanted,
        index: curve.index,
        found,
        end: match &branch.progress().end {
            Some(End::Failed(reason)) => format!("; it ended before its range: {reason}"),
            _ => String::new(),
        },
    })
}

/// An event as a result folder tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labelled {
    /// Type.
    pub kind: EventType,
    /// Bloch sector of an HB.
    pub sector: usize,
    /// Im λ of an HB.
    pub omega: Option<f64>,
}

/// The event of a branch.
fn of_branch(item: &Item, curve: &problem::Curve) -> Result<Start, NoCurve> {
    let (wave, point) = item.wave();
    let event = item.event.as_ref();
    let labelled = Labelled {
        kind: item.point.kind.unwrap_or(EventType::EP),
        sector: curve.sector,
        omega: event.and_then(|event| event.omega),
    };
    pose(wave, point, labelled, curve)
}

/// The event that an earlier run labelled, with its saved wave.
///
/// # Errors
/// When the label is no event that can be followed, when it lies outside the ranges, or when its
/// equations are singular.
pub fn labelled(
    problem: &Problem,
    saved: &SavedWave,
    event: Labelled,
    curve: &problem::Curve,
) -> Result<Start, NoCurve> {
    if !FOLLOWED.contains(&event.kind) {
        return Err(NoCurve::Kind {
            label: saved.label,
            kind: event.kind,
        });
    }
    let (low, high) = curve.range.0;
    let wave = saved.wave(curve.parameters.0, problem.wave.mode, high - low);
    let wave = match problem.method {
        Some(method) => wave.with_method(method),
        None => wave,
    };
    let value = saved.model.value(curve.parameters.0).unwrap_or(f64::NAN);
    let point = wave.pack(&saved.unknowns(), saved.excess, value);
    pose(&wave, &point, event, curve)
}

/// Events that have a curve.
const FOLLOWED: [EventType; 6] = [
    EventType::LP,
    EventType::GR,
    EventType::RV,
    EventType::CO,
    EventType::ST,
    EventType::HB,
];

/// The equations of an event.
fn pose(
    wave: &Wave,
    point: &Vector,
    event: Labelled,
    curve: &problem::Curve,
) -> Result<Start, NoCurve> {
    let parameters = [curve.parameters.0, curve.parameters.1];
    let material = wave.material || parameters.contains(&Parameter::StiffnessDamping);
    let layered;
    let (wave, point) = if material && !wave.material {
        layered = wave.with_layers(point).map_err(Singular::from)?;
        (&layered.0, &layered.1)
    } else {
        (wave, point)
    };
    let ranges = [curve.range.0, curve.range.1];
    let widths = ranges.map(|(low, high)| high - low);
    let model = wave.model_at(point);
    for (parameter, (low, high)) in parameters.into_iter().zip(ranges) {
        let value = model.value(parameter).unwrap_or(f64::NAN);
        if !(value >= low && value <= high) {
            return Err(NoCurve::Outside {
                name: parameter.column(),
                value,
                low,
                high,
            });
        }
    }
    let posed = |condition| EventSystem::new(wave, point, parameters, widths, condition);
    let (system, further) = match event.kind {
        EventType::LP => {
            let (matrix, _) = newton::jacobian(wave, point).map_err(Singular::from)?;
            let count = matrix.nrows();
            let least = linalg::least(&matrix.columns(0, count).clone_owned())
                .ok_or(Singular::NoNullVector)?;
            (posed(Condition::Fold), least.right.as_slice().to_vec())
        }
        EventType::HB => {
            let system = posed(Condition::Hopf {
                sector: event.sector,
            });
            let scaled = event.omega.unwrap_or(f64::NAN) / system.frequency();
            (system, vec![scaled])
        }
        _ => {
            let examination = examine(wave, point).map_err(Singular::from)?;
            let mut margins: Vec<Margin> = examination
                .margins
                .into_iter()
                .filter(|margin| margin.jet.value.abs() < VANISHED)
                .collect();
            // a zone without length says most, as on the branch
            margins.sort_by_key(|margin| margin.watch != Watch::Duration);
            let margin = *margins.first().ok_or(Singular::NoMargin)?;
            (posed(Condition::Margin(margin)), Vec::new())
        }
    };
    let point = system.pack(point, &further);
    Ok(Start {
        event: event.kind,
        system,
        point,
        limits: Limits {
            ranges,
            steps: Steps {
                ds: curve.ds,
                ds_min: curve.ds_min,
                ds_max: curve.ds_max,
                tolerance: curve.tolerance,
            },
            most_points: curve.max_points,
        },
    })
}
