//! The sentences about what happens along a branch or a curve, made from data.

mod branch;
mod curve;
pub(crate) mod figures;
mod system;
mod wave;

#[cfg(feature = "cli")]
pub(crate) use system::{AWAY, halt, lack};

use std::fmt::{self, Display, Formatter};

use figures::{PLACE, significant};

use crate::map::Missing;
use crate::problem::{Doubt, Rotation};

impl Display for Doubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Doubt::Supersonic { gamma } => write!(
                f,
                "gamma = {gamma}: the surface of the shaft runs at {:.3e} times the speed of sound sqrt(E/rho); \
                 gamma is rho R^2 Omega^2/E",
                gamma.sqrt()
            ),
            Doubt::Interference { mismatch } => write!(
                f,
                "the shaft is {:.3} % thicker than the bore of the tube: the model is linear, for small strains; \
                 the mismatch is d/R",
                100.0 * mismatch
            ),
            Doubt::Fast { speed, rotation } => {
                write!(
                    f,
                    "the surface of the shaft runs at {speed:.0} m/s, faster than in any brake"
                )?;
                match rotation {
                    Rotation::RadPerSecond(_) => {
                        f.write_str("; revolutions per minute are written `Rpm(600.0)`")
                    }
                    Rotation::Rpm(_) => Ok(()),
                }
            }
            Doubt::Inaudible { hertz, mode, bare } => {
                let kilohertz = hertz / 1e3;
                write!(
                    f,
                    "waves of mode {mode} have about {kilohertz:.0} kHz, which nobody hears"
                )?;
                match bare {
                    true => f.write_str("; `output.rotation` is in rad/s"),
                    false => Ok(()),
                }
            }
        }
    }
}

/// Something that comes so close to zero on a branch that its sign is not known.
fn near_zero(f: &mut Formatter<'_>, column: &str, value: f64, what: &impl Display) -> fmt::Result {
    write!(
        f,
        "{column} = {}: here, or since the point before, {what} comes so close to zero that \
         rounding decides: two events may be missing, or the regimes may be others",
        significant(value, PLACE)
    )
}

impl Display for Missing {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Missing::NoStart(reason) => reason.fmt(f),
            Missing::NoBranch(reason) => write!(
                f,
                "{reason}; and no branch that begins elsewhere in the plane comes here"
            ),
            Missing::Cut(failure) => write!(f, "a branch ends before: {failure}"),
            Missing::ComesBack => {
                f.write_str("the branch comes back to waves it has passed before")
            }
            Missing::Elsewhere => f.write_str("the branch does not come here"),
            Missing::Listed => {
                f.write_str("what the branch meets here is listed under another start")
            }
        }
    }
}

fn list<T: Display>(things: &[T], between: &str) -> String {
    let words: Vec<String> = things.iter().map(T::to_string).collect();
    words.join(between)
}

/// The first of many things, and how many more there are.
fn first_of<T: Display>(things: &[T], between: &str) -> String {
    /// So many are read.
    const MOST: usize = 8;
    let (first, more) = things.split_at(things.len().min(MOST));
    let first = list(first, between);
    match more.len() {
        0 => first,
        count => format!("{first}{between}and {count} more"),
    }
}
