//! Problems with a system of one's own: the sections `system` and `orbit` stand in the place of `model` and
//! `wave`.

mod beginning;
mod check;
mod equilibrium;
mod mistake;
mod motions;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use equilibrium::{EquilibriumSection, EquilibriumStart};

use super::error::Flaw;
use super::outline::{Outline, Subject};
use super::{
    Continuation, Expectation, Output, ProblemError, Scan, SystemCurve, SystemMap, missing,
    refuse_at,
};
use crate::affine::closure::Prescribed;
use crate::affine::mode::AffineSystem;
use crate::affine::monitor::{Monitor, MonitorSource};
use crate::affine::monitored;
use crate::affine::motion::Moment;
use crate::affine::system::{Ordered, Source, System, SystemError};

/// Most periods of the forcing in one orbit.
pub(crate) const MAX_PERIODS: usize = 1000;
/// Samples of a motion where no number is given.
const DEFAULT_SAMPLES: usize = 1000;

/// A problem with a system of one's own that has passed every check; with a [`Source`] as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Problem", deny_unknown_fields)]
pub struct SystemProblem<S = System> {
    /// Title for plots and reports.
    #[serde(default)]
    pub title: Option<String>,
    /// What moves: affine at the values of the file, with parameters that are all used.
    pub system: S,
    /// The orbit to begin with.
    #[serde(default, skip_serializing_if = "OrbitSection::is_none")]
    pub orbit: OrbitSection,
    /// Numbers of orbits: columns of the results.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub monitor: Ordered<MonitorSource>,
    /// The equilibrium to begin with, in the place of the orbit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equilibrium: Option<EquilibriumSection>,
    /// The branch to follow in a parameter of the system.
    #[serde(default)]
    pub continuation: Option<Continuation<String>>,
    /// Whether multipliers are computed, and PD, NS and BP looked for.
    #[serde(default)]
    pub stability: Option<Multipliers>,
    /// The event to follow in two parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<SystemCurve>,
    /// The plane to map.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<SystemMap>,
    /// The motion to simulate.
    #[serde(default)]
    pub simulation: Option<SystemSimulation>,
    /// The parameter to scan.
    #[serde(default)]
    pub scan: Option<Scan>,
    /// Plots and tables to write.
    #[serde(default)]
    pub output: Output<SystemPlot>,
    /// Events that a check compares with.
    #[serde(default)]
    pub expect: Vec<Expectation>,
    /// Whether a check proves the special points of the branch.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub certify: bool,
}

/// The section `stability` of a problem with a system: nothing is to be chosen yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Multipliers {}

/// The periodic orbit that a computation begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Orbit", deny_unknown_fields)]
pub struct OrbitSection {
    /// Where it comes from.
    pub start: OrbitStart,
    /// Periods of the forcing in one orbit, at least 1; found by `Simulate`: at most. 1 without forcing.
    #[serde(default = "one")]
    pub periods: usize,
    /// The period that is prescribed, an expression in the parameters: for it one of these is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<String>,
    /// Name of that parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<String>,
}

fn one() -> usize {
    1
}

/// That of a problem without the section `orbit`.
impl Default for OrbitSection {
    fn default() -> OrbitSection {
        OrbitSection {
            start: OrbitStart::Nowhere,
            periods: one(),
            period: None,
            free: None,
        }
    }
}

impl OrbitSection {
    /// Whether the problem has no section `orbit`.
    pub(crate) fn is_none(&self) -> bool {
        self.start == OrbitStart::Nowhere
    }
}

/// Where the first orbit comes from. States are complete, in the order of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum OrbitStart {
    /// There is none: the problem is about equilibria.
    #[serde(skip)]
    Nowhere,
    /// What a motion comes to.
    Simulate {
        /// Mode that it begins in.
        mode: String,
        /// Every state.
        state: Ordered<f64>,
        /// Phase of the forcing; 0 without.
        #[serde(default)]
        phase: f64,
        /// Periods of the forcing, or units of time without one, before an orbit is looked for.
        settle: f64,
    },
    /// A guess for Newton's method.
    Given {
        /// Mode that begins there.
        mode: String,
        /// Every state at the beginning of the mode.
        state: Ordered<f64>,
        /// Phase of the forcing there; 0 without.
        #[serde(default)]
        phase: f64,
        /// Period; with a forcing it is known, and may be left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        period: Option<f64>,
    },
    /// A labelled orbit of an earlier run.
    Restart {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the orbit.
        label: usize,
    },
    /// The other branch at a labelled PD or BP of an earlier run.
    Switch {
        /// Directory with the results of that run.
        dir: PathBuf,
        /// Label of the event.
        label: usize,
    },
}

