//! Separation with material damping β > 0: four slow motions forward, two layers backward.
//!
//! With z = (U, V) the equations of (M) without contact are, along a material point,
//!
//! ```text
//! −βBz⃛ + Mz̈ + Sż + Hz = 0,     B = diag(b̃, ã),   H = diag(g, h),
//! M = [ m_b  βκ ]     S = [ α + βg     κ    ]
//!     [ −βκ  m_a ],       [  −κ     α + βh  ].
//! ```
//!
//! For every β > 0 two of the six exponents grow, about m_b/(βb̃) and m_a/(βã); the others are those of
//! the undamped motion, damped. As in [`super::material`] the two are taken out of the matrix
//! polynomial, here by a matrix R, the smallest solution of
//!
//! ```text
//! −βB + MR + SR² + HR³ = 0,        growing motions:  ż = R⁻¹z,
//! ```
//!
//! and the rest is a second-order system, M̂z̈ + Ŝż + Hz = 0 with Ŝ = S + LH, M̂ = M + LŜ, where L
//! solves the same equation with R on the left: by the symmetry of M and S, L = (JRJ)ᵀ, J = diag(1, −1).
//! (Solvents of matrix polynomials: Gohberg, Lancaster & Rodman, Matrix Polynomials, 1982.) A zone is
//!
//! ```text
//! z = slow motion from the entry + R e^{−(T−s)R⁻¹} G,
//! ```
//!
//! with the layers given by the velocity G = (G_U, G_V) that they have at its end: every number is of
//! order one for any β. As β → 0, R → βM⁻¹B: G becomes the jump of the velocity in the impact, and
//! N = βR⁻¹ → B⁻¹M makes of the concentrated reaction β(Ü, V̈)⁻ its impulse.

use super::jet::{
    DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, LAYER, MultiDual, PARAMETER, RADIAL_LAYER, SOURCES,
};
use super::material::THIN;
use super::piece::SeparationPiece;
use super::separation::SeparationFlow;
use super::solvent::{polynomial, solvent};
use super::square::{Pair, Square};
use super::{FlowError, Frame, Slide, Unsolved, ZoneEnd};
use crate::orbit::sign::{COEFFICIENTS, REMAINDER};

/// e^{−x} beyond this is nothing.
const UNDERFLOW: f64 = 708.0;

/// Zones shorter than this many radians use the power series of the slow motion, where U − δ is not
/// lost in U; 36 terms leave 3³⁶/36! ≈ 4e-25.
const SHORT_ZONE: f64 = 3.0;
const SHORT_TERMS: usize = 36;

/// Layers within which one decays below rounding.
const LAYERS: f64 = 50.0;

/// The equations of separation with material damping in one frame.
#[derive(Clone, Copy, Debug)]
pub struct LayeredFlow {
    slow: SeparationFlow,
    layers: Square<2>,
    /// N = βR⁻¹.
    rates: Square<2>,
    /// M̂⁻¹Ŝ and M̂⁻¹H: z̈ = −M̂⁻¹(Ŝż + Hz).
    drag: Square<2>,
    stiffness: Square<2>,
    /// β.
    beta: MultiDual<2>,
    mismatch: MultiDual<2>,
    steady: MultiDual<2>,
}

/// z and its derivatives at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free<const D: usize> {
    /// z = (U, V), in units of R.
    pub position: Pair<D>,
    /// ż = (U̇, V̇), in units of RΩ.
    pub rate: Pair<D>,
    /// z̈ = (Ü, V̈), in units of RΩ².
    pub acceleration: Pair<D>,
}

fn plus<const D: usize>(x: Pair<D>, y: Pair<D>) -> Pair<D> {
    [x[0] + y[0], x[1] + y[1]]
}

