//! The ladder of methods and settings, and what each of them achieves.

use serde::{Deserialize, Serialize};

use crate::tube::flow::method::Method;
use crate::tube::model::FrictionLaw;

/// One rung of the ladder of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rung {
    /// A method of the boundary-value problem.
    Flow(Method),
    /// Orbits of a system by Taylor series.
    Taylor {
        /// Of a step.
        tolerance: f64,
    },
    /// Single orbits of a system by a Runge–Kutta method.
    RungeKutta {
        /// Of a step.
        tolerance: f64,
    },
    /// The discretised ring with n points per wavelength and ε.
    Ring {
        points: usize,
        /// Width of the friction law in V̇.
        epsilon: f64,
    },
}

impl Rung {
    pub(crate) fn method(self) -> &'static str {
        match self {
            Rung::Flow(Method::Exact) => "exact",
            Rung::Flow(Method::Shooting { .. }) => "shooting",
            Rung::Flow(Method::Collocation { .. }) => "collocation",
            Rung::Taylor { .. } => "taylor",
            Rung::RungeKutta { .. } => "dop853",
            Rung::Ring { .. } => "ring",
        }
    }

    fn setting(self) -> String {
        match self {
            Rung::Flow(Method::Exact) => String::new(),
            Rung::Flow(Method::Shooting { tolerance })
            | Rung::Taylor { tolerance }
            | Rung::RungeKutta { tolerance } => format!("tolerance {tolerance:.0e}"),
            Rung::Flow(Method::Collocation { intervals, degree }) => {
                format!("{intervals} intervals of degree {degree}")
            }
            Rung::Ring { points, epsilon } => format!("{points} points, epsilon {epsilon}"),
        }
    }
}

impl std::fmt::Display for Rung {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self.setting() {
            setting if setting.is_empty() => write!(f, "{}", self.method()),
            setting => write!(f, "{}, {setting}", self.method()),
        }
    }
}

/// The ladder for a friction law, from coarse to fine within each method.
pub(crate) fn ladder(law: FrictionLaw) -> Vec<Rung> {
    let exact = law.piecewise_linear().then_some(Method::Exact);
    let collocation = |intervals| Method::Collocation {
        intervals,
        degree: 4,
    };
    let mut methods: Vec<Method> = exact.into_iter().collect();
    if matches!(law, FrictionLaw::Regularised { .. }) {
        methods.extend([50, 100, 200, 400].map(collocation));
    } else {
        let tolerances = [1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
        methods.extend(tolerances.map(|tolerance| Method::Shooting { tolerance }));
        methods.extend([3, 5, 10, 20, 40].map(collocation));
    }
    let mut rungs: Vec<Rung> = methods.into_iter().map(Rung::Flow).collect();
    if law == FrictionLaw::Coulomb {
        let rings = [(25, 0.1), (50, 0.05), (100, 0.02), (200, 0.005)];
        rungs.extend(rings.map(|(points, epsilon)| Rung::Ring { points, epsilon }));
    }
    rungs
}

/// The ladder for a system, which has an exact flow or not.
pub(crate) fn ladder_of_system(exact: bool) -> Vec<Rung> {
    // where steps leave out more than the corrections of Newton's method, these do not end
    let taylor = [1e-9, 1e-11, 1e-13, 1e-15];
    let taylor = taylor.map(|tolerance| Rung::Taylor { tolerance });
    let runge_kutta = [1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
    let runge_kutta = runge_kutta.map(|tolerance| Rung::RungeKutta { tolerance });
    let exact = exact.then_some(Rung::Flow(Method::Exact));
    exact.into_iter().chain(taylor).chain(runge_kutta).collect()
}

/// The method of the reference under a law.
pub(crate) fn reference_method(law: FrictionLaw) -> Method {
    match law {
        FrictionLaw::Coulomb | FrictionLaw::Static { .. } => Method::Exact,
        FrictionLaw::Stribeck { .. } => Method::Collocation {
            intervals: 60,
            degree: 6,
        },
        FrictionLaw::Regularised { .. } => Method::Collocation {
            intervals: 600,
            degree: 5,
        },
    }
}

/// What one rung achieves: a row of `accuracy.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RungRow {
    pub method: String,
    /// Setting of the rung, in words.
    pub setting: String,
    pub points: usize,
    pub events_found: usize,
    pub events_expected: usize,
    /// Largest relative error of c.
    pub speed_error: Option<f64>,
    /// Largest error of a switching point, in wavelengths; for a system of a state there, in its largest value, or of a
    /// duration, in periods.
    pub switch_error: Option<f64>,
    /// Largest relative error of the parameter at an event.
    pub event_error: Option<f64>,
    /// Largest error of a leading eigenvalue; for a system of a multiplier.
    pub eigenvalue_error: Option<f64>,
    /// Median run time in seconds, of the branch or of a wave of the ring.
    pub seconds: Option<f64>,
    pub points_per_second: Option<f64>,
    /// What went wrong, if anything did.
    pub failure: Option<String>,
}

impl RungRow {
    /// Whether this is what a rung achieves.
    pub(crate) fn is_of(&self, rung: Rung) -> bool {
        self.method == rung.method() && self.setting == rung.setting()
    }

    /// The largest of the errors of the wave and its events.
    pub(crate) fn error(&self) -> Option<f64> {
        [self.speed_error, self.switch_error, self.event_error]
            .into_iter()
            .flatten()
            .reduce(f64::max)
    }

    pub(super) fn took(self, seconds: f64) -> RungRow {
        RungRow {
            seconds: Some(seconds),
            points_per_second: Some(self.points as f64 / seconds),
            ..self
        }
    }

    /// What a rung failed at.
    pub(super) fn failed(rung: Rung, events_expected: usize, failure: Option<String>) -> RungRow {
        RungRow {
            method: rung.method().to_owned(),
            setting: rung.setting(),
            events_expected,
            failure,
            ..RungRow::default()
        }
    }
}
