//! Flow in contact: slip and reverse slip, closed form.
//!
//! With y = V − σfgδ/h the equation is m_a ÿ − sẏ + hy = 0, s = σfκ − α. Put p = s/(2m_a),
//! q = h/m_a, Δ = p² − q; then (y, W) moves by
//!
//! ```text
//! exp(At) = e^{pt} [ C − pS    S     ]     C = cosh(√Δ t),   S = sinh(√Δ t)/√Δ,
//!                  [  −qS    C + pS  ]
//! ```
//!
//! both entire in Δ: a power series serves through critical damping Δ = 0, circular functions
//! below it, and two separate exponentials above it, where C − pS would cancel.

use std::f64::consts::PI;

use super::jet::{DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, MultiDual};
use super::{FlowError, Frame};

/// Up to this |Δ|t² the series of C, S and ∂S/∂Δ are used. Their terms fall faster than
/// 1/(2j+1)!, so [`SERIES_TERMS`] terms reach rounding; beyond it ∂S/∂Δ = (tC − S)/(2Δ) loses at
/// most a digit, in a derivative only.
const SERIES_LIMIT: f64 = 1.0;
const SERIES_TERMS: usize = 10;

/// A zone with more zeros than this is no zone of a wave of interest; the list stays short.
const MOST_ZEROS: f64 = 1e5;

/// The equation of one sliding direction in one frame.
#[derive(Clone, Copy, Debug)]
pub struct ContactFlow {
    /// p = (σfκ − α)/(2m_a): half the growth rate of W.
    pub p: f64,
    /// q = h/m_a: square of the frequency.
    pub q: f64,
    /// y − Y: 0 for slip, 2fgδ/h for reverse slip.
    pub shift: Jet,
    p_by: [f64; 2],
    q_by: [f64; 2],
}

/// exp(At) with the pieces from which its derivatives are made.
#[derive(Clone, Copy, Debug)]
struct ContactExponential {
    matrix: [[f64; 2]; 2],
    /// e^{pt}S.
    s: f64,
    /// e^{pt}∂C/∂Δ = e^{pt}tS/2.
    c_by: f64,
    /// e^{pt}∂S/∂Δ.
    s_by: f64,
}

impl ContactFlow {
    /// The equation for σ = +1 (slip) or −1 (reverse slip).
    pub(crate) fn new(frame: &Frame, sliding: f64) -> ContactFlow {
        let [f, kappa] = [frame.number(|of| of.friction), frame.number(|of| of.kappa)];
        let s = f * kappa * sliding - frame.number(|of| of.damping);
        ContactFlow::of(frame, sliding, frame.number(|of| of.ma), s)
    }

    /// The equation mÿ − sẏ + hy = 0.
    pub(super) fn of(frame: &Frame, sliding: f64, m: MultiDual<2>, s: MultiDual<2>) -> ContactFlow {
        let (p, q) = (s * 0.5 / m, frame.number(|of| of.h) / m);
        ContactFlow {
            p: p.value,
            q: q.value,
            shift: if sliding < 0.0 {
                frame.steady() * 2.0
            } else {
                Jet::default()
            },
            p_by: p.by,
            q_by: q.by,
        }
    }

    /// 2p and q as jets of the frame.
    pub(super) fn coefficients(&self) -> [Jet; 2] {
        let jet = |value: f64, by: [f64; 2]| Jet::lifted(MultiDual { value, by });
        [jet(self.p, self.p_by) * 2.0, jet(self.q, self.q_by)]
    }

    /// (x, ẋ) after a time t of a solution of ẍ − 2pẋ + qx = 0.
    pub(super) fn solution(&self, [value, slope]: [f64; 2], t: f64) -> [f64; 2] {
        let [[m00, m01], [m10, m11]] = self.propagator(t).matrix;
        [m00 * value + m01 * slope, m10 * value + m11 * slope]
    }

