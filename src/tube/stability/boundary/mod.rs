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
//!
//! Without stick the last zone is followed by the first. The three conditions that join them, Bx before and
//! Ax behind the switch, hold for Bx e^{−λT}/z_j + Ax = 0, and the determinant of all conditions is
//!
//! ```text
//! D₀ + D₁ω + D₂ω² + D₃ω³,    ω = e^{−λT}/z_j,
//! ```
//!
//! D_m summed over the choices of m conditions in which B stands. Of the three multipliers of a period one
//! is that of the layer, which is large: D₁ takes the place of 1 in F_j, −D₂ and D₃ those of t and d.
//! An arrested landing joins two conditions only, η and η′, for it forgets η″: there are two multipliers, and
//! D₀ takes the place of 1, −D₁ and D₂ those of t and d.

mod part;

use nalgebra::{DMatrix, DVector};

use super::dual::{ComplexDual, determinant, simultaneous};
use super::perturbation::{Characteristic, LinearZone, PerturbationJump, ScaledComplex, Value};
use super::{C64, ONE, ZERO};
use crate::linalg::least_vector;
use crate::tube::model::signature::Regime;
use part::{BEND, ETA, GROWTH, LEFT, MotionShape, RATE, U, U_BEND, U_LEFT, U_RATE, ZoneMotions};

/// (u, u′, u″, η, η′, η″).
pub(super) type Motion = [C64; 6];

/// Adds a linear form of motions to a row.
fn add(row: &mut [ComplexDual], motions: &[[ComplexDual; 8]], form: &[(usize, f64)]) {
    for (slot, motion) in row.iter_mut().zip(motions) {
        for &(index, factor) in form {
            *slot = *slot + motion[index] * factor;
        }
    }
}

/// The system of one phase from release to stick, or of a period without stick.
struct Phase {
    parts: Vec<ZoneMotions>,
    /// M; the first row is η = 1 at release. Without stick the conditions within a period.
    rows: Vec<Vec<ComplexDual>>,
    /// η at the end of a phase that ends.
    end: Vec<ComplexDual>,
    /// B and A of the conditions from a period to the next, those on η and η′ first; none with stick.
    joints: Vec<[Vec<ComplexDual>; 2]>,
}

