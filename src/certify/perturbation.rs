//! Eigenvalues of a wave: the equations of an eigenfunction.
//!
//! The eigenfunction problem is that of [`crate::tube::stability::characteristic`]. With ζ = e^{−λs}η and
//! υ = e^{−λs}u the condition of a Bloch sector, e^{−λT}η(T) = e^{2πij/k}η(0), has no exponential:
//! ζ(T) = e^{2πij/k}ζ(0). In every zone x = (ζ, e^{−λs}η′, υ, e^{−λs}u′) obeys ẋ = (A − λ)x; its propagator
//! e^{(A − λ)T} is a power series for T/2ⁿ, squared n times. Unknowns besides the wave are λ and x at the
//! beginning of the period, with ζ = 1; the equations say that the period gives x back, times e^{2πij/k}.
//!
//! At a crossing Re λ = 0 takes the place of the condition on the parameter. Where all equations have a
//! regular zero, λ is a simple eigenvalue, and it crosses the axis with a speed along the branch that is not
//! zero: with G(s, λ) = 0 for the eigenvalue, (G_s, iG_λ) are independent over the real numbers exactly if
//! Re dλ/ds ≠ 0.

use serde::{Deserialize, Serialize};

use super::equations::Evaluated;
use super::flow::{GAP_RATE, W, Y};
use super::frame::IntervalFrame;
use super::krawczyk;
use super::propagator::{
    Complex, ETA, ETA_RATE, Perturbation, PerturbationEquations, RADIAL, RADIAL_RATE, combined,
    dimension, dot, nothing, unit,
};
use super::system::{EXCESS, PARAMETER, SLOTS, TIME, WaveCondition, WaveSystem};
use crate::interval::{Gradient, Interval, Number, PI};
use crate::linalg::{Matrix, least};
use crate::tube::model::signature::ZoneEntry;

/// Slots of λ, beyond those of a step.
const GROWTH: usize = SLOTS;
const OMEGA: usize = SLOTS + 1;
const ALL: usize = SLOTS + 2;
type Mixed = Gradient<Interval, ALL>;

/// Slots of what the propagator of a zone depends on besides its duration.
const LOCAL: [usize; 4] = [EXCESS, PARAMETER, GROWTH, OMEGA];
type Local = Gradient<Interval, { LOCAL.len() }>;

/// An eigenvalue λ of a wave, with e^{λt}.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProvenEigenvalue {
    /// Bloch sector.
    pub sector: usize,
    /// λ in doubles.
    pub near: [f64; 2],
    /// Re λ.
    pub growth: Interval,
    /// Im λ.
    pub omega: Interval,
}

/// Where λ and an eigenfunction stand among unknowns and equations.
#[derive(Clone, Copy)]
pub(super) struct EigenfunctionPlace {
    sector: usize,
    /// Column of Re λ, which is 0 where it has none.
    growth: Option<usize>,
    /// Column of Im λ; those of the eigenfunction follow.
    omega: usize,
    row: usize,
}

/// What a perturbation becomes over a zone and the switch at its end: a column for each component.
struct ZoneTransfer {
    /// Columns of the unknowns in which derivatives are taken.
    columns: [Option<usize>; ALL],
    matrix: Vec<Perturbation<Mixed>>,
    /// The same as a product: over a step, how many there are, and over the switch.
    step: Vec<Perturbation<Interval>>,
    count: usize,
    switch: Vec<Perturbation<Interval>>,
}

impl ZoneTransfer {
    fn part(
        &self,
        of: impl Fn(&Complex<Mixed>) -> Complex<Interval>,
    ) -> Vec<Perturbation<Interval>> {
        parts(&self.matrix, of)
    }

    /// The factors in their order.
    fn factors(&self) -> impl Iterator<Item = &Vec<Perturbation<Interval>>> {
        std::iter::repeat_n(&self.step, self.count).chain(std::iter::once(&self.switch))
    }
}

fn parts<N>(
    matrix: &[Perturbation<N>],
    of: impl Fn(&Complex<N>) -> Complex<Interval>,
) -> Vec<Perturbation<Interval>> {
    let columns = matrix.iter();
    columns.map(|column| column.each_ref().map(&of)).collect()
}

