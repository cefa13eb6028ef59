//! The eigenfunction problem between release and the next stick, with material damping, as one
//! boundary-value problem.
//!
//! Sliding zones have three exponents, separated ones six, two of which belong to layers that grow. With
//! K(r) = κ(r − λ)(1 + βr) and P_a, P_b as in sliding without friction, separation has the exponents and shapes
//!
//! ```text
//! P_a P_b + K² = 0,   (u, η) = (P_a, K)e^{rs}  or  (−K, P_b)e^{rs}.
//! ```
//!
//! An exponent that grows by much over a zone is counted from its end. What is known of a landing without
//! impact, with τ = −u′/Ü⁻ and the friction of the concentrated reaction, s = σfb/a, is
//!
//! | switch | conditions |
//! |---|---|
//! | take-off | u⁺ = u′⁺ = 0, η and η′ continuous, [η″ − su″] = 0 |
//! | landing, touch | u⁻ = 0, u⁺ = 0, u′⁺ = −Ü⁺τ, [η] = 0, [η′] = −[V̈]τ, [η″ − su″] = −[V⃛ − sU⃛]τ |
//! | arrested landing | u⁻ = 0, η′⁻ + V̈⁻τ = 0, [η] = 0, η′⁺ + V̈⁺τ = 0 |
//!
//! By the equations of separation and V̈⁻ − sÜ⁻ = V̈⁺ − sÜ⁺ the last of the landing is one between
//! η″ − m_aη′/(βã) and u″ − m_bu′/(βb̃), which layers leave as small as u′ (their products with 1/β
//! cancel as β → 0):
//!
//! ```text
//! [η″ − m_aη′/(βã) − s(u″ − m_bu′/(βb̃))] = −[…]τ,   the same of V⃛ and U⃛ in the bracket.
//! ```
//!
//! The conditions hold without those on u⁺ where there is contact, and on η⁺ where there is stick. Together with η = 1 and η′ = 0 at release they are a linear
//! system Mx = e for the amplitudes, and N = n/g, g = det M over the determinants of the shapes at the
//! entries, n the same of M bordered by η at the end. Both are entire: what depends on the order of the
//! exponents cancels. A determinant needs no more than its own pivots, on which it depends smoothly, so
//! that derivatives in λ are carried along, and g = 0 is a value like any other.

use std::ops::{Add, Mul, Sub};

use nalgebra::{DMatrix, DVector};

use super::perturbation::{C64, Characteristic, Jump, LinearZone, ONE, Scaled, ZERO};
use crate::model::signature::Regime;

/// (u, u′, u″, η, η′, η″).
pub(super) type Motion = [C64; 6];

/// A complex number with its derivative in λ.
#[derive(Clone, Copy, Debug)]
struct Dual {
    at: C64,
    by: C64,
}

impl Dual {
    fn constant(at: impl Into<C64>) -> Dual {
        Dual {
            at: at.into(),
            by: ZERO,
        }
    }

    fn inverse(self) -> Dual {
        let at = self.at.inv();
        Dual {
            at,
            by: -self.by * at * at,
        }
    }

    fn exp(self) -> Dual {
        let at = self.at.exp();
        Dual {
            at,
            by: self.by * at,
        }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        Dual {
            at: self.at + other.at,
            by: self.by + other.by,
        }
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        self + other * -1.0
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        Dual {
            at: self.at * other.at,
            by: self.by * other.at + self.at * other.by,
        }
    }
}

impl Mul<f64> for Dual {
    type Output = Dual;
    fn mul(self, factor: f64) -> Dual {
        Dual {
            at: self.at * factor,
            by: self.by * factor,
        }
    }
}

/// A motion (u, η) = shape·e^{rs} of a zone.
#[derive(Clone, Copy)]
struct Shape {
    r: Dual,
    shape: [Dual; 2],
    /// r − m_b/(βb̃) and r − m_a/(βã).
    apart: [Dual; 2],
    /// Where s is zero: at the entry, or at the end.
    origin: f64,
}

/// Most steps of the root search, and the last one relative to the root.
const MOST_STEPS: usize = 40;
const LAST_STEP: f64 = 1e-13;

