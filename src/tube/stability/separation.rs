//! The perturbation of a separation zone.
//!
//! ```text
//! P_b(d)u + κ(d − λ)η = 0,   P_a(d)η − κ(d − λ)u = 0,   d = d/ds,
//! P_a(r) = m_a r² + (2ãλ + α)r + h − ãλ²,   P_b(r) = m_b r² + (2b̃λ + α)r + g − b̃λ²
//! ```
//!
//! have constant coefficients. Their Laplace transform, with σ = r − λ and the initial data in
//!
//! ```text
//! ρ_u = (m_b r + 2b̃λ + α)u₀ + m_b u₀′ + κη₀,   ρ_η = (m_a r + 2ãλ + α)η₀ + m_a η₀′ − κu₀,
//! ```
//!
//! has its poles at the four roots of χ(r) = P_a P_b + κ²σ², so that
//!
//! ```text
//! u(s) = Σ (P_a ρ_u − κσρ_η)e^{rs}/χ′(r),   η(s) = Σ (κσρ_u + P_b ρ_η)e^{rs}/χ′(r).
//! ```
//!
//! Where the zone is short against every exponent these terms cancel, u being of order s³ after a
//! take-off, and the power series in s is summed. Where they cancel for another reason, as two
//! roots come together, the answer is the matrix exponential.

use nalgebra::{Matrix4, Vector4};

use super::perturbation::{Characteristic, PerturbationColumns, square_root};
use super::{C64, ONE, ZERO};
use crate::tube::flow::exponential::MatrixJet;

/// Up to this bound of |r s| the power series is summed; beyond it, u of order (rs)³/6 is no
/// longer a small difference of the residues.
const SHORT: f64 = 2.0;

/// The first omitted term of the series is below this fraction of u, which is of order (rs)³/6.
const SERIES_ERROR: f64 = 1e-19;

/// Most steps of the root search: a handful is needed, unless roots come together.
const MOST_STEPS: usize = 20;

/// The search ends with a step below this, relative to |r| + 1/s; it converges like a cube, and
/// the residues themselves hold one correction more.
const LAST_STEP: f64 = 1e-6;

/// Largest correction that the residues leave, relative to |r| + 1/s.
const ROOT_ERROR: f64 = 1e-11;

/// Largest cancellation allowed in a sum of residues: it costs as many units of rounding.
const CANCELLATION: f64 = 30.0;

/// P(r) = m r² + p₁r + p₀ and its derivatives in r and λ.
#[derive(Clone, Copy)]
struct Oscillator {
    m: f64,
    p1: C64,
    p0: C64,
    /// ∂p₁/∂λ = 2ã; ∂P/∂λ = 2ãσ.
    p1_by: f64,
}

impl Oscillator {
    fn new(m: f64, a: f64, damping: f64, stiffness: f64, lambda: C64) -> Oscillator {
        Oscillator {
            m,
            p1: lambda * (2.0 * a) + damping,
            p0: C64::from(stiffness) - lambda * lambda * a,
            p1_by: 2.0 * a,
        }
    }

    /// P and ∂P/∂r.
    fn at(&self, r: C64) -> (C64, C64) {
        let linear = r * self.m + self.p1;
        (r * linear + self.p0, linear + r * self.m)
    }

    /// Both roots, the larger one first, from p₁² − 4mp₀ without what cancels as m → 0, ã + m = 1.
    fn roots(&self, damping: f64, stiffness: f64, lambda: C64) -> [C64; 2] {
        let delta = lambda * (lambda + damping) * (2.0 * self.p1_by)
            + (damping * damping - 4.0 * self.m * stiffness);
        let root = square_root(delta);
        let aligned = self.p1.re * root.re + self.p1.im * root.im >= 0.0;
        let sum = if aligned {
            self.p1 + root
        } else {
            self.p1 - root
        };
        [sum * (-0.5 / self.m), self.p0 * (-2.0) / sum]
    }
}

/// One term of the sum of residues, e^{−exponent} taken out.
#[derive(Clone, Copy)]
struct Residue {
    r: C64,
    r_by: C64,
    /// e^{rs}/χ′ and its logarithmic derivative in λ.
    weight: C64,
    weight_by: C64,
    /// P_a, P_b, κσ.
    pa: C64,
    pb: C64,
    coupling: C64,
    pa_by: C64,
    pb_by: C64,
    coupling_by: C64,
}

