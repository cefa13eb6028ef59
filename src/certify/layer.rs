//! Sliding with material damping: what a layer adds to the flow of second order.
//!
//! V̈ = v̈ + G e^{(t−T)/ρ}, v solving m̂v̈ + ŝv̇ + hv = σfgδ and G being an unknown of the zone; so V̇ − v̇ and V − v are ρ and ρ²
//! times that. No number grows with 1/ρ along the zone, for any β > 0. The nodes between steps are those of v.

use super::flow::{AMPLITUDE, IntervalSeries, Positive, RegimeFlow, W, WHOLE};
use super::frame::{IntervalFrame, Layered};
use super::system::WaveSystem;
use crate::interval::{Interval, Number};
use crate::tube::model::signature::Regime;

impl WaveSystem<'_> {
    /// Whether a zone has a layer at its end.
    pub(super) fn is_layered(&self, zone: usize) -> bool {
        let regime = self.near.signature.zone(zone).regime;
        self.posed.written.material.is_some() && regime.sliding().is_some()
    }

    /// Whether an unknown is V̈ of a layer.
    pub(super) fn is_amplitude(&self, index: usize) -> bool {
        let mut zones = 0..self.near.zones.len();
        zones.any(|zone| self.is_layered(zone) && self.first[zone] + 3 == index)
    }

    /// The numbers of the layer of a zone.
    pub(super) fn layered<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
    ) -> Option<Layered<N>> {
        let [slip, reverse] = frame.layers?;
        match self.near.signature.zone(zone).regime {
            Regime::Slip => Some(slip),
            Regime::Reverse => Some(reverse),
            _ => None,
        }
    }

    /// Time from the beginning of a step to the end of its zone, of which `whole` is the duration.
    pub(super) fn left<N: Number>(&self, zone: usize, step: usize, whole: N) -> N {
        let steps = self.steps[zone];
        whole.scaled(Interval::point((steps - step) as f64) / Interval::point(steps as f64))
    }

    /// The slots of a step, at its beginning without the layer: at the entry of a zone they have Y and W themselves.
    pub(super) fn smooth<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
        step: usize,
        [y, w, amplitude, whole]: [N; 4],
    ) -> [N; 4] {
        match self.layered(frame, zone).filter(|_| step == 0) {
            Some(layered) => {
                let rate = layered.rho * layered.remains(amplitude, whole);
                [y - layered.rho * rate, w - rate, amplitude, whole]
            }
            None => [y, w, amplitude, whole],
        }
    }

    /// (Y, W, V̈, V⃛) a time before the end of a zone, where there is a layer.
    pub(super) fn moving<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
        smooth: [N; 4],
        left: N,
    ) -> [N; 4] {
        let both = self.layered(frame, zone).zip(self.flow(frame, zone));
        let Some((layered, flow)) = both else {
            return smooth;
        };
        let first = flow.derivative(smooth, true);
        let second = flow.derivative(first, false);
        let fast = layered.remains(smooth[AMPLITUDE], left);
        let rate = layered.rho * fast;
        [
            smooth[0] + layered.rho * rate,
            smooth[W] + rate,
            first[W] + fast,
            second[W] + fast * layered.rho.recip(),
        ]
    }

    /// (Y, W, V̈, V⃛) at the entry of a zone with a layer, from its first slots.
    pub(super) fn entered<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        zone: usize,
        slots: [N; 4],
    ) -> [N; 4] {
        self.moving(
            frame,
            zone,
            self.smooth(frame, zone, 0, slots),
            slots[WHOLE],
        )
    }
}

impl<N: Number> Layered<N> {
    /// V̈ of the layer a time before the end of its zone.
    fn remains(&self, amplitude: N, left: N) -> N {
        amplitude * (-(left * self.rho.recip())).exp()
    }
}

/// A zone with a layer, over which a quantity is to be positive.
pub struct Layers<'a, N> {
    system: &'a WaveSystem<'a>,
    x: &'a [N],
    zone: usize,
    frame: &'a IntervalFrame<N>,
    flow: RegimeFlow<N>,
    layered: Layered<N>,
}

/// One step of it.
struct LayerStep<N> {
    series: IntervalSeries<N>,
    amplitude: N,
    /// Time from its beginning to the end of the zone.
    left: N,
}

/// A piece of a step, and the orders of the known zeros at its ends.
#[derive(Clone, Copy)]
struct LayerPiece {
    from: f64,
    to: f64,
    orders: [usize; 2],
    depth: u32,
}

