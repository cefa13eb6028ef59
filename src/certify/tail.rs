//! A region without eigenvalues: |λ| ≥ Λ with Re λ ≥ ρ.
//!
//! In a zone, η and u are waves that run both ways. With p₁ + p₂ = η, x₁p₁ + x₂p₂ = wη′, w = 1/λ, and likewise of
//! u (see [`crate::tube::stability::asymptotic`] for x), the eigenfunction problem of a zone is, with e^{−λs} taken out,
//!
//! ```text
//! p′ = (λ(X − 1) + B + wZ)p,   X diagonal,  B and Z without λ.
//! ```
//!
//! p = (I + wK)v with Kᵢⱼ = Bᵢⱼ/(xⱼ − xᵢ), i ≠ j, takes away what B has besides its diagonal Y:
//!
//! ```text
//! v′ = (λ(X − 1) + Y + wE)v,   E = (I + wK)⁻¹(BK − KY + Z(I + wK)).
//! ```
//!
//! For |w| ≤ W = 1/Λ and Re λ ≥ ρ, every entry of e^{…s} is at most that of exp((ρ(X − 1) + Y + W|E|)s) in modulus,
//! since x < 1. The factors of a period, the switches with theirs, multiply up to a matrix of bounds. Where its
//! spectral radius is less than 1 there is no eigenvalue, in any sector. As Λ → ∞ the bound becomes that of
//! [`crate::tube::stability::asymptotic::HighFrequency`].

use super::frame::IntervalFrame;
use super::propagator::{Complex, ETA, ETA_RATE, Perturbation, dimension, unit};
use super::system::WaveSystem;
use crate::interval::Interval;
use crate::tube::model::signature::{Regime, ZoneEntry};

type Rows = Vec<Vec<Interval>>;

/// The waves of a zone.
struct ZoneWaves {
    /// xᵢ and 1 − xᵢ.
    x: Vec<Interval>,
    delay: Vec<Interval>,
    /// State (η, wη′, u, wu′) from p, and p from the state.
    state: Rows,
    from_state: Rows,
    b: Rows,
    z: Rows,
}

fn rows(n: usize, m: usize, entry: impl Fn(usize, usize) -> Interval) -> Rows {
    (0..n)
        .map(|i| (0..m).map(|j| entry(i, j)).collect())
        .collect()
}

fn product(a: &Rows, b: &Rows) -> Rows {
    let columns = b.first().map_or(0, Vec::len);
    rows(a.len(), columns, |i, j| {
        let terms = a[i].iter().zip(b).map(|(a, row)| *a * row[j]);
        terms.fold(Interval::ZERO, |sum, term| sum + term)
    })
}

fn sum(a: &Rows, b: &Rows) -> Rows {
    rows(a.len(), a[0].len(), |i, j| a[i][j] + b[i][j])
}

fn times(a: &Rows, factor: Interval) -> Rows {
    rows(a.len(), a[0].len(), |i, j| a[i][j] * factor)
}

fn identity(n: usize) -> Rows {
    rows(n, n, |i, j| Interval::point(if i == j { 1.0 } else { 0.0 }))
}

/// Upper bounds of the moduli.
fn moduli(a: &Rows) -> Rows {
    rows(a.len(), a[0].len(), |i, j| {
        Interval::point(a[i][j].magnitude())
    })
}

/// Largest row sum of moduli.
fn size(a: &Rows) -> Interval {
    let sums = a.iter().map(|row| {
        let moduli = row.iter().map(|entry| Interval::point(entry.magnitude()));
        moduli.fold(Interval::ZERO, |sum, entry| sum + entry).high
    });
    Interval::point(sums.fold(0.0, f64::max))
}

/// Bounds of (I + M)⁻¹ for all |M| ≤ m; `None` where m is too large.
fn inverse(m: &Rows) -> Option<Rows> {
    let size = size(m);
    let rest = Interval::ONE - size;
    if !rest.is_positive() {
        return None;
    }
    let n = m.len();
    let square = product(m, m);
    let others = size * size * size / rest;
    let rest = rows(n, n, |_, _| others);
    Some(sum(&sum(&identity(n), m), &sum(&square, &rest)))
}

