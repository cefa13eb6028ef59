//! Continuation of R(u) = 0 in one parameter: knows nothing of waves.
//!
//! - [`newton`]: a system, a constraint that closes it, Newton's method;
//! - [`arclength`]: one step of pseudo-arclength;
//! - [`branch_point`]: where curves cross;
//! - [`branching`]: tangents of the curves that pass through one point;
//! - [`locate`]: points within a step;
//! - [`limit`]: a point that steps come near and do not reach;
//! - [`unbounded`]: branches that leave every bound;
//! - [`walk`]: the driver that follows a curve, event by event, to its end;
//! - [`zero`]: zeros of functions of one variable.

pub mod arclength;
pub mod branch_point;
pub mod branching;
#[cfg(test)]
mod circle;
#[cfg(test)]
mod cut_disc;
pub mod limit;
pub mod locate;
pub mod newton;
pub mod unbounded;
pub mod walk;
pub mod zero;

pub use arclength::{
    DEFAULT_DS, DEFAULT_DS_MAX, DEFAULT_DS_MIN, DEFAULT_TOLERANCE, Node, Path, Steps,
};
