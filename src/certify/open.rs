//! Why a point is not proven: what is not covered, and what is undecided.

use super::UnprovenWave;

/// Why a point is not proven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenPoint {
    /// A layer in V and one in U, which are coupled.
    #[error("not covered: separation with material damping")]
    LayeredSeparation,
    /// β = 0 where β > 0 elsewhere on the branch.
    #[error("not covered: the limit of no material damping, in which a layer has no thickness")]
    NoLayer,
    /// Eigenvalues for β > 0.
    #[error("not covered: eigenvalues of waves with material damping")]
    LayeredEigenvalues,
    /// The zone grows like T³.
    #[error("not covered: a sliding zone that opens or closes with material damping")]
    LayeredOpening,
    /// A law whose flow has no closed form.
    #[error("not covered: friction that depends on the velocity")]
    Law,
    /// A method other than the exact one.
    #[error("not covered: equations solved by a numerical method")]
    Method,
    /// The vertical family.
    #[error("not covered: in the family at the Hopf point of steady sliding no parameter moves")]
    Family,
    /// The end of a branch of waves of twice the wavelength.
    #[error("not covered: a wave that is one of half its wavelength, traversed twice")]
    Repeats,
    /// The perturbation of a Coulomb impact.
    #[error("not covered: eigenvalues of waves with a Coulomb impact")]
    CoulombImpact,
    /// The equations do not depend on the continuation parameter.
    #[error("not covered: a parameter that is not in the equations")]
    Parameter,
    /// A coefficient outside its range.
    #[error("undecided: the numbers of the model are not known to be in their ranges")]
    Model,
    /// A margin elsewhere than where it is watched.
    #[error("what vanishes is no condition of that zone")]
    Margin,
    /// A sector that the mode has not.
    #[error("there is no such Bloch sector")]
    Sector,
    /// The sign of ω, or that it is 0.
    #[error("undecided: whether an eigenvalue crosses the axis at 0 or off it")]
    AtZero,
    /// What is said of an event is not what vanishes there.
    #[error("undecided: the type of the event does not follow from what vanishes")]
    Type,
    /// D = 0.
    #[error("not covered: where D = 0 there is no wave")]
    Undriven,
    /// A zone that begins at V̇ = 0, or switches that the table has not.
    #[error("not covered: a sequence of zones that is not in the table of switches")]
    Signature,
    /// Too long a zone, or numbers that are not finite.
    #[error("undecided: the equations cannot be enclosed")]
    NotEnclosed,
    /// Krawczyk's operator does not map a box into itself.
    #[error("undecided: no box is known to have exactly one solution")]
    NotIsolated,
    /// An inequality.
    #[error("undecided: {0} is not proven")]
    Inequality(#[from] UnprovenWave),
}
