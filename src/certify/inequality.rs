//! The inequalities of a wave, over whole zones.
//!
//! A function of a zone — 1 − W, P, U − δ — is a power series from either end of a step. Over half a step
//! from a known zero of order m it is tᵐg(t), and g > 0 is proven by subdivision; elsewhere m = 0. A touch
//! inside a zone, where the margin of an event vanishes, is a known zero of order 2 in both directions.

use super::flow::{GAP, GAP_RATE, IntervalSeries, Positive, RegimeFlow, W, Y};
use super::frame::IntervalFrame;
use super::layer::Layers;
use super::system::{NearWave, WaveCondition, WaveSystem};
use crate::interval::{Interval, Number};
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, ZoneEntry};
use crate::tube::wave::admissibility::WaveWatch;

/// Which inequality is not proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnprovenWave {
    /// The speed, or the numbers of the model.
    #[error("that the wave runs in the direction of D, faster than √a > √b")]
    Speed,
    /// The length of a zone.
    #[error("that zone {0} has a length")]
    Duration(usize),
    /// 1 − W in slip, W − 1 in reverse slip.
    #[error("the direction of sliding in zone {0}")]
    Sliding(usize),
    /// P in contact.
    #[error("P > 0 in zone {0}")]
    Pressure(usize),
    /// U − δ in separation.
    #[error("U > δ in zone {0}")]
    Gap(usize),
    /// A condition of the switching table at an end of a zone.
    #[error("the margin {1:?} of zone {0}")]
    Switch(usize, WaveWatch),
}

/// Bisections of half a step.
const DEEPEST: u32 = 24;

/// What is looked at in a zone.
#[derive(Clone, Copy)]
enum ZoneQuantity {
    /// σ(1 − W).
    Lag(f64),
    Pressure,
    Gap,
}

/// A function of time: offset + factor·component, from which `order` vanishing coefficients are left out.
struct TimeFunction<'a, N> {
    series: &'a IntervalSeries<N>,
    component: usize,
    offset: N,
    factor: N,
    order: usize,
}

impl<N: Positive> TimeFunction<'_, N> {
    /// f(t)/tᵐ over times t ≥ 0 forwards or backwards, whose sign is that of f: the value in the middle and
    /// the slope over all of them.
    fn at(&self, time: Interval, sign: f64) -> N {
        let middle = Interval::point(time.middle());
        let (there, all) = (N::constant(middle), N::constant(time));
        let value = self.series.at(self.component, there, self.order);
        let slope = self.series.slope(self.component, all, self.order);
        let sum = self.factor * (value + slope.scaled(time - middle));
        let offset = if self.order == 0 {
            self.offset
        } else {
            N::double(0.0)
        };
        if sign < 0.0 && self.order % 2 == 1 {
            -(sum + offset)
        } else {
            sum + offset
        }
    }

    /// Whether it is positive over [0, `length`], forwards or backwards.
    fn is_positive(&self, length: N, sign: f64) -> bool {
        bisect(length, sign, |time| self.at(time, sign))
    }

    /// Whether it is positive over a zone at whose end it vanishes, since f(t)/tᵐ falls all along.
    fn falls(&self, length: N) -> bool {
        bisect(length, 1.0, |time| {
            -(self.factor
                * self
                    .series
                    .slope(self.component, N::constant(time), self.order))
        })
    }
}

/// Whether a function of times is positive over [0, `length`], forwards or backwards.
pub(super) fn bisect<N: Positive>(length: N, sign: f64, of: impl Fn(Interval) -> N) -> bool {
    let mut open = vec![(0.0, length.value().high, 0)];
    while let Some((from, to, depth)) = open.pop() {
        let time = Interval::new(from, to) * Interval::point(sign);
        if of(time).is_positive() {
            continue;
        }
        let middle = 0.5 * (from + to);
        let there = of(Interval::point(middle * sign));
        if depth == DEEPEST || !there.is_positive() {
            return false;
        }
        open.push((from, middle, depth + 1));
        open.push((middle, to, depth + 1));
    }
    true
}

