//! Contacts: forces that keep to a law, and the modes that these laws make.
//!
//! [`law`] has the laws as they are written and the names of their states; [`forces`] finds the forces of all contacts in given
//! states from one linear system, `forms` are what modes are made of; [`arrivals`] says which states follow where one of them ends, with
//! what its impact does to others in `impacts` and to the user's modes in `carried`, and [`modes`] makes a mode like any other of it, when it is asked for; [`mistake`] has what may be wrong with one, and `place`
//! whether a state is that of a mode.

mod arrivals;
mod carried;
mod forces;
pub(crate) mod forms;
mod impacts;
pub mod law;
pub mod mistake;
mod modes;
pub mod place;

pub use forms::ContactForms;
pub use law::{Law, Products};
pub use mistake::{ContactMistake, Kinematic, MAX_CONTACTS};