/// Where a motion begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Beginning", deny_unknown_fields)]
pub struct BeginningSection {
    /// The mode.
    pub mode: String,
    /// Every state, in the order of the file.
    pub state: Ordered<f64>,
    /// Phase of the forcing; 0 without.
    #[serde(default)]
    pub phase: f64,
}

/// The section `simulation` of a problem with a system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SystemSimulation {
    /// Time simulated, > 0.
    pub duration: f64,
    /// Samples at equal times after the beginning, at least 1.
    #[serde(default = "samples")]
    pub samples: usize,
    /// Where the motion begins; where the one of `orbit` does unless it is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<BeginningSection>,
}

fn samples() -> usize {
    DEFAULT_SAMPLES
}

/// A kind of plot of a problem with a system.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SystemPlot {
    /// Branch diagram: the greatest value of the first state over the parameter.
    Diagram,
    /// Two states of several orbits over one another.
    Phase(String, String),
    /// A state of several orbits over time.
    Time(String),
    /// Multipliers of the first labelled orbit, with the unit circle.
    Multipliers,
    /// Branch diagram of the named column of `branch.csv`.
    Column(String),
}

impl<S> SystemProblem<S> {
    /// The same with another form of its system.
    fn with<T>(self, system: T) -> SystemProblem<T> {
        SystemProblem {
            title: self.title,
            system,
            orbit: self.orbit,
            monitor: self.monitor,
            equilibrium: self.equilibrium,
            continuation: self.continuation,
            stability: self.stability,
            curve: self.curve,
            map: self.map,
            simulation: self.simulation,
            scan: self.scan,
            output: self.output,
            expect: self.expect,
            certify: self.certify,
        }
    }

    /// Where a motion begins: as the section `simulation` says, or else `orbit`; nowhere where that names an
    /// earlier run.
    pub fn beginning(&self) -> Option<BeginningSection> {
        let own = self.simulation.as_ref();
        let own = own.and_then(|section| section.start.clone());
        own.or(self.start_of_motion())
    }

    /// The mode and the state that `orbit` or `equilibrium` gives.
    pub fn start_of_motion(&self) -> Option<BeginningSection> {
        match &self.equilibrium {
            Some(section) => section.start.beginning(),
            None => self.orbit.start.beginning(),
        }
    }

    /// The earlier run that the start names.
    pub fn earlier_run(&self) -> Option<&PathBuf> {
        match &self.equilibrium {
            Some(section) => section.start.dir(),
            None => self.orbit.start.dir(),
        }
    }
}

impl OrbitStart {
    /// The mode, the state and the phase that are given.
    pub fn beginning(&self) -> Option<BeginningSection> {
        match self {
            OrbitStart::Simulate {
                mode, state, phase, ..
            }
            | OrbitStart::Given {
                mode, state, phase, ..
            } => Some(BeginningSection {
                mode: mode.clone(),
                state: state.clone(),
                phase: *phase,
            }),
            OrbitStart::Nowhere | OrbitStart::Restart { .. } | OrbitStart::Switch { .. } => None,
        }
    }

    /// The earlier run that it names.
    pub fn dir(&self) -> Option<&PathBuf> {
        match self {
            OrbitStart::Restart { dir, .. } | OrbitStart::Switch { dir, .. } => Some(dir),
            OrbitStart::Nowhere | OrbitStart::Simulate { .. } | OrbitStart::Given { .. } => None,
        }
    }
}

impl BeginningSection {
    /// The place at time zero with the states in the order of the system, which is that at these parameters; `None` where the
    /// system has no such mode, or another state.
    pub fn place(&self, system: &System, at: &AffineSystem) -> Option<Moment> {
        let mode = system.mode(&self.mode)?;
        let states = system.source.states.iter();
        let state = states.map(|name| match self.state.index(name) {
            Some(index) => Some(self.state.0[index].1),
            None => system
                .is_stretch(name)
                .then(|| system.stretch(at, mode, name)),
        });
        Some(Moment {
            time: 0.0,
            phase: self.phase,
            mode,
            state: state.collect::<Option<_>>()?,
        })
    }
}

impl SystemProblem {
    /// The period, where it is prescribed.
    pub fn prescribed(&self) -> Option<Prescribed> {
        let (period, free) = self.orbit.period.as_ref().zip(self.orbit.free.as_ref())?;
        let source = &self.system.source;
        Prescribed::new(source, period, source.parameters.index(free)?).ok()
    }

    /// The monitors.
    pub fn monitors(&self) -> Vec<Monitor> {
        monitored::read(&self.system.source, &self.monitor).unwrap_or_default()
    }

    /// Values of the parameters, in the order of the file.
    pub fn values(&self) -> Vec<f64> {
        self.system.values()
    }

