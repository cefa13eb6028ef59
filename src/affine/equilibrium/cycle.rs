//! Guesses of the cycles that are born at a Hopf point, and why there are none.
//!
//! On the plane of the pair the motion is ż = (α + iω)z + ωl₁z|z|², α = α′(p − p₀): cycles of amplitude |z|² = −α/(ωl₁) lie
//! on the side of p₀ where αl₁ < 0.

use super::curve::EquilibriumCurve;
use super::extended::{Condition, locate};
use super::normal_form::{Lyapunov, NormalForm, normal_form, plane_of_pair};
use super::spectrum::{critical_pair, eigenvalues};
use crate::continuation::Node;
use crate::linalg::Vector;

/// Why no cycle can be guessed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoCycle {
    /// There is no Hopf point.
    #[error("no pair of eigenvalues is imaginary at this equilibrium")]
    NoHopf,
    /// The rates are affine.
    #[error(
        "the mode is affine: the cycles of this Hopf point are a vertical family, all at this value of the parameter, and \
         begin no branch"
    )]
    Vertical,
    /// The side is not known.
    #[error(
        "rounding decides on which side of this Hopf point cycles lie: the first Lyapunov coefficient is zero, or the pair \
         does not cross"
    )]
    Undecided,
    /// There is no boundary equilibrium.
    #[error("no guard of the mode is zero at this equilibrium")]
    NoBoundary,
    /// There are more states, or one.
    #[error("cycles that grow from a BE are looked for in systems of two states only")]
    NotPlanar,
    /// None is in proportion to the distance of the parameter.
    #[error(
        "on neither side of this BE motions turn into a cycle whose size is in proportion to the parameter's distance from it"
    )]
    NoneGrows,
    /// None is found at any amplitude that is tried.
    #[error("Newton's method finds no cycle next to this event")]
    NotFound,
}

/// A guess of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleGuess {
    /// A mode of it.
    pub mode: usize,
    /// A state in that mode.
    pub state: Vec<f64>,
    /// The parameter.
    pub value: f64,
    /// Its period.
    pub period: f64,
    /// The range of every state, where that is told.
    pub ranges: Option<Vec<f64>>,
    /// Whether cycles of larger amplitude have larger values of the parameter.
    pub up: bool,
}

impl CycleGuess {
    /// Whether a cycle of this period and with these ranges of the states, in these units, is the one of the guess and no other that lies
    /// about it: next to a Hopf point of what is slow and fast Newton's method may come to a relaxation oscillation.
    pub fn is_like(&self, period: f64, ranges: &[f64], units: &[f64]) -> bool {
        /// By this factor at most: of third order the guess leaves out a small part.
        const LIKE: f64 = 2.0;
        let Some(guessed) = &self.ranges else {
            return true;
        };
        let most = |ranges: &[f64]| {
            let ranges = ranges.iter().zip(units);
            ranges.fold(0.0_f64, |most, (range, unit)| most.max(range / unit))
        };
        let pairs = [(period, self.period), (most(ranges), most(guessed))];
        let like = |(one, other): &(f64, f64)| (LIKE.recip()..=LIKE).contains(&(one / other));
        pairs.iter().all(like)
    }
}

/// Amplitudes that are tried, relative to the units of the states, then to the amplitude of the cycle that the normal form has at
/// the width of the range: it leaves out what is of third order, and next to the Hopf point the equations of a cycle are singular.
const AMPLITUDES: [f64; 6] = [0.03, 0.01, 0.1, 0.003, 0.001, 0.0003];

/// A cycle that is nearer to the Hopf point than this part of the range is not told from the others of the linear rates.
const NEAREST: f64 = 1e-8;

