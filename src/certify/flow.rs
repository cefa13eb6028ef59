//! The flow of a regime as a power series in time, with its remainder.
//!
//! Every regime is linear with constant coefficients, ẋ = Ax + r, in x = (Y, W, U − δ, U̇). The coefficients
//! of x(t) = Σ c_j tʲ follow from c_{j+1} = Ac_j/(j + 1), and in any norm
//!
//! ```text
//! Σ_{j>K} |c_j| tʲ ≤ |c_K| tᴷ · Θ/(K + 1) / (1 − Θ/(K + 2)),   Θ = |A| t.
//! ```
//!
//! A zone is cut into steps with Θ about 1, whose ends are unknowns of the system: nothing wraps.

use super::frame::IntervalFrame;
use crate::interval::{Gradient, Interval, Number};

/// Index of Y in a state.
pub const Y: usize = 0;
pub const W: usize = 1;
/// Index of U − δ.
pub const GAP: usize = 2;
/// Index of U̇.
pub const GAP_RATE: usize = 3;

/// Places of G and T among the slots of a step, where a zone that separates has U − δ and U̇.
pub const AMPLITUDE: usize = 2;
pub const WHOLE: usize = 3;
/// Places of V̈ and V⃛ in (Y, W, V̈, V⃛).
pub const ACCELERATION: usize = 2;
pub const JERK: usize = 3;

/// What can be proven positive.
pub trait Positive: Number {
    fn is_positive(&self) -> bool;
}

impl Positive for Interval {
    fn is_positive(&self) -> bool {
        Interval::is_positive(*self)
    }
}

/// A number along a piece of a branch, with its derivative away from an end of the piece at which it is not
/// negative: beyond that end it is positive where it is so all along, and where it grows all along.
impl Positive for Gradient<Interval, 1> {
    fn is_positive(&self) -> bool {
        self.value.is_positive() || self.by[0].is_positive()
    }
}

/// Degree K of the polynomial: 1/(K + 1)! = 4e-23, of second derivatives 2³² times as much.
pub const DEGREE: usize = 22;

/// Θ/(K + 1)/(1 − Θ/(K + 2)): what a series leaves out, by its last term.
pub fn geometric(theta: Interval) -> Interval {
    let k = DEGREE as f64;
    let rest = Interval::ONE - theta / Interval::point(k + 2.0);
    if rest.is_positive() {
        theta / (Interval::point(k + 1.0) * rest)
    } else {
        Interval::ENTIRE
    }
}

/// The equations of one regime.
#[derive(Clone, Copy, Debug)]
pub struct RegimeFlow<N> {
    /// ∂Ẇ/∂(Y, W, U̇) and ∂Ü/∂(W, U − δ, U̇); none in contact.
    tangential: [N; 3],
    radial: Option<[N; 3]>,
    /// What drives W and U̇.
    force: [N; 2],
    /// Weights of the norm max |wᵢxᵢ|: with √h, √m_a, √g, √m_b it is that of the energy.
    weights: [f64; 4],
    /// |A| in it.
    norm: f64,
}

impl<N: Number> RegimeFlow<N> {
    /// Slip (σ = 1) and reverse slip (σ = −1); with material damping what a layer leaves of it.
    pub fn contact(frame: &IntervalFrame<N>, sigma: f64) -> RegimeFlow<N> {
        let sign = Interval::point(sigma);
        let layered = frame
            .layers
            .map(|[slip, reverse]| if sigma < 0.0 { reverse } else { slip });
        let mass = layered.map_or(frame.ma, |layered| layered.mass).recip();
        // h(y − Y) = 2fgδ in reverse slip
        let shift = Interval::point(if sigma < 0.0 { -2.0 } else { 0.0 });
        let drive = (frame.friction * frame.weight).scaled(shift) * mass;
        let rate = match layered {
            Some(layered) => -layered.damping,
            None => (frame.friction * frame.kappa).scaled(sign) - frame.damping,
        };
        let zero = N::double(0.0);
        RegimeFlow::new(
            frame,
            [-frame.h * mass, rate * mass, zero],
            None,
            [drive, zero],
        )
    }

    pub fn separation(frame: &IntervalFrame<N>) -> RegimeFlow<N> {
        let (ma, mb) = (frame.ma.recip(), frame.mb.recip());
        let [g, h, kappa, damping] = [frame.g, frame.h, frame.kappa, frame.damping];
        RegimeFlow::new(
            frame,
            [-h * ma, -damping * ma, kappa * ma],
            Some([-kappa * mb, -g * mb, -damping * mb]),
            [-frame.friction * frame.weight * ma, -frame.weight * mb],
        )
    }