/// An exponent that grows by more than this over a zone is counted from its end.
const GROWTH: f64 = 3.0;

impl Shape {
    fn at(&self, time: f64) -> [Dual; 8] {
        // the derivatives of the fastest motions stay of order one
        let size = self.r.at.norm_sqr().max(1.0).recip();
        let factor = (self.r * (time - self.origin)).exp() * size;
        let [u, eta] = self.shape.map(|shape| shape * factor);
        let [u_rate, rate] = [u * self.r, eta * self.r];
        let [u_left, left] = [u_rate * self.apart[0], rate * self.apart[1]];
        let [u_bend, bend] = [u_rate * self.r, rate * self.r];
        [u, u_rate, u_bend, eta, rate, bend, u_left, left]
    }
}

/// One zone with its motions, at its entry and at its end.
struct Part {
    zone: LinearZone,
    shapes: Vec<Shape>,
    entry: Vec<[Dual; 8]>,
    exit: Vec<[Dual; 8]>,
}

impl Part {
    fn new(zone: &LinearZone, shapes: Vec<Shape>) -> Part {
        let at = |time: f64| shapes.iter().map(|shape| shape.at(time)).collect();
        Part {
            zone: *zone,
            entry: at(0.0),
            exit: at(zone.duration),
            shapes,
        }
    }
}

/// Adds a linear form of motions to a row.
fn add(row: &mut [Dual], motions: &[[Dual; 8]], form: &[(usize, f64)]) {
    for (slot, motion) in row.iter_mut().zip(motions) {
        for &(index, factor) in form {
            *slot = *slot + motion[index] * factor;
        }
    }
}

/// The system of one phase from release to stick.
struct Phase {
    parts: Vec<Part>,
    /// M; the first row is η = 1 at release.
    rows: Vec<Vec<Dual>>,
    /// η at the end.
    end: Vec<Dual>,
}

/// Forms in η, η′ and u′, and the like.
const U: usize = 0;
const U_RATE: usize = 1;
const U_BEND: usize = 2;
const ETA: usize = 3;
const RATE: usize = 4;
const BEND: usize = 5;
/// u″ − m_b u′/(βb̃) and η″ − m_a η′/(βã): what the layers leave of their second derivatives.
const U_LEFT: usize = 6;
const LEFT: usize = 7;

impl Phase {
    fn new(parts: Vec<Part>) -> Phase {
        let width = parts.iter().map(|part| part.shapes.len()).sum();
        let mut rows: Vec<Vec<Dual>> = Vec::with_capacity(width);
        let none = vec![Dual::constant(0.0); width];
        for index in [ETA, RATE] {
            let mut row = none.clone();
            add(&mut row, &parts[0].entry, &[(index, 1.0)]);
            rows.push(row);
        }
        let mut first = 0;
        let mut end = none.clone();
        for (index, part) in parts.iter().enumerate() {
            let next = first + part.shapes.len();
            let after = parts.get(index + 1);
            let mut condition = |before: &[(usize, f64)], behind: &[(usize, f64)]| {
                let mut row = none.clone();
                add(&mut row[first..], &part.exit, before);
                if let Some(after) = after {
                    add(&mut row[next..], &after.entry, behind);
                }
                rows.push(row);
            };
            let continued = |index: usize| ([(index, 1.0)], [(index, -1.0)]);
            match (part.zone.jump, after.map(|part| part.zone.regime)) {
                (Jump::Settle(landing), after) if landing.arrested => {
                    condition(&[(U, 1.0)], &[]);
                    condition(&[(RATE, 1.0), (U_RATE, -landing.before)], &[]);
                    if after.is_some() {
                        let (before, behind) = continued(ETA);
                        condition(&before, &behind);
                        condition(&[(U_RATE, landing.after)], &[(RATE, -1.0)]);
                    }
                }
                (_, None) => condition(&[(RATE, 1.0)], &[]),
                (Jump::Settle(landing), Some(regime)) => {
                    let (before, behind) = continued(ETA);
                    condition(&before, &behind);
                    condition(&[(U, 1.0)], &[]);
                    // [V̈] = s[Ü], of which V̈⁻ and V̈⁺ would keep little as β → 0
                    let kept = landing.share * (landing.lift - 1.0);
                    condition(&[(RATE, 1.0), (U_RATE, kept)], &[(RATE, -1.0)]);
                    let share = landing.share;
                    condition(
                        &[(LEFT, 1.0), (U_LEFT, -share), (U_RATE, landing.bend)],
                        &[(LEFT, -1.0), (U_LEFT, share)],
                    );
                    if regime == Regime::Separation {
                        condition(&[], &[(U, 1.0)]);
                        condition(&[(U_RATE, landing.lift)], &[(U_RATE, -1.0)]);
                    }
                }
                (jump, Some(regime)) => {
                    for index in [ETA, RATE] {
                        let (before, behind) = continued(index);
                        condition(&before, &behind);
                    }
                    let (bend, share) = match jump {
                        Jump::Bend(factor) => (factor, 0.0),
                        Jump::Depart(share) => (0.0, share),
                        _ => (0.0, 0.0),
                    };
                    condition(
                        &[(BEND, 1.0), (RATE, bend)],
                        &[(BEND, -1.0), (U_BEND, share)],
                    );
                    if regime == Regime::Separation {
                        condition(&[], &[(U, 1.0)]);
                        condition(&[], &[(U_RATE, 1.0)]);
                    }
                }
            }
            if after.is_none() {
                add(&mut end[first..], &part.exit, &[(ETA, 1.0)]);
            }
            first = next;
        }
        Phase { parts, rows, end }
    }