impl<'a, N: Positive> Layers<'a, N> {
    /// Bisections of a step: a layer may be 2⁵⁰ times as thin.
    const DEEPEST: u32 = 60;

    pub(super) fn new(
        system: &'a WaveSystem<'a>,
        frame: &'a IntervalFrame<N>,
        x: &'a [N],
        zone: usize,
    ) -> Option<Layers<'a, N>> {
        Some(Layers {
            system,
            x,
            zone,
            frame,
            flow: system.flow(frame, zone)?,
            layered: system.layered(frame, zone)?,
        })
    }

    pub(super) fn beta(&self) -> N {
        self.layered.beta
    }

    /// Whether a + bW + cV̈ is positive inside the zone, with zeros of known order at its ends and, where the event is a
    /// touch of it, one of order 2 inside. On a piece at a zero the derivative of that order has a sign.
    pub(super) fn is_positive(&self, of: [N; 3], orders: [usize; 2], touch: bool) -> bool {
        let steps = self.system.steps(self.zone);
        let touched = self.system.minimum(self.x).filter(|_| touch);
        (0..steps).all(|index| {
            let (state, time) = self.system.step_at(self.x, self.zone, index);
            let state = self.system.smooth(self.frame, self.zone, index, state);
            let step = LayerStep {
                series: self.flow.series(state),
                amplitude: state[AMPLITUDE],
                left: self.system.left(self.zone, index, state[WHOLE]),
            };
            let first = if index == 0 { orders[0] } else { 0 };
            let last = if index + 1 == steps { orders[1] } else { 0 };
            let piece = |from, to, orders| LayerPiece {
                from,
                to,
                orders,
                depth: 0,
            };
            let end = time.value().high;
            match touched {
                Some((_, at, place)) if at == index => {
                    let place = place.value();
                    self.is_positive_on(&step, &of, piece(0.0, place.high, [first, 2]))
                        && self.is_positive_on(&step, &of, piece(place.low, end, [2, last]))
                }
                _ => self.is_positive_on(&step, &of, piece(0.0, end, [first, last])),
            }
        })
    }

    fn is_positive_on(&self, step: &LayerStep<N>, of: &[N; 3], piece: LayerPiece) -> bool {
        let mut open = vec![piece];
        while let Some(piece) = open.pop() {
            let LayerPiece {
                from,
                to,
                orders: [first, last],
                depth,
            } = piece;
            let middle = 0.5 * (from + to);
            if first == 0 || last == 0 {
                let value = self.derivative(step, of, first + last, Interval::new(from, to));
                let value = if last % 2 == 1 { -value } else { value };
                if value.is_positive() {
                    continue;
                }
            }
            if depth == Self::DEEPEST || !(from < middle && middle < to) {
                return false;
            }
            let there = self.derivative(step, of, 0, Interval::point(middle));
            if first + last == 0 && !there.is_positive() {
                return false;
            }
            for (from, to, orders) in [(middle, to, [0, last]), (from, middle, [first, 0])] {
                open.push(LayerPiece {
                    from,
                    to,
                    orders,
                    depth: depth + 1,
                });
            }
        }
        true
    }

    /// The derivative of some order of a + bW + cV̈ over times of a step: that of v by its value in the middle and the next
    /// derivative over all of them, that of the layer, which is monotone, as it is.
    fn derivative(
        &self,
        step: &LayerStep<N>,
        [a, b, c]: &[N; 3],
        order: usize,
        time: Interval,
    ) -> N {
        let middle = Interval::point(time.middle());
        let smooth = |time: Interval| {
            let mut state = step.series.state(N::constant(time));
            for taken in 0..order {
                state = self.flow.derivative(state, taken == 0);
            }
            let next = self.flow.derivative(state, order == 0);
            let further = self.flow.derivative(next, false);
            (*b * state[W] + *c * next[W], *b * next[W] + *c * further[W])
        };
        let ((value, _), (_, slope)) = (smooth(middle), smooth(time));
        let rho = self.layered.rho;
        let fast = self
            .layered
            .remains(step.amplitude, step.left - N::constant(time));
        let inverse = rho.recip();
        let fast = (0..order).fold((*b * rho + *c) * fast, |fast, _| fast * inverse);
        let sum = value + slope.scaled(time - middle) + fast;
        if order == 0 { sum + *a } else { sum }
    }
}