/// exp(a) of a matrix that is not negative but on its diagonal.
fn exponential(a: &Rows) -> Option<Rows> {
    /// 2²³/23! is 3e-16.
    const TERMS: u32 = 23;
    let n = a.len();
    let halvings = size(a).high.max(1.0).log2().ceil();
    if halvings.is_nan() || halvings > 40.0 {
        return None;
    }
    let a = times(a, Interval::point((-halvings).exp2()));
    // e^{−1}·e^{a + I}, of a matrix that is not negative, of size 2 at most
    let a = sum(&a, &identity(n));
    let (mut series, mut term) = (identity(n), identity(n));
    for k in 1..=TERMS {
        term = times(
            &product(&term, &a),
            Interval::ONE / Interval::point(f64::from(k)),
        );
        series = sum(&series, &term);
    }
    // the terms left out fall faster than a geometric series of ratio 1/8
    let rest = size(&term) * Interval::point(0.25);
    let series = sum(&series, &rows(n, n, |_, _| rest));
    let mut power = times(&series, (-Interval::ONE).exp());
    for _ in 0..halvings as u32 {
        power = product(&power, &power);
    }
    Some(power)
}

impl ZoneWaves {
    fn new(frame: &IntervalFrame<Interval>, regime: Regime) -> ZoneWaves {
        let one = Interval::ONE;
        if regime == Regime::Stick {
            // η alone, which stays what it is
            let nothing = rows(1, 1, |_, _| Interval::ZERO);
            return ZoneWaves {
                x: vec![Interval::ZERO],
                delay: vec![one],
                state: identity(1),
                from_state: identity(1),
                b: nothing.clone(),
                z: nothing,
            };
        }
        let sigma = regime.sliding();
        let force = Interval::point(sigma.unwrap_or(0.0)) * frame.friction * frame.kappa;
        let mut fields = vec![(frame.ma, frame.h, force)];
        if sigma.is_none() {
            fields.push((frame.mb, frame.g, Interval::ZERO));
        }
        let n = 2 * fields.len();
        let q: Vec<Interval> = fields.iter().map(|field| (one - field.0).sqrt()).collect();
        // q/(1 + q) and −q/(1 − q), with m = (1 + q)(1 − q)
        let by_wave = |index: usize, value: &dyn Fn(Interval, Interval) -> [Interval; 2]| {
            value(q[index / 2], fields[index / 2].0)[index % 2]
        };
        let x: Vec<Interval> = (0..n)
            .map(|i| by_wave(i, &|q, m| [q / (one + q), -q * (one + q) / m]))
            .collect();
        let delay: Vec<Interval> = (0..n)
            .map(|i| by_wave(i, &|q, m| [one / (one + q), (one + q) / m]))
            .collect();
        let sign = |i: usize| Interval::point(if i.is_multiple_of(2) { 1.0 } else { -1.0 });
        let same = |i: usize, j: usize| i / 2 == j / 2;
        let state = rows(n, n, |i, j| match (same(i, j), i % 2) {
            (false, _) => Interval::ZERO,
            (true, 0) => one,
            _ => x[j],
        });
        let from_state = rows(n, n, |i, j| {
            let other = x[i ^ 1];
            let entry = if j % 2 == 0 { -other } else { one };
            match same(i, j) {
                true => entry / (x[i] - other),
                false => Interval::ZERO,
            }
        });
        let over = |i: usize| sign(i) / (Interval::point(2.0) * q[i / 2]);
        let b = rows(n, n, |i, j| {
            let pull = if same(i, j) {
                -fields[i / 2].2 * delay[j] - frame.damping * x[j]
            } else if i < 2 {
                -frame.kappa * delay[j]
            } else {
                frame.kappa * delay[j]
            };
            over(i) * pull
        });
        let z = rows(n, n, |i, j| match same(i, j) {
            true => -over(i) * fields[i / 2].1,
            false => Interval::ZERO,
        });
        ZoneWaves {
            x,
            delay,
            state,
            from_state,
            b,
            z,
        }
    }

    /// I + w|K|, bounds of the flow, and of (I + wK)⁻¹ before it, for |w| ≤ `w`, Re λ ≥ `rho`.
    fn bounds(&self, w: Interval, rho: Interval, duration: Interval) -> Option<Rows> {
        let n = self.x.len();
        let k = rows(n, n, |i, j| match i == j {
            true => Interval::ZERO,
            false => self.b[i][j] / (self.x[j] - self.x[i]),
        });
        let y = rows(n, n, |i, j| match i == j {
            true => self.b[i][i],
            false => Interval::ZERO,
        });
        let small = times(&moduli(&k), w);
        let back = inverse(&small)?;
        let forward = sum(&identity(n), &small);
        let moved = sum(
            &product(&self.b, &k),
            &times(&product(&k, &y), -Interval::ONE),
        );
        let pulled = product(&moduli(&self.z), &forward);
        let error = product(&back, &sum(&moduli(&moved), &pulled));
        let rate = rows(n, n, |i, j| {
            let error = Interval::point((w * error[i][j]).high);
            match i == j {
                true => self.b[i][i] - rho * self.delay[i] + error,
                false => error,
            }
        });
        let bounds = rows(n, n, |i, j| Interval::point((rate[i][j] * duration).high));
        Some(product(&forward, &product(&exponential(&bounds)?, &back)))
    }
}