impl LayeredFlow {
    /// The equations in this frame.
    ///
    /// # Errors
    /// Growing and other exponents cannot be told apart.
    pub(crate) fn new(frame: &Frame) -> Result<LayeredFlow, FlowError> {
        let of = polynomial(frame);
        let failed = FlowError::Integration {
            duration: 0.0,
            reason: Unsolved::SeparationExponents,
        };
        let layers = solvent(&of).ok_or(failed)?;
        let [_, m, s, h] = of;
        let [[a, b], [c, d]] = layers.0;
        let left = Square([[a, -c], [-b, d]]);
        let slow_drag = s + left * h;
        let mass = (m + left * slow_drag).inverse();
        let stress = Square::diagonal(
            frame.number(|q| q.radial_stress).inverse(),
            frame.number(|q| q.stress).inverse(),
        );
        let (drag, stiffness) = (mass * slow_drag, mass * h);
        let entries = [drag, stiffness, layers];
        if !entries.iter().all(|entry| entry.norm().is_finite()) {
            return Err(failed);
        }
        let steady = frame.steady();
        Ok(LayeredFlow {
            slow: SeparationFlow::of(frame, &drag, &stiffness),
            layers,
            rates: stress * (m + (s + h * layers) * layers),
            drag,
            stiffness,
            beta: frame.number(|q| q.material),
            mismatch: frame.number(|q| q.mismatch),
            steady: MultiDual {
                value: steady.value,
                by: [steady.by[EXCESS], steady.by[PARAMETER]],
            },
        })
    }

    /// Radians per unit of time: a bound of the rates of the slow motions.
    pub(crate) fn norm(&self) -> f64 {
        self.slow.norm()
    }

    /// A bound of the times in which the layers decay.
    pub(crate) fn thickness(&self) -> f64 {
        self.layers.norm()
    }

    fn matrix<const D: usize>(&self, of: &Square<2>) -> Square<D> {
        of.map(MultiDual::lifted)
    }

    /// R⁻¹, for β > 0.
    fn inverse<const D: usize>(&self) -> Square<D> {
        self.matrix(&(self.rates * self.beta.inverse()))
    }

    /// Whether nothing is left of the layers this long before the end. A zone that has shrunk beyond
    /// nothing by more than a layer goes on as it was while it was long: the layers would grow there. So
    /// they would for β < 0, where a step may end that passes β = 0.
    fn forgotten(&self, time: f64) -> bool {
        let longest = self.thickness();
        let none = self.beta.value <= 0.0;
        none || time > 0.0 && time >= UNDERFLOW * longest || time < -longest
    }

    /// What is left of the layers' velocity, and of their acceleration, a time before the end.
    fn rest<const D: usize>(&self, time: MultiDual<D>, end: Pair<D>) -> [Pair<D>; 2] {
        if self.forgotten(time.value) {
            return Default::default();
        }
        let inverse = self.inverse();
        let rate = (inverse * time).moments()[0] * end;
        [rate, inverse * rate]
    }

    /// (G_U, G_V) and (V, V̇) at the entry as the zone's own unknowns, and its duration.
    fn sources<const D: usize>(&self, slide: &Slide) -> ([Pair<D>; 2], MultiDual<D>) {
        let [y, w] = slide.entry;
        let end = [
            MultiDual::own(slide.radial, RADIAL_LAYER),
            MultiDual::own(slide.layer, LAYER),
        ];
        let v = MultiDual::own(y, ENTRY_Y) + MultiDual::lifted(self.steady);
        let entry = [v, MultiDual::own(w, ENTRY_W)];
        ([end, entry], MultiDual::own(slide.duration, DURATION))
    }

    /// The slow motion and the acceleration at the entry.
    fn entry<const D: usize>(&self, slide: &Slide) -> ([Pair<D>; 2], Pair<D>) {
        let ([end, [v, w]], duration) = self.sources(slide);
        let [rate, acceleration] = self.rest(duration, end);
        let place = self.matrix(&self.layers) * rate;
        let position = [
            MultiDual::<D>::lifted(self.mismatch) - place[0],
            v - place[1],
        ];
        let slow = [position, [-rate[0], w - rate[1]]];
        (slow, plus(self.slow_acceleration(slow), acceleration))
    }

