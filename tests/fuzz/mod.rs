//! Random inputs for the binary: whatever it is given, it ends with an exit code of its contract,
//! says what is wrong, takes no longer than it says, and loses no file.
//!
//! `cargo test --release --test all fuzz::` makes a fixed number of inputs from a fixed seed. A longer run by hand:
//!
//! ```sh
//! BRAKEWAVE_FUZZ_INPUTS=20000 BRAKEWAVE_FUZZ_SEED=7 \
//!     cargo test --release --test all fuzz:: -- --nocapture
//! ```
//!
//! Every input that breaks a rule is printed with what is needed to repeat it; the counts of all
//! exit codes are printed at the end.

mod dice;
mod folders;
mod models;
mod mutations;
mod systems;
mod watch;

/// Inputs of one run of all targets together, unless `BRAKEWAVE_FUZZ_INPUTS` says otherwise.
const INPUTS: usize = 40;

/// A number from the environment.
fn setting(name: &str, default: usize) -> usize {
    match std::env::var(name) {
        Ok(text) => text
            .parse()
            .unwrap_or_else(|_| panic!("{name} must be a whole number, not `{text}`")),
        Err(_) => default,
    }
}

/// How many inputs a target makes that has this share of all, in per cent.
fn inputs(share: usize) -> usize {
    (setting("BRAKEWAVE_FUZZ_INPUTS", INPUTS) * share).div_ceil(100)
}

fn seed() -> u64 {
    setting("BRAKEWAVE_FUZZ_SEED", 1) as u64
}