/// Whether the spectral radius of a matrix of one or two rows that are not negative is less than 1.
fn contracts(a: &Rows) -> bool {
    let less = |x: Interval| Interval::ONE - x;
    match a.len() {
        1 => less(a[0][0]).is_positive(),
        2 => {
            let rest = [less(a[0][0]), less(a[1][1])];
            rest[0].is_positive()
                && rest[1].is_positive()
                && (rest[0] * rest[1] - a[0][1] * a[1][0]).is_positive()
        }
        _ => false,
    }
}

impl WaveSystem<'_> {
    /// The zones in their order from the first that sticks, or else from the first in contact.
    pub(super) fn course_of_zones(&self) -> Option<Vec<usize>> {
        let zones = self.near.signature.len();
        let regime = |zone: &usize| self.near.signature.zone(*zone).regime;
        let first = (0..zones)
            .find(|zone| regime(zone) == Regime::Stick)
            .or_else(|| (0..zones).find(|zone| regime(zone).sliding().is_some()))?;
        Some((0..zones).map(|index| (first + index) % zones).collect())
    }

    /// Whether a wave that is known to intervals has no eigenvalue with |λ| ≥ Λ, Re λ ≥ ρ ≥ 0 and |Im λ| ≤ `top`, in
    /// any sector.
    pub(super) fn is_free(
        &self,
        wave: &[Interval],
        least: f64,
        rho: f64,
        top: f64,
    ) -> Option<bool> {
        if self.sticks() && top.is_infinite() {
            return Some(false);
        }
        let frame = self.frame_at(wave)?;
        // |λ| at Re λ = ρ, which counts where static friction makes η′ of the order of λ²η: with the bound of a
        // period, which falls at least like e^{−T Re λ/2}, it falls as Re λ grows
        let largest = Interval::point(rho) + Interval::point(top);
        let releases = |zone: usize| {
            self.sticks() && self.near.signature.zone(zone + 1).entry == ZoneEntry::Release
        };
        let w = Interval::ONE / Interval::point(least);
        let course = self.course_of_zones()?;
        let regime = |zone: usize| self.near.signature.zone(zone).regime;
        if course.iter().any(|zone| regime(*zone) == Regime::Contact) {
            return Some(false);
        }
        let first = ZoneWaves::new(&frame, regime(course[0]));
        let mut period = identity(first.x.len());
        let (mut time, mut released) = (Interval::ZERO, Interval::ZERO);
        for (index, zone) in course.iter().enumerate() {
            let waves = ZoneWaves::new(&frame, regime(*zone));
            let next = course[(index + 1) % course.len()];
            let next = ZoneWaves::new(&frame, regime(next));
            let duration = wave[self.duration(*zone)];
            let Some(bounds) = waves.bounds(w, Interval::point(rho), duration) else {
                return Some(false);
            };
            // the switch on the state, its entries sorted by powers of w
            let end = self.end_of_zone(&frame, wave, *zone);
            let zero = Complex::real(Interval::ZERO);
            let switched: Vec<Perturbation<Interval>> = (0..dimension(regime(*zone)))
                .map(|column| {
                    let mut x = unit(column);
                    self.jump(&frame, zero, &mut x, &end, *zone);
                    x
                })
                .collect();
            let part = |power: usize| {
                // a rate has one power of w more; no switch makes values of rates
                let jump = rows(next.x.len(), waves.x.len(), |i, j| {
                    match i % 2 == power + j % 2 {
                        true => switched[j][i].re,
                        false => Interval::ZERO,
                    }
                });
                moduli(&product(&next.from_state, &product(&jump, &waves.state)))
            };
            let mut switch = sum(&part(0), &times(&part(1), w));
            if releases(*zone) {
                // of V̈⁺(h + rfκλ − ãλ²)/h what is not V̈⁺, over λ
                let stress = Interval::ONE - frame.ma;
                let force = frame.static_friction * frame.kappa + stress * largest;
                let rate = switched[ETA][ETA_RATE].re * force / frame.h;
                let jump = rows(next.x.len(), 1, |i, _| next.from_state[i][ETA_RATE] * rate);
                switch = sum(&switch, &moduli(&jump));
                released = released + Interval::ONE;
            }
            period = product(&product(&switch, &bounds), &period);
            time = time + duration;
        }
        let falls = largest * time * Interval::point(0.5) - released;
        Some(contracts(&period) && (released == Interval::ZERO || falls.is_positive()))
    }
}