impl Characteristic {
    /// Carries `count` perturbations through the time s of a separation zone.
    pub(super) fn separated(
        &self,
        lambda: C64,
        s: f64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        if s == 0.0 {
            return;
        }
        let a = Oscillator::new(self.ma, self.a, self.damping, self.h, lambda);
        let b = Oscillator::new(self.mb, self.b, self.damping, self.g, lambda);
        let starts = [
            a.roots(self.damping, self.h, lambda),
            b.roots(self.damping, self.g, lambda),
        ];
        let largest = starts
            .iter()
            .map(|pair| pair[0].norm_sqr())
            .fold(0.0, f64::max);
        let reach = s.abs() * (largest.sqrt() + self.kappa.abs() / (self.ma * self.mb).sqrt());
        if reach <= SHORT {
            self.series(&a, &b, lambda, s, reach, state, count);
            return;
        }
        let [[r1, r2], [r3, r4]] = starts;
        if let Some((residues, exponent)) = self.residues(&a, &b, lambda, s, [r1, r2, r3, r4])
            && self.sum(&a, &b, &residues, state, count)
        {
            state.exponent += exponent;
            return;
        }
        let transfer = self.matrix(lambda, s);
        for column in 0..count {
            state.by[column] =
                transfer.at * state.by[column] + transfer.by[0] * state.columns[column];
            state.columns[column] = transfer.at * state.columns[column];
        }
        state.exponent += transfer.exponent;
    }

    /// The power series in s.
    #[allow(clippy::too_many_arguments)]
    fn series(
        &self,
        a: &Oscillator,
        b: &Oscillator,
        lambda: C64,
        s: f64,
        reach: f64,
        state: &mut PerturbationColumns,
        count: usize,
    ) {
        let mut terms = 4;
        let mut last = reach / 24.0;
        while last > SERIES_ERROR {
            terms += 1;
            last *= reach / terms as f64;
        }
        // by the factors of s and of the mass at once
        let (sb, sa) = (-s / self.mb, -s / self.ma);
        let (b1, b0) = (b.p1 * sb, b.p0 * (sb * s));
        let (a1, a0) = (a.p1 * sa, a.p0 * (sa * s));
        let (b1_by, b0_by) = (b.p1_by * sb, lambda * (-b.p1_by * sb * s));
        let (a1_by, a0_by) = (a.p1_by * sa, lambda * (-a.p1_by * sa * s));
        let (kb, ka) = (self.kappa * sb, self.kappa * sa);
        let (lb, la) = (lambda * (kb * s), lambda * (ka * s));
        let (kb_s, ka_s) = (kb * s, ka * s);
        for column in 0..count {
            let [u, u_rate, y, y_rate] = state.columns[column].data.0[0];
            let [u_by, u_rate_by, y_by, y_rate_by] = state.by[column].data.0[0];
            // terms n and n + 1 of u, η, and their derivatives
            let mut one = [u, y, u_by, y_by];
            let mut two = [u_rate * s, y_rate * s, u_rate_by * s, y_rate_by * s];
            let mut sum = [0, 1, 2, 3].map(|i| one[i] + two[i]);
            let mut rate = two;
            for n in 0..terms {
                let n = n as f64;
                let first = 1.0 / (n + 2.0);
                let second = first / (n + 1.0);
                let [x0, y0, dx0, dy0] = one;
                let [x1, y1, dx1, dy1] = two;
                let next = [
                    (b1 * x1 + y1 * kb) * first + (b0 * x0 - lb * y0) * second,
                    (a1 * y1 - x1 * ka) * first + (a0 * y0 + la * x0) * second,
                    (b1 * dx1 + x1 * b1_by + dy1 * kb) * first
                        + (b0 * dx0 + b0_by * x0 - lb * dy0 - y0 * kb_s) * second,
                    (a1 * dy1 + y1 * a1_by - dx1 * ka) * first
                        + (a0 * dy0 + a0_by * y0 + la * dx0 + x0 * ka_s) * second,
                ];
                for i in 0..4 {
                    sum[i] += next[i];
                    rate[i] += next[i] * (n + 2.0);
                }
                one = two;
                two = next;
            }
            let rate = rate.map(|x| x / s);
            state.columns[column] = Vector4::new(sum[0], rate[0], sum[1], rate[1]);
            state.by[column] = Vector4::new(sum[2], rate[2], sum[3], rate[3]);
        }
    }

