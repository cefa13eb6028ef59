//! One step of every node with material damping β > 0, in contact.
//!
//! Stiffness acts on V̂ = V + βV̇. Leapfrog has V̇ half a step before and after the instant n, and
//! forces are due at n: the rate there is extrapolated from the two half-steps before,
//!
//! ```text
//! V̇ⁿ⁺½ = [(1 − αΔt/2) V̇ⁿ⁻½ + Δt (a∂²V̂ − hV̂ + Q)ⁿ] / (1 + αΔt/2),   P = gδ − D∂V̂ⁿ,
//! Vⁿ⁺¹ = Vⁿ + Δt V̇ⁿ⁺½,   V̂ⁿ⁺¹ = Vⁿ⁺¹ + β(3V̇ⁿ⁺½ − V̇ⁿ⁻½)/2,
//! ```
//!
//! of second order in Δt: V̇ has no jump of its slope here, for β > 0 makes V̈ continuous. A node keeps V̂
//! of the instant, which is all that its neighbours read, so that a step remains explicit and its reach
//! that of the differences.
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
//! **Contact.** What happens at take-off and landing with β > 0 is another matter (U̇ must not jump along
//! the surface, and the reaction gets a concentrated part). A node at which the pressure falls
//! below zero is marked as in the air and stays so, for [`super::Ring::in_contact`] to see.
//!
//! Crossings of V̇ = 1 within a step are those of [`super::friction`].

use super::friction::Friction;
use super::kernel::{Nodes, StepConstants, windows};

/// Takes the nodes `from..to` of a stretch through one step. V̂ and V of the next instant go to
/// `next`; V̂ of the nodes within `R` of the range is read, and V if account is kept.
#[inline(always)]
pub(crate) fn step<const R: usize, const WATCHED: bool, F: Friction>(
    constants: &StepConstants,
    law: F,
    nodes: &mut Nodes,
    next: (&mut [f64], &mut [f64]),
    from: usize,
    to: usize,
) {
    let c = *constants;
    let count = to - from;
    let hat = windows::<R>(&nodes.effective, from, to);
    let v = windows::<R>(&nodes.tangential, from, to);
    let tangential_rate = &mut nodes.tangential_rate[from..to];
    let share = &mut nodes.share[from..to];
    let effective_next = &mut next.0[from..to];
    let tangential_next = &mut next.1[from..to];
    let (friction_work, damping_work) = if WATCHED {
        (
            &mut nodes.friction_work[from..to],
            &mut nodes.damping_work[from..to],
        )
    } else {
        (&mut [][..], &mut [][..])
    };
    for i in 0..count {
        let mut bend = c.a[0] * hat[R][i];
        let mut slope = 0.0;
        for k in 1..=R {
            let (left, right) = (hat[R - k][i], hat[R + k][i]);
            bend += c.a[k] * (left + right);
            slope += c.coupling[k - 1] * (right - left);
        }
        let force = bend - c.h * hat[R][i];
        let pressure = c.rest - slope;
        let holds = (share[i] != 0.0) & (pressure >= 0.0);
        share[i] = if holds { 1.0 } else { 0.0 };

        let old = tangential_rate[i];
        let change = c.gain * (c.keep * old + c.kick * force) - old;
        let most = if holds {
            c.gain * c.kick * c.friction * pressure
        } else {
            0.0
        };
        let (slid, kink) = law.slide(old - 1.0, change, most);
        let new = 1.0 + slid;
        let moved = v[R][i] + c.dt * (new + kink);
        tangential_rate[i] = new;
        tangential_next[i] = moved;
        effective_next[i] = moved + c.material * (1.5 * new - 0.5 * old);

        if WATCHED {
            // forces are what is missing between the velocity without and with them
            let mean = 0.5 * (old + new);
            let mut elastic = (c.a[0] - c.h) * v[R][i];
            for k in 1..=R {
                elastic += c.a[k] * (v[R - k][i] + v[R + k][i]);
            }
            // moving the node by what is bent does work against the elastic force
            friction_work[i] += (new - old - change) / c.gain * mean - c.dt * kink * elastic;
            // αΔt = 1/gain − keep
            let alpha = 1.0 / c.gain - c.keep;
            damping_work[i] += (c.kick * (force - elastic) - alpha * mean) * mean;
        }
    }
}
