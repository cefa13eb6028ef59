//! Why an equilibrium is not proven: what is not covered, and what is undecided.

/// Why an equilibrium is not proven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenEquilibrium {
    /// A value of a monitor.
    #[error("not covered: a value of a monitor")]
    Monitor,
    /// A branch point.
    #[error("not covered: a branch point of equilibria")]
    Branching,
    /// Several eigenvalues that pass together, or an event that was not located.
    #[error("not covered: several eigenvalues that pass the imaginary axis together")]
    Several,
    /// Two modes that do not meet in one surface.
    #[error(
        "not covered: sliding between modes whose `zero` are not one but for the sign by their formulas"
    )]
    Sliding,
    /// The mode beyond a boundary equilibrium.
    #[error("undecided: which equilibria of the mode beyond are admissible")]
    Beyond,
    /// Between two points.
    #[error("not covered: arcs of equilibria")]
    Arcs,
    /// A mode, a guard or numbers that do not fit the system.
    #[error("not covered: a mode, a guard or numbers that are not those of the system")]
    System,
    /// A value that is not known to be a finite number.
    #[error("undecided: the equations cannot be enclosed")]
    NotEnclosed,
    /// Krawczyk's operator does not map a box into itself.
    #[error("undecided: no box is known to have exactly one solution")]
    NotIsolated,
    /// ω is zero, or is not told from zero.
    #[error("undecided: the frequency of the pair is not known to be positive")]
    Frequency,
    /// A surface that its force may not hold.
    #[error("undecided: that what holds the mode acts against what it holds is not proven")]
    Held,
    /// The law of a contact.
    #[error(
        "undecided: that the law of `{0}` makes sense is not proven: its force against its slip or for its gap, no constant less than zero"
    )]
    Law(String),
    /// A guard.
    #[error("undecided: that {0} is positive at the equilibrium is not proven")]
    Guard(String),
}