    fn propagator(&self, t: f64) -> ContactExponential {
        let (p, q) = (self.p, self.q);
        let delta = p * p - q;
        let argument = delta * t * t;
        if argument > SERIES_LIMIT {
            // r1 is the root of larger modulus: r2 = q/r1 does not cancel
            let half = delta.sqrt();
            let r1 = p + half.copysign(p);
            let r2 = q / r1;
            let (e1, e2) = ((r1 * t).exp(), (r2 * t).exp());
            let s = e2 * ((r1 - r2) * t).exp_m1() / (r1 - r2);
            let c = 0.5 * (e1 + e2);
            return ContactExponential {
                matrix: [[e2 - r2 * s, s], [-q * s, e2 + r1 * s]],
                s,
                c_by: 0.5 * t * s,
                s_by: 0.5 * (t * c - s) / delta,
            };
        }
        let growth = (p * t).exp();
        let (c, s, s_by);
        if argument.abs() <= SERIES_LIMIT {
            // C = Σ x^j/(2j)!, S = tΣ x^j/(2j+1)!, ∂S/∂Δ = t³Σ (j+1)x^j/(2j+3)!,  x = Δt²
            let (mut even, mut odd, mut slope) = (0.0, 0.0, 0.0);
            for j in (0..SERIES_TERMS).rev() {
                let n = 2.0 * j as f64;
                even = 1.0 + even * argument / ((n + 1.0) * (n + 2.0));
                odd = 1.0 + odd * argument / ((n + 2.0) * (n + 3.0));
                // ratio of terms j+1 and j: (j+2)/(j+1)/((2j+4)(2j+5)) = 1/(2(j+1)(2j+5))
                slope = 1.0 + slope * argument / ((n + 2.0) * (n + 5.0));
            }
            c = even;
            s = odd * t;
            s_by = slope * t * t * t / 6.0;
        } else {
            let frequency = (-delta).sqrt();
            let (sine, cosine) = (frequency * t).sin_cos();
            c = cosine;
            s = sine / frequency;
            s_by = 0.5 * (t * c - s) / delta;
        }
        ContactExponential {
            matrix: [
                [growth * (c - p * s), growth * s],
                [-q * growth * s, growth * (c + p * s)],
            ],
            s: growth * s,
            c_by: 0.5 * growth * t * s,
            s_by: growth * s_by,
        }
    }

    /// Sizes of the terms of which (Y, W) after a time t is the sum: where they are much larger than that its digits are lost, as
    /// where an entry lies on the slower of two growing motions but for rounding and the faster one comes to tell.
    pub fn terms(&self, entry: [f64; 2], t: f64) -> [f64; 2] {
        let [y, w] = [entry[0] + self.shift.value, entry[1]];
        let size = |[of_y, of_w]: [f64; 2]| (of_y * y).abs() + (of_w * w).abs();
        self.propagator(t).matrix.map(size)
    }

    /// (Y, W) after a time t from the entry (Y, W), without derivatives.
    pub fn state(&self, entry: [f64; 2], t: f64) -> [f64; 2] {
        let [[m00, m01], [m10, m11]] = self.propagator(t).matrix;
        let y = entry[0] + self.shift.value;
        [
            m00 * y + m01 * entry[1] - self.shift.value,
            m10 * y + m11 * entry[1],
        ]
    }

    /// Ẇ = V̈ at a state: 2pW − qy.
    pub fn acceleration(&self, state: [f64; 2]) -> f64 {
        2.0 * self.p * state[1] - self.q * (state[0] + self.shift.value)
    }

