//! Coulomb friction of one node in one step.
//!
//! Between the half-steps n − ½ and n + ½ the node has the sliding velocity d = V̇ − 1 relative to the
//! shaft. Without friction it would change by `free`; full friction adds `most` ≥ 0 towards V̇ = 1
//! for slip (d < 0) and takes it away for reverse slip (d > 0).

/// A friction law, solved for the velocity after the step.
pub trait Friction: Copy + Send + Sync {
    /// d after the step, from d before it, the change `free` and the bound `most` of the change
    /// by friction; and what is to be added to ΔV/Δt.
    fn slide(self, d: f64, free: f64, most: f64) -> (f64, f64);
}

/// The set-valued law |Q| ≤ fP, Q(1 − V̇) = fP|1 − V̇|.
///
/// With constant forces within the step d moves by `free + most` per step in slip and by
/// `free − most` in reverse slip. If it reaches 0 within the step, the node sticks when the two
/// have different signs, for then some |Q| ≤ fP holds it; otherwise it goes on with the other sign
/// for the rest of the step. So the step is continuous in d and in the forces, and a perturbation of
/// the instant of crossing is passed on as the flow does it: nothing is left of it in stick, and
/// the ratio of the accelerations after slip turns into reverse slip.
///
/// Leapfrog adds Δt V̇ at the middle of a step to V. When the acceleration jumps from A₁ to A₂ after the
/// part ϑ of the step from n − ½ to n + ½, the true V differs from then on by ½(A₂ − A₁)(ϑ − ½)²Δt². Left
/// out, that would be roughness from node to node, which stick preserves and which in ∂²V is as
/// large on a fine grid as on a coarse one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb;

impl Friction for Coulomb {
    #[inline(always)]
    fn slide(self, d: f64, free: f64, most: f64) -> (f64, f64) {
        let (slip, reverse) = (free + most, free - most);
        let behind = d <= 0.0;
        // what carries the node towards V̇ = 1, and what would carry it beyond
        let (toward, beyond) = if behind {
            (slip, reverse)
        } else {
            (reverse, slip)
        };
        let reached = d + toward;
        let stays = if behind {
            reached <= 0.0
        } else {
            reached >= 0.0
        };
        let crosses = if behind { beyond > 0.0 } else { beyond < 0.0 };
        // the share of the step left after the crossing
        let left = reached / toward;
        let after = if crosses { beyond } else { 0.0 };
        let late = 0.5 - left;
        let kink = 0.5 * (after - toward) * late * late;
        // a node that was in stick has no kink behind it
        let kink = if stays | (d == 0.0) { 0.0 } else { kink };
        (if stays { reached } else { after * left }, kink)
    }
}

/// The smoothed law Q = fP tanh((1 − V̇)/ε).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Width ε > 0 of the transition, in units of ΩR.
    pub epsilon: f64,
}

/// Iterations of [`Smoothed`]; bisection alone reaches rounding in this many.
const ITERATIONS: usize = 60;

impl Friction for Smoothed {
    /// Solves d₁ = d + free − most·tanh(d₁/ε): the left side minus the right one grows with d₁, and its
    /// zero lies within ± most of d + free.
    #[inline(always)]
    fn slide(self, d: f64, free: f64, most: f64) -> (f64, f64) {
        let target = d + free;
        if most == 0.0 {
            return (target, 0.0);
        }
        let (mut low, mut high) = (target - most, target + most);
        let mut guess = d.clamp(low, high);
        for _ in 0..ITERATIONS {
            let tanh = (guess / self.epsilon).tanh();
            let value = guess - target + most * tanh;
            if value > 0.0 {
                high = guess;
            } else {
                low = guess;
            }
            let slope = 1.0 + most / self.epsilon * (1.0 - tanh * tanh);
            let newton = guess - value / slope;
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if next == guess {
                break;
            }
            guess = next;
        }
        (guess, 0.0)
    }
}