    /// g and n, e^{Σ rT} of the exponents counted from the end taken out.
    fn determinants(&self) -> [Scaled; 2] {
        let mut shapes = Scaled {
            value: ONE,
            derivative: ZERO,
            exponent: 0.0,
        };
        for part in &self.parts {
            let of: &[usize] = match part.zone.regime {
                Regime::Separation => &[0, 1, 2, 3, 4, 5],
                _ => &[ETA, RATE, BEND],
            };
            let columns = part.shapes.iter().map(|shape| {
                let entry = Shape {
                    origin: 0.0,
                    ..*shape
                };
                let motion = entry.at(0.0);
                of.iter().map(|&index| motion[index]).collect()
            });
            shapes = shapes.times(determinant(columns.collect()));
        }
        let mut bordered = self.rows.clone();
        for (index, row) in bordered.iter_mut().enumerate() {
            // −det of the bordered matrix is n
            row.push(Dual::constant(if index == 0 { -1.0 } else { 0.0 }));
        }
        let mut last = self.end.clone();
        last.push(Dual::constant(0.0));
        bordered.push(last);
        let inverse = Dual {
            at: shapes.value,
            by: shapes.derivative,
        }
        .inverse();
        let inverse = Scaled {
            value: inverse.at,
            derivative: inverse.by,
            exponent: -shapes.exponent,
        };
        [self.rows.clone(), bordered].map(|rows| determinant(rows).times(inverse))
    }
}

/// A determinant with its derivative, by elimination with the largest pivots of the columns of rows of
/// equal size.
fn determinant(mut rows: Vec<Vec<Dual>>) -> Scaled {
    let count = rows.len();
    let mut product = Scaled {
        value: ONE,
        derivative: ZERO,
        exponent: 0.0,
    };
    for row in &mut rows {
        let size = row
            .iter()
            .fold(0.0_f64, |size, x| size.max(x.at.norm_sqr()));
        if size > 0.0 && size.is_finite() {
            let factor = size.sqrt().recip();
            row.iter_mut().for_each(|x| *x = *x * factor);
            product.exponent += 0.5 * size.ln();
        }
    }
    for index in 0..count {
        let size = |row: &Vec<Dual>| row[index].at.norm_sqr();
        let largest = (index..count)
            .max_by(|&one, &other| size(&rows[one]).total_cmp(&size(&rows[other])))
            .unwrap_or(index);
        if largest != index {
            rows.swap(largest, index);
            product.value = -product.value;
            product.derivative = -product.derivative;
        }
        let (done, left) = rows.split_at_mut(index + 1);
        let pivot = &done[index];
        product = product.times(Scaled {
            value: pivot[index].at,
            derivative: pivot[index].by,
            exponent: 0.0,
        });
        let inverse = pivot[index].inverse();
        for row in left {
            if row[index].at == ZERO && row[index].by == ZERO {
                continue;
            }
            let factor = row[index] * inverse;
            for column in index + 1..count {
                row[column] = row[column] - factor * pivot[column];
            }
        }
    }
    product
}