    /// The section `simulation`, or an error that says how to write one.
    ///
    /// # Errors
    /// Where there is none; `text` and `name` are the source of the problem and the name of its file.
    pub fn simulation(&self, text: &str, name: &str) -> Result<&SystemSimulation, ProblemError> {
        let section = self.simulation.as_ref();
        section.ok_or_else(|| {
            let lack = "nothing to simulate";
            missing(Subject::System, "simulation", lack, text, name)
        })
    }

    /// The section `scan`; see [`SystemProblem::simulation`].
    ///
    /// # Errors
    /// Where there is none.
    pub fn scan(&self, text: &str, name: &str) -> Result<&Scan, ProblemError> {
        let section = self.scan.as_ref();
        section.ok_or_else(|| missing(Subject::System, "scan", "nothing to scan", text, name))
    }

    /// The section `map`; see [`SystemProblem::simulation`].
    ///
    /// # Errors
    /// Where there is none, or where `orbit` does not say for how long motions settle.
    pub fn map(&self, text: &str, name: &str) -> Result<&SystemMap, ProblemError> {
        let section = self.map.as_ref();
        let lack = "no plane to map";
        let section = section.ok_or_else(|| missing(Subject::System, "map", lack, text, name))?;
        if matches!(self.orbit.start, OrbitStart::Simulate { .. }) {
            return Ok(section);
        }
        let message =
            "a map has what motions settle on, and `orbit` does not say for how long they settle";
        let help = "write for example `start: Simulate(mode: .., state: .., settle: 200)`";
        Err(refuse_at(text, name, "orbit.start", message, help))
    }

    /// The section `continuation`; see [`SystemProblem::simulation`].
    ///
    /// # Errors
    /// Where there is none.
    pub fn continuation(
        &self,
        text: &str,
        name: &str,
    ) -> Result<&Continuation<String>, ProblemError> {
        let section = self.continuation.as_ref();
        section.ok_or_else(|| {
            let lack = "no branch to follow";
            missing(Subject::System, "continuation", lack, text, name)
        })
    }

    /// The section `curve`; see [`SystemProblem::simulation`].
    ///
    /// # Errors
    /// Where there is none.
    pub fn curve(&self, text: &str, name: &str) -> Result<&SystemCurve, ProblemError> {
        let section = self.curve.as_ref();
        let lack = "no event to follow";
        section.ok_or_else(|| missing(Subject::System, "curve", lack, text, name))
    }

    /// Index of the parameter of the branch.
    pub fn parameter(&self) -> Option<usize> {
        let section = self.continuation.as_ref()?;
        self.system.source.parameters.index(&section.parameter)
    }

    /// Columns of `branch.csv` of which a curve can be drawn, in their order.
    pub(crate) fn drawable_columns(&self) -> Vec<String> {
        let Source {
            states, parameters, ..
        } = &self.system.source;
        let extrema = |state: &String| [format!("min_{state}"), format!("max_{state}")];
        let own = |names: &str| names.split(' ').map(str::to_owned).collect::<Vec<_>>();
        if self.equilibrium.is_some() {
            return [
                own("point label"),
                parameters.names().map(str::to_owned).collect(),
                states.clone(),
                self.monitor.names().map(str::to_owned).collect(),
                own("unstable re im newton residual leg"),
            ]
            .concat();
        }
        [
            own("point label"),
            parameters.names().map(str::to_owned).collect(),
            own("period"),
            states.iter().flat_map(extrema).collect(),
            self.monitor.names().map(str::to_owned).collect(),
            own("unstable multiplier_re multiplier_im newton residual leg"),
        ]
        .concat()
    }

    /// Reads what a text means.
    pub(super) fn read(
        written: SystemProblem<Source>,
        outline: &Outline,
    ) -> Result<SystemProblem, Flaw> {
        check::written(&written, outline)?;
        let source = written.system.clone();
        let flawed = |error| mistake::flaw(&written.system, outline, &error);
        let system = System::new(source).map_err(flawed)?;
        system.at(&system.values(), &[]).map_err(flawed)?;
        if !written.monitor.is_empty() {
            let flawed = |error: SystemError| {
                mistake::flaw_at(&written.system, outline, &error.path, &error)
            };
            let monitors = monitored::read(&system.source, &written.monitor).map_err(flawed)?;
            let observed = system.clone().with_monitors(monitors);
            observed
                .monitored(&system.values(), &[], &[0])
                .map_err(flawed)?;
        }
        let mut problem = written.with(system);
        let shows = |plot: &SystemPlot| matches!(plot, SystemPlot::Phase(..) | SystemPlot::Time(_));
        problem.output.with_profiles(outline, shows);
        check::check(&problem, outline)?;
        Ok(problem)
    }
}