    fn slow_acceleration<const D: usize>(&self, [position, rate]: [Pair<D>; 2]) -> Pair<D> {
        let [x, y] = plus(
            self.matrix(&self.drag) * rate,
            self.matrix(&self.stiffness) * position,
        );
        [-x, -y]
    }

    /// (Ü, V̈) just after the entry.
    pub(crate) fn entry_acceleration(&self, slide: &Slide) -> Pair<SOURCES> {
        self.entry(slide).1
    }

    /// The motion at a time after the entry, with all derivatives at this time held fixed or none.
    pub(crate) fn motion<const D: usize>(
        &self,
        slide: &Slide,
        t: f64,
    ) -> Result<Free<D>, FlowError> {
        let (slow, _) = self.entry::<D>(slide);
        let slow = self.slow.carried(slow, t, false)?;
        let ([end, _], duration) = self.sources(slide);
        let [rate, acceleration] = self.rest(duration - t, end);
        let moved = Free {
            position: plus(slow[0], self.matrix(&self.layers) * rate),
            rate: plus(slow[1], rate),
            acceleration: plus(self.slow_acceleration(slow), acceleration),
        };
        let finite = moved.position.iter().chain(&moved.rate);
        if !finite.into_iter().all(|number| number.value.is_finite()) {
            return Err(FlowError::Overflow { duration: t });
        }
        Ok(moved)
    }

    /// (U, U̇, Y, W) at a time after the entry.
    pub(crate) fn state(&self, slide: &Slide, t: f64) -> Result<[f64; 4], FlowError> {
        let Free { position, rate, .. } = self.motion::<0>(slide, t)?;
        Ok([
            position[0].value,
            rate[0].value,
            position[1].value - self.steady.value,
            rate[1].value,
        ])
    }

    /// (G, G_U) of the first part of a zone that is cut at a time.
    pub(crate) fn layers_at(&self, slide: &Slide, t: f64) -> [f64; 2] {
        let ([end, _], _) = self.sources::<0>(slide);
        let [[radial, layer], _] = self.rest(MultiDual::constant(slide.duration - t), end);
        [layer.value, radial.value]
    }

    /// (G, G_U) of a zone of no duration that is entered at (Y, W) with this V̈, and U̇ = Ü = 0.
    pub(crate) fn layers_of(&self, [y, w]: [f64; 2], acceleration: f64) -> [f64; 2] {
        let acceleration = [0.0, acceleration];
        let number = MultiDual::<0>::constant;
        let position = [number(self.mismatch.value), number(y + self.steady.value)];
        let slow = self.slow_acceleration([position, [number(0.0), number(w)]]);
        // R⁻¹G + M̂⁻¹(ŜG + HRG) is what the slow motion lacks
        let beta = self.beta.value;
        let own =
            self.matrix::<0>(&self.drag) + self.matrix(&self.stiffness) * self.matrix(&self.layers);
        let matrix = self.matrix(&self.rates) + own * beta;
        let lacking = [0, 1].map(|i| number((acceleration[i] - slow[i].value) * beta));
        let [radial, layer] = matrix.inverse() * lacking;
        [layer.value, radial.value]
    }