    /// Times in (0, duration) at which a solution x of ẍ − 2pẋ + qx = 0 with x(0) = `value`,
    /// ẋ(0) = `slope` vanishes, in order: y, W and V̈ are such solutions.
    ///
    /// x = e^{pt}[C x₀ + S(ẋ₀ − px₀)] is zero where S/C = −x₀/(ẋ₀ − px₀).
    pub fn zeros(&self, value: f64, slope: f64, duration: f64) -> Vec<f64> {
        let mut times = Vec::new();
        let delta = self.p * self.p - self.q;
        let ratio = -value / (slope - self.p * value);
        if delta >= 0.0 {
            let root = delta.sqrt();
            let argument = root * ratio;
            let time = if argument.abs() < 1e-8 {
                ratio
            } else if argument.abs() < 1.0 {
                argument.atanh() / root
            } else {
                return times;
            };
            if time > 0.0 && time < duration {
                times.push(time);
            }
            return times;
        }
        let frequency = (-delta).sqrt();
        let period = PI / frequency;
        let first = (frequency * ratio).atan() / frequency;
        if !(first.is_finite() && duration / period < MOST_ZEROS) {
            return times;
        }
        let mut time = if first > 0.0 { first } else { first + period };
        while time < duration {
            times.push(time);
            time += period;
        }
        times
    }

    /// (Y, W) after a time t from the entry (Y, W), with all derivatives.
    pub(crate) fn advance(&self, entry: [f64; 2], t: f64) -> Result<[Jet; 2], FlowError> {
        let propagator = self.propagator(t);
        let [[m00, m01], [m10, m11]] = propagator.matrix;
        let (p, q) = (self.p, self.q);
        let (y0, w0) = (entry[0] + self.shift.value, entry[1]);
        let y = m00 * y0 + m01 * w0;
        let w = m10 * y0 + m11 * w0;
        if !(y.is_finite() && w.is_finite()) {
            return Err(FlowError::Overflow { duration: t });
        }
        let mut y_jet = Jet {
            value: y - self.shift.value,
            by: [m00, m01, w, 0.0, 0.0, 0.0, 0.0],
        };
        let mut w_jet = Jet {
            value: w,
            by: [m10, m11, 2.0 * p * w - q * y, 0.0, 0.0, 0.0, 0.0],
        };
        for index in 0..2 {
            let (p_by, q_by) = (self.p_by[index], self.q_by[index]);
            let delta_by = 2.0 * p * p_by - q_by;
            let c_by = propagator.c_by * delta_by;
            let s_by = propagator.s_by * delta_by;
            let d00 = t * p_by * m00 + c_by - p * s_by - p_by * propagator.s;
            let d01 = t * p_by * m01 + s_by;
            let d10 = t * p_by * m10 - q * s_by - q_by * propagator.s;
            let d11 = t * p_by * m11 + c_by + p * s_by + p_by * propagator.s;
            let shift_by = self.shift.by[EXCESS + index];
            y_jet.by[EXCESS + index] = d00 * y0 + d01 * w0 + (m00 - 1.0) * shift_by;
            w_jet.by[EXCESS + index] = d10 * y0 + d11 * w0 + m10 * shift_by;
        }
        Ok([y_jet, w_jet])
    }

    /// (W(t) − 1)/t^m for an entry with W = 1 (m = 1) or W = 1 and V̈ = 0 (m = 2).
    ///
    /// For short zones the quotient comes from the power series of W with its first m terms left
    /// out, so that it is exact down to t = 0 and beyond: a zone that vanishes is a regular point.
    pub(crate) fn reduced_rate(&self, entry: [f64; 2], t: f64, m: usize, w_end: Jet) -> Jet {
        let (p, q) = (self.p, self.q);
        if (q.sqrt() + 2.0 * p.abs()) * t.abs() > SHORT_ZONE {
            let factor = t.powi(-(m as i32));
            let mut jet = w_end * factor - factor;
            jet.by[DURATION] -= m as f64 * jet.value / t;
            return jet;
        }
        // derivatives of W at the entry by W⁽ʲ⁺¹⁾ = 2pW⁽ʲ⁾ − qW⁽ʲ⁻¹⁾, starting from Ẏ = W
        let y = Jet::variable(entry[0], ENTRY_Y) + self.shift;
        let w = Jet::variable(entry[1], ENTRY_W);
        let [p_jet, q_jet] = self.coefficients();
        let (mut before, mut current) = (y, w);
        let mut sum = Jet::default();
        // t^{j−m}/j! of the term j, and its derivative in t
        let mut weight = 1.0;
        let mut factorial = 1.0;
        for j in 0..SHORT_TERMS {
            if j > 0 {
                factorial *= j as f64;
            }
            if j >= m {
                let scale = weight / factorial;
                sum = sum + current * scale;
                if j > m {
                    // weight is t^{j−m}; its derivative is (j−m)t^{j−m−1}
                    let slope = (j - m) as f64 * t.powi((j - m) as i32 - 1) / factorial;
                    sum.by[DURATION] += slope * current.value;
                }
                weight *= t;
            }
            let next = p_jet * current - q_jet * before;
            before = current;
            current = next;
        }
        sum
    }
}

