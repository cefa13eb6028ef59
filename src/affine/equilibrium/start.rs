//! The first equilibrium of a branch.

use super::curve::{EquilibriumCurve, EquilibriumFailure, EquilibriumSetting, scales};
use super::{EquilibriumExamination, EquilibriumScales, VirtualEquilibrium};
use crate::affine::steady::{Isolation, NoEquilibrium};
use crate::affine::system::{System, SystemError};
use crate::continuation::newton::{self, Settings};
use crate::linalg::{Matrix, Vector};
use crate::orbit::Examined;
use crate::orbit::sign::SignVerdict;

/// Where an equilibrium is looked for.
#[derive(Clone, Debug, PartialEq)]
pub enum EquilibriumGuess {
    /// Next to a state.
    State(Vec<f64>),
    /// The one with this number, from 1, of those of its mode.
    Index(usize),
}

/// Why there is no first equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFirstEquilibrium {
    /// The system makes no sense.
    #[error("{0}")]
    System(SystemError),
    /// The mode has none.
    #[error("{0}")]
    None(NoEquilibrium),
    /// Newton's method comes to none that is simple.
    #[error(
        "Newton's method comes from there to no equilibrium of the mode at which ∂f/∂x is regular"
    )]
    NotFound,
    /// The mode has fewer.
    #[error("the mode has {count} equilibria, and number {index} is asked for")]
    Fewer {
        /// How many.
        count: usize,
        /// The number that is asked for.
        index: usize,
    },
    /// It is degenerate.
    #[error("∂f/∂x is singular at that equilibrium: it is degenerate, or one of a family")]
    Degenerate,
    /// It is not admissible.
    #[error("the equilibrium at {state} is not one of the system: {reason}")]
    Virtual {
        /// Its states, each with its name.
        state: String,
        /// Why not.
        reason: VirtualEquilibrium,
    },
    /// Its equations have no value there.
    #[error("{0}")]
    NoValue(#[from] EquilibriumFailure),
}

/// What is asked for of the first equilibrium.
#[derive(Clone, Debug)]
pub struct EquilibriumRequest {
    /// The system.
    pub system: System,
    /// Values of its parameters.
    pub values: Vec<f64>,
    /// Index of the parameter of the branch.
    pub parameter: usize,
    /// Length of its range.
    pub width: f64,
    /// Index of the mode.
    pub mode: usize,
}

/// The equilibria of a mode as a curve, and the first of them in scaled unknowns.
///
/// # Errors
/// There is none, or it is degenerate or virtual.
pub fn first(
    request: &EquilibriumRequest,
    guess: &EquilibriumGuess,
) -> Result<(EquilibriumCurve, Vector), NoFirstEquilibrium> {
    let EquilibriumRequest {
        system,
        values,
        mode,
        ..
    } = request;
    let at = system.at(values, &[]).map_err(NoFirstEquilibrium::System)?;
    let state = match guess {
        EquilibriumGuess::State(state) => match at.equilibrium_near(*mode, state) {
            Some(found) => found.state,
            None => settled(request, state)?,
        },
        EquilibriumGuess::Index(index) => {
            let all = at.equilibria(*mode).map_err(NoFirstEquilibrium::None)?;
            let fewer = NoFirstEquilibrium::Fewer {
                count: all.len(),
                index: *index,
            };
            let index = index.checked_sub(1);
            let found = index.and_then(|index| all.into_iter().nth(index));
            let found = found.ok_or(fewer)?;
            if found.isolation != Isolation::Simple {
                return Err(NoFirstEquilibrium::Degenerate);
            }
            found.state
        }
    };
    let (curve, point) = EquilibriumCurve::at(request, &state)?;
    let examination = curve.examined(&point)?;
    if is_told(&examination) {
        return Ok((curve, point));
    }
    let names = system.source.states.iter().zip(&state);
    let state: Vec<String> = names.map(|(name, x)| format!("{name} = {x:.9}")).collect();
    Err(NoFirstEquilibrium::Virtual {
        state: state.join(", "),
        reason: curve.worst(&examination),
    })
}