/// A zone being looked at.
struct ExaminedZone<'a, N> {
    system: &'a WaveSystem<'a>,
    x: &'a [N],
    frame: &'a IntervalFrame<N>,
    flow: RegimeFlow<N>,
    index: usize,
}

impl<N: Positive> ExaminedZone<'_, N> {
    /// Whether a quantity is positive within the zone, with zeros of known order at its ends and, where the
    /// event is a touch of it, one of order 2 inside.
    fn is_positive(
        &self,
        quantity: ZoneQuantity,
        at_start: usize,
        at_end: usize,
        touch: bool,
    ) -> bool {
        let steps = self.system.steps(self.index);
        let half = Interval::point(0.5);
        let touched = self.system.minimum(self.x).filter(|_| touch);
        let halves = (0..steps).all(|step| {
            let (state, time) = self.system.step_at(self.x, self.index, step);
            let forwards = self.flow.series(state);
            let order_there = if step + 1 == steps { at_end } else { 0 };
            let order_here = if step == 0 { at_start } else { 0 };
            if let Some((_, at, place)) = touched
                && at == step
            {
                // from the touch to both ends, neither of which is a zero
                let series = self.flow.series(forwards.state(place));
                return order_here + order_there == 0
                    && self.function(&series, quantity, 2).is_positive(place, -1.0)
                    && self
                        .function(&series, quantity, 2)
                        .is_positive(time - place, 1.0);
            }
            let end = if step + 1 == steps {
                forwards.state(time)
            } else {
                self.system.step_at(self.x, self.index, step + 1).0
            };
            let backwards = self.flow.series(end);
            self.function(&forwards, quantity, order_here)
                .is_positive(time.scaled(half), 1.0)
                && self
                    .function(&backwards, quantity, order_there)
                    .is_positive(time.scaled(half), -1.0)
        });
        halves || touched.is_none() && self.is_positive_at_once(quantity, at_start, at_end)
    }

    /// The same over a zone of one step that may be as short as one likes: in its halves the function may be, too,
    /// where it vanishes at the other end.
    fn is_positive_at_once(&self, quantity: ZoneQuantity, at_start: usize, at_end: usize) -> bool {
        if self.system.steps(self.index) > 1 {
            return false;
        }
        let (state, time) = self.system.step_at(self.x, self.index, 0);
        let forwards = self.flow.series(state);
        match (at_start, at_end) {
            (0, _) => {
                let backwards = self.flow.series(forwards.state(time));
                self.function(&backwards, quantity, at_end)
                    .is_positive(time, -1.0)
            }
            (_, 0) => self
                .function(&forwards, quantity, at_start)
                .is_positive(time, 1.0),
            (_, 1) => self.function(&forwards, quantity, at_start).falls(time),
            _ => false,
        }
    }

    /// Whether a flight from take-off to where U = δ and P = 0 again is its own mirror image in time, so that it
    /// lands without speed and P falls to 0 there as it rose from 0.
    ///
    /// Without damping (U(−t), −V(−t)) solves the equations with (U(t), V(t)). With time from the middle of the
    /// flight, ± τ at its ends, the odd part of U and the even part of V solve them too; at τ this U vanishes, and
    /// this V̇. Where no solution but zero does so there is no such part, and −U̇ at the end is U̇ at take-off, 0.
    fn is_mirrored(&self) -> bool {
        let zone = self.system.near.signature.zone(self.index);
        if zone.entry != ZoneEntry::TakeOff || !self.frame.damping.is_zero() {
            return false;
        }
        let steps = self.system.steps(self.index);
        let (_, step) = self.system.step_at(self.x, self.index, 0);
        let half = step.scaled(Interval::point(0.5));
        // the difference of two solutions is one without a force
        let from_middle = |component: Option<usize>| {
            let mut state = [N::double(0.0); 4];
            if let Some(component) = component {
                state[component] = N::double(1.0);
            }
            (0..steps).fold(state, |state, _| self.flow.series(state).state(half))
        };
        let still = from_middle(None);
        let [[w, gap], [other_w, other_gap]] = [Y, GAP_RATE].map(|component| {
            let moved = from_middle(Some(component));
            [W, GAP].map(|component| moved[component] - still[component])
        });
        let determinant = w * other_gap - gap * other_w;
        !determinant.value().contains(0.0)
    }

    fn function<'s>(
        &self,
        series: &'s IntervalSeries<N>,
        quantity: ZoneQuantity,
        order: usize,
    ) -> TimeFunction<'s, N> {
        let (component, offset, factor) = match quantity {
            ZoneQuantity::Lag(sigma) => (W, N::double(sigma), N::double(-sigma)),
            ZoneQuantity::Pressure => (W, self.frame.weight, self.frame.kappa),
            ZoneQuantity::Gap => (GAP, N::double(0.0), N::double(1.0)),
        };
        TimeFunction {
            series,
            component,
            offset,
            factor,
            order,
        }
    }
}

