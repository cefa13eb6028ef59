//! The branches that the claims are about, and following one to its end.

use std::sync::Arc;

use brakewave::branch::EventType;
use brakewave::branch::first_wave::first_wave;
use brakewave::branch::orbit::{Follower, Found};
use brakewave::branch::special::{Ending, Special};
use brakewave::continuation;
use brakewave::linalg::Vector;
use brakewave::orbit::follow::Limits;
use brakewave::tube::flow::SlidingFlow;
use brakewave::tube::flow::contact::ContactFlow;
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, Impact, Model, Parameter};
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::Which;

/// Steps of the default problem.
pub const STEPS: continuation::Steps = continuation::Steps {
    ds: 0.005,
    ds_min: 1e-12,
    ds_max: 0.01,
    tolerance: 1e-10,
};

/// An undamped tube with γ = 1 and frictionless impact.
pub fn tube(nu: f64, xi: f64, friction: f64, mismatch: f64) -> Model {
    Model::tube(Geometry { nu, xi, gamma: 1.0 }, friction, mismatch)
}

/// The tube of the mode-4 branches.
pub fn mode4(mismatch: f64) -> Model {
    tube(0.3, 1.5, 0.5, mismatch)
}

/// A branch to follow.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Model at the first wave.
    pub model: Model,
    /// Continuation parameter.
    pub parameter: Parameter,
    /// Mode k.
    pub mode: u32,
    /// First wave.
    pub which: Which,
    /// Range of the parameter.
    pub range: (f64, f64),
    /// Direction of the first step.
    pub up: bool,
    /// Event after whose n-th occurrence to stop.
    pub until: Option<(EventType, usize)>,
}

/// A branch that was followed.
pub struct Run {
    /// All points in order; the first one is the start.
    pub points: Vec<Found>,
    /// How it ended, if it did.
    pub end: Option<Ending>,
}

/// Mode 4, fast, δ from 0.2 down: reverse slip, separation, and the end of stick.
pub fn fast_in_mismatch() -> Case {
    Case {
        model: mode4(0.2),
        parameter: Parameter::Mismatch,
        mode: 4,
        which: Which::Fast,
        range: (0.0003, 0.2),
        up: false,
        until: None,
    }
}

/// Mode 4, slow, δ from 0.8: down, round a fold, up, round a second fold, and down to a second
/// separation zone.
pub fn slow_in_mismatch() -> Case {
    Case {
        model: mode4(0.8),
        which: Which::Slow,
        range: (0.5, 6.0),
        until: Some((EventType::GR, 2)),
        ..fast_in_mismatch()
    }
}

/// Mode 4, fast, f from 0.2 up to the fold of slip-stick, round it, round a second one, up.
pub fn fast_in_friction() -> Case {
    Case {
        model: tube(0.3, 1.5, 0.2, 0.2),
        parameter: Parameter::Friction,
        range: (0.2, 3.0),
        up: true,
        ..fast_in_mismatch()
    }
}

/// A tube with D > 0, whose wave runs with the shaft and separates twice in a row.
pub fn with_the_shaft() -> Case {
    Case {
        model: tube(0.45, 1.25, 0.1, 0.1),
        range: (0.001, 0.1),
        ..fast_in_mismatch()
    }
}

/// Mode 4 as above with a Coulomb impact.
pub fn with_coulomb_impact() -> Case {
    let case = fast_in_mismatch();
    Case {
        model: Model {
            impact: Impact::Coulomb,
            ..case.model
        },
        range: (0.001, 0.2),
        ..case
    }
}

/// Mode 4 as above with material damping β.
pub fn with_material_damping(beta: f64) -> Case {
    let case = fast_in_mismatch();
    Case {
        model: Model {
            damping: Damping {
                mass: 0.0,
                stiffness: beta,
            },
            ..case.model
        },
        range: (0.03, 0.2),
        ..case
    }
}

impl Case {
    /// A follower at the first wave.
    pub fn follower(&self, steps: continuation::Steps, stop_at: &[f64]) -> Follower {
        let width = self.range.1 - self.range.0;
        let (wave, point) = first_wave(
            &self.model,
            self.parameter,
            self.mode,
            self.which,
            width,
            steps,
        )
        .expect("there is a first wave");
        let settings = Limits {
            range: self.range,
            stop_at: stop_at.to_vec(),
            steps,
        };
        Follower::new(wave, &point, self.up, settings).expect("a regular start")
    }

