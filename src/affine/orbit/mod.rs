//! Periodic orbits of a hybrid system as orbits that the engine follows.
//!
//! [`signature`] is the sequence of zones, [`setting`] what the orbits of a branch have in common, [`layout`] the unknowns of one,
//! `posed` its system at one value of the parameter, [`residual`] the equations, `section` the beginning of an orbit that has none by
//! itself; [`passage`] is the exact flow through a zone with its derivatives, `shots` what
//! it is divided into where a motion grows by much, `coordinates` other unknowns for the same orbits, and [`structure`] knows what is zero at its ends
//! whatever the parameter, as [`forms`] tell, or [`generic`] points, and `conserved` which sums never change. [`margin`] measures the
//! inequalities, [`examine`] decides them, by what [`turning`] tells of smooth functions; [`candidates`] finds what lies beyond an
//! event, [`ends`] why nothing does, which is a `termination`, by the motions beside it as [`discontinuity`] has them, `family` where others of
//! a family go on, and `bounds` where friction makes no sense; [`multipliers`] has the stability, [`monodromy`] what tells where it changes,
//! `multiplier` each number of it, with the `saltation` of every switch and what `surface` tells of sliding;
//! [`start`] finds the first orbit, or says by [`behaviour`] what a motion looks like that comes to none, [`switch`] that of the other
//! branch at an event, [`hopf`] that at which orbits shrink to nothing, [`homoclinic`] that at which they `stay` for ever. [`row`] has
//! what results keep of one, `monitor` the numbers of it that a problem asks for, those of them that are integrals by `integral`;
//! `bifurcation` names the changes of a sequence by sliding.

pub mod behaviour;
mod beside;
mod bifurcation;
mod bounds;
pub mod candidates;
mod conserved;
mod coordinates;
mod critical;
mod discontinuity;
mod ends;
pub mod examine;
mod family;
mod forms;
mod generic;
mod homoclinic;
mod hopf;
mod inequality;
mod integral;
pub mod layout;
pub mod margin;
mod memory;
mod monitor;
pub mod monodromy;
pub mod multiplier;
pub mod multipliers;
pub(in crate::affine) mod passage;
mod posed;
mod residual;
pub mod row;
pub(super) mod saltation;
mod section;
pub mod setting;
mod shots;
pub mod signature;
pub mod start;
mod stay;
mod structure;
mod surface;
pub mod switch;
pub mod symmetry;
mod termination;
mod turning;

use crate::affine::system::DEFAULT_FLOW_TOLERANCE;
use crate::continuation::newton;
use crate::linalg::{Matrix, Vector};
use crate::orbit::Zones;

pub use bifurcation::SlidingBifurcation;
pub use critical::Critical;
pub use examine::Examination;
pub use inequality::{Inadmissible, OrbitInequality};
pub use layout::{AffineOrbit, ZonePoint};
pub use margin::{Margin, Watch};
pub use multiplier::Multiplier;
pub use setting::{OrbitFailure, Scales, Setting};
pub use signature::{Sequence, Way, Zone};
pub use termination::OrbitTermination;

/// A zone shorter than this, in units of the period, is about to close.
const CLOSING: f64 = 1e-6;

impl Zones for AffineOrbit {
    type Signature = Sequence;
    type Parameter = String;
    type Margin = Margin;
    type Examination = Examination;

    fn signature(&self) -> &Sequence {
        &self.sequence
    }

    fn posed(&self, signature: Sequence) -> Option<AffineOrbit> {
        self.with_sequence(signature)
    }

    fn is_rotation(&self, signature: &Sequence) -> bool {
        signature.is_rotation_of(&self.sequence)
    }

    fn parameter(&self) -> String {
        let names = self.setting.system.source.parameters.names();
        let mut names = names.skip(self.setting.parameter);
        names.next().unwrap_or_default().to_owned()
    }

    fn column(parameter: &String) -> &str {
        parameter
    }

    fn duration_index(&self, zone: usize) -> usize {
        self.width() * zone + self.states()
    }

    fn unit(&self) -> f64 {
        self.setting.scales.parameter
    }

    fn examination(&self, point: &Vector) -> Result<Examination, OrbitFailure> {
        self.at(point)?.examine()
    }

    /// The units are those of the first orbit, beside which another may be a thousand times as large: steps are then
    /// relative to its size.
    fn stretch(&self, point: &Vector) -> f64 {
        point.rows(0, self.width() * self.zones()).amax().max(1.0)
    }

    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64> {
        let parameter = point.len() - 1;
        // the phase has the rounding of a turn
        let mut sizes = point.abs();
        if let Some(index) = self.phase_index() {
            sizes[index] = sizes[index].max(1.0);
        }
        let mut noise = newton::noise(self, matrix, point);
        let left_out = self.left_out(point);
        if left_out > 0.0 {
            let noise = noise.get_or_insert_with(|| Vector::zeros(matrix.nrows()));
            noise.add_scalar_mut(left_out);
        }
        if let Some(noise) = &mut noise {
            noise[parameter] = last;
        }
        Some(newton::rounding(matrix, &sizes, noise.as_ref())?[parameter])
    }

    fn left_out(&self, point: &Vector) -> f64 {
        let tolerance = self.setting.system.flow_tolerance();
        if tolerance <= DEFAULT_FLOW_TOLERANCE {
            return 0.0;
        }
        let exact = self.at(point).is_ok_and(|at| {
            let mut zones = 0..self.zones();
            zones.all(|zone| at.mode(zone).field.is_exact)
        });
        if exact { 0.0 } else { tolerance }
    }
}