fn before(
    effect: &Perturbation<Interval>,
    matrix: &[Perturbation<Interval>],
) -> Perturbation<Interval> {
    let mut row = nothing();
    for (entry, column) in row.iter_mut().zip(matrix) {
        *entry = dot(effect, column, 4);
    }
    row
}

fn rounded(x: Perturbation<Interval>) -> Perturbation<Interval> {
    let middle = |x: Interval| Interval::point(x.middle());
    x.map(|x| Complex {
        re: middle(x.re),
        im: middle(x.im),
    })
}

fn difference(a: Perturbation<Interval>, b: &Perturbation<Interval>) -> Perturbation<Interval> {
    std::array::from_fn(|index| a[index].plus(b[index].minus()))
}

/// A component at the end of the period, sharper than a product of intervals is.
///
/// With x̂ₙ and ŷₙ in doubles near the perturbation before the n-th factor Pₙ and near the row of its effect on
/// the component, eₙ = xₙ − x̂ₙ,
///
/// ```text
/// x_N = x̂_N + ŷ₀e₀ + Σ ŷₙ₊₁(Pₙx̂ₙ − x̂ₙ₊₁) + Σ (ŷₙ₊₁Pₙ − ŷₙ)eₙ,
/// ```
///
/// so that roundings add up instead of being multiplied; those of eₙ, which `course` knows at the beginning of
/// every zone, are multiplied by roundings.
fn sharpened(
    transfers: &[ZoneTransfer],
    course: &[Perturbation<Interval>],
    component: usize,
) -> Complex<Interval> {
    let mut near = rounded(course[0]);
    let mut states = vec![near];
    for factor in transfers.iter().flat_map(ZoneTransfer::factors) {
        near = rounded(combined(factor, &near));
        states.push(near);
    }
    let mut effect = unit(component);
    let mut effects = vec![effect];
    for transfer in transfers.iter().rev() {
        for factor in transfer.factors().collect::<Vec<_>>().into_iter().rev() {
            effect = rounded(before(&effect, factor));
            effects.push(effect);
        }
    }
    effects.reverse();
    let error = difference(course[0], &states[0]);
    let mut sum = dot(&effects[0], &error, 4);
    let mut index = 0;
    for (transfer, from) in transfers.iter().zip(course) {
        let mut error = difference(*from, &states[index]);
        for factor in transfer.factors() {
            let defect = difference(combined(factor, &states[index]), &states[index + 1]);
            let row = difference(before(&effects[index + 1], factor), &effects[index]);
            sum = sum
                .plus(dot(&effects[index + 1], &defect, 4))
                .plus(dot(&row, &error, 4));
            let moved = combined(factor, &error);
            error = std::array::from_fn(|part| moved[part].plus(defect[part]));
            index += 1;
        }
    }
    states[index][component].plus(sum)
}

/// A perturbation at the beginning of every zone, and at the end of the period.
fn course(
    transfers: &[ZoneTransfer],
    start: Perturbation<Interval>,
) -> Vec<Perturbation<Interval>> {
    let mut course = vec![start];
    for transfer in transfers {
        let moved = combined(&transfer.part(Complex::value), &course[course.len() - 1]);
        course.push(moved);
    }
    course
}