    /// The end of a zone. U − δ has an m-fold zero at the entry, m = 3 after a take-off and 2 after a
    /// touch, and U = δ, U̇ = 0 hold at the end. As the zone shrinks both become the same condition;
    /// they are posed as
    ///
    /// ```text
    /// A = (U − δ)/T^m,     C = (U̇ − m(U − δ)/T)/T^m,
    /// ```
    ///
    /// the two lowest moments of the m-th derivative of U, with the factors (ρ + T)^{m−2} and
    /// (ρ + T)C − A/(m + 1) that keep them of order one where T is small against the layer ρ or large.
    pub(crate) fn zone(&self, slide: &Slide, m: usize) -> Result<ZoneEnd, FlowError> {
        let t = slide.duration;
        let (entry, _) = self.entry::<SOURCES>(slide);
        let ([end, _], duration) = self.sources::<SOURCES>(slide);
        let slow = self.slow.carried(entry, t, true)?;
        let layers = self.matrix(&self.layers);
        let position = plus(slow[0], layers * end);
        let rate = plus(slow[1], end);
        let beta = MultiDual::lifted(self.beta);
        let impulse = plus(
            self.slow_acceleration(slow).map(|x| beta * x),
            self.matrix(&self.rates) * end,
        );
        let power = |n: usize| (0..n).fold(Jet::constant(1.0), |power, _| power * duration);
        let order = m as f64;
        let [gap, slope] = if self.norm() * t.abs() > SHORT_ZONE {
            let factor = power(m).inverse();
            let gap = position[0] - MultiDual::lifted(self.mismatch);
            [
                gap * factor,
                (rate[0] - gap * duration.inverse() * order) * factor,
            ]
        } else {
            let [gap, slope] = self.short_moments(entry, duration, m);
            if self.forgotten(t) {
                let factor = power(m).inverse();
                let gap_of_layers = (layers * end)[0] * factor;
                let slope_of_layers = end[0] * factor - gap_of_layers * duration.inverse() * order;
                [gap + gap_of_layers, slope + slope_of_layers]
            } else {
                let inverse = self.inverse();
                let moments = (inverse * duration).moments();
                let high = (1..m).fold(end, |high, _| inverse * high);
                [
                    gap + (moments[m] * high)[0],
                    slope + ((moments[m] - moments[m + 1] * order) * (inverse * high))[0],
                ]
            }
        };
        // smooth through T = 0, and of one sign
        let thickness = layers.0[0][0];
        let sign = if t < -0.5 * thickness.value {
            -1.0
        } else {
            1.0
        };
        let scale = thickness + duration * sign;
        let first = if m == 3 { scale * gap } else { gap };
        let jets = [first, position[1], rate[1]];
        if !jets.iter().all(|jet| jet.value.is_finite()) {
            return Err(FlowError::Overflow { duration: t });
        }
        Ok(ZoneEnd {
            y: position[1] - MultiDual::lifted(self.steady),
            w: rate[1],
            radial_rate: rate[0],
            switching: first,
            second: scale * slope - gap * (1.0 / (order + 1.0)),
            impulse,
            ..ZoneEnd::default()
        })
    }

    /// Σ_{j≥m} T^{j−m}U⁽ʲ⁾/j! and Σ_{j>m} (j−m)T^{j−m−1}U⁽ʲ⁾/j! of the slow motion.
    fn short_moments(&self, entry: [Pair<SOURCES>; 2], duration: Jet, m: usize) -> [Jet; 2] {
        let (mut gap, mut slope) = (Jet::default(), Jet::default());
        let [mut before, mut current] = entry;
        let mut factorial = 1.0;
        let mut power = [Jet::default(), Jet::constant(1.0)];
        for j in 2..SHORT_TERMS {
            let next = self.slow_acceleration([before, current]);
            (before, current) = (current, next);
            factorial *= j as f64;
            if j < m {
                continue;
            }
            let derivative = current[0] * (1.0 / factorial);
            gap = gap + derivative * power[1];
            slope = slope + derivative * power[0] * (j - m) as f64;
            power = [power[1], power[1] * duration];
        }
        [gap, slope]
    }

