//! Hybrid systems that a user writes down.
//!
//! [`expression`] reads what stands in a problem file, [`algebra`] knows its operations and functions, [`system`] the whole section with its names, [`values`] those of its
//! parameters; [`form`] is what expressions of such a system are evaluated in, with coefficients that are [`dual`] numbers,
//! [`evaluation`] does that, [`mode`] is the linear flow that a mode is made into at given parameters: `shape` and `matrices` lay it
//! out, `products` what contacts make, `sliding` puts modes between two others, and [`origin`] leads a system along a parameter.
//! [`program`] makes components of z of others, [`series`] has the flow of a mode whose rates are not affine, by [`recurrence`] (that of `quotients` by exponentials, too), `length` how long that holds, `exponential` those of matrices, `stiff` what is
//! slow of one, [`flow`] either with the signs of its guards, [`motion`] follows it through its switches, [`course`] sees it at equal
//! times, and [`tangent`] has its perturbations; [`steady`] has the equilibria, within the `surfaces` that a mode does not leave, [`equilibrium`] branches of them, [`orbit`] the periodic
//! orbits, whose period [`closure`] may prescribe, [`connection`] those to which they come beside saddles, and of which [`monitor`]s are numbers, laid out in a [`monitored`] system.

pub mod algebra;
pub mod closure;
mod coefficients;
pub mod connection;
pub mod contact;
pub mod course;
pub mod dual;
pub mod equilibrium;
pub(crate) mod evaluation;
pub(crate) mod exponential;
mod exprel;
pub mod expression;
pub mod flow;
pub mod form;
mod hyperdual;
mod length;
mod logistic;
mod matrices;
pub mod mode;
pub mod monitor;
pub mod monitored;
pub mod motion;
pub mod orbit;
pub mod origin;
mod phases;
mod products;
pub mod program;
mod quotients;
pub mod recurrence;
pub mod rows;
pub mod series;
mod shape;
mod sizes;
mod sliding;
pub(crate) mod slots;
pub mod steady;
mod stiff;
mod substitution;
mod surfaces;
pub mod system;
pub mod tangent;
pub mod values;
