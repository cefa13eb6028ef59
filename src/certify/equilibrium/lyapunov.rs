//! The first Lyapunov coefficient of a Hopf point, enclosed.
//!
//! With Aq = iωq, Aᵀp = −iωp, ⟨p, q⟩ = Σ p̄ᵢqᵢ = 1, B and C the second and third derivatives of the rates,
//!
//! > l₁ = 1/(2ω⟨q, q⟩) Re[⟨p, C(q, q, q̄)⟩ + 2⟨p, B(q, h₁₁)⟩ + ⟨p, B(q̄, h₂₀)⟩], Ah₁₁ = −B(q, q̄), (2iω − A)h₂₀ = B(q, q)
//!
//! (Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 5.4), as of a q of length 1. In a sliding mode, or with contacts, Mẏ = E(y) has the same
//! expansion, with E_y in the place of A and iωM in that of iω; ⟨p, Mq⟩ = 1, and ⟨q, q⟩ is that of the states. Linear equations are
//! solved over all of the intervals, those of p with a border: (Aᵀ + iωM)p + sq = 0, Σ pᵢ(Mq̄)ᵢ = 1, where s is 0.

use serde::{Deserialize, Serialize};

use super::Rows;
use super::dependence::is_affine;
use super::system::EquilibriumSystem;
use crate::certify::analytic::Analytic;
use crate::certify::krawczyk::LinearEquations;
use crate::certify::orbit::flow::dot;
use crate::interval::{Gradient, Interval, Number};

/// The first Lyapunov coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ProvenLyapunov {
    /// It lies in here.
    Within(Interval),
    /// The rates are affine, so that it is zero: all cycles around the equilibrium belong to this value of the parameter.
    Vertical,
}

/// Real and imaginary part of a vector.
type Complexes = [Vec<Interval>; 2];

/// A number with a derivative in one quantity.
type Once<N> = Gradient<N, 1>;

fn along<N: Number>(value: N, by: N) -> Once<N> {
    Gradient { value, by: [by] }
}

fn added(one: &[Interval], sign: f64, other: &[Interval]) -> Vec<Interval> {
    let sign = Interval::point(sign);
    one.iter().zip(other).map(|(a, b)| *a + sign * *b).collect()
}

/// Re ⟨p, v⟩.
fn product([p_re, p_im]: &Complexes, [re, im]: &Complexes) -> Interval {
    dot(p_re, re) + dot(p_im, im)
}

/// The solution of (M + iN)z = b, M and N being given row by row.
fn solved(matrix: &[Rows; 2], [re, im]: Complexes) -> Option<Complexes> {
    let size = re.len();
    let [real, imaginary] = matrix;
    let row = |i: usize, upper: bool| -> Vec<Interval> {
        let turned = imaginary[i].iter().map(|x| if upper { -*x } else { *x });
        match upper {
            true => real[i].iter().copied().chain(turned).collect(),
            false => turned.chain(real[i].iter().copied()).collect(),
        }
    };
    let rows = (0..size).map(|i| row(i, true));
    let rows: Rows = rows.chain((0..size).map(|i| row(i, false))).collect();
    let mut both = LinearEquations::new(&rows)?.solve(&[re, im].concat())?;
    let im = both.split_off(size);
    Some([both, im])
}

/// The equations of an equilibrium next to it.
struct LocalEquations<'a, 'b> {
    system: &'b EquilibriumSystem<'a>,
    state: &'b [Interval],
    parameter: Interval,
}

impl LocalEquations<'_, '_> {
    /// B(v, w) of real vectors.
    fn second(&self, v: &[Interval], w: &[Interval]) -> Option<Vec<Interval>> {
        let zero = Interval::ZERO;
        let moved = self.state.iter().zip(v).zip(w);
        let moved = moved.map(|((x, v), w)| along(along(*x, *v), along(*w, zero)));
        let moved: Vec<Once<Once<Interval>>> = moved.collect();
        let still = Number::constant(self.parameter);
        let rates = self.system.rest(&moved, still)?;
        Some(rates.iter().map(|rate| rate.by[0].by[0]).collect())
    }

    /// C(u, v, w) of real vectors.
    fn third(&self, [u, v, w]: [&[Interval]; 3]) -> Option<Vec<Interval>> {
        let constant = |x: Interval| along(x, Interval::ZERO);
        let zero = Interval::ZERO;
        let moved = |index: usize| {
            let inner = along(along(self.state[index], u[index]), constant(v[index]));
            along(inner, along(constant(w[index]), constant(zero)))
        };
        let moved: Vec<Once<Once<Once<Interval>>>> = (0..self.state.len()).map(moved).collect();
        let still = Number::constant(self.parameter);
        let rates = self.system.rest(&moved, still)?;
        Some(rates.iter().map(|rate| rate.by[0].by[0].by[0]).collect())
    }