/// The equilibrium to which Newton's method leads by the equations of the branch, with shorter steps where the whole ones do
/// not come nearer: in a sliding mode they have the surface in the place of a rate that follows from the others.
fn settled(request: &EquilibriumRequest, guess: &[f64]) -> Result<Vec<f64>, NoFirstEquilibrium> {
    const NEWTON: Settings = Settings {
        tolerance: 1e-10,
        most_iterations: 60,
        halvings: 8,
        polish: 1,
    };
    let (curve, point) = EquilibriumCurve::at(request, guess)?;
    let index = point.len() - 1;
    let mut fixed = newton::Fixed {
        index,
        value: point[index],
    };
    let solution = newton::solve(&curve, &mut fixed, &point, &NEWTON);
    let found = solution
        .ok()
        .filter(|solution| is_told_apart(&curve, &solution.point));
    let found = found.ok_or(NoFirstEquilibrium::NotFound)?;
    Ok(curve.state(&found.point))
}

/// Whether derivatives stay what they are within a few roundings of the unknowns. Where they do not, as where a sine turns between
/// one double and the next, what is found is chance.
fn is_told_apart(curve: &EquilibriumCurve, point: &Vector) -> bool {
    /// Roundings, and the part of derivatives that may change within them; below the last, derivatives in scaled unknowns are zero.
    const ROUNDINGS: f64 = 4.0 * f64::EPSILON;
    const CHANGED: f64 = 0.05;
    const SINGULAR: f64 = 1e-9;
    let states = point.len() - 1;
    let slopes = |factor: f64| {
        let mut beside = point * factor;
        beside[states] = point[states];
        let (matrix, _) = newton::evaluated(curve, &beside).ok()?;
        Some(matrix.columns(0, states).clone_owned())
    };
    let Some(here) = slopes(1.0) else {
        return false;
    };
    let stays = |beside: Matrix| {
        let rows = beside.row_iter().zip(here.row_iter());
        let mut changed = rows.map(|(beside, here)| ((beside - here).amax(), here.amax()));
        changed.all(|(changed, size)| changed <= CHANGED * size.max(SINGULAR))
    };
    let mut beside = [1.0 + ROUNDINGS, 1.0 - ROUNDINGS].into_iter();
    beside.all(|factor| slopes(factor).is_some_and(stays))
}

impl EquilibriumCurve {
    /// A change of states and parameter in scaled unknowns.
    pub fn scaled(&self, change: &[f64]) -> Vector {
        let units = &self.setting.scales.units;
        let scaled = change.iter().zip(units).map(|(x, unit)| x / unit);
        Vector::from_iterator(units.len().min(change.len()), scaled)
    }

    /// The equilibria of a mode in units of a state, and that state in them.
    ///
    /// # Errors
    /// Rates or guards have no finite value there.
    pub fn at(
        request: &EquilibriumRequest,
        state: &[f64],
    ) -> Result<(EquilibriumCurve, Vector), EquilibriumFailure> {
        let EquilibriumRequest {
            system,
            values,
            parameter,
            width,
            mode,
        } = request;
        let units = scales(system, values, *parameter, (*mode, state), *width);
        let no_value = || EquilibriumFailure::NoValue {
            mode: system.mode_name(*mode).into_owned(),
        };
        let setting = EquilibriumSetting {
            system: system.clone(),
            values: values.clone(),
            parameter: *parameter,
            scales: units.ok_or_else(no_value)?,
        };
        let curve = EquilibriumCurve::new(setting, *mode).ok_or_else(no_value)?;
        let point = curve.pack(state, values[*parameter]);
        Ok((curve, point))
    }

    /// The equilibria of a named mode at these values of the parameters, in units that are known; `None` where the system has
    /// no such mode or parameter, or makes no sense.
    pub fn posed_in(
        system: &System,
        values: &[f64],
        parameter: &str,
        (mode, scales): (&str, EquilibriumScales),
    ) -> Option<EquilibriumCurve> {
        let setting = EquilibriumSetting {
            system: system.clone(),
            values: values.to_vec(),
            parameter: system.source.parameters.index(parameter)?,
            scales,
        };
        EquilibriumCurve::new(setting, system.mode(mode)?)
    }
}

/// Whether every guard is positive by more than rounding.
fn is_told(examination: &EquilibriumExamination) -> bool {
    let mut margins = examination.margins.iter();
    examination.verdict() == SignVerdict::Positive
        && margins.all(|margin| margin.value > margin.error)
}