impl Characteristic {
    /// r² + αr + [stiffness − drive·(r − λ) − ã(r − λ)²](1 + βr).
    fn pencil(&self, [a, stiffness, drive]: [f64; 3], r: Dual, lambda: Dual) -> Dual {
        let turned = r - lambda;
        let stretched = Dual::constant(1.0) + r * self.beta;
        let force = Dual::constant(stiffness) - turned * (turned * a + Dual::constant(drive));
        r * (r + Dual::constant(self.damping)) + force * stretched
    }

    /// The exponents and shapes of a zone.
    fn shapes(&self, zone: &LinearZone, lambda: C64) -> Vec<Shape> {
        let free = [self.a, self.h, 0.0];
        let radial = [self.b, self.g, 0.0];
        let bend = |r: Dual, lambda: Dual| {
            (r - lambda) * (Dual::constant(1.0) + r * self.beta) * self.kappa
        };
        let sliding = zone.regime.sliding();
        let equation = |r: Dual, lambda: Dual| match sliding {
            Some(sigma) => {
                let drive = sigma * self.friction * self.kappa;
                self.pencil([self.a, self.h, drive], r, lambda)
            }
            None => {
                let bend = bend(r, lambda);
                self.pencil(free, r, lambda) * self.pencil(radial, r, lambda) + bend * bend
            }
        };
        let mut starts = self
            .split(lambda, self.tangential(sliding.unwrap_or(0.0)))
            .roots()
            .to_vec();
        if sliding.is_none() {
            starts.extend(self.split(lambda, self.radial()).roots());
        }
        let fixed = Dual::constant(lambda);
        let moving = Dual {
            at: lambda,
            by: ONE,
        };
        let roots = simultaneous(starts, |r| equation(Dual { at: r, by: ONE }, fixed));
        roots
            .into_iter()
            .map(|at| {
                let slope = equation(Dual { at, by: ONE }, fixed).by;
                let by = -equation(Dual::constant(at), moving).by / slope;
                let r = Dual { at, by };
                let shape = if sliding.is_some() {
                    [Dual::constant(0.0), Dual::constant(1.0)]
                } else {
                    // of the two the one whose oscillator is farther from free
                    let (pa, pb) = (self.pencil(free, r, moving), self.pencil(radial, r, moving));
                    let size = |[a, stiffness, _]: [f64; 3]| {
                        at.norm_sqr()
                            + (stiffness + a * (at - lambda).norm_sqr())
                                * (at * self.beta + 1.0).norm()
                    };
                    let bend = bend(r, moving);
                    let shape = if pa.at.norm() * size(radial) > pb.at.norm() * size(free) {
                        [pa, bend]
                    } else {
                        [bend * -1.0, pb]
                    };
                    let size = (shape[0].at.norm_sqr() + shape[1].at.norm_sqr()).sqrt();
                    shape.map(|part| part * size.recip())
                };
                let late = at.re * zone.duration > GROWTH;
                let origin = if late { zone.duration } else { 0.0 };
                let drive = sliding.unwrap_or(0.0) * self.friction * self.kappa;
                let force = |of: [f64; 3]| match sliding {
                    Some(_) => Dual::constant(0.0),
                    None => {
                        let bend = bend(r, moving);
                        bend * bend * self.pencil(of, r, moving).inverse()
                    }
                };
                let apart = [
                    self.apart(r, moving, self.radial(), || force(free)),
                    self.apart(r, moving, [self.ma, self.a, self.h, drive], || {
                        force(radial)
                    }),
                ];
                Shape {
                    r,
                    shape,
                    apart,
                    origin,
                }
            })
            .collect()
    }