/// What vanishes at an event, and with it conditions of the zones next to it.
struct VanishingCondition<'a> {
    near: &'a NearWave,
    condition: &'a WaveCondition,
}

impl VanishingCondition<'_> {
    fn is(&self, wanted: WaveWatch, at: usize) -> bool {
        let at = at % self.near.zones.len();
        matches!(self.condition, WaveCondition::Margin { watch, zone, .. } if *watch == wanted && *zone == at)
    }

    /// Whether a zone has no length.
    fn closed(&self, zone: usize) -> bool {
        self.is(WaveWatch::Duration, zone)
    }

    /// Whether a zone of a regime, so entered, has no length.
    fn closed_as(&self, zone: usize, regime: Regime, entry: ZoneEntry) -> bool {
        let there = self.near.signature.zone(zone);
        self.closed(zone) && there.regime == regime && there.entry == entry
    }
}

/// Which inequalities are to be proven.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum ProvenPart {
    All,
    /// All but those within a zone, which opens or closes: it may be as short as one likes.
    But(usize),
    /// Those within such a zone.
    Within(usize),
}

impl ProvenPart {
    fn has(self, zone: usize) -> bool {
        match self {
            ProvenPart::All => true,
            ProvenPart::But(other) => zone != other,
            ProvenPart::Within(one) => zone == one,
        }
    }

    fn is_within(self) -> bool {
        matches!(self, ProvenPart::Within(_))
    }
}

/// P/T² just after a separation that lasts T, however short. With P = 0 at take-off P is κ(w₁T + w₂T² + …) at its
/// end, w and u being the coefficients of W and U − δ, and u₃ + u₄T + … = 0, u₃ = −κw₁/6m_b. A Coulomb impact adds
/// to it.
fn landing_pressure<N: Number>(
    system: &WaveSystem,
    frame: &IntervalFrame<N>,
    x: &[N],
    zone: usize,
) -> Option<N> {
    if system.steps(zone) > 1 {
        return None;
    }
    let (state, time) = system.step_at(x, zone, 0);
    let series = system.flow(frame, zone)?.series(state);
    let rest = frame.mb.scaled(Interval::point(6.0)) * series.at(GAP, time, 4);
    Some(frame.kappa * series.at(W, time, 2) + rest)
}