    /// Follows the branch with the default steps.
    pub fn follow(&self, stop_at: &[f64]) -> Run {
        self.follow_with(STEPS, stop_at)
    }

    /// Follows the branch.
    pub fn follow_with(&self, steps: continuation::Steps, stop_at: &[f64]) -> Run {
        to_the_end(self.follower(steps, stop_at), self.until)
    }
}

/// Steps until the branch ends or an event has occurred often enough.
pub fn to_the_end(mut follower: Follower, until: Option<(EventType, usize)>) -> Run {
    let mut points = vec![follower.here()];
    let mut met = 0;
    loop {
        let (found, end) = follower.step();
        for point in found {
            met += usize::from(until.is_some_and(|(kind, _)| point.kind() == Some(kind)));
            points.push(point);
        }
        if end.is_some() || until.is_some_and(|(_, count)| met >= count) {
            return Run { points, end };
        }
    }
}

/// Whether a point is an event of the branch: a fold or a change of regime.
pub fn is_event(found: &Found) -> bool {
    !matches!(
        found.kind(),
        None | Some(EventType::EP | EventType::MX | EventType::UZ)
    )
}

impl Run {
    /// Folds and changes of regime, in order.
    pub fn events(&self) -> Vec<&Found> {
        self.points.iter().filter(|found| is_event(found)).collect()
    }

    /// The user points at a value, in order.
    pub fn user_points(&self, value: f64) -> Vec<&Found> {
        self.points
            .iter()
            .filter(|found| found.kind() == Some(EventType::UZ) && found.parameter == value)
            .collect()
    }
}

/// Zone lengths T|c| in order from release.
pub fn lengths(wave: &Wave, point: &Vector) -> Vec<f64> {
    let speed = wave.speed_at(point).abs();
    (0..wave.zones())
        .map(|zone| wave.duration_at(point, zone) * speed)
        .collect()
}

/// Speed of a point found.
pub fn speed(found: &Found) -> f64 {
    found.orbit.speed_at(&found.node.point)
}

/// Regimes before and after a point found.
pub fn regimes(found: &Found) -> (String, String) {
    let before = found.orbit.signature.to_string();
    let after = found.special.as_ref().and_then(Special::after);
    let after = after.map_or_else(|| before.clone(), |after| after.to_string());
    (before, after)
}

/// Waves of every signature of a branch: with zones that have no length yet, just after they
/// opened, in the middle, and at the end.
pub fn specimens(case: &Case, steps: continuation::Steps) -> Vec<(Arc<Wave>, Vector)> {
    let mut follower = case.follower(steps, &[]);
    let mut groups: Vec<Vec<(Arc<Wave>, Vector)>> = Vec::new();
    let mut add = |wave: &Arc<Wave>, point: &Vector| match groups.last_mut() {
        Some(group) if group[0].0.signature == wave.signature => {
            group.push((wave.clone(), point.clone()));
        }
        _ => groups.push(vec![(wave.clone(), point.clone())]),
    };
    let mut met = 0;
    loop {
        let here = follower.here();
        add(&here.orbit, &here.node.point);
        let (found, end) = follower.step();
        for point in &found {
            add(&point.orbit, &point.node.point);
            met += usize::from(
                case.until
                    .is_some_and(|(kind, _)| point.kind() == Some(kind)),
            );
        }
        if end.is_some() || case.until.is_some_and(|(_, count)| met >= count) {
            break;
        }
    }
    let mut chosen = Vec::new();
    for group in groups {
        let last = group.len() - 1;
        let mut places = vec![0, 1, 2, last / 2, last];
        places.retain(|place| *place <= last);
        places.sort_unstable();
        places.dedup();
        chosen.extend(places.into_iter().map(|place| group[place].clone()));
    }
    chosen
}

/// The closed form behind a flow.
pub fn exact(flow: &SlidingFlow) -> &ContactFlow {
    match flow {
        SlidingFlow::Exact(flow) => flow,
        SlidingFlow::Numerical(_) | SlidingFlow::Material(_) => {
            panic!("Coulomb's law has a closed form")
        }
    }
}