impl WaveSystem<'_> {
    /// Where λ of a crossing and its eigenfunction stand.
    pub(super) fn crossing(&self) -> Option<EigenfunctionPlace> {
        match &self.condition {
            WaveCondition::Crossing { sector, .. } => Some(EigenfunctionPlace {
                sector: *sector,
                growth: None,
                omega: self.waves(),
                row: self.waves() - 1,
            }),
            _ => None,
        }
    }

    /// Components of a perturbation at the beginning of the period.
    fn components(&self) -> usize {
        dimension(self.near.signature.zone(0).regime)
    }

    /// The eigenfunction at the beginning of the period, next to a wave and λ in doubles, but for ζ = 1.
    fn eigenfunction(&self, place: EigenfunctionPlace, x: &[Interval]) -> Option<Vec<f64>> {
        let count = self.components();
        if self.near.signature.zone(0).entry == ZoneEntry::Release && !self.sticks() {
            // η′ = 0 at release
            return Some(vec![0.0; 2 * (count - 1)]);
        }
        let mut period = Matrix::identity(2 * count, 2 * count) * -1.0;
        let transfers = self.transfers(place, x)?;
        for j in 0..count {
            let course = course(&transfers, unit(j));
            for (i, end) in course.last()?[..count].iter().enumerate() {
                let (re, im) = (end.re.middle(), end.im.middle());
                period[(2 * i, 2 * j)] += re;
                period[(2 * i, 2 * j + 1)] -= im;
                period[(2 * i + 1, 2 * j)] += im;
                period[(2 * i + 1, 2 * j + 1)] += re;
            }
        }
        // every vector of the null space is a complex multiple of one
        let vector = least(&period)?.right;
        let size = vector[0] * vector[0] + vector[1] * vector[1];
        let by_first = |j: usize| {
            let (re, im) = (vector[2 * j], vector[2 * j + 1]);
            let turned = [
                re * vector[0] + im * vector[1],
                im * vector[0] - re * vector[1],
            ];
            turned.map(|part| part / size)
        };
        Some((1..count).flat_map(by_first).collect())
    }

    /// λ and the eigenfunction of a crossing next to a wave in doubles.
    pub(super) fn crossing_near(&self, guess: &[f64]) -> Option<Vec<f64>> {
        let WaveCondition::Crossing { omega, .. } = &self.condition else {
            return Some(Vec::new());
        };
        let numbers = guess.iter().chain([omega]);
        let x: Vec<Interval> = numbers.copied().map(Interval::point).collect();
        let rest = self.eigenfunction(self.crossing()?, &x)?;
        Some(std::iter::once(*omega).chain(rest).collect())
    }

    /// The equations of the wave and of an eigenfunction at λ = iω.
    pub(super) fn crossing_at(&self, x: &[Interval]) -> Option<Evaluated> {
        let mut evaluated = self.waves_into(x, x.len())?;
        self.perturb(self.crossing()?, x, &mut evaluated)?;
        Some(evaluated)
    }

    /// Proves an eigenvalue of a Bloch sector of a wave that is known to intervals, next to one in doubles.
    pub(super) fn eigenvalue(
        &self,
        wave: &[Interval],
        sector: usize,
        near: [f64; 2],
    ) -> Option<[Interval; 2]> {
        let waves = self.waves();
        let place = EigenfunctionPlace {
            sector,
            growth: Some(waves),
            omega: waves + 1,
            row: waves,
        };
        let whole = |y: &[Interval]| [&wave[..waves], y].concat();
        let equations = |y: &[Interval]| {
            let x = whole(y);
            let mut evaluated = Evaluated::zero(x.len());
            self.perturb(place, &x, &mut evaluated)?;
            let rows = evaluated.jacobian.split_off(waves);
            Some(Evaluated {
                residual: evaluated.residual.split_off(waves),
                jacobian: rows
                    .into_iter()
                    .map(|mut row| row.split_off(waves))
                    .collect(),
            })
        };
        let middles: Vec<Interval> = wave.iter().map(|x| Interval::point(x.middle())).collect();
        let lambda = near.map(Interval::point);
        let start = self.eigenfunction(place, &[&middles[..waves], &lambda].concat())?;
        let guess = [&near[..], &start].concat();
        let units: Vec<f64> = guess.iter().map(|x| x.abs().max(1.0)).collect();
        let at = krawczyk::enclosed(&equations, &guess, &units)?.at;
        Some([at[0], at[1]])
    }

    /// Adds the equations of an eigenfunction.
    fn perturb(
        &self,
        place: EigenfunctionPlace,
        x: &[Interval],
        evaluated: &mut Evaluated,
    ) -> Option<()> {
        let count = self.components();
        let first = place.omega + 1;
        let mut start = unit(ETA);
        let parts = x[first..].chunks_exact(2);
        for (start, part) in start[1..count].iter_mut().zip(parts) {
            let [re, im] = [part[0], part[1]];
            *start = Complex { re, im };
        }
        let transfers = self.transfers(place, x)?;
        let course = course(&transfers, start);
        for equation in 0..count {
            let row = place.row + 2 * equation;
            let mut put = |value: Complex<Interval>, column: Option<usize>| {
                for (row, part) in [(row, value.re), (row + 1, value.im)] {
                    let entry = match column {
                        Some(column) => &mut evaluated.jacobian[row][column],
                        None => &mut evaluated.residual[row],
                    };
                    *entry = *entry + part;
                }
            };
            // of a box the derivatives are wanted, not the residual
            let last = if x[place.omega].low == x[place.omega].high {
                sharpened(&transfers, &course, equation)
            } else {
                course[transfers.len()][equation]
            };
            put(last.plus(start[equation].minus()), None);
            // what a perturbation at the beginning of a zone does to the equation
            let mut effect = unit(equation);
            for (transfer, from) in transfers.iter().zip(&course).rev() {
                for (slot, column) in transfer.columns.iter().enumerate() {
                    if column.is_some() {
                        let moved = combined(&transfer.part(|entry| entry.slope(slot)), from);
                        put(dot(&effect, &moved, 4), *column);
                    }
                }
                effect = before(&effect, &transfer.part(Complex::value));
            }
            effect[equation] = effect[equation].plus(Complex::real(-Interval::ONE));
            for (index, Complex { re, im }) in effect.into_iter().enumerate().take(count).skip(1) {
                let at = first + 2 * (index - 1);
                put(Complex { re, im }, Some(at));
                put(Complex { re: -im, im: re }, Some(at + 1));
            }
        }
        Some(())
    }

    /// What a perturbation becomes over every zone, the last with e^{−2πij/k}.
    fn transfers(&self, place: EigenfunctionPlace, x: &[Interval]) -> Option<Vec<ZoneTransfer>> {
        let [excess, parameter] = self.tail();
        let known = [
            (EXCESS, Some(excess)),
            (PARAMETER, Some(parameter)),
            (GROWTH, place.growth),
            (OMEGA, Some(place.omega)),
        ];
        let narrow: [Local; 4] = std::array::from_fn(|index| match known[index].1 {
            Some(column) => Local::variable(x[column], index),
            None => Local::double(0.0),
        });
        let wide = known.map(|(slot, column)| match column {
            Some(column) => Mixed::variable(x[column], slot),
            None => Mixed::double(0.0),
        });
        let lambda = Complex {
            re: narrow[2],
            im: narrow[3],
        };
        let narrow = self.frame(narrow[0], narrow[1])?;
        let frame = self.frame(wide[0], wide[1])?;
        let wide = Complex {
            re: wide[2],
            im: wide[3],
        };
        let zones = self.near.zones.len();
        let sector = Interval::point(2.0 * place.sector as f64);
        let turn = PI * sector / Interval::point(f64::from(self.mode()));
        let multiplier = Complex {
            re: Mixed::constant(turn.cos()),
            im: Mixed::constant(-turn.sin()),
        };
        let mut transfers = Vec::with_capacity(zones);
        for zone in 0..zones {
            let regime = self.near.signature.zone(zone).regime;
            let duration = self.duration(zone);
            let steps = self.steps(zone);
            let mut columns = [None; ALL];
            columns[..SLOTS].copy_from_slice(&self.columns(zone, steps - 1, duration));
            (columns[GROWTH], columns[OMEGA]) = (place.growth, Some(place.omega));
            let linear = match self.flow(&narrow, zone) {
                Some(flow) => PerturbationEquations::new(&narrow, regime, lambda, flow.weights())?,
                // V stays what it is: ζ turns by e^{−λT}
                None => PerturbationEquations::still(lambda),
            };
            let lifted = |column: Perturbation<Local>| {
                let rate = linear.rate(&column);
                std::array::from_fn(|index| lift(column[index], rate[index].value()))
            };
            let (moved, (step, count)) = linear.propagator(x[duration])?;
            let step = parts(&step, Complex::value);
            let mut matrix: Vec<Perturbation<Mixed>> = moved.into_iter().map(lifted).collect();
            let slot = |slot: usize| match columns[slot] {
                Some(column) => Mixed::variable(x[column], slot),
                None => Mixed::double(0.0),
            };
            let state = [slot(0), slot(1), slot(2), slot(3)];
            let time = slot(TIME).scaled(Interval::ONE / Interval::point(steps as f64));
            let end = match self.bends(zone) {
                true => self.later(&frame, zone, state, time),
                false => state,
            };
            let mut switch: Vec<Perturbation<Mixed>> = (0..dimension(regime)).map(unit).collect();
            for column in matrix.iter_mut().chain(&mut switch) {
                self.jump(&frame, wide, column, &end, zone);
                if zone + 1 == zones {
                    *column = column.map(|x| multiplier.times(x));
                }
            }
            transfers.push(ZoneTransfer {
                columns,
                matrix,
                step,
                count,
                switch: parts(&switch, Complex::value),
            });
        }
        Some(transfers)
    }

    /// Whether the state at the end of a zone enters the jump there.
    pub(super) fn bends(&self, zone: usize) -> bool {
        let next = self.near.signature.zone(zone + 1).entry;
        matches!(
            next,
            ZoneEntry::Reversal | ZoneEntry::Landing | ZoneEntry::Touch
        ) || next == ZoneEntry::Release && self.sticks()
    }

    /// What the switch at the end of a zone does to a perturbation; see the table of
    /// [`crate::tube::stability::characteristic`].
    pub(super) fn jump<N: Number>(
        &self,
        frame: &IntervalFrame<N>,
        lambda: Complex<N>,
        x: &mut Perturbation<N>,
        end: &[N; 4],
        zone: usize,
    ) {
        let zero = Complex::real(N::double(0.0));
        let next = self.near.signature.zone(zone + 1);
        let zones = self.near.zones.len();
        let rate = |zone: usize, state: [N; 4], component: usize| {
            let flow = self.flow(frame, zone % zones);
            flow.map_or(N::double(0.0), |flow| {
                flow.derivative(state, true)[component]
            })
        };
        let landed = [end[Y], end[W], N::double(0.0), N::double(0.0)];
        match next.entry {
            ZoneEntry::Arrest => x[ETA_RATE] = zero,
            ZoneEntry::Release => {
                x[ETA_RATE] = zero;
                if self.sticks() {
                    // V̈⁺(h + rfκλ − ãλ²)η/h
                    let stress = N::double(1.0) - frame.ma;
                    let factor = Complex::real(frame.h)
                        .plus(lambda.times(lambda).by(-stress))
                        .plus(lambda.by(frame.static_friction * frame.kappa));
                    let jump = rate(zone + 1, landed, W) * frame.h.recip();
                    x[ETA_RATE] = x[ETA].times(factor.by(jump));
                }
            }
            ZoneEntry::Reversal => {
                let ratio = rate(zone + 1, landed, W) * rate(zone, *end, W).recip();
                x[ETA_RATE] = x[ETA_RATE].by(ratio);
            }
            ZoneEntry::TakeOff => (x[RADIAL], x[RADIAL_RATE]) = (zero, zero),
            ZoneEntry::Landing | ZoneEntry::Touch => {
                let bend = rate(zone + 1, landed, W) - rate(zone, *end, W);
                let delay = x[RADIAL].by(end[GAP_RATE].recip());
                x[ETA_RATE] = x[ETA_RATE].plus(delay.by(bend));
                x[RADIAL] = zero;
                x[RADIAL_RATE] = delay.by(rate(zone + 1, landed, GAP_RATE));
            }
            ZoneEntry::ArrestedLanding | ZoneEntry::Section => {}
        }
    }
}

/// An entry of a propagator with the slots of a zone, and its rate in time.
fn lift(entry: Complex<Local>, rate: Complex<Interval>) -> Complex<Mixed> {
    let part = |part: Local, rate: Interval| {
        let mut by = [Interval::ZERO; ALL];
        for (slot, slope) in LOCAL.into_iter().zip(part.by) {
            by[slot] = slope;
        }
        by[TIME] = rate;
        Gradient {
            value: part.value,
            by,
        }
    };
    Complex {
        re: part(entry.re, rate.re),
        im: part(entry.im, rate.im),
    }
}
