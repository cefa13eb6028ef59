//! A perturbation of a wave in one regime, and its propagator.

use super::flow::{DEGREE, geometric};
use super::frame::IntervalFrame;
use crate::interval::{Gradient, Interval, Number};
use crate::tube::model::signature::Regime;

/// Squarings of a propagator at most: 2¹² radians.
const SQUARINGS: f64 = 12.0;
/// Steps of a zone at most between which roundings are told apart: more may multiply them too often.
const STEPS: usize = 32;

/// A propagator over a step, and the number of steps.
pub(super) type Steps<N> = (Vec<Perturbation<N>>, usize);

/// Index of ζ, e^{−λs}η′, υ, e^{−λs}u′.
pub(super) const ETA: usize = 0;
pub(super) const ETA_RATE: usize = 1;
pub(super) const RADIAL: usize = 2;
pub(super) const RADIAL_RATE: usize = 3;

#[derive(Clone, Copy)]
pub(super) struct Complex<N> {
    pub(super) re: N,
    pub(super) im: N,
}

impl<N: Number> Complex<N> {
    pub(super) fn real(re: N) -> Complex<N> {
        let im = N::double(0.0);
        Complex { re, im }
    }

    pub(super) fn plus(self, other: Complex<N>) -> Complex<N> {
        Complex {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }

    pub(super) fn times(self, other: Complex<N>) -> Complex<N> {
        if self.im.is_zero() {
            return other.by(self.re);
        }
        if self.re.is_zero() {
            return Complex {
                re: -(self.im * other.im),
                im: self.im * other.re,
            };
        }
        Complex {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    pub(super) fn by(self, factor: N) -> Complex<N> {
        Complex {
            re: self.re * factor,
            im: self.im * factor,
        }
    }

    pub(super) fn minus(self) -> Complex<N> {
        self.by(N::double(-1.0))
    }

    pub(super) fn norm(&self) -> f64 {
        (Interval::point(self.re.norm()) + Interval::point(self.im.norm())).high
    }
}

impl<const D: usize> Complex<Gradient<Interval, D>> {
    pub(super) fn value(&self) -> Complex<Interval> {
        Complex {
            re: self.re.value,
            im: self.im.value,
        }
    }

    pub(super) fn slope(&self, slot: usize) -> Complex<Interval> {
        Complex {
            re: self.re.by[slot],
            im: self.im.by[slot],
        }
    }
}

pub(super) type Perturbation<N> = [Complex<N>; 4];

pub(super) fn nothing<N: Number>() -> Perturbation<N> {
    [Complex::real(N::double(0.0)); 4]
}

pub(super) fn unit<N: Number>(index: usize) -> Perturbation<N> {
    let mut unit = nothing();
    unit[index] = Complex::real(N::double(1.0));
    unit
}

/// Σ aᵢxᵢ over the first `count`.
pub(super) fn dot<N: Number>(a: &Perturbation<N>, x: &Perturbation<N>, count: usize) -> Complex<N> {
    let products = a.iter().zip(x).take(count).map(|(a, x)| a.times(*x));
    products.fold(Complex::real(N::double(0.0)), Complex::plus)
}

/// Σ xⱼ·columnⱼ.
pub(super) fn combined<N: Number>(
    columns: &[Perturbation<N>],
    x: &Perturbation<N>,
) -> Perturbation<N> {
    let mut sum = nothing();
    for (column, factor) in columns.iter().zip(x) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum = sum.plus(factor.times(*entry));
        }
    }
    sum
}

/// The equations of a perturbation in one regime: ẋ = (A − λ)x.
pub(super) struct PerturbationEquations<N> {
    /// Rows of the second derivatives of η and u; `None` without u.
    tangential: [Complex<N>; 4],
    radial: Option<[Complex<N>; 4]>,
    /// −λ.
    decay: Complex<N>,
    dimension: usize,
    weights: [f64; 4],
}

impl<N: Number> PerturbationEquations<N> {
    pub(super) fn new(
        frame: &IntervalFrame<N>,
        regime: Regime,
        lambda: Complex<N>,
        weights: [f64; 4],
    ) -> Option<PerturbationEquations<N>> {
        let one = N::double(1.0);
        let sigma = regime.sliding();
        if sigma.is_none() && regime != Regime::Separation {
            return None;
        }
        let real = Complex::real;
        let zero = real(N::double(0.0));
        let square = lambda.times(lambda);
        let twice = lambda.plus(lambda);
        let [g, h, kappa, damping] = [frame.g, frame.h, frame.kappa, frame.damping];
        let (stress, shear) = (one - frame.ma, one - frame.mb);
        let drag = (frame.friction * kappa).scaled(Interval::point(sigma.unwrap_or(0.0)));
        let (joined, coupled) = match sigma {
            Some(_) => (zero, zero),
            None => (lambda.by(kappa), real(-kappa)),
        };
        // over −m_a: h − ãλ² + σfκλ and 2ãλ − σfκ + α; then −κ(u′ − λu)
        let tangential = [
            real(h).plus(square.by(-stress)).plus(lambda.by(drag)),
            real(damping - drag).plus(twice.by(stress)),
            joined,
            coupled,
        ];
        // over −m_b: κ(η′ − λη), g − b̃λ², 2b̃λ + α
        let radial = [
            lambda.by(-kappa),
            real(kappa),
            real(g).plus(square.by(-shear)),
            real(damping).plus(twice.by(shear)),
        ];
        let (mass, radial_mass) = (-frame.ma.recip(), -frame.mb.recip());
        Some(PerturbationEquations {
            tangential: tangential.map(|entry| entry.by(mass)),
            radial: (sigma.is_none()).then(|| radial.map(|entry| entry.by(radial_mass))),
            decay: lambda.minus(),
            dimension: dimension(regime),
            weights,
        })
    }