    /// The roots of χ by the method of Aberth and Ehrlich from those without coupling, and what
    /// the residues there are made of; `None` where the roots are not found.
    fn residues(
        &self,
        a: &Oscillator,
        b: &Oscillator,
        lambda: C64,
        s: f64,
        roots: [C64; 4],
    ) -> Option<([Residue; 4], f64)> {
        let square = self.kappa * self.kappa;
        let least = 1.0 / (s * s);
        let roots = self.roots([a, b], lambda, least, roots)?;
        let exponent = roots
            .iter()
            .map(|r| r.re * s)
            .fold(f64::NEG_INFINITY, f64::max);
        let mut credible = true;
        let residues = roots.map(|r| {
            let sigma = r - lambda;
            let (pa, pa_r) = a.at(r);
            let (pb, pb_r) = b.at(r);
            let turned = sigma * square;
            let value = pa * pb + turned * sigma;
            let slope = pa_r * pb + pa * pb_r + turned * 2.0;
            let inverse = slope.inv();
            let correction = value * inverse;
            credible &= inverse.is_finite()
                && correction.norm_sqr() <= ROOT_ERROR * ROOT_ERROR * (r.norm_sqr() + least);
            // ∂P/∂λ at constant r, and that of χ
            let (pa_l, pb_l) = (sigma * a.p1_by, sigma * b.p1_by);
            let r_by = -(pa_l * pb + pa * pb_l - turned * 2.0) * inverse;
            let slope_by = pb * a.p1_by + pa_r * pb_l + pa_l * pb_r + pa * b.p1_by - 2.0 * square
                + (pb * (2.0 * a.m) + pa_r * pb_r * 2.0 + pa * (2.0 * b.m) + 2.0 * square) * r_by;
            Residue {
                r,
                r_by,
                weight: ((r - correction) * s - exponent).exp() * inverse,
                weight_by: r_by * s - slope_by * inverse,
                pa,
                pb,
                coupling: sigma * self.kappa,
                pa_by: pa_l + pa_r * r_by,
                pb_by: pb_l + pb_r * r_by,
                coupling_by: (r_by - 1.0) * self.kappa,
            }
        });
        credible.then_some((residues, exponent))
    }

    /// The roots of χ by the method of Aberth and Ehrlich, from those without coupling.
    fn roots(
        &self,
        [a, b]: [&Oscillator; 2],
        lambda: C64,
        least: f64,
        mut roots: [C64; 4],
    ) -> Option<[C64; 4]> {
        let square = self.kappa * self.kappa;
        let mut found = false;
        for _ in 0..MOST_STEPS {
            found = true;
            for index in 0..4 {
                let r = roots[index];
                let (pa, pa_r) = a.at(r);
                let (pb, pb_r) = b.at(r);
                let turned = (r - lambda) * square;
                let value = pa * pb + turned * (r - lambda);
                let slope = pa_r * pb + pa * pb_r + turned * 2.0;
                let [x, y, z] = [1, 2, 3].map(|shift| r - roots[(index + shift) % 4]);
                // Newton's step N over 1 − N Σ 1/(r − r_k), with one division
                let (xy, product) = (x * y, x * y * z);
                let repelled = slope * product - value * (xy + (x + y) * z);
                let step = value * product / repelled;
                let size = step.norm_sqr();
                if !size.is_finite() {
                    return None;
                }
                roots[index] = r - step;
                found &= size <= LAST_STEP * LAST_STEP * (r.norm_sqr() + least);
            }
            if found {
                break;
            }
        }
        if !found {
            return None;
        }
        Some(roots)
    }