impl Phase {
    fn new(parts: Vec<ZoneMotions>, periodic: bool) -> Phase {
        let width = parts.iter().map(|part| part.shapes.len()).sum();
        let mut rows: Vec<Vec<ComplexDual>> = Vec::with_capacity(width);
        let mut joints = Vec::new();
        let none = vec![ComplexDual::constant(0.0); width];
        let start: &[usize] = if periodic { &[] } else { &[ETA, RATE] };
        for &index in start {
            let mut row = none.clone();
            add(&mut row, &parts[0].entry, &[(index, 1.0)]);
            rows.push(row);
        }
        let mut first = 0;
        let mut end = none.clone();
        for (index, part) in parts.iter().enumerate() {
            let next = first + part.shapes.len();
            let closing = periodic && index + 1 == parts.len();
            let (after, next) = if closing {
                (parts.first(), 0)
            } else {
                (parts.get(index + 1), next)
            };
            let mut condition = |before: &[(usize, f64)], behind: &[(usize, f64)]| {
                let mut row = none.clone();
                add(&mut row[first..], &part.exit, before);
                let mut row_behind = none.clone();
                if let Some(after) = after {
                    add(&mut row_behind[next..], &after.entry, behind);
                }
                if closing && !before.is_empty() && !behind.is_empty() {
                    joints.push([row, row_behind]);
                    return;
                }
                for (slot, behind) in row.iter_mut().zip(row_behind) {
                    *slot = *slot + behind;
                }
                rows.push(row);
            };
            let continued = |index: usize| ([(index, 1.0)], [(index, -1.0)]);
            match (part.zone.jump, after.map(|part| part.zone.regime)) {
                (PerturbationJump::Settle(landing), after) if landing.arrested => {
                    condition(&[(U, 1.0)], &[]);
                    condition(&[(RATE, 1.0), (U_RATE, -landing.before)], &[]);
                    if after.is_some() {
                        let (before, behind) = continued(ETA);
                        condition(&before, &behind);
                        condition(&[(U_RATE, landing.after)], &[(RATE, -1.0)]);
                    }
                }
                (_, None) => condition(&[(RATE, 1.0)], &[]),
                (PerturbationJump::Settle(landing), Some(regime)) => {
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
                        PerturbationJump::Bend(factor) => (factor, 0.0),
                        PerturbationJump::Depart(share) => (0.0, share),
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
            first += part.shapes.len();
        }
        Phase {
            parts,
            rows,
            end,
            joints,
        }
    }

    /// g and n, or D₁, −D₂, D₃ and D₀ (with two conditions D₀, −D₁ and D₂), e^{Σ rT} of the exponents counted from the end taken out.
    fn determinants(&self) -> Value {
        let shapes = self.shape_determinant();
        let inverse = ComplexDual {
            at: shapes.value,
            by: shapes.derivative,
        }
        .inverse();
        let inverse = ScaledComplex {
            value: inverse.at,
            derivative: inverse.by,
            exponent: -shapes.exponent,
        };
        let of = |rows: Vec<Vec<ComplexDual>>| determinant(rows).times(inverse);
        if !self.joints.is_empty() {
            let mut powers = vec![ScaledComplex::ZERO; self.joints.len() + 1];
            for choice in 0..1_usize << self.joints.len() {
                let mut rows = self.rows.clone();
                let chosen = self
                    .joints
                    .iter()
                    .enumerate()
                    .map(|(index, [before, behind])| {
                        let stands = choice >> index & 1 == 1;
                        if stands { before } else { behind }.clone()
                    });
                rows.extend(chosen);
                let power = &mut powers[choice.count_ones() as usize];
                *power = power.plus(of(rows));
            }
            let mut powers = powers.into_iter().map(Self::unit).rev();
            let mut next = || powers.next().unwrap_or(ScaledComplex::ZERO);
            let [determinant, trace, unit] = [next(), next(), next()];
            return Value {
                unit,
                trace: trace.times(ScaledComplex {
                    value: -ONE,
                    ..ScaledComplex::ONE
                }),
                determinant,
                layer: powers.next(),
                offset: 0.0,
            };
        }
        let mut bordered = self.rows.clone();
        for (index, row) in bordered.iter_mut().enumerate() {
            // −det of the bordered matrix is n
            row.push(ComplexDual::constant(if index == 0 { -1.0 } else { 0.0 }));
        }
        let mut last = self.end.clone();
        last.push(ComplexDual::constant(0.0));
        bordered.push(last);
        Value::of_stick([self.rows.clone(), bordered].map(|rows| Self::unit(of(rows))))
    }

    /// A number of the same exponent and argument, of modulus one: exponents alone tell how large determinants are.
    fn unit(of: ScaledComplex) -> ScaledComplex {
        if of.value == ZERO {
            return ScaledComplex::ZERO;
        }
        let unit = ScaledComplex::normalised(of.value, of.derivative);
        let exponent = unit.exponent + of.exponent;
        ScaledComplex { exponent, ..unit }
    }

    /// Π of the determinants of the motions of the zones at their entries.
    fn shape_determinant(&self) -> ScaledComplex {
        let mut shapes = ScaledComplex::ONE;
        for part in &self.parts {
            let of: &[usize] = match part.zone.regime {
                Regime::Separation => &[0, 1, 2, 3, 4, 5],
                _ => &[ETA, RATE, BEND],
            };
            let columns = part.shapes.iter().zip(&part.entry).map(|(shape, entry)| {
                let motion = if shape.origin == 0.0 {
                    *entry
                } else {
                    let entry = MotionShape {
                        origin: 0.0,
                        ..*shape
                    };
                    entry.at(0.0)
                };
                of.iter().map(|&index| motion[index]).collect()
            });
            shapes = shapes.times(determinant(columns.collect()));
        }
        shapes
    }

    /// The conditions with a value of ω.
    fn closed(&self, turn: C64) -> Vec<Vec<C64>> {
        let at = |row: &Vec<ComplexDual>| row.iter().map(|entry| entry.at).collect();
        let joined = self.joints.iter().map(|[before, behind]| {
            let pairs = before.iter().zip(behind);
            pairs
                .map(|(before, behind)| before.at * turn + behind.at)
                .collect()
        });
        self.rows.iter().map(at).chain(joined).collect()
    }
}

impl Characteristic {
    /// r² + αr + [stiffness − drive·(r − λ) − ã(r − λ)²](1 + βr).
    fn pencil(
        &self,
        [a, stiffness, drive]: [f64; 3],
        r: ComplexDual,
        lambda: ComplexDual,
    ) -> ComplexDual {
        let turned = r - lambda;
        let stretched = ComplexDual::constant(1.0) + r * self.beta;
        let force =
            ComplexDual::constant(stiffness) - turned * (turned * a + ComplexDual::constant(drive));
        r * (r + ComplexDual::constant(self.damping)) + force * stretched
    }

    /// The exponents and shapes of a zone.
    fn shapes(&self, zone: &LinearZone, lambda: C64) -> Vec<MotionShape> {
        let free = [self.a, self.h, 0.0];
        let radial = [self.b, self.g, 0.0];
        let bend = |r: ComplexDual, lambda: ComplexDual| {
            (r - lambda) * (ComplexDual::constant(1.0) + r * self.beta) * self.kappa
        };
        let sliding = zone.regime.sliding();
        let equation = |r: ComplexDual, lambda: ComplexDual| match sliding {
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
        let fixed = ComplexDual::constant(lambda);
        let moving = ComplexDual {
            at: lambda,
            by: ONE,
        };
        let roots = simultaneous(starts, |r| equation(ComplexDual { at: r, by: ONE }, fixed));
        roots
            .into_iter()
            .map(|at| {
                let slope = equation(ComplexDual { at, by: ONE }, fixed).by;
                let by = -equation(ComplexDual::constant(at), moving).by / slope;
                let r = ComplexDual { at, by };
                let shape = match sliding {
                    Some(_) => [ComplexDual::constant(0.0), ComplexDual::constant(1.0)],
                    None => self.separated_shape(r, moving, bend(r, moving)),
                };
                let late = at.re * zone.duration > GROWTH;
                let origin = if late { zone.duration } else { 0.0 };
                let drive = sliding.unwrap_or(0.0) * self.friction * self.kappa;
                let force = |of: [f64; 3]| match sliding {
                    Some(_) => ComplexDual::constant(0.0),
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
                MotionShape {
                    r,
                    shape,
                    apart,
                    origin,
                }
            })
            .collect()
    }

    /// (u, η) of an exponent in separation, of norm one: of the two oscillators it stands in that one counts which is farther
    /// from free.
    fn separated_shape(
        &self,
        r: ComplexDual,
        lambda: ComplexDual,
        bend: ComplexDual,
    ) -> [ComplexDual; 2] {
        let free = [self.a, self.h, 0.0];
        let radial = [self.b, self.g, 0.0];
        let (pa, pb) = (self.pencil(free, r, lambda), self.pencil(radial, r, lambda));
        let size = |[a, stiffness, _]: [f64; 3]| {
            r.at.norm_sqr()
                + (stiffness + a * (r.at - lambda.at).norm_sqr()) * (r.at * self.beta + 1.0).norm()
        };
        let shape = if pa.at.norm() * size(radial) > pb.at.norm() * size(free) {
            [pa, bend]
        } else {
            [bend * -1.0, pb]
        };
        let size = (shape[0].at.norm_sqr() + shape[1].at.norm_sqr()).sqrt();
        shape.map(|part| part * size.recip())
    }

    /// r − m/(βã) of a root of −βãr³ + m₂r² + m₁r + m₀ + force = 0, to its own rounding.
    fn apart(
        &self,
        r: ComplexDual,
        lambda: ComplexDual,
        [mass, a, stiffness, drive]: [f64; 4],
        force: impl Fn() -> ComplexDual,
    ) -> ComplexDual {
        let (beta, limit) = (self.beta, mass / (self.beta * a));
        if (r.at - limit).norm() > 0.5 * limit {
            return r - ComplexDual::constant(limit);
        }
        // βã(r − m/(βã)) = (m₂ − m) + m₁/r + (m₀ + force)/r²
        let l1 = lambda * (2.0 * a) - ComplexDual::constant(drive);
        let l0 = lambda * drive - lambda * lambda * a + ComplexDual::constant(stiffness);
        let m1 = l1 + l0 * beta + ComplexDual::constant(self.damping);
        let inverse = r.inverse();
        (l1 * beta + ((l0 + force()) * inverse + m1) * inverse) * (1.0 / (beta * a))
    }

    /// Every phase from release to stick.
    fn phases(&self, lambda: C64) -> Vec<Phase> {
        self.zones
            .split(|zone| zone.regime == Regime::Stick)
            .filter(|zones| !zones.is_empty())
            .map(|zones| {
                let part = |zone: &LinearZone| ZoneMotions::new(zone, self.shapes(zone, lambda));
                Phase::new(zones.iter().map(part).collect(), !self.stick)
            })
            .collect()
    }

    /// g and n of all phases, or what stands in their place without stick, and Σ rT with its derivative
    /// of what was taken out of them.
    pub(super) fn boundary_values(&self, lambda: C64) -> (Value, [C64; 2]) {
        let (mut values, mut common) = (Value::of_stick([ScaledComplex::ONE; 2]), [ZERO; 2]);
        for phase in self.phases(lambda) {
            let found = phase.determinants();
            values = if self.stick {
                let both = [(values.unit, found.unit), (values.trace, found.trace)];
                Value::of_stick(both.map(|(one, other)| one.times(other)))
            } else {
                found
            };
            for shape in phase.parts.iter().flat_map(|part| &part.shapes) {
                common[0] += shape.r.at * shape.origin;
                common[1] += shape.r.by * shape.origin;
            }
        }
        (values, common)
    }

    /// The motion at chosen times of every zone, for η = 1 at the first release; without stick the one
    /// that the next period repeats z times, if there is one. Also η and η′ at the end of the period, η′ = 0
    /// with stick.
    pub(super) fn material_states(
        &self,
        lambda: C64,
        z: C64,
        times: impl Fn(&LinearZone) -> Vec<f64>,
    ) -> (Vec<Vec<Motion>>, [C64; 2]) {
        let mut states = Vec::with_capacity(self.zones.len());
        let [mut eta, mut rate] = [ONE, ZERO];
        let mut phases = self.phases(lambda).into_iter();
        let mut zones = self.zones.iter().peekable();
        while let Some(zone) = zones.peek() {
            if zone.regime == Regime::Stick {
                let held = [ZERO, ZERO, ZERO, eta, ZERO, ZERO];
                states.push(vec![held; times(zone).len()]);
                zones.next();
                continue;
            }
            let Some(phase) = phases.next() else { break };
            let rows = phase.closed((-lambda * self.period).exp() / z);
            let count = rows.len();
            let mut matrix = DMatrix::from_fn(count, count, |i, j| rows[i][j]);
            let mut right = DVector::<C64>::zeros(count);
            right[0] = eta;
            for (index, mut row) in matrix.row_iter_mut().enumerate() {
                let size = row.iter().fold(0.0_f64, |size, x| size.max(x.norm()));
                row.unscale_mut(size);
                right[index] /= size;
            }
            let solved = if self.stick {
                matrix.lu().solve(&right)
            } else {
                least_vector(&matrix)
            };
            let amplitudes = solved.unwrap_or_else(|| DVector::repeat(count, C64::from(f64::NAN)));
            let mut first = 0;
            for part in &phase.parts {
                let last = first + part.shapes.len();
                let shares = part.shares(&amplitudes.as_slice()[first..last]);
                let at = |time: f64| {
                    let mut motion = [ZERO; 6];
                    for (shape, share) in part.shapes.iter().zip(&shares) {
                        for (sum, own) in motion.iter_mut().zip(shape.at(time)) {
                            *sum += own.at * share;
                        }
                    }
                    motion
                };
                states.push(times(&part.zone).into_iter().map(at).collect());
                first = last;
                zones.next();
            }
            let at_end = |row: &[ComplexDual]| -> C64 {
                let pairs = row.iter().zip(amplitudes.iter());
                pairs.map(|(row, amplitude)| row.at * amplitude).sum()
            };
            eta = at_end(&phase.end);
            if let [[of_eta, _], [of_rate, _], ..] = &phase.joints[..] {
                [eta, rate] = [at_end(of_eta), at_end(of_rate)];
            }
        }
        (states, [eta, rate])
    }
}

#[cfg(test)]
mod tests;