    /// B(v, w) of complex vectors.
    fn bent(&self, [v_re, v_im]: &Complexes, [w_re, w_im]: &Complexes) -> Option<Complexes> {
        let of = |v: &[Interval], w: &[Interval]| self.second(v, w);
        Some([
            added(&of(v_re, w_re)?, -1.0, &of(v_im, w_im)?),
            added(&of(v_re, w_im)?, 1.0, &of(v_im, w_re)?),
        ])
    }
}

impl EquilibriumSystem<'_> {
    /// A multiple of M.
    fn mass(&self, value: Interval) -> Rows {
        let entry = |i: usize, j: usize| match i == j && self.is_rate(i) {
            true => value,
            false => Interval::ZERO,
        };
        let row = |i: usize| (0..self.size).map(|j| entry(i, j)).collect();
        (0..self.size).map(row).collect()
    }

    /// p, from the derivatives of E, ω and q.
    fn adjoint(&self, slopes: &Rows, omega: Interval, [a, b]: &Complexes) -> Option<Complexes> {
        let n = self.size;
        let column = |i: usize| slopes.iter().map(|row| row[i]).collect();
        let mut real: Rows = (0..n).map(column).collect();
        let mut imaginary = self.mass(omega);
        for (rows, q) in [(&mut real, a), (&mut imaginary, b)] {
            rows.iter_mut().zip(q).for_each(|(row, q)| row.push(*q));
        }
        let states = |v: &[Interval], sign: f64| -> Vec<Interval> {
            let sign = Interval::point(sign);
            let mut row: Vec<Interval> = v[..self.states()].iter().map(|x| sign * *x).collect();
            row.resize(n + 1, Interval::ZERO);
            row
        };
        real.push(states(a, 1.0));
        imaginary.push(states(b, -1.0));
        let mut side = [vec![Interval::ZERO; n + 1], vec![Interval::ZERO; n + 1]];
        side[0][n] = Interval::ONE;
        let [mut re, mut im] = solved(&[real, imaginary], side)?;
        re.truncate(n);
        im.truncate(n);
        Some([re, im])
    }

    /// The coefficient of a Hopf point; `None` where it is not enclosed, or zero for a reason that is not told.
    pub fn lyapunov(&self, x: &[Interval]) -> Option<ProvenLyapunov> {
        if is_affine(self.system, &self.resting) {
            return Some(ProvenLyapunov::Vertical);
        }
        let (n, omega) = (self.size, *x.last()?);
        let zero = Interval::ZERO;
        let slopes = self.matrix(x)?;
        let [a, b] = [0, 1].map(|which| self.vector(x, which));
        let q: Complexes = [a.to_vec(), b.to_vec()];
        let conjugate: Complexes = [a.to_vec(), b.iter().map(|b| -*b).collect()];
        let p = self.adjoint(&slopes, omega, &q)?;
        let at = LocalEquations {
            system: self,
            state: &x[..n],
            parameter: x[self.parameter()],
        };
        let [mean, _] = at.bent(&q, &conjugate)?;
        let minus: Vec<Interval> = mean.iter().map(|x| -*x).collect();
        let mean = LinearEquations::new(&slopes)?.solve(&minus)?;
        let opposite: Rows = {
            let row = |row: &Vec<Interval>| row.iter().map(|x| -*x).collect();
            slopes.iter().map(row).collect()
        };
        let twice = self.mass(Interval::point(2.0) * omega);
        let second = solved(&[opposite, twice], at.bent(&q, &q)?)?;
        // C(q, q, q̄) = C(a, a, a) + C(a, b, b) + i(C(a, a, b) + C(b, b, b))
        let cubic = [
            added(&at.third([a, a, a])?, 1.0, &at.third([a, b, b])?),
            added(&at.third([a, a, b])?, 1.0, &at.third([b, b, b])?),
        ];
        let terms = product(&p, &cubic)
            + Interval::point(2.0) * product(&p, &at.bent(&q, &[mean, vec![zero; n]])?)
            + product(&p, &at.bent(&conjugate, &second)?);
        let square = |v: &[Interval]| v.iter().fold(zero, |sum, x| sum + x.square());
        let length = square(&a[..self.states()]) + square(&b[..self.states()]);
        let found = terms / (Interval::point(2.0) * omega * length);
        let known = found.is_finite() && found != zero;
        known.then_some(ProvenLyapunov::Within(found))
    }
}