/// Proves inequalities of a wave over intervals of its unknowns, but for the margin that vanishes at the
/// event; returns how many there are.
pub fn prove<N: Positive>(
    system: &WaveSystem,
    condition: &WaveCondition,
    part: ProvenPart,
    x: &[N],
) -> Result<usize, UnprovenWave> {
    let near = system.near;
    let frame = &system.frame_at(x).ok_or(UnprovenWave::Speed)?;
    let mut proof = InequalityProof {
        system,
        x,
        frame,
        part,
        vanishing: VanishingCondition { near, condition },
        proven: 0,
    };
    // e > 0 is in m_a; a > b > 0 in m_b
    let beta = frame.layers.map(|[slip, _]| slip.beta);
    for number in [frame.ma, frame.mb, frame.kappa, frame.excess_ratio]
        .into_iter()
        .chain(beta)
    {
        proof.hold(number.is_positive(), UnprovenWave::Speed)?;
    }
    for index in 0..near.zones.len() {
        if proof.vanishing.closed(index) {
            continue;
        }
        if !part.is_within() {
            let duration = x[system.duration(index)];
            proof.hold(duration.is_positive(), UnprovenWave::Duration(index))?;
        }
        if !part.has(index) {
            continue;
        }
        match near.signature.zone(index).regime {
            Regime::Stick => proof.stick(index)?,
            _ if system.is_layered(index) => proof.layered(index)?,
            Regime::Slip | Regime::Reverse => proof.sliding(index)?,
            Regime::Separation => proof.separation(index)?,
            Regime::Contact => return Err(UnprovenWave::Sliding(index)),
        }
    }
    Ok(proof.proven)
}

/// Inequalities of a wave being proven, zone by zone.
struct InequalityProof<'a, N> {
    system: &'a WaveSystem<'a>,
    x: &'a [N],
    frame: &'a IntervalFrame<N>,
    part: ProvenPart,
    vanishing: VanishingCondition<'a>,
    proven: usize,
}