    /// Stick: η′ = 0.
    pub(super) fn still(lambda: Complex<N>) -> PerturbationEquations<N> {
        PerturbationEquations {
            tangential: nothing(),
            radial: None,
            decay: lambda.minus(),
            dimension: 1,
            weights: [1.0; 4],
        }
    }

    /// |A − λ|.
    pub(super) fn norm(&self) -> f64 {
        let one = |at: usize, by: usize| {
            Interval::point(self.weights[at]) / Interval::point(self.weights[by])
        };
        let decay = Interval::point(self.decay.norm());
        let row = |at: usize, entries: &[Complex<N>; 4]| {
            let terms = entries.iter().enumerate();
            let terms = terms.map(|(by, entry)| one(at, by) * Interval::point(entry.norm()));
            terms.fold(decay, |sum, term| sum + term).high
        };
        if self.dimension == 1 {
            return decay.high;
        }
        let norm = row(ETA_RATE, &self.tangential).max((decay + one(ETA, ETA_RATE)).high);
        match &self.radial {
            None => norm,
            Some(radial) => norm
                .max(row(RADIAL_RATE, radial))
                .max((decay + one(RADIAL, RADIAL_RATE)).high),
        }
    }

    /// The perturbation after a time, by the power series.
    pub(super) fn advance(&self, start: Perturbation<N>, time: Interval) -> Perturbation<N> {
        let (mut sum, mut term) = (start, start);
        let count = self.dimension;
        for j in 0..DEGREE {
            let next = self.rate(&term);
            let share = time / Interval::point((j + 1) as f64);
            for index in 0..count {
                term[index] = Complex {
                    re: next[index].re.scaled(share),
                    im: next[index].im.scaled(share),
                };
                sum[index] = sum[index].plus(term[index]);
            }
        }
        let sizes = term.iter().zip(self.weights);
        let sizes = sizes.map(|(x, weight)| Interval::point(x.norm()) * Interval::point(weight));
        let size = sizes.fold(0.0_f64, |size, x| size.max(x.high));
        let theta = Interval::point(self.norm()) * Interval::point(time.magnitude());
        let rest = Interval::point(size) * geometric(theta);
        for (sum, weight) in sum[..count].iter_mut().zip(self.weights) {
            let bound = (rest / Interval::point(weight)).high;
            *sum = Complex {
                re: sum.re.widened(bound),
                im: sum.im.widened(bound),
            };
        }
        sum
    }

    /// e^{(A − λ)T} column by column, and over a step, with the number of steps; `None` where T is too long.
    pub(super) fn propagator(&self, time: Interval) -> Option<(Vec<Perturbation<N>>, Steps<N>)> {
        let squarings = (self.norm() * time.magnitude()).log2().ceil().max(0.0);
        if squarings.is_nan() || squarings > SQUARINGS {
            return None;
        }
        let step = time * Interval::point((-squarings).exp2());
        let columns = 0..self.dimension;
        let mut columns: Vec<_> = columns.map(|j| self.advance(unit(j), step)).collect();
        let mut steps = (columns.clone(), 1 << squarings as u32);
        for _ in 0..squarings as u32 {
            columns = columns.iter().map(|x| combined(&columns, x)).collect();
            if steps.1 > STEPS {
                steps = (columns.clone(), steps.1 / 2);
            }
        }
        Some((columns, steps))
    }

    /// (A − λ)x.
    pub(super) fn rate(&self, x: &Perturbation<N>) -> Perturbation<N> {
        let count = self.dimension;
        let mut rate = x.map(|x| x.times(self.decay));
        rate[ETA] = rate[ETA].plus(x[ETA_RATE]);
        rate[ETA_RATE] = rate[ETA_RATE].plus(dot(&self.tangential, x, count));
        if let Some(radial) = &self.radial {
            rate[RADIAL] = rate[RADIAL].plus(x[RADIAL_RATE]);
            rate[RADIAL_RATE] = rate[RADIAL_RATE].plus(dot(radial, x, count));
        }
        rate
    }
}

/// Components of a perturbation in a regime.
pub(super) fn dimension(regime: Regime) -> usize {
    match regime {
        Regime::Separation => 4,
        Regime::Stick => 1,
        _ => 2,
    }
}