    /// Sums the residues of the perturbations; false, and nothing is done, where they cancel.
    fn sum(
        &self,
        a: &Oscillator,
        b: &Oscillator,
        residues: &[Residue; 4],
        state: &mut PerturbationColumns,
        count: usize,
    ) -> bool {
        let mut columns = [[ZERO; 4]; 2];
        let mut by = [[ZERO; 4]; 2];
        for column in 0..count {
            let [u, u_rate, y, y_rate] = state.columns[column].data.0[0];
            let [u_by, u_rate_by, y_by, y_rate_by] = state.by[column].data.0[0];
            // what does not depend on the root
            let fixed = b.p1 * u + u_rate * self.mb + y * self.kappa;
            let fixed_by = b.p1 * u_by + u * b.p1_by + u_rate_by * self.mb + y_by * self.kappa;
            let bound = a.p1 * y + y_rate * self.ma - u * self.kappa;
            let bound_by = a.p1 * y_by + y * a.p1_by + y_rate_by * self.ma - u_by * self.kappa;
            let (mut sizes, mut sum, mut sum_by) = ([0.0; 4], [ZERO; 4], [ZERO; 4]);
            for residue in residues {
                let Residue { r, r_by, .. } = *residue;
                let normal = r * u * self.mb + fixed;
                let normal_by = (r_by * u + r * u_by) * self.mb + fixed_by;
                let shear = r * y * self.ma + bound;
                let shear_by = (r_by * y + r * y_by) * self.ma + bound_by;
                let gap = residue.pa * normal - residue.coupling * shear;
                let gap_by = residue.pa_by * normal + residue.pa * normal_by
                    - residue.coupling_by * shear
                    - residue.coupling * shear_by
                    + gap * residue.weight_by;
                let slide = residue.coupling * normal + residue.pb * shear;
                let slide_by = residue.coupling_by * normal
                    + residue.coupling * normal_by
                    + residue.pb_by * shear
                    + residue.pb * shear_by
                    + slide * residue.weight_by;
                let (gap, gap_by) = (gap * residue.weight, gap_by * residue.weight);
                let (slide, slide_by) = (slide * residue.weight, slide_by * residue.weight);
                let values = [gap, r * gap, slide, r * slide];
                let slopes = [
                    gap_by,
                    r * gap_by + r_by * gap,
                    slide_by,
                    r * slide_by + r_by * slide,
                ];
                for i in 0..4 {
                    sizes[i] += values[i].norm_sqr();
                    sum[i] += values[i];
                    sum_by[i] += slopes[i];
                }
            }
            let cancels = |i: usize| {
                // not-a-number as well
                let kept = sizes[i] <= CANCELLATION * CANCELLATION * sum[i].norm_sqr();
                !kept
            };
            if (0..4).any(cancels) {
                return false;
            }
            columns[column] = sum;
            by[column] = sum_by;
        }
        for column in 0..count {
            state.columns[column] = Vector4::from(columns[column]);
            state.by[column] = Vector4::from(by[column]);
        }
        true
    }