impl<N: Positive> InequalityProof<'_, N> {
    fn hold(&mut self, holds: bool, otherwise: UnprovenWave) -> Result<(), UnprovenWave> {
        self.proven += usize::from(holds);
        if holds { Ok(()) } else { Err(otherwise) }
    }

    /// A condition of the switching table at an end of a zone, unless it is the one that vanishes.
    fn edge(&mut self, watch: WaveWatch, index: usize) -> Result<(), UnprovenWave> {
        let index = index % self.system.near.zones.len();
        if self.vanishing.is(watch, index) {
            return Ok(());
        }
        let margin = self.system.edge_at(self.frame, self.x, watch, index);
        let holds = margin.is_some_and(|margin| margin.is_positive());
        self.hold(holds, UnprovenWave::Switch(index, watch))
    }

    fn zone_at(&self, index: usize) -> Result<ExaminedZone<'_, N>, UnprovenWave> {
        let flow = self.system.flow(self.frame, index);
        Ok(ExaminedZone {
            system: self.system,
            x: self.x,
            frame: self.frame,
            flow: flow.ok_or(UnprovenWave::Speed)?,
            index,
        })
    }

    fn before(&self, index: usize) -> usize {
        index + self.system.near.zones.len() - 1
    }

    /// P > 0 where V̇ ≥ 1.
    fn pressed(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let pressure = self.frame.weight + self.frame.kappa;
        self.hold(pressure.is_positive(), UnprovenWave::Pressure(index))
    }

    fn stick(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let (before, signature) = (self.before(index), &self.system.near.signature);
        // Q = fP at the end, and Q grows; where a reverse zone from W = 1 closes Q = −fP at the beginning
        let closed = self.vanishing.closed(before)
            && signature.zone(before).regime == Regime::Reverse
            && self.system.order(before) == 1;
        if !closed {
            self.edge(WaveWatch::LowerForce, index)?;
        }
        self.pressed(index)
    }

    fn sliding(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let signature = &self.system.near.signature;
        let (zone, next) = (signature.zone(index), signature.zone(index + 1));
        let slips = zone.regime == Regime::Slip;
        if next.entry == ZoneEntry::Reversal {
            let vanishing = &self.vanishing;
            if !slips && !vanishing.closed_as(index + 1, Regime::Slip, ZoneEntry::Reversal) {
                self.edge(WaveWatch::UpperForce, index)?;
            }
            if slips && self.system.sticks() {
                // Q < −rfP: what static friction could hold would stick
                let after = (index + 1) % self.system.near.zones.len();
                let force = self
                    .system
                    .edge_at(self.frame, self.x, WaveWatch::LowerForce, after);
                let holds = force.is_some_and(|force| (-force).is_positive());
                self.hold(holds, UnprovenWave::Switch(index, WaveWatch::LowerForce))?;
            }
        }
        if zone.entry == ZoneEntry::ArrestedLanding && self.system.sticks() {
            self.arrested(index)?;
        }
        self.direction(index, if slips { 1.0 } else { -1.0 })?;
        if slips || next.entry == ZoneEntry::TakeOff {
            self.pressure(index)
        } else {
            self.pressed(index)
        }
    }

    /// |Q| > rfP where a landing is arrested and slides at once: what static friction could hold would stick.
    fn arrested(&mut self, index: usize) -> Result<(), UnprovenWave> {
        if self.system.near.signature.zone(index).regime == Regime::Slip {
            return self.edge(WaveWatch::UpperForce, self.before(index));
        }
        let force = self
            .system
            .edge_at(self.frame, self.x, WaveWatch::LowerForce, index);
        let holds = force.is_some_and(|force| (-force).is_positive());
        self.hold(holds, UnprovenWave::Switch(index, WaveWatch::LowerForce))
    }

    /// A sliding zone with a layer: V̈ = 0 where it is released and where it is arrested, and P jumps there.
    fn layered(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let signature = &self.system.near.signature;
        let (zone, next) = (signature.zone(index), signature.zone(index + 1));
        let sigma = zone.regime.sliding().unwrap_or(1.0);
        if zone.entry == ZoneEntry::Release {
            self.edge(WaveWatch::Release, index)?;
        }
        if zone.regime == Regime::Reverse && next.entry == ZoneEntry::Reversal {
            self.edge(WaveWatch::UpperForce, index)?;
        }
        let vanishing = &self.vanishing;
        let lost = vanishing.is(WaveWatch::Release, index)
            || vanishing.is(WaveWatch::UpperForce, self.before(index));
        let at_start = self.system.order(index) + usize::from(lost);
        let at_end = match next.entry {
            ZoneEntry::Arrest => 2,
            _ => 1 + usize::from(vanishing.is(WaveWatch::UpperForce, index)),
        };
        let over =
            Layers::new(self.system, self.frame, self.x, index).ok_or(UnprovenWave::Speed)?;
        let [one, slides] = [1.0, sigma].map(N::double);
        let touch = [WaveWatch::Rate, WaveWatch::Pressure].map(|watch| vanishing.is(watch, index));
        let lag = [slides, -slides, N::double(0.0)];
        let slides = over.is_positive(lag, [at_start, at_end], touch[0]);
        self.hold(slides, UnprovenWave::Sliding(index))?;
        let frame = self.frame;
        let pressure = [frame.weight, frame.kappa, frame.kappa * over.beta() * one];
        let pressed = over.is_positive(pressure, [0, 0], touch[1]);
        self.hold(pressed, UnprovenWave::Pressure(index))
    }

    /// σ(1 − W) > 0.
    fn direction(&mut self, index: usize, sigma: f64) -> Result<(), UnprovenWave> {
        let vanishing = &self.vanishing;
        // W − 1 at the ends
        let at_start = match self.system.order(index) {
            0 if vanishing.is(WaveWatch::LandingRate, index) => 1,
            1 if vanishing.is(WaveWatch::UpperForce, self.before(index)) => 2,
            order => order,
        };
        let at_end = match self.system.near.signature.zone(index + 1).entry {
            ZoneEntry::TakeOff => 0,
            // released where it is arrested
            ZoneEntry::Arrest if vanishing.closed(index + 1) && sigma > 0.0 => 2,
            _ => 1,
        };
        let touch = vanishing.is(WaveWatch::Rate, index);
        let zone = self.zone_at(index)?;
        let lag = zone.is_positive(ZoneQuantity::Lag(sigma), at_start, at_end, touch);
        self.hold(lag, UnprovenWave::Sliding(index))
    }

    /// P > 0 in a zone that slides.
    fn pressure(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let (near, before) = (self.system.near, self.before(index));
        let preceding = before % near.zones.len();
        let short = self.part == ProvenPart::But(preceding)
            && near.signature.zone(before).entry == ZoneEntry::TakeOff;
        if short {
            let there = landing_pressure(self.system, self.frame, self.x, preceding);
            let holds = there.is_some_and(|there| there.is_positive());
            self.hold(holds, UnprovenWave::Pressure(index))?;
        }
        let vanishing = &self.vanishing;
        let closed = |zone| vanishing.closed_as(zone, Regime::Separation, ZoneEntry::TakeOff);
        let lifted = vanishing.is(WaveWatch::LandingPressure, index)
            || vanishing.closed_as(before, Regime::Separation, ZoneEntry::Touch);
        let at_start = match closed(before) {
            true => 2,
            // where it is short P is more than just after the landing
            false if short || lifted => 1,
            false => 0,
        };
        let at_end = match near.signature.zone(index + 1).entry {
            ZoneEntry::TakeOff if closed(index + 1) => 2,
            ZoneEntry::TakeOff => 1,
            _ => 0,
        };
        let touch = vanishing.is(WaveWatch::Pressure, index);
        let zone = self.zone_at(index)?;
        let pressed = zone.is_positive(ZoneQuantity::Pressure, at_start, at_end, touch);
        self.hold(pressed, UnprovenWave::Pressure(index))
    }

    /// U > δ, and what holds where it lands.
    fn separation(&mut self, index: usize) -> Result<(), UnprovenWave> {
        let (order, vanishing) = (self.system.order(index), &self.vanishing);
        if self.part.is_within() {
            // (U − δ)/tᵐ falls to 0 at the end: U̇ < 0 there
            let open = self
                .zone_at(index)?
                .is_positive_at_once(ZoneQuantity::Gap, order, 1);
            return self.hold(open, UnprovenWave::Gap(index));
        }
        // P = 0 where it lands
        let lifted = vanishing.is(WaveWatch::LandingPressure, index + 1)
            || vanishing.closed_as(index + 1, Regime::Separation, ZoneEntry::Touch);
        // a Coulomb impact changes V̇
        let rigid = self.system.impact() != Impact::Coulomb;
        let mirrored = lifted && rigid && self.zone_at(index)?.is_mirrored();
        if !mirrored {
            self.edge(WaveWatch::LandingSpeed, index)?;
        }
        let next = self.system.near.signature.zone(index + 1);
        if self.system.impact() == Impact::Coulomb && next.entry == ZoneEntry::ArrestedLanding {
            self.edge(WaveWatch::Impulse, index)?;
        }
        if self.system.impact() == Impact::Coulomb && next.entry == ZoneEntry::Touch {
            // friction takes V̇ towards 1, not past it
            let after = (index + 1) % self.system.near.zones.len();
            let lag = self
                .system
                .edge_at(self.frame, self.x, WaveWatch::LandingRate, after);
            let holds = lag.is_some_and(|lag| lag.is_positive());
            self.hold(holds, UnprovenWave::Switch(after, WaveWatch::LandingRate))?;
        }
        let vanishing = &self.vanishing;
        let at_start = order + usize::from(vanishing.is(WaveWatch::Tension, index));
        let at_end = match mirrored {
            true => 3,
            false => 1 + usize::from(vanishing.is(WaveWatch::LandingSpeed, index)),
        };
        let touch = vanishing.is(WaveWatch::Gap, index);
        let zone = self.zone_at(index)?;
        let open = zone.is_positive(ZoneQuantity::Gap, at_start, at_end, touch);
        self.hold(open, UnprovenWave::Gap(index))
    }
}
