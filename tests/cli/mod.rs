//! Black-box tests of the binary: what its users and their scripts rely on.

mod accuracy;
mod advice;
mod bad_input;
mod branch_end;
mod budgets;
mod check;
mod equilibria;
mod fields;
mod figures;
mod files;
mod first_contact;
mod folders;
pub mod harness;
mod labels;
mod long_work;
mod pipe;
mod plots;
mod report;
mod restart;
mod resume;
mod scan;
mod stability;
mod systems;