    /// r − m/(βã) of a root of −βãr³ + m₂r² + m₁r + m₀ + force = 0, to its own rounding.
    fn apart(
        &self,
        r: Dual,
        lambda: Dual,
        [mass, a, stiffness, drive]: [f64; 4],
        force: impl Fn() -> Dual,
    ) -> Dual {
        let (beta, limit) = (self.beta, mass / (self.beta * a));
        if (r.at - limit).norm() > 0.5 * limit {
            return r - Dual::constant(limit);
        }
        // βã(r − m/(βã)) = (m₂ − m) + m₁/r + (m₀ + force)/r²
        let l1 = lambda * (2.0 * a) - Dual::constant(drive);
        let l0 = lambda * drive - lambda * lambda * a + Dual::constant(stiffness);
        let m1 = l1 + l0 * beta + Dual::constant(self.damping);
        let inverse = r.inverse();
        (l1 * beta + ((l0 + force()) * inverse + m1) * inverse) * (1.0 / (beta * a))
    }

    /// Every phase from release to stick.
    fn phases(&self, lambda: C64) -> Vec<Phase> {
        self.zones
            .split(|zone| zone.regime == Regime::Stick)
            .filter(|zones| !zones.is_empty())
            .map(|zones| {
                let part = |zone: &LinearZone| Part::new(zone, self.shapes(zone, lambda));
                Phase::new(zones.iter().map(part).collect())
            })
            .collect()
    }

    /// g and n of all phases, and Σ rT with its derivative of what was taken out of both.
    pub(super) fn boundary_values(&self, lambda: C64) -> ([Scaled; 2], [C64; 2]) {
        let one = Scaled {
            value: ONE,
            derivative: ZERO,
            exponent: 0.0,
        };
        let (mut values, mut common) = ([one; 2], [ZERO; 2]);
        for phase in self.phases(lambda) {
            let found = phase.determinants();
            values = [0, 1].map(|index| values[index].times(found[index]));
            for shape in phase.parts.iter().flat_map(|part| &part.shapes) {
                common[0] += shape.r.at * shape.origin;
                common[1] += shape.r.by * shape.origin;
            }
        }
        (values, common)
    }

    /// The motion at chosen times of every zone, for η = 1 at the first release. Also η at the end of the
    /// period.
    pub(super) fn material_states(
        &self,
        lambda: C64,
        times: impl Fn(&LinearZone) -> Vec<f64>,
    ) -> (Vec<Vec<Motion>>, C64) {
        let mut states = Vec::with_capacity(self.zones.len());
        let mut eta = ONE;
        let mut phases = self.phases(lambda).into_iter();
        let mut zones = self.zones.iter().peekable();
        while let Some(&zone) = zones.peek() {
            if zone.regime == Regime::Stick {
                let held = [ZERO, ZERO, ZERO, eta, ZERO, ZERO];
                states.push(vec![held; times(zone).len()]);
                zones.next();
                continue;
            }
            let Some(phase) = phases.next() else { break };
            let count = phase.rows.len();
            let mut matrix = DMatrix::from_fn(count, count, |i, j| phase.rows[i][j].at);
            let mut right = DVector::<C64>::zeros(count);
            right[0] = eta;
            for (index, mut row) in matrix.row_iter_mut().enumerate() {
                let size = row.iter().fold(0.0_f64, |size, x| size.max(x.norm()));
                row.unscale_mut(size);
                right[index] /= size;
            }
            let amplitudes = matrix
                .lu()
                .solve(&right)
                .unwrap_or_else(|| DVector::repeat(count, C64::from(f64::NAN)));
            let mut first = 0;
            for part in &phase.parts {
                let at = |time: f64| {
                    let mut motion = [ZERO; 6];
                    for (index, shape) in part.shapes.iter().enumerate() {
                        let amplitude = amplitudes[first + index];
                        for (sum, own) in motion.iter_mut().zip(shape.at(time)) {
                            *sum += own.at * amplitude;
                        }
                    }
                    motion
                };
                states.push(times(&part.zone).into_iter().map(at).collect());
                first += part.shapes.len();
                zones.next();
            }
            let end = phase.end.iter().zip(amplitudes.iter());
            eta = end.map(|(row, amplitude)| row.at * amplitude).sum();
        }
        (states, eta)
    }
}

