//! Why there is no first orbit, in words.

use crate::affine::motion::{Halt, Moment};
use crate::affine::orbit::Inadmissible;
use crate::affine::orbit::behaviour::Behaviour;
use crate::affine::orbit::layout::AffineOrbit;
use crate::affine::orbit::setting::OrbitFailure;
use crate::affine::orbit::termination::quoted;
use crate::affine::system::SystemError;
use crate::continuation::newton;
use crate::orbit::special::NoFollower;
use crate::orbit::switch::NoBranch;

/// Why there is no first orbit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// The system makes no sense at these values.
    #[error("{0}")]
    System(SystemError),
    /// The motion does not go on.
    #[error("{0}")]
    Halted(Halt),
    /// The same, about a guard.
    #[error("{}", .halt.named(&format!("the mode `{mode}`"), guard))]
    Stuck {
        /// Why.
        halt: Halt,
        /// Name of the mode.
        mode: String,
        /// The guard, as the file has it.
        guard: String,
    },
    /// The motion comes to rest.
    #[error("the motion comes to rest after its last switch, at t = {time}")]
    Rests {
        /// Time of the last switch, or of the beginning.
        time: f64,
        /// Where it rests.
        place: Moment,
    },
    /// Some states stand still for ever, where the motion happened to leave them, while the rest moves with the forcing.
    #[error(
        "the motion comes to rest in part: after its last switch, at t = {time}, it stays in `{mode}` for ever, where {} \
         stand{} still while the rest moves with the forcing. Where depends on where the motion begins, so that the orbit is \
         one of a family, without a branch of its own",
        quoted(.states), if .states.len() == 1 { "s" } else { "" }
    )]
    Stands {
        /// Time of the last switch, or of the beginning.
        time: f64,
        /// Name of the mode.
        mode: String,
        /// Names of the states.
        states: Vec<String>,
    },
    /// The motion switches no more and does not come to rest.
    #[error(
        "the motion does not switch any more after t = {time}, and is not seen to rest or to return: it leaves, settles \
         slowly, or wanders"
    )]
    Leaves {
        /// Time of the last switch.
        time: f64,
    },
    /// The motion does not return within the periods asked for.
    #[error(
        "after {periods} periods the motion does not return: it is off by {off:.1e} of its size{}", in_words(*.looks)
    )]
    NotPeriodic {
        /// How many were tried.
        periods: u32,
        /// Least distance found, relative to the size of the states.
        off: f64,
        /// What it looks like, where it was asked.
        looks: Option<Behaviour>,
    },
    /// A state moves on by as much from one return to the next.
    #[error(
        "`{state}` runs away: it moves by {by:.6e} from each return to the next, for ever, while what is left comes back"
    )]
    Drifts {
        /// Name of the state.
        state: String,
        /// By how much it moves.
        by: f64,
    },
    /// More switches than an orbit is followed through.
    #[error("{0} switches in one period are more than are followed")]
    Switches(usize),
    /// Newton's method finds no orbit.
    #[error("no orbit is found: {0}")]
    Newton(newton::Failure<OrbitFailure>),
    /// What Newton's method finds is no orbit.
    #[error("the solution found is an equilibrium and no orbit")]
    Equilibrium,
    /// The orbit is not isolated.
    #[error("{0}")]
    Family(NoFollower<AffineOrbit>),
    /// The orbit is not admissible.
    #[error("the solution found is not an admissible orbit: {0}")]
    Inadmissible(Inadmissible),
    /// Two switches of the motion come in one instant, and neither leads to the other: which comes first is rounding.
    #[error(
        "two switches of the motion come in one instant, that of {first} and that of {second}, and neither leads to the other: \
         no orbit is followed through both; elements that are alike all along may be written as one"
    )]
    AtOnce {
        /// The guard of the one that comes first by rounding.
        first: String,
        /// That of the other.
        second: String,
    },
    /// The motion has infinitely many switches in a period: no orbit is followed through them.
    #[error(
        "infinitely many switches of `{from}` end in `{to}` at t = {time}, and so in every period: `simulate` and `scan` go on \
         through them, but no orbit is followed through infinitely many zones"
    )]
    Accumulates {
        /// Where they end.
        time: f64,
        /// Name of the mode before.
        from: String,
        /// Name of that which goes on.
        to: String,
    },
    /// A zone of the guess has no length in the solution: its sequence is not that of an orbit.
    #[error(
        "no orbit has the zones of the guess: one of `{mode}` shrinks to nothing as the equations are solved"
    )]
    Shrinks {
        /// Name of its mode.
        mode: String,
    },
    /// The system does not have these zones.
    #[error("the motion has zones that no orbit has")]
    NoZones,
    /// The equations of an orbit are regular at a fixed parameter: no other branch passes there.
    #[error("no other branch passes through the orbit: its equations are singular to {0:.1e} only")]
    Regular(f64),
}

/// What a motion that does not return looks like, in words.
fn in_words(looks: Option<Behaviour>) -> String {
    match looks {
        None | Some(Behaviour::Unclear | Behaviour::Drifts(..)) => String::new(),
        Some(Behaviour::Periodic(count)) => {
            format!("; later it is seen to be periodic: it is back after {count} of them")
        }
        Some(Behaviour::Settles) => {
            "; it settles slowly: motions next to it come nearer".to_owned()
        }
        Some(Behaviour::QuasiPeriodic) => {
            "; it looks quasi-periodic: motions next to it neither come nearer nor part".to_owned()
        }
        Some(Behaviour::Chaotic(exponent)) => {
            format!("; it looks chaotic: motions next to it part like exp({exponent:.2e} t)")
        }
    }
}

impl From<NoBranch<AffineOrbit>> for NoStart {
    fn from(reason: NoBranch<AffineOrbit>) -> NoStart {
        match reason {
            NoBranch::Regular(singular) => NoStart::Regular(singular),
            NoBranch::Newton(failure) => NoStart::Newton(failure),
            NoBranch::Inadmissible(reason) => NoStart::Inadmissible(reason),
        }
    }
}