    /// exp(As) of a separation zone on (u, u′, η, η′).
    fn matrix(&self, lambda: C64, s: f64) -> MatrixJet<C64, 1> {
        let square = lambda * lambda;
        let (mb, ma) = (1.0 / self.mb, 1.0 / self.ma);
        let (ub, ua) = (
            -(lambda * (2.0 * self.b) + self.damping) * mb,
            -(lambda * (2.0 * self.a) + self.damping) * ma,
        );
        let kb = self.kappa * mb;
        let ka = self.kappa * ma;
        // half of the trace of each oscillator, averaged: what is left has small real parts
        let shift = (ub + ua) * 0.25;
        // scales that make the matrix nearly skew, at the frequency |λ|
        let size = lambda.norm_sqr();
        let scale = [
            (self.g + self.b * size).sqrt(),
            self.mb.sqrt(),
            (self.h + self.a * size).sqrt(),
            self.ma.sqrt(),
        ];
        let real = |x: f64| C64::new(x, 0.0);
        #[rustfmt::skip]
        let at = Matrix4::new(
            -shift, ONE, ZERO, ZERO,
            (square * self.b - self.g) * mb, ub - shift, lambda * kb, real(-kb),
            ZERO, ZERO, -shift, ONE,
            -lambda * ka, real(ka), (square * self.a - self.h) * ma, ua - shift,
        );
        let shift_by = real(-0.5 * (self.b * mb + self.a * ma));
        #[rustfmt::skip]
        let by = Matrix4::new(
            -shift_by, ZERO, ZERO, ZERO,
            lambda * (2.0 * self.b * mb), real(-2.0 * self.b * mb) - shift_by, real(kb), ZERO,
            ZERO, ZERO, -shift_by, ZERO,
            real(-ka), ZERO, lambda * (2.0 * self.a * ma), real(-2.0 * self.a * ma) - shift_by,
        );
        let weigh = |matrix: Matrix4<C64>, power: f64| {
            Matrix4::from_fn(|i, j| matrix[(i, j)] * (scale[i] / scale[j]).powf(power))
        };
        let (at, by) = (weigh(at, 1.0), weigh(by, 1.0));
        let norm = (0..4)
            .map(|j| at.column(j).iter().map(|x| x.norm()).sum::<f64>())
            .fold(0.0, f64::max)
            * s.abs();
        let halvings = if norm > 1.0 { norm.log2().ceil() } else { 0.0 };
        let generator = MatrixJet {
            at,
            by: [by],
            exponent: 0.0,
        };
        let short = generator.scaled(s * (-halvings).exp2());
        let transfer = short.exponential(halvings as u32);
        let turn = C64::from_polar(1.0, shift.im * s);
        let matrix = weigh(transfer.at, -1.0) * turn;
        MatrixJet {
            at: matrix,
            by: [weigh(transfer.by[0], -1.0) * turn + matrix * (shift_by * s)],
            exponent: transfer.exponent + shift.re * s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of a mode-4 wave, ν = 0.3, ξ = 1.5, c = −1.2465.
    fn separation(damping: f64) -> Characteristic {
        let (a, b) = (0.69995, 0.19999);
        Characteristic {
            zones: Vec::new(),
            stick: false,
            period: 1.0,
            mode: 4,
            excess: 0.0,
            friction: 0.0,
            static_friction: 0.0,
            beta: 0.0,
            turn: 0.0,
            defect: 0.0,
            ma: 1.0 - a,
            mb: 1.0 - b,
            a,
            b,
            kappa: 0.65059,
            g: 17.856,
            h: 8.4579,
            damping,
        }
    }

    /// The weights of (u, u′, η, η′) in which the flow is nearly an isometry at high frequency.
    fn weights(zone: &Characteristic, lambda: C64) -> [f64; 4] {
        let square = lambda.norm_sqr();
        [
            (zone.g + zone.b * square).sqrt(),
            zone.mb.sqrt(),
            (zone.h + zone.a * square).sqrt(),
            zone.ma.sqrt(),
        ]
    }

    /// Power series, residues and matrix exponential are one flow. Every exponent is below
    /// 6(|λ| + 5), and each way loses about as many units of rounding as the zone has radians, times
    /// the operations of a few products; derivatives lose a factor of the cancellation more.
    #[test]
    fn flow_is_the_matrix_exponential() {
        let mut worst = [0.0_f64; 2];
        for damping in [0.0, 0.3] {
            let zone = separation(damping);
            for size in [0.0, 0.3, 2.0, 11.0, 60.0, 1e3] {
                for angle in [0.4, 1.2, 1.57, 1.9, 2.8] {
                    for s in [1e-4, 1e-2, 0.05, 0.2, 0.8] {
                        let lambda = C64::from_polar(size, angle);
                        let column =
                            Vector4::new(ZERO, C64::new(0.5, 0.2), ONE, C64::new(-1.0, 2.0));
                        let mut state = PerturbationColumns {
                            columns: [column; 2],
                            by: [Vector4::repeat(ZERO); 2],
                            exponent: 0.0,
                        };
                        zone.separated(lambda, s, &mut state, 1);
                        let transfer = zone.matrix(lambda, s);
                        let rescale = C64::from((state.exponent - transfer.exponent).exp());
                        let radians = 1.0 + 6.0 * (size + 5.0) * s;
                        let weights = weights(&zone, lambda);
                        let pairs = [
                            (transfer.at * column, state.columns[0] * rescale),
                            (transfer.by[0] * column, state.by[0] * rescale),
                        ];
                        for (kind, (exact, found)) in pairs.iter().enumerate() {
                            let sum = |vector: &Vector4<C64>| -> f64 {
                                vector.iter().zip(weights).map(|(x, w)| x.norm() * w).sum()
                            };
                            let error = sum(&(exact - found)) / sum(exact);
                            let ratio = error / (f64::EPSILON * radians);
                            assert!(
                                ratio < [100.0, 1000.0][kind],
                                "λ = {lambda}, s = {s}, derivative {kind}: {error:e}"
                            );
                            worst[kind] = worst[kind].max(ratio);
                        }
                    }
                }
            }
        }
    }
}