/// Zones shorter than this many radians (norm of A times duration) use the power series;
/// [`SHORT_TERMS`] terms of it leave 1/20! ≈ 4e-19.
pub(super) const SHORT_ZONE: f64 = 1.0;
pub(super) const SHORT_TERMS: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::model::Constants;
    use crate::tube::model::coefficients::{Coefficients, Geometry};

    fn flow(friction: f64, damping: f64, excess: f64, sliding: f64) -> ContactFlow {
        let parameters = Constants {
            coefficients: Geometry {
                nu: 0.3,
                xi: 1.5,
                gamma: 1.0,
            }
            .coefficients(),
            friction,
            mismatch: 0.1,
            mass_damping: damping,
            ..Constants::default()
        };
        let derivative = Constants {
            coefficients: Coefficients::default(),
            mismatch: 1.0,
            ..Constants::default()
        };
        ContactFlow::new(
            &Frame::new(&parameters, &derivative, excess).unwrap(),
            sliding,
        )
    }

    /// Semigroup: two halves equal the whole, through every branch of the closed form.
    #[test]
    fn flow_is_a_semigroup() {
        for (friction, excess) in [(0.5, 0.19), (0.5, 1.2e-3), (3.0, 0.0165), (12.0, 0.15)] {
            for sliding in [1.0, -1.0] {
                let flow = flow(friction, 0.0, excess, sliding);
                for t in [1e-9, 1e-3, 0.1, 0.3, 1.0] {
                    let entry = [0.03, -0.4];
                    let whole = flow.state(entry, t);
                    let halves = flow.state(flow.state(entry, 0.37 * t), 0.63 * t);
                    let size = whole[1].abs() + flow.q.sqrt() * (whole[0] + flow.shift.value).abs();
                    // rounding of the argument, amplified by the rates of the flow
                    let allowed = 1e-15 * (4.0 + (flow.p.abs() + flow.q.sqrt()) * t) * 4.0;
                    assert!((whole[1] - halves[1]).abs() < allowed * size);
                    assert!(
                        (whole[0] - halves[0]).abs() * flow.q.sqrt()
                            < allowed * (size + flow.q.sqrt() * entry[0].abs())
                    );
                }
            }
        }
    }

    /// The reduced rate is continuous where the series takes over, and equals the plain quotient.
    #[test]
    fn reduced_rate_has_one_value() {
        let flow = flow(0.5, 0.0, 0.1916, -1.0);
        let entry = [-0.12, 1.0];
        let t = SHORT_ZONE / (flow.q.sqrt() + 2.0 * flow.p.abs());
        for m in [1, 2] {
            let jets: Vec<Jet> = [t * (1.0 - 1e-12), t * (1.0 + 1e-12)]
                .into_iter()
                .map(|t| {
                    let end = flow.advance(entry, t).unwrap()[1];
                    flow.reduced_rate(entry, t, m, end)
                })
                .collect();
            let scale = t.powi(1 - m as i32) * flow.acceleration(entry).abs();
            // with m = 2 the entry above does not satisfy V̈ = 0: the dropped term is V̈ t^{1−m}
            let dropped = if m == 2 {
                flow.acceleration(entry) / t
            } else {
                0.0
            };
            assert!((jets[0].value + dropped - jets[1].value).abs() < 1e-10 * scale);
        }
    }
}
