//! Why an orbit is not proven: what is not covered, and what is undecided.

use crate::affine::contact::mistake::ContactMistake;

/// Which inequality is not proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnprovenOrbit {
    /// The duration of a zone.
    #[error("that zone {0} has a duration")]
    Duration(usize),
    /// A guard within a zone.
    #[error("that guard {1} of zone {0} is positive within it")]
    Guard(usize, usize),
    /// A guard that is zero all along a zone.
    #[error("guard {1} of zone {0}, which is zero all along it: whether its switch is taken")]
    Zero(usize, usize),
    /// Another guard that is zero at the end of a zone.
    #[error(
        "that guard {1}, which is zero at the end of zone {0} too, leads on like the one taken"
    )]
    Together(usize, usize),
    /// A condition of the exit taken.
    #[error("condition {1} at the end of zone {0}")]
    Condition(usize, usize),
    /// A condition of an exit before the one taken.
    #[error("that exit {1} is not taken at the end of zone {0}")]
    Before(usize, usize),
}

/// Why the orbit of an event is not proven in the other sequence of zones.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OrbitNotBeyond {
    /// Formulas do not tell.
    #[error("not covered: how the zones of this event open or close")]
    Laws,
    /// It is not proven, or an inequality is not.
    #[error(transparent)]
    Open(#[from] OpenOrbit),
    /// It may be another.
    #[error("undecided: the orbit beyond may be another")]
    Another,
}

/// Why an orbit is not proven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenOrbit {
    /// The multiplier that passes is not simple.
    #[error("not covered: several multipliers that pass the unit circle together")]
    Several,
    /// The period is prescribed.
    #[error("not covered: orbits whose period is prescribed, with a parameter that is free for it")]
    Prescribed,
    /// Forces of contacts over the range of the parameter.
    #[error("undecided: {0}")]
    Contacts(ContactMistake),
    /// Numbers of contacts that must not be negative.
    #[error(
        "undecided: whether a bound, a restitution or the influence of a force is negative, or a restitution above 1"
    )]
    Signs,
    /// Formulas of contacts that are too long.
    #[error("not covered: forces of contacts whose formulas are so long")]
    Written,
    /// Modes of contacts beyond the range in which they are known.
    #[error("undecided: the modes that contacts make over so wide an interval of the parameter")]
    Range,
    /// A value of a monitor.
    #[error("not covered: a value of a monitor")]
    Monitor,
    /// Expressions that have no affine form in intervals.
    #[error(
        "not covered: {0} is not affine in the states, or a function of parameters that cannot be enclosed"
    )]
    System(String),
    /// A division by what may be zero, or numbers that are not finite.
    #[error("undecided: the numbers of the system cannot be enclosed")]
    Numbers,
    /// Modes whose sliding field is not affine by its formulas.
    #[error(
        "not covered: sliding where the rates of the two modes differ in several states that move"
    )]
    Sliding,
    /// No forcing and no switches.
    #[error("not covered: an orbit without forcing and without switches")]
    Centre,
    /// A Hopf point at which the orbit shrinks to an equilibrium.
    #[error("not covered: where an orbit shrinks to an equilibrium")]
    Shrinking,
    /// A family of orbits begins.
    #[error("not covered: orbits beyond it are a family at one value of the parameter")]
    Family,
    /// A homoclinic orbit.
    #[error("not covered: a homoclinic orbit, or a cycle of connections between saddles")]
    Homoclinic,
    /// A multiplier 1 that is no fold, of an orbit without symmetry.
    #[error(
        "not covered: a branch point of an orbit that is not its image around a point half a period later by its formulas"
    )]
    Branching,
    /// Zones that do not follow from one another.
    #[error("not covered: a sequence of zones that is not one of the system")]
    Sequence,
    /// A zone of no duration that no other sequence does without.
    #[error(
        "not covered: a zone of no duration, without which the orbit has no sequence that is proven"
    )]
    Duration,
    /// The angle of a pair is 0 or π, or is not told from that.
    #[error("undecided: the angle of a pair of multipliers is not known to lie between 0 and π")]
    Angle,
    /// An orbit that closes after a part of its period.
    #[error("undecided: the orbit may be one of a part of its period, traversed several times")]
    Repeated,
    /// A change of the sequence whose type does not follow from what vanishes.
    #[error("undecided: what vanishes does not make it an event of its type")]
    Kind,
    /// Too long an orbit.
    #[error("not covered: an orbit so long that its equations have more than 1000 unknowns")]
    Long,
    /// Numbers that are not finite.
    #[error("undecided: the equations cannot be enclosed")]
    NotEnclosed,
    /// Krawczyk's operator does not map a box into itself.
    #[error("undecided: no box is known to have exactly one solution")]
    NotIsolated,
    /// An inequality.
    #[error("undecided: {0} is not proven")]
    Inequality(#[from] UnprovenOrbit),
}
