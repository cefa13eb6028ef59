//! The tube on its shaft: the waves of the Note, as a hybrid system whose flows, switches and spectra are known.
//!
//! - [`model`] has the parameters, the laws of friction and impact, the coefficients, the regimes and the
//!   table of switches between them;
//! - [`flow`] is the exact flow of one regime with its derivatives, and signs over whole zones;
//! - [`wave`] poses a wave as a boundary-value problem for one signature, has its closed form, examines
//!   it, and finds candidates for its successor;
//! - [`stability`] has all eigenvalues of a wave from its eigenfunction problem, and the verdict;
//! - [`steady`] has the stability of steady sliding, where the waves come from.

pub mod flow;
pub mod model;
pub mod stability;
pub mod steady;
pub mod wave;
