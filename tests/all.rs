//! Claims about the mathematics and the program, a folder for each subject: in one program, so that the machine has work
//! until the last of them is done.
//!
//! `cargo test --release --test all waves::` runs those of one folder, `-- --nocapture` shows the errors observed.

mod affine;
mod certify;
mod chebyshev;
mod cli;
mod curve;
mod docs;
mod fuzz;
mod map;
mod methods;
mod simulation;
mod stability;
mod steady;
mod tree;
mod waves;

/// Shows the worst error of a claim.
fn observed(claim: &str, error: f64) {
    println!("observed: {claim}: {error:.1e}");
}