    fn new(
        frame: &IntervalFrame<N>,
        tangential: [N; 3],
        radial: Option<[N; 3]>,
        force: [N; 2],
    ) -> RegimeFlow<N> {
        let size = |x: &N| x.value().middle().abs().sqrt().max(f64::MIN_POSITIVE);
        let weights = [
            size(&frame.h),
            size(&frame.ma),
            size(&frame.g),
            size(&frame.mb),
        ];
        let by = |row: usize, entries: &[(f64, usize)]| {
            let terms = entries.iter().map(|(size, column)| {
                Interval::point(*size) * Interval::point(weights[row])
                    / Interval::point(weights[*column])
            });
            terms.fold(Interval::ZERO, |sum, term| sum + term).high
        };
        let [y, w, rate] = tangential.each_ref().map(N::norm);
        let mut norm = by(Y, &[(1.0, W)]).max(by(W, &[(y, Y), (w, W), (rate, GAP_RATE)]));
        if let Some(radial) = &radial {
            let [w, gap, rate] = radial.each_ref().map(N::norm);
            let row = by(GAP_RATE, &[(w, W), (gap, GAP), (rate, GAP_RATE)]);
            norm = norm.max(row).max(by(GAP, &[(1.0, GAP_RATE)]));
        }
        RegimeFlow {
            tangential,
            radial,
            force,
            weights,
            norm,
        }
    }

    /// |A|: about the radians of the regime per unit of time.
    pub fn norm(&self) -> f64 {
        self.norm
    }

    pub fn weights(&self) -> [f64; 4] {
        self.weights
    }

    /// Components of the state that move.
    pub fn dimension(&self) -> usize {
        if self.radial.is_some() { 4 } else { 2 }
    }

    /// Ax, and r with it where `forced`.
    pub fn derivative(&self, [y, w, gap, rate]: [N; 4], forced: bool) -> [N; 4] {
        let zero = N::double(0.0);
        let [by_y, by_w, by_rate] = self.tangential;
        let mut next = [w, by_y * y + by_w * w, zero, zero];
        if let Some([r_w, r_gap, r_rate]) = self.radial {
            next[W] = next[W] + by_rate * rate;
            next[GAP] = rate;
            next[GAP_RATE] = r_w * w + r_gap * gap + r_rate * rate + self.radial_force(forced);
        }
        if forced {
            next[W] = next[W] + self.force[0];
        }
        next
    }

    fn radial_force(&self, forced: bool) -> N {
        if forced {
            self.force[1]
        } else {
            N::double(0.0)
        }
    }

    /// The series from a state.
    pub fn series(&self, state: [N; 4]) -> IntervalSeries<N> {
        let mut coefficients = Vec::with_capacity(DEGREE + 1);
        let mut last = state;
        coefficients.push(last);
        for j in 0..DEGREE {
            let next = self.derivative(last, j == 0);
            let share = Interval::ONE / Interval::point((j + 1) as f64);
            last = next.map(|x| x.scaled(share));
            coefficients.push(last);
        }
        let weighted =
            |(x, weight): (&N, &f64)| (Interval::point(x.norm()) * Interval::point(*weight)).high;
        let size = last.iter().zip(&self.weights).map(weighted);
        IntervalSeries {
            size: size.fold(0.0, f64::max),
            coefficients,
            norm: self.norm,
            weights: self.weights,
        }
    }
}

/// A solution as a power series in time.
#[derive(Clone, Debug)]
pub struct IntervalSeries<N> {
    coefficients: Vec<[N; 4]>,
    /// |c_K|.
    size: f64,
    norm: f64,
    weights: [f64; 4],
}

impl<N: Number> IntervalSeries<N> {
    /// Bound of Σ_{j>K} c_j t^{j−m} over |t| ≤ `time`.
    fn rest(&self, component: usize, time: f64, m: usize) -> f64 {
        let t = Interval::point(time);
        let power = (0..DEGREE - m).fold(Interval::ONE, |power, _| power * t);
        let bound = Interval::point(self.size) * power * geometric(Interval::point(self.norm) * t)
            / Interval::point(self.weights[component]);
        bound.high
    }

    /// Σ_{j≥m} c_j t^{j−m}: the component over tᵐ where the first m coefficients vanish.
    pub fn at(&self, component: usize, time: N, m: usize) -> N {
        let sum = self.coefficients[m..]
            .iter()
            .rev()
            .fold(N::double(0.0), |sum, c| sum * time + c[component]);
        sum.widened(self.rest(component, time.norm(), m))
    }

    /// The derivative of [`IntervalSeries::at`] in time, over an interval.
    pub fn slope(&self, component: usize, time: N, m: usize) -> N {
        let terms = self.coefficients.iter().enumerate().skip(m + 1).rev();
        let sum = terms.fold(N::double(0.0), |sum, (j, c)| {
            sum * time + c[component].scaled(Interval::point((j - m) as f64))
        });
        // (j − m)tʲ ≤ (2t)ʲ
        let twice = Interval::point(2.0) * Interval::point(time.norm());
        let rest = self.rest(component, twice.high, m + 1) * 2.0_f64.powi(m as i32 + 1);
        sum.widened(rest)
    }

    /// The state at a time.
    pub fn state(&self, time: N) -> [N; 4] {
        [Y, W, GAP, GAP_RATE].map(|component| self.at(component, time, 0))
    }
}