    /// Times in which the layers decay, the shorter first: the same twice where they are of about one
    /// length, or turn, and nothing where they are too thin to be told from the end, or β ≤ 0.
    fn layer_times(&self) -> [f64; 2] {
        let [[a, b], [c, d]] = self.layers.0.map(|row| row.map(|entry| entry.value));
        let (half, determinant) = (0.5 * (a + d), a * d - b * c);
        if half <= THIN / self.norm() {
            return [0.0; 2];
        }
        let discriminant = half * half - determinant;
        let long = half + discriminant.max(0.0).sqrt();
        let short = if long > 0.0 { determinant / long } else { 0.0 };
        if discriminant > 0.0 && short < 0.5 * long {
            return [short, long];
        }
        [determinant.max(0.0).sqrt(); 2]
    }

    /// The pieces of a zone, U − δ having an m-fold zero at the entry.
    pub(crate) fn pieces(
        &self,
        slide: &Slide,
        m: usize,
    ) -> Result<Vec<SeparationPiece>, FlowError> {
        let stretches = self.stretches(slide.duration).into_iter().enumerate();
        stretches
            .map(|(index, stretch)| self.piece(slide, stretch, if index == 0 { m } else { 0 }))
            .collect()
    }

    /// A zone cut up: thinner towards the end, where the layers are.
    fn stretches(&self, duration: f64) -> Vec<LayeredSegment> {
        let radian = 1.0 / self.norm();
        let [short, long] = self.layer_times();
        // distances from the end up to which the longer, and both layers, are there
        let from = |time: f64| (duration - LAYERS * time).max(0.0);
        let mut pieces = Vec::new();
        let mut start = 0.0;
        for (end, longest, layers) in [
            (from(long), radian, 0),
            (from(short), radian.min(long), 1),
            (duration, radian.min(short), 2),
        ] {
            let length = end - start;
            // what is left of a layer without thickness is no piece
            if length <= 0.0 || longest <= 0.0 {
                continue;
            }
            let count = (length / longest).ceil().max(1.0) as usize;
            let length = length / count as f64;
            pieces.extend((0..count).map(|index| LayeredSegment {
                start: start + length * index as f64,
                length,
                layers,
            }));
            start = end;
        }
        pieces
    }

    /// A stretch as a piece, the first m coefficients of U − δ being zero.
    fn piece(
        &self,
        slide: &Slide,
        stretch: LayeredSegment,
        m: usize,
    ) -> Result<SeparationPiece, FlowError> {
        let LayeredSegment {
            start,
            length,
            layers,
        } = stretch;
        let (slow, _) = self.entry::<0>(slide);
        let [mut before, mut current] = self.slow.carried(slow, start, false)?;
        let size = |pair: Pair<0>| pair[0].value.abs().max(pair[1].value.abs());
        let unit = 1.0 / self.norm();
        let mut remainder = (length / unit).powi(17) * (size(before) + unit * size(current));
        let ([end, _], duration) = self.sources::<0>(slide);
        let [short, long] = self.layer_times();
        let mut rate = if layers > 0 {
            self.rest(duration - start, end)[0]
        } else {
            Pair::default()
        };
        let matrix = self.matrix::<0>(&self.layers);
        if layers == 1 {
            // the shorter layer is not there yet, but its rounding would grow
            rate = (matrix - Square::unit(short)) * (1.0 / (long - short)) * rate;
        }
        let thickness = if layers == 1 { long } else { short };
        // alone the longer layer grows by its own exponent: the other one would bring its rounding back
        let inverse = match layers {
            1 => Square::unit(1.0 / long),
            _ => self.inverse(),
        };
        if layers > 0 {
            // the layers grow by e at most
            remainder += (length / thickness).powi(17) * std::f64::consts::E * size(matrix * rate);
        }
        let mut layer = matrix * rate;
        let (mut gap, mut tangential) = ([0.0; COEFFICIENTS], [0.0; COEFFICIENTS]);
        let mut scale = 1.0;
        for j in 0..COEFFICIENTS {
            gap[j] = (before[0] + layer[0]).value * scale;
            tangential[j] = (before[1] + layer[1]).value * scale;
            layer = rate;
            if layers > 0 {
                rate = inverse * rate;
            }
            (before, current) = (current, self.slow_acceleration([before, current]));
            scale *= length / (j + 1) as f64;
        }
        gap[0] -= self.mismatch.value;
        let distance = slide.duration - start;
        if layers > 0 && self.norm() * distance <= SHORT_ZONE {
            let [here, slope] = self.before_landing(slide, distance)?;
            (gap[0], gap[1]) = (here, slope * length);
        }
        gap[..m].fill(0.0);
        Ok(SeparationPiece {
            start,
            length,
            gap,
            tangential,
            remainder: REMAINDER * remainder,
        })
    }