impl EquilibriumCurve {
    /// Guesses of cycles of several amplitudes next to a Hopf point.
    ///
    /// # Errors
    /// There is none, or its cycles are not on one side of it.
    pub fn cycles(&self, point: &Vector) -> Result<Vec<CycleGuess>, NoCycle> {
        let node = Node::on(self, point.clone()).ok_or(NoCycle::NoHopf)?;
        let located = locate(self, &node, Condition::Hopf).ok_or(NoCycle::NoHopf)?;
        if self.is_affine(&located.point) {
            return Err(NoCycle::Vertical);
        }
        let at = self.linearised(&located.point);
        let at = at.map_err(|_| NoCycle::NoHopf)?;
        let omega = critical_pair(&eigenvalues(&at)).ok_or(NoCycle::NoHopf)?;
        let place = self.place(&located.point);
        let Some(form) = normal_form(self.local(&place), &at, omega) else {
            let plane = plane_of_pair(&at, omega).ok_or(NoCycle::NoHopf)?;
            return Ok(self.cycles_in_proportion(&plane, &place, omega));
        };
        let Lyapunov::Known(lyapunov) = form.lyapunov else {
            return Err(NoCycle::Undecided);
        };
        // u′ with p′ = 1
        let units = &self.setting.scales.units;
        let n = self.states();
        let tangent = Node::on(self, located.point.clone()).ok_or(NoCycle::NoHopf)?;
        let tangent = tangent.tangent;
        let drift = tangent[n] * units[n];
        let along = Vector::from_fn(n + 1, |i, _| tangent[i] * units[i] / drift);
        let speed = form.crossing_speed(self.local(&place), &along);
        if !(speed.is_normal() && lyapunov.is_normal()) {
            return Err(NoCycle::Undecided);
        }
        let width = units[n];
        let sizes = [
            form.unit_amplitude(units),
            (width * speed / (omega * lyapunov)).abs().sqrt(),
        ];
        let guess = |amplitude: f64| {
            let shift = -omega * lyapunov * amplitude * amplitude / speed;
            let moved = form.displacement(amplitude);
            CycleGuess {
                mode: self.signature.mode,
                state: (0..n)
                    .map(|i| place[i] + along[i] * shift + moved[i])
                    .collect(),
                value: place[n] + shift,
                period: std::f64::consts::TAU / omega,
                ranges: Some(form.ranges(amplitude)),
                up: shift > 0.0,
            }
        };
        let amplitudes = sizes
            .into_iter()
            .flat_map(|size| AMPLITUDES.map(|relative| relative * size));
        let told = |guess: &CycleGuess| (guess.value - place[n]).abs() >= NEAREST * width;
        Ok(amplitudes.map(guess).filter(told).collect())
    }

    /// The same where the rates have no third derivatives, as of `abs(v)*v`: the size of cycles is in proportion to the parameter's
    /// distance then, or nearly so, and their side is not known.
    fn cycles_in_proportion(
        &self,
        plane: &NormalForm,
        place: &[f64],
        omega: f64,
    ) -> Vec<CycleGuess> {
        /// Distances of the parameter, in parts of the range, and how many sizes are tried, each half of the one before.
        const SHIFTS: [f64; 4] = [0.01, -0.01, 0.001, -0.001];
        const SIZES: i32 = 12;
        let units = &self.setting.scales.units;
        let n = self.states();
        let unit = plane.unit_amplitude(units);
        let sizes = (0..SIZES).map(|halvings| unit * 0.5_f64.powi(halvings));
        let guess = |shift: f64, amplitude: f64| CycleGuess {
            mode: self.signature.mode,
            state: {
                let moved = plane.displacement(amplitude);
                (0..n).map(|i| place[i] + moved[i]).collect()
            },
            value: place[n] + shift,
            period: std::f64::consts::TAU / omega,
            ranges: Some(plane.ranges(amplitude)),
            up: shift > 0.0,
        };
        let guesses = SHIFTS.iter().flat_map(|part| {
            let shift = part * units[n];
            sizes.clone().map(move |size| guess(shift, size))
        });
        guesses.collect()
    }
}
