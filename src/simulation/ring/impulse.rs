//! Reactions with a concentrated part that carries friction: material damping β > 0, and Coulomb impacts
//! for β = 0. The step itself is in [`super::kernel`].
//!
//! Stiffness acts on Û = U + βU̇ and V̂ = V + βV̇. Leapfrog has the rates half a step before and after the
//! instant n, and forces are due at n: rates there are extrapolated from the two half-steps before,
//!
//! ```text
//! V̇ⁿ⁺½ = [(1 − αΔt/2) V̇ⁿ⁻½ + Δt (a∂²V̂ − D∂Û − hV̂ + Q)ⁿ] / (1 + αΔt/2),
//! Vⁿ⁺¹ = Vⁿ + Δt V̇ⁿ⁺½,   V̂ⁿ⁺¹ = Vⁿ⁺¹ + β(3V̇ⁿ⁺½ − V̇ⁿ⁻½)/2,
//! ```
//!
//! of second order in Δt where the rates have no jump, and so for U in the air. A node keeps Û and V̂ of the
//! instant, which is all that its neighbours read, so that a step remains explicit and its reach that of
//! the differences.
//!
//! **Time step.** A free motion of frequency ω turns into μ in a step, with p = Δt²ω² and q = βΔtω²
//!
//! ```text
//! μ(μ − 1)² + pμ² + ½q(3μ − 1)(μ − 1) = 0,
//! ```
//!
//! which leaves the unit circle at μ = −1 where p + 4q = 4: Δt = √(4β² + 4/ω²) − 2β, the Courant limit
//! 2/ω for β = 0, and 1/(βω²), about Δφ²/(4βa), where β is large or the grid is fine.
//!
//! **Reaction.** A node in contact has U = δ and U̇ = 0, and needs the reaction P = gδ − D∂V̂ − b∂²Û for it. The
//! last term is what neighbours in the air exert. Towards a landing it is concentrated, and together
//! with the velocity that the node loses by Newton's law without restitution it amounts to
//!
//! ```text
//! Δφ Σ P Δt → m_b|U̇⁻|, m_b = 1 − b/c²  (β = 0),      (βb/c²)Ü⁻  (β > 0)
//! ```
//!
//! for a front of speed c that nobody has to know: half of b/c² has slowed the node down before it
//! landed, half pulls at it until the next one lands. Friction may take f times as much, and the waves
//! of V make m_a[V̇] of it. As β and Δφ fall in whatever order, the law of the landing is that of Coulomb.
//!
//! The pull of a falling neighbour must not throw a landed node up again, and friction must last until
//! the neighbours that lag behind have landed as well: a node that is held at V̇ = 1 for one step only is torn
//! off it. So what is concentrated is handed out evenly over the time Δφ/√a from landing on, longer than
//! any front that is faster than these waves takes to the next node. It is an error of the first order
//! in Δφ. From then on b∂²Û acts at once: without it, nodes before a take-off would not know that the
//! pressure is to vanish.
//!
//! Instants within a step are those of [`super::kernel`] and [`super::friction`].

/// What is handed out in a step of an impulse that has been handed out for `age` steps of `window`; the
/// node is touched for the part `touched` of its first step, 1 in all others.
#[inline(always)]
pub(super) fn release(window: f64, impulse: f64, age: f64, touched: f64) -> f64 {
    let left = window - age;
    if left > touched {
        impulse * (touched / left)
    } else {
        impulse
    }
}