    /// U − δ and U̇ a short time d before a landing, where U = δ and U̇ = 0, from the accelerations
    /// there: nothing is lost in U. With p_m the moments of dR⁻¹ the layers add
    /// d²R⁻¹(p₁ − p₂)G and −dR⁻¹p₁G, the slow motion its power series from the second derivative on.
    fn before_landing(&self, slide: &Slide, distance: f64) -> Result<[f64; 2], FlowError> {
        let (entry, _) = self.entry::<0>(slide);
        let [mut before, mut current] = self.slow.carried(entry, slide.duration, false)?;
        let ([end, _], _) = self.sources::<0>(slide);
        let inverse = self.inverse::<0>();
        let [_, first, second, ..] = (inverse * distance).moments();
        let layer = (inverse * (first - second) * end)[0].value * distance * distance;
        let layer_rate = -(inverse * first * end)[0].value * distance;
        let (mut gap, mut slope) = (0.0, 0.0);
        let mut power = -distance;
        for j in 2..SHORT_TERMS {
            let next = self.slow_acceleration([before, current]);
            (before, current) = (current, next);
            // power is (−d)^{j−1}/(j−1)!
            slope += current[0].value * power;
            power *= -distance / j as f64;
            gap += current[0].value * power;
        }
        Ok([gap + layer, slope + layer_rate])
    }
}

/// A stretch of a zone.
struct LayeredSegment {
    /// Its beginning after the entry.
    start: f64,
    length: f64,
    /// How many of the layers are felt on it.
    layers: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::flow::piece::horner;
    use crate::tube::model::Constants;
    use crate::tube::model::coefficients::Geometry;

    /// The polynomials of the pieces are the motion: at the end of each of them too, where a rounding of the
    /// other layer would have grown by (long/short)¹⁶.
    #[test]
    fn pieces_end_where_the_motion_is() {
        for (nu, xi, excess) in [(0.3, 1.5, 0.2), (0.44, 3.5, 0.05), (0.48, 2.1, 0.4)] {
            for beta in [1e-2, 1e-3, 2e-5, 1e-7] {
                let parameters = Constants {
                    coefficients: Geometry { nu, xi, gamma: 1.0 }.coefficients(),
                    friction: 0.2,
                    mismatch: 0.1,
                    stiffness_damping: beta,
                    ..Constants::default()
                };
                let frame = Frame::new(&parameters, &Constants::default(), excess).unwrap();
                let flow = LayeredFlow::new(&frame).unwrap();
                let slide = Slide {
                    entry: [0.05, -0.8],
                    duration: 0.6,
                    layer: -0.7,
                    radial: 0.9,
                };
                for piece in flow.pieces(&slide, 3).unwrap() {
                    let end = (piece.start + piece.length).min(slide.duration);
                    let state = flow.state(&slide, end).unwrap();
                    let error = horner(&piece.tangential, 1.0) - flow.steady.value - state[2];
                    // the exponential rounds per radian, and V̇ times the rounding of the time
                    let rounding = 1e-14 * (1.0 + flow.norm() * slide.duration);
                    assert!(
                        error.abs() < piece.remainder + rounding,
                        "ν = {nu}, β = {beta}, t = {end}: {error:e}"
                    );
                }
            }
        }
    }
}
