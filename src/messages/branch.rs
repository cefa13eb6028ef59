//! What happens along a branch of any kind of orbit, and how it ends.

use std::fmt::{self, Display, Formatter};

use super::figures::with_error;
use super::first_of;
use crate::continuation::walk::End;
use crate::orbit::{self, Orbit};

/// Orbits whose changes of signature have sentences.
pub(crate) trait Told: Orbit {
    /// What its orbits are.
    const NAME: &'static str;

    /// What happens at a change, without what comes of it.
    fn event(change: &orbit::special::Change<Self>) -> String;
}

impl<O: Told> Display for orbit::special::Special<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::Special;
        match self {
            Special::Start => f.write_str("start"),
            Special::Fold(parameter) => write!(f, "fold in {}", O::column(parameter)),
            Special::User(parameter, value) => {
                write!(f, "user point {} = {value}", O::column(parameter))
            }
            Special::Monitor(name, value) => write!(f, "user point {name} = {value}"),
            Special::Edge(parameter, value) => {
                write!(f, "edge of the range, {} = {value}", O::column(parameter))
            }
            Special::Closed => f.write_str("the branch closes on its first point"),
            Special::Change(change) => change.fmt(f),
            Special::Failed(failure) => failure.fmt(f),
            Special::Own(special) => special.fmt(f),
        }
    }
}

impl<O: Told> Display for orbit::special::Change<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&O::event(self))?;
        // sequences of the same modes may differ by their guards
        let after = self.after.as_ref().map(ToString::to_string);
        let mut others: Vec<String> = self.others.iter().map(ToString::to_string).collect();
        let mut told: Vec<String> = after.into_iter().collect();
        others.retain(|other| {
            let is_new = !told.contains(other);
            told.push(other.clone());
            is_new
        });
        if !others.is_empty() {
            write!(f, "; also admissible: {}", others.join(", "))?;
        }
        if let Some(end) = &self.end {
            write!(f, "; {end}")?;
        }
        if self.turned_back {
            f.write_str("; the branch turns back in the parameter here")?;
        }
        if let Some(remark) = &self.spectrum {
            write!(f, "; {remark}")?;
        }
        Ok(())
    }
}

impl<O: Orbit> Display for orbit::special::OrbitRefusal<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::OrbitRefusal;
        match self {
            OrbitRefusal::Flow(error) => error.fmt(f),
            OrbitRefusal::Inadmissible(reason) => reason.fmt(f),
            OrbitRefusal::NotFound => {
                f.write_str("a fold or a user point inside the step was not found")
            }
            OrbitRefusal::NotLocated(count) => write!(
                f,
                "{count} inequalities fail within the step and none is located"
            ),
            OrbitRefusal::Uncertain {
                parameter,
                value,
                error,
            } => write!(
                f,
                "what happens near {} = {value:.6} is known to {error:.0e} only",
                O::column(parameter)
            ),
            OrbitRefusal::Order => f.write_str("the order of two events is not resolved"),
            OrbitRefusal::NoSolution => f.write_str("its equations do not hold at the event"),
        }
    }
}

impl<O: Orbit> Display for orbit::special::BranchTermination<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::BranchTermination;
        match self {
            BranchTermination::NoSignature => {
                f.write_str("no sequence of regimes solves the equations beyond this event")
            }
            BranchTermination::NoneAdmissible(tried) => {
                f.write_str("no admissible signature continues beyond this event; tried ")?;
                let (no_solutions, refused): (Vec<_>, Vec<_>) =
                    tried.iter().partition(|tried| tried.is_no_solution());
                f.write_str(&first_of(&refused, "; "))?;
                let signatures = no_solutions
                    .iter()
                    .filter_map(|tried| tried.signature.as_ref());
                let signatures: Vec<_> = signatures.collect();
                if signatures.is_empty() {
                    return Ok(());
                }
                let between = if refused.is_empty() { "" } else { "; " };
                write!(
                    f,
                    "{between}{}: the equations do not hold at the event",
                    first_of(&signatures, ", ")
                )
            }
            BranchTermination::Converges {
                kind,
                changes,
                ratio,
                parameter,
                limit,
                error,
            } => write!(
                f,
                "a sequence without end: {changes} events {kind} in a row add the same zones each, and the distances of \
                 their values fall by {ratio:.3} from one to the next; they converge at {} = {}",
                O::column(parameter),
                with_error(*limit, *error)
            ),
            BranchTermination::Flow(error) => error.fmt(f),
            BranchTermination::Own(stop) => stop.fmt(f),
        }
    }
}

impl<O: Orbit> Display for orbit::special::Tried<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.signature {
            Some(signature) => write!(f, "{signature}: {}", self.reason),
            None => self.reason.fmt(f),
        }
    }
}

impl<R: Display, E: Display> Display for End<R, E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            End::Edge => f.write_str("the edge of the range is reached"),
            End::Closed => f.write_str("the branch closes on its first point"),
            End::MaxPoints { most } => write!(
                f,
                "max_points = {most} points are reached before the end of the range; raise \
                 `max_points` to go on, or the steps `ds` and `ds_max` if they are small"
            ),
            End::Creeps { steps, longest } => write!(
                f,
                "the branch does not get on: none of its last {steps} steps is as long as \
                 {longest:.0e}, and longer ones fail"
            ),
            End::NoStep { ds_min, reason } => {
                write!(
                    f,
                    "no step of at least ds_min = {ds_min:e} succeeds: {reason}"
                )
            }
            End::Own(end) => end.fmt(f),
        }
    }
}

impl<O: Orbit> Display for orbit::special::BranchFailure<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::BranchFailure;
        match self {
            BranchFailure::Ended(end) => end.fmt(f),
            BranchFailure::NoLeg(reason) => reason.fmt(f),
        }
    }
}

impl<H: Display> Display for orbit::special::Close<H> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            orbit::special::Close::Margin(held) => held.fmt(f),
            orbit::special::Close::Fold => {
                f.write_str("the slope of the parameter, which vanishes at a fold,")
            }
            orbit::special::Close::Circle => {
                f.write_str("the distance of a multiplier from the unit circle")
            }
        }
    }
}