/// All roots of a polynomial by the method of Aberth and Ehrlich from starts near them.
fn simultaneous(mut roots: Vec<C64>, value: impl Fn(C64) -> Dual) -> Vec<C64> {
    for _ in 0..MOST_STEPS {
        let mut found = true;
        for index in 0..roots.len() {
            let r = roots[index];
            let Dual { at, by } = value(r);
            let others = roots.iter().filter(|other| **other != r);
            let repelled: C64 = others.map(|other| (r - other).inv()).sum();
            let step = at / (by - at * repelled);
            if !step.is_finite() {
                continue;
            }
            roots[index] = r - step;
            found &= step.norm_sqr() <= LAST_STEP * LAST_STEP * r.norm_sqr();
        }
        if found {
            break;
        }
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::super::perturbation::{Reaction, Value};
    use super::*;

    /// ν = 0.3, ξ = 1.5, γ = 1, f = 0.5, mode 4, without mass damping.
    fn wave(beta: f64, speed: f64, zones: Vec<LinearZone>) -> Characteristic {
        let [a, b, d, g, h]: [f64; 5] = [
            1.087571206929277,
            0.31073463055122197,
            -0.8109523622920911,
            17.855545645727595,
            8.457890042713071,
        ];
        let square = speed * speed;
        Characteristic {
            period: zones.iter().map(|zone| zone.duration).sum(),
            zones,
            stick: true,
            mode: 4,
            excess: speed.abs() / a.sqrt() - 1.0,
            ma: 1.0 - a / square,
            mb: 1.0 - b / square,
            a: a / square,
            b: b / square,
            kappa: d / speed,
            g,
            h,
            friction: 0.5,
            static_friction: 0.5,
            damping: 0.0,
            beta,
            turn: 0.0,
        }
    }

    fn zone(regime: Regime, duration: f64, jump: Jump) -> LinearZone {
        LinearZone {
            regime,
            duration,
            jump,
        }
    }

    /// slip-separation-stick at δ = 0.01, from an independent program, with V̈/Ü before the landing.
    fn separated(
        beta: f64,
        [slip, free, stick]: [f64; 3],
        speed: f64,
        ratio: f64,
    ) -> Characteristic {
        let share = 0.5 * 0.31073463055122197 / 1.087571206929277;
        let landing = Reaction {
            before: ratio,
            after: 0.0,
            bend: 0.0,
            share,
            lift: 0.0,
            arrested: true,
        };
        let zones = vec![
            zone(Regime::Slip, slip, Jump::Depart(share)),
            zone(Regime::Separation, free, Jump::Settle(landing)),
            zone(Regime::Stick, stick, Jump::None),
        ];
        let mut wave = wave(beta, speed, zones);
        wave.turn = wave.material_turn();
        wave
    }

    fn specimens() -> [(Characteristic, [C64; 4]); 3] {
        let number = C64::new;
        [
            (
                separated(
                    0.005,
                    [0.3352077195928157, 0.8167057053031375, 0.09190901759717841],
                    -1.2628782639155272,
                    0.0829631002327951,
                ),
                [
                    number(1.0, 0.0),
                    number(-0.4423034386157088, -0.6816164577859914),
                    number(0.43385317297565, -0.6803887415518491),
                    number(-1.0145105895653699, -0.055474937299201464),
                ],
            ),
            (
                separated(
                    0.001,
                    [0.33083316494179377, 0.8195999707021037, 0.09692399427074753],
                    -1.25929959361549,
                    0.004100293122075833,
                ),
                [
                    number(1.0, 0.0),
                    number(-0.5098192055689909, -0.5826178613675397),
                    number(0.5417361049113807, -0.8070189253941591),
                    number(-1.345094002303426, -0.12145905424470385),
                ],
            ),
            (
                separated(
                    1e-6,
                    [0.3301748216008823, 0.8205530863955943, 0.09727835809135124],
                    -1.2586445833472704,
                    -0.013920682629959083,
                ),
                [
                    number(1.0, 0.0),
                    number(-0.5345329422448382, -0.5472062135130125),
                    number(0.6135388179633604, -0.8425484060987555),
                    number(-1.4469387942118943, -0.17912658617268695),
                ],
            ),
        ]
    }

    /// N of waves whose data have some 13 digits, over β.
    #[test]
    fn values_of_an_independent_program() {
        let places = [(0.0, 0.0), (0.1, 1.0), (0.3, 9.0), (1.0, 30.0)];
        for (wave, expected) in specimens() {
            for ((re, im), expected) in places.into_iter().zip(expected) {
                let lambda = C64::new(re, im);
                let [found, _] = wave.evaluate_material(lambda).numbers();
                let error = (found * (lambda * wave.period).exp() - expected).norm();
                println!("observed: β = {}, λ = {lambda}: {error:.1e}", wave.beta);
                assert!(error < 1e-11, "β = {}, λ = {lambda}: {error:e}", wave.beta);
            }
        }
    }

    /// Derivatives against differences of fourth order: of the size F they err by (hT)⁴/30, and by the
    /// rounding ε(1 + |λ|T) of exponents over hT, times the hundred operations of an elimination.
    #[test]
    fn derivatives_are_those_of_the_values() {
        for (wave, _) in specimens() {
            for (re, im) in [(0.0, 0.0), (0.3, 1.7), (-0.4, 12.0), (0.1, 70.0)] {
                let lambda = C64::new(re, im);
                // N e^{−λT}, in which the exponents of the layers cancel
                let of = |lambda: C64| {
                    let Value { unit, trace, .. } = wave.evaluate_material(lambda);
                    let [value, _] = wave.evaluate_material(lambda).numbers();
                    let by = trace.derivative / trace.value - unit.derivative / unit.value;
                    (value, value * by)
                };
                let h = 1e-3;
                let f = |shift: f64| of(lambda + shift * h).0;
                let difference = ((f(1.0) - f(-1.0)) * 8.0 - (f(2.0) - f(-2.0))) / (12.0 * h);
                let (value, by) = of(lambda);
                let error = (difference - by).norm() / (value.norm() + by.norm());
                let turned = f64::EPSILON * (1.0 + lambda.norm() * wave.period) / h;
                let allowed = 100.0 * ((h * wave.period).powi(4) / 30.0 + turned);
                println!("observed: derivative at {lambda}: {error:.1e} of {allowed:.1e}");
                assert!(
                    error < allowed,
                    "β = {}, λ = {lambda}: {error:e}",
                    wave.beta
                );
            }
        }
    }

    /// N of waves that slide is the same from determinants and by the compound flow.
    #[test]
    fn sliding_as_by_the_compound_flow() {
        let mut worst = 0.0_f64;
        for beta in [1e-2, 1e-4, 1e-8] {
            let zones = vec![
                zone(Regime::Slip, 0.98, Jump::Bend(0.7 / beta)),
                zone(Regime::Reverse, 0.07, Jump::Arrest),
                zone(Regime::Stick, 0.21, Jump::None),
            ];
            let wave = wave(beta, -1.243, zones);
            for (re, im) in [
                (0.0, 0.0),
                (0.3, 1.7),
                (-0.4, 12.0),
                (0.1, 70.0),
                (1.2, 0.0),
            ] {
                let lambda = C64::new(re, im);
                let [expected, _] = wave.evaluate_material(lambda).numbers();
                let (values, common) = wave.boundary_values(lambda);
                let [found, _] = wave.quotient(lambda, values, common).numbers();
                let error = (found - expected).norm() / expected.norm().max(1.0);
                worst = worst.max(error);
                assert!(error < 1e-12, "β = {beta}, λ = {lambda}: {error:e}");
            }
        }
        println!("observed: determinants against the compound flow: {worst:.1e}");
    }
}
