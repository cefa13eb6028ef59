//! What is wrong with a contact.

use serde::{Deserialize, Serialize};

use crate::affine::algebra::Obstacle;

/// Most contacts of a system.
pub const MAX_CONTACTS: usize = 12;

/// Most modes of a system with contacts where these are not all affine: they are made at once.
pub const MAX_PRODUCTS: usize = 1000;

/// Most combinations of states of contacts that are looked at where one of them changes: those of six blocks that rub on one
/// another.
pub const MAX_STATES: usize = 1000;

/// What is wrong with a contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum ContactMistake {
    /// More than can be followed.
    #[error("{0} contacts; at most {MAX_CONTACTS} are possible")]
    Many(usize),
    /// Its force is multiplied with a force, or stands in a function.
    #[error("the force `{0}` does not stand linearly here")]
    Nonlinear(String),
    /// Its force stands where it is not known.
    #[error("a force stands in what says when the contact changes")]
    HasForce,
    /// Its force has no influence on its slip or gap.
    #[error("the force `{0}` does not change {1}: does it stand in the rates?")]
    NoInfluence(String, Kinematic),
    /// Its force has the wrong sign.
    #[error("a positive force `{0}` would make {1} smaller")]
    Sign(String, Kinematic),
    /// A velocity depends on a force.
    #[error("the velocity of the gap depends on a force: it must follow from the states")]
    Massless,
    /// A bound that has no meaning.
    #[error("the bound is {0}: it must not be negative")]
    Bound(f64),
    /// A restitution that has no meaning.
    #[error("the restitution is {0}: it must be no less than 0 and no more than 1")]
    Restitution(f64),
    /// A stiffness or a damping that has no meaning.
    #[error("the {0} is {1}: it must not be negative")]
    Coefficient(SpringConstant, f64),
    /// A static bound below the other.
    #[error("the static bound {0} is less than the bound {1}")]
    Static(f64, f64),
    /// A bound that changes where it must not.
    #[error("the bound of this law must be a number")]
    BoundChanges,
    /// Friction by the force of a stop that has impacts.
    #[error("the bound has the force of a stop with impacts, whose friction is not modelled")]
    Impulse,
    /// Several forces that are not determined.
    #[error("the forces in `{0}` are not determined by what they hold")]
    Singular(String),
    /// A force that would close the gap that it opens.
    #[error(
        "in `{0}` a positive force of `{1}` would close its gap, by the friction that it causes: no motion follows"
    )]
    Paradox(String, String),
    /// An impact whose impulse would close a stop that is closed.
    #[error(
        "the impulse of `{impact}` would close the gap of `{closed}`, which is closed, in the same instant: no law of these \
         contacts says what two impacts at once come to"
    )]
    Pressed {
        /// The contact that has the impact.
        impact: String,
        /// The stop that is closed.
        closed: String,
    },
    /// A reset behind a stop.
    #[error("the reset leads behind the stop `{0}`: its gap is negative there")]
    Behind(String),
    /// Too many modes that are not affine.
    #[error("{0} modes that are not affine; at most {MAX_PRODUCTS} are possible")]
    Products(usize),
    /// Contacts that act on one another in too many states.
    #[error(
        "more than {MAX_STATES} combinations of states of its contacts may follow where a contact of `{0}` changes: at most six \
         that act on one another are possible"
    )]
    States(String),
    /// An operation without result.
    #[error("the forces in `{0}` have no value: {1}")]
    Obstacle(String, Obstacle),
}

/// What a force acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum Kinematic {
    /// The velocity of slip.
    #[error("its slip")]
    Slip,
    /// The gap.
    #[error("its gap")]
    Gap,
}

/// What a law multiplies a displacement or its velocity with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum SpringConstant {
    /// Of the displacement.
    #[error("stiffness")]
    Stiffness,
    /// Of the velocity.
    #[error("damping")]
    Damping,
}
