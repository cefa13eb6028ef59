//! Extremes within a sliding zone with material damping: times at which V̈, V̇ or the rate of the pressure vanishes, of a sum of
//! an oscillation and a layer at the end of the zone.

use super::{LAYERS, MaterialFlow, THIN, decayed, ratio};
use crate::continuation::zero::boundary;
use crate::tube::flow::Slide;

/// A zero of V̈ closer to a switch than this fraction of the shortest time scale is the switch.
const AT_SWITCH: f64 = 1e-6;

impl MaterialFlow {
    /// Times in (0, T) at which V̈ vanishes, that of the end left out, and that of the beginning where
    /// V̈ vanishes there (`at_rest`).
    pub(crate) fn turning_points(&self, slide: &Slide, at_rest: bool) -> Vec<f64> {
        let entry = self.slow_entry(slide);
        let [acceleration, jerk] = self.slow_rates(entry);
        let mut times = self.zeros([acceleration, jerk], slide.layer, slide.duration);
        if at_rest {
            let near = AT_SWITCH / self.slow.q.sqrt();
            times.retain(|time| *time > near);
        }
        times
    }

    /// Ṗ/κ = V̈ + βV⃛ and P̈/κ of the oscillator at a state.
    fn slow_pressure_rates(&self, state: [f64; 2]) -> [f64; 2] {
        let [acceleration, jerk] = self.slow_rates(state);
        let snap = 2.0 * self.slow.p * jerk - self.slow.q * acceleration;
        [acceleration + self.beta * jerk, jerk + self.beta * snap]
    }

    /// 1 + β/ρ: Ṗ/κ by V̈ of the layer; β/ρ → m_a/ã as β → 0, where the layer has no thickness.
    fn layer_pressure(&self) -> f64 {
        if self.rho > 0.0 {
            1.0 + self.beta / self.rho
        } else {
            1.0
        }
    }

    /// Times in (0, T) at which Ṗ = κ(V̈ + βV⃛) vanishes.
    pub(crate) fn pressure_extremes(&self, slide: &Slide) -> Vec<f64> {
        self.zeros(
            self.slow_pressure_rates(self.slow_entry(slide)),
            slide.layer * self.layer_pressure(),
            slide.duration,
        )
    }

    /// Ṗ/P̈ at a time: Newton's step towards an extreme of P.
    pub(crate) fn pressure_step(&self, slide: &Slide, t: f64) -> f64 {
        let [slope, curvature] = self.pressure_rates(slide, t);
        slope / curvature
    }

    /// Whether P̈ > 0 at a time.
    pub(crate) fn pressure_bends_up(&self, slide: &Slide, t: f64) -> bool {
        self.pressure_rates(slide, t)[1] > 0.0
    }

    /// Ṗ/κ and P̈/κ.
    fn pressure_rates(&self, slide: &Slide, t: f64) -> [f64; 2] {
        let state = self.slow.state(self.slow_entry(slide), t);
        let fast = slide.layer * decayed(ratio(slide.duration - t, self.rho));
        let [mut slope, mut curvature] = self.slow_pressure_rates(state);
        if fast != 0.0 && self.rho > 0.0 {
            let moved = fast * self.layer_pressure();
            slope += moved;
            curvature += moved / self.rho;
        }
        [slope, curvature]
    }

    /// Times in (0, T) at which W vanishes.
    pub(crate) fn extremes(&self, slide: &Slide) -> Vec<f64> {
        let entry = self.slow_entry(slide);
        let acceleration = self.slow.acceleration(entry);
        self.zeros(
            [entry[1], acceleration],
            slide.layer * self.rho,
            slide.duration,
        )
    }

    /// Zeros in (0, T) of x(s) + g e^{(s−T)/ρ}, x a solution of ẍ − 2pẋ + qx = 0 with these initial
    /// values. Divided by e^{s/ρ} the sum has the slope (ρẋ − x)e^{−s/ρ}/ρ, whose zeros are known in
    /// closed form: between two of them there is one zero at most.
    fn zeros(&self, initial: [f64; 2], g: f64, duration: f64) -> Vec<f64> {
        let (p, q) = (self.slow.p, self.slow.q);
        let [value, slope] = initial;
        let curvature = 2.0 * p * slope - q * value;
        let unit = 1.0 / q.sqrt();
        let mut zeros = Vec::new();
        let mut places = Vec::new();
        if self.rho < THIN * unit {
            // the layer does not reach this far, and the zeros of the slope would be those of the sum
            let before = duration - LAYERS * self.rho.max(0.0);
            zeros = self.slow.zeros(value, slope, before);
            places.push(before.max(0.0));
        } else {
            places.push(0.0);
            places.extend(self.slow.zeros(
                self.rho * slope - value,
                self.rho * curvature - slope,
                duration,
            ));
        }
        places.push(duration);
        let at =
            |t: f64| self.slow.solution(initial, t)[0] + g * decayed(ratio(duration - t, self.rho));
        for pair in places.windows(2) {
            let (at_low, at_high) = (at(pair[0]), at(pair[1]));
            if at_low * at_high > 0.0 || at_low == at_high {
                continue;
            }
            let rising = at_high > at_low;
            let passed = |t: f64| (at(t) > 0.0) == rising;
            let (before, beyond) = boundary((pair[0], pair[1]), 2.0 * f64::EPSILON, passed);
            let zero = 0.5 * (before + beyond);
            // the layer may be thinner than a time next to T is resolved
            let layer = if self.rho > 0.0 { self.rho } else { unit };
            let at_end = (AT_SWITCH * unit.min(layer)).max(8.0 * f64::EPSILON * duration);
            if zero > 0.0 && duration - zero > at_end {
                zeros.push(zero);
            }
        }
        zeros
    }
}
