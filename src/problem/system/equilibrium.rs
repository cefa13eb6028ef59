//! The section `equilibrium` of a problem with a system, in the place of `orbit`.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::super::error::Flaw;
use super::super::expectation::Expectation;
use super::super::outline::Outline;
use super::super::rules::{Check, Checks};
use super::{BeginningSection, SystemPlot, SystemProblem};
use crate::affine::monitor::{MONITOR, MonitorSource};
use crate::affine::system::{Ordered, Source};
use crate::orbit::EventType;

/// The equilibrium that a branch begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Equilibrium", deny_unknown_fields)]
pub struct EquilibriumSection {
    /// Where it comes from.
    pub start: EquilibriumStart,
}

/// Where the first equilibrium comes from. States are complete, in the order of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum EquilibriumStart {
    /// A guess for Newton's method.
    Given {
        /// Its mode.
        mode: String,
        /// Every state.
        state: Ordered<f64>,
    },
    /// One of those that `steady` lists.
    Steady {
        /// Its mode.
        mode: String,
        /// Its number, from 1, among those of the mode.
        #[serde(default = "first")]
        index: usize,
    },
    /// A labelled equilibrium of an earlier run.
    Restart {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the equilibrium.
        label: usize,
    },
    /// The other branch at a labelled BP of an earlier run.
    Switch {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the event.
        label: usize,
    },
}

fn first() -> usize {
    1
}

impl EquilibriumStart {
    /// The mode and the state that are given.
    pub fn beginning(&self) -> Option<BeginningSection> {
        match self {
            EquilibriumStart::Given { mode, state } => Some(BeginningSection {
                mode: mode.clone(),
                state: state.clone(),
                phase: 0.0,
            }),
            _ => None,
        }
    }

    /// The mode that it names.
    pub(super) fn mode(&self) -> Option<&str> {
        match self {
            EquilibriumStart::Given { mode, .. } | EquilibriumStart::Steady { mode, .. } => {
                Some(mode)
            }
            EquilibriumStart::Restart { .. } | EquilibriumStart::Switch { .. } => None,
        }
    }

    /// The earlier run that it names.
    pub fn dir(&self) -> Option<&PathBuf> {
        match self {
            EquilibriumStart::Restart { dir, .. } | EquilibriumStart::Switch { dir, .. } => {
                Some(dir)
            }
            EquilibriumStart::Given { .. } | EquilibriumStart::Steady { .. } => None,
        }
    }
}

/// Columns of branches of equilibria beyond those of orbits.
pub(super) const COLUMNS: [&str; 4] = ["re", "im", "omega", "lyapunov"];

/// Refuses a problem with neither an orbit nor an equilibrium, or with both.
pub(super) fn one_of_both(written: &SystemProblem<Source>, outline: &Outline) -> Check {
    if written.equilibrium.is_some() && !written.orbit.is_none() {
        return Err(super::super::written::beside(
            outline,
            "equilibrium",
            "orbit",
        ));
    }
    if written.equilibrium.is_some() || !written.orbit.is_none() {
        return Ok(());
    }
    let example = super::super::examples::example(outline.subject(), "", "orbit");
    let help = format!("add for example `{}`", example.unwrap_or_default());
    let at = outline.locate("orbit");
    Err(Flaw::new(at, "missing field `orbit` in the problem", help))
}

impl Checks<'_, SystemProblem> {
    /// Refuses a start that is none of the system, and what only orbits have.
    pub(super) fn equilibrium(&self, section: &EquilibriumSection) -> Check {
        let source = &self.problem.system.source;
        if source.forcing.is_some() {
            let message = "a system with `forcing` has no equilibria";
            return self.refuse("equilibrium", message, "write `orbit` in its place");
        }
        if self.problem.map.is_some() {
            let message = "`map` is for orbits, and this is a branch of equilibria";
            return self.refuse("map", message, "leave it out");
        }
        for (name, monitor) in &self.problem.monitor.0 {
            let what = match monitor {
                MonitorSource::Integral(_) => "an integral over a period",
                MonitorSource::Before(..) | MonitorSource::After(..) => "a value at a switch",
                _ => continue,
            };
            let message = format!("`{name}` is {what}, and an equilibrium has none");
            let help = "take `Max`, `Min` or `Mean`: of an equilibrium they are the value";
            return self.refuse(&format!("{MONITOR}.{name}"), message, help);
        }
        match &section.start {
            EquilibriumStart::Given { .. } => match section.start.beginning() {
                Some(start) => self.start("equilibrium.start", &start),
                None => Ok(()),
            },
            EquilibriumStart::Steady { mode, .. } => {
                self.names_a_mode("equilibrium.start.mode", mode)
            }
            EquilibriumStart::Restart { .. } | EquilibriumStart::Switch { .. } => Ok(()),
        }
    }

    /// Refuses the curve of an event that equilibria do not have, or only they.
    pub(super) fn curve_event(&self, event: EventType) -> Check {
        use EventType::{BE, BP, HB, LP, UZ};
        let (has, what, help) = match self.problem.equilibrium {
            Some(_) => (
                matches!(event, LP | HB | BE | BP | UZ),
                "equilibria",
                "take LP, HB, BE, BP or `Constant(\"name\")`",
            ),
            None => (
                !matches!(event, HB | BE),
                "orbits",
                "take LP, PD, NS, BP, GR, CO, SL, HC or `Constant(\"name\")`; curves of HB and BE are those of `equilibrium`",
            ),
        };
        let message = format!("{what} have no curve of {event}");
        match has {
            true => Ok(()),
            false => self.refuse("curve.event", message, help),
        }
    }

    /// Refuses a picture of what equilibria do not have.
    pub(super) fn plot_of_equilibria(&self, path: &str, plot: &SystemPlot) -> Check {
        match plot {
            SystemPlot::Diagram | SystemPlot::Column(_) => Ok(()),
            _ => {
                let message =
                    format!("the plot {plot:?} shows orbits, and this is a branch of equilibria");
                self.refuse(path, message, "take `Diagram` or `Column(\"x\")`")
            }
        }
    }

    /// Names of the numbers that an event can be expected to have.
    pub(super) fn numbers_of_events(&self) -> Vec<&str> {
        let Source {
            states, parameters, ..
        } = &self.problem.system.source;
        let parameters: Vec<&str> = parameters.names().collect();
        let monitors: Vec<&str> = self.problem.monitor.names().collect();
        if self.problem.equilibrium.is_none() {
            return [&parameters[..], &Expectation::OF_ORBITS, &monitors].concat();
        }
        let states: Vec<&str> = states.iter().map(String::as_str).collect();
        [&parameters[..], &states, &monitors, &COLUMNS].concat()
    }
}
