//! An orbit that keeps a sum of states is one of a family, of which the branch follows the member with the value of its start.
//! Where that member ends others may go on.

use super::layout::AffineOrbit;
use super::{Margin, OrbitStop};
use crate::continuation::newton::{self, Fixed, Settings};
use crate::linalg::Vector;
use crate::orbit::sign::SignVerdict;
use crate::orbit::{Examined as _, Orbit as _};

/// How far beside the member of the branch another one is looked at, in units of the states: far above what an event is
/// located to, and little enough for other margins to stay as they are.
const BESIDE: f64 = 1e-6;

impl AffineOrbit {
    /// Whether the branch ends at the zero of a margin since it keeps what it does: at the same value of the parameter orbits of
    /// the same zones are admissible that keep another value.
    pub(super) fn others_remain(&self, point: &Vector, margin: &Margin) -> Option<OrbitStop> {
        if self.conserved.count() == 0 {
            return None;
        }
        let units = &self.setting.scales.states;
        let remains = |state: &usize| {
            let moved = |by: f64| self.member(point, *state, by * units[*state]);
            [BESIDE, -BESIDE]
                .into_iter()
                .any(|by| moved(by).is_some_and(|verdict| verdict == SignVerdict::Positive))
        };
        let names = &self.setting.system.source.states;
        let states: Vec<String> = (0..names.len())
            .filter(remains)
            .map(|state| names[state].clone())
            .collect();
        (!states.is_empty()).then(|| OrbitStop::OthersRemain {
            held: self.held(margin),
            states,
        })
    }

    /// Whether the orbit of the family is admissible that keeps another value of a state, at the same parameter.
    fn member(&self, point: &Vector, state: usize, by: f64) -> Option<SignVerdict> {
        let mut kept = self.sequence.kept().to_vec();
        *kept.get_mut(state)? += by;
        let sequence = self.sequence.clone().keeping(&kept);
        let orbit = AffineOrbit::new(self.setting.clone(), sequence)?;
        let index = point.len() - 1;
        let mut fixed = Fixed {
            index,
            value: point[index],
        };
        let solved = newton::solve(&orbit, &mut fixed, point, &Settings::default()).ok()?;
        Some(orbit.examination(&solved.point).ok()?.verdict())
    }
}
