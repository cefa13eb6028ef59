//! The rates next to an equilibrium, and what λ of a sliding mode and the forces of contacts follow from.
//!
//! With contacts the unknowns beside the states are all forces q. One that a law says, −B, −kz, −kg − cġ or 0, has that as its equation. One
//! that holds has what it holds, s = 0 or g = 0. It follows from the rate of s, or of ġ, being zero: of these rates and of the laws the
//! derivatives in q are J, and where J is regular the forces are functions of the states. Where every diagonal entry of J⁻¹ that belongs
//! to what holds is positive, each of these forces works against what it holds, whatever the others do. λ of a sliding
//! mode is such a force, which holds h = 0.

use super::Rows;
use super::place::NameValues;
use super::resting::{ForceEquation, Resting};
use super::system::{EquilibriumSystem, Seeded, plain, plain_one};
use crate::affine::contact::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN,
};
use crate::affine::equilibrium::EquilibriumScales;
use crate::affine::expression::Expression;
use crate::affine::system::System;
use crate::certify::analytic::Analytic;
use crate::certify::krawczyk::LinearEquations;
use crate::interval::{Decimal, Gradient, Interval, Number, PI};
use crate::linalg::{Factors, Matrix, Vector};

/// A number with derivatives, and that with one more along the motion.
type Moved<N, const D: usize> = Gradient<Gradient<N, D>, 1>;

impl EquilibriumSystem<'_> {
    /// The law and the state of a contact.
    pub fn law(&self, contact: usize) -> Option<(&Law<Expression>, usize)> {
        let Resting::Contacts(contacts) = &self.resting else {
            return None;
        };
        self.system
            .contacts
            .get(contact)
            .zip(contacts.states.get(contact).copied())
    }

    /// The rates of the states.
    fn rates<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Vec<Gradient<N, D>>> {
        let place = self.place(y, parameter);
        match &self.resting {
            Resting::Mode(mode) => place.rates(*mode),
            Resting::Sliding(surface) => {
                let [first, second] = surface.sides;
                let (below, above) = (place.rates(first)?, place.rates(second)?);
                let share = *y.get(self.states())?;
                let mixed = below.into_iter().zip(above);
                Some(
                    mixed
                        .map(|(below, above)| below + share * (above - below))
                        .collect(),
                )
            }
            Resting::Contacts(contacts) => {
                let mut rates = place.rates(contacts.own)?;
                for (contact, stretch) in self.system.stretches.iter().enumerate() {
                    if let Some((Law::Jenkins { slip, .. }, HELD)) = self.law(contact) {
                        rates[(*stretch)?] = place.value(slip)?;
                    }
                }
                Some(rates)
            }
        }
    }

    /// The rate of a function of the states along the motion.
    fn along<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
        function: impl Fn(&[Moved<N, D>], Moved<N, D>) -> Option<Moved<N, D>>,
    ) -> Option<Gradient<N, D>> {
        let rates = self.rates(y, parameter)?;
        let mut moved = plain(y);
        for (moved, rate) in moved.iter_mut().zip(rates) {
            moved.by = [rate];
        }
        Some(function(&moved, plain_one(parameter))?.by[0])
    }

    /// The slip of a contact, or the rate of its gap.
    pub fn speed<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
        contact: usize,
    ) -> Option<Gradient<N, D>> {
        match self.law(contact)?.0 {
            Law::Friction { .. } | Law::Jenkins { .. } => {
                self.slip_or_gap(&self.place(y, parameter), contact)
            }
            Law::Stop { .. } | Law::Spring { .. } => self.along(y, parameter, |y, parameter| {
                self.slip_or_gap(&self.place(y, parameter), contact)
            }),
        }
    }

    /// The rate of that.
    pub fn acceleration<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
        contact: usize,
    ) -> Option<Gradient<N, D>> {
        self.along(y, parameter, |y, parameter| {
            self.speed(y, parameter, contact)
        })
    }

    /// q less what its law says.
    fn beside_law<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
        contact: usize,
    ) -> Option<Gradient<N, D>> {
        let place = self.place(y, parameter);
        let value = |expression: &Expression| place.value(expression);
        let force = *y.get(self.states() + contact)?;
        Some(match self.law(contact)? {
            (Law::Friction { bound, .. }, FORWARD)
            | (Law::Jenkins { bound, .. }, GIVES_FORWARD) => force + value(bound)?,
            (Law::Friction { bound, .. }, BACKWARD)
            | (Law::Jenkins { bound, .. }, GIVES_BACKWARD) => force - value(bound)?,
            (Law::Jenkins { stiffness, .. }, HELD) => {
                let stretch = self.system.stretches.get(contact).copied().flatten()?;
                force + value(stiffness)? * *y.get(stretch)?
            }
            (
                Law::Spring {
                    gap,
                    stiffness,
                    damping,
                },
                CLOSED,
            ) => {
                let elastic = force + value(stiffness)? * value(gap)?;
                match damping {
                    Some(damping) => {
                        elastic + value(damping)? * self.speed(y, parameter, contact)?
                    }
                    None => elastic,
                }
            }
            (Law::Stop { .. } | Law::Spring { .. }, OPEN) => force,
            // held, or of a damped spring that parts, which has no equilibrium
            _ => return None,
        })
    }

    /// E(y, p).
    pub fn rest<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Vec<Gradient<N, D>>> {
        let mut rows = self.rates(y, parameter)?;
        let place = self.place(y, parameter);
        for constraint in &self.constraints {
            rows.push(match *constraint {
                ForceEquation::Surface(zero) => place.zero(zero)?,
                ForceEquation::Slip(contact) | ForceEquation::Gap(contact) => {
                    self.slip_or_gap(&place, contact)?
                }
                ForceEquation::Law(contact) => self.beside_law(y, parameter, contact)?,
            });
        }
        Some(rows)
    }

    /// The slip or the gap of a contact.
    fn slip_or_gap<N: Analytic, const D: usize>(
        &self,
        place: &NameValues<Gradient<N, D>>,
        contact: usize,
    ) -> Option<Gradient<N, D>> {
        match self.law(contact)?.0 {
            Law::Friction { slip, .. } | Law::Jenkins { slip, .. } => place.value(slip),
            Law::Stop { gap, .. } | Law::Spring { gap, .. } => place.value(gap),
        }
    }

    /// What the unknowns beside the states follow from where these are given.
    fn followed<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Vec<Gradient<N, D>>> {
        let of = |constraint: &ForceEquation| match *constraint {
            ForceEquation::Surface(zero) => self.along(y, parameter, |y, parameter| {
                self.place(y, parameter).zero(zero)
            }),
            ForceEquation::Slip(contact) | ForceEquation::Gap(contact) => {
                self.acceleration(y, parameter, contact)
            }
            ForceEquation::Law(contact) => self.beside_law(y, parameter, contact),
        };
        self.constraints.iter().map(of).collect()
    }

    /// The functions that stay zero along the motion: those that are held, and the rates of gaps.
    fn surfaces<N: Analytic, const D: usize>(
        &self,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Vec<Gradient<N, D>>> {
        let place = self.place(y, parameter);
        let mut found = Vec::new();
        for constraint in &self.constraints {
            match *constraint {
                ForceEquation::Surface(zero) => found.push(place.zero(zero)?),
                ForceEquation::Slip(contact) => found.push(self.slip_or_gap(&place, contact)?),
                ForceEquation::Gap(contact) => {
                    found.push(self.slip_or_gap(&place, contact)?);
                    found.push(self.speed(y, parameter, contact)?);
                }
                ForceEquation::Law(_) => {}
            }
        }
        Some(found)
    }

    /// The linear parts of all that at y and p: the motion within its surfaces and normals of these; `None` where the forces
    /// are no functions of the states.
    pub fn motion(&self, x: &[Interval]) -> Option<(Rows, Rows)> {
        let (states, base) = (self.states(), &x[..=self.size]);
        let all = self.differentiated(base, |x| {
            let (y, parameter) = (plain(&x[..self.size]), plain_one(x[self.size]));
            let rates = self.rates(&y, parameter)?;
            let followed = self.followed(&y, parameter)?;
            let rows = rates.into_iter().chain(followed);
            let rows = rows.chain(self.surfaces(&y, parameter)?);
            Some(rows.map(|row| row.value).collect())
        })?;
        let mut rates = all.jacobian;
        let mut followed = rates.split_off(states);
        let mut normals = followed.split_off(self.size - states);
        let solver = LinearEquations::new(&inner(&followed, states, self.size))?;
        // ∂q/∂x
        let columns = (0..states).map(|column| {
            let side: Vec<Interval> = followed.iter().map(|row| -row[column]).collect();
            solver.solve(&side)
        });
        let columns: Rows = columns.collect::<Option<_>>()?;
        for row in &mut rates {
            let by_force = row.split_off(states);
            for (entry, column) in row.iter_mut().zip(&columns) {
                let terms = by_force.iter().zip(column);
                *entry = terms.fold(*entry, |sum, (by, force)| sum + *by * *force);
            }
        }
        normals.iter_mut().for_each(|row| row.truncate(states));
        Some((rates, normals))
    }

    /// The unknowns beside the states next to these, in doubles: Newton's method, of what is linear one step.
    pub fn forces(&self) -> Option<Vec<f64>> {
        /// Steps.
        const MOST: usize = 8;
        let (states, count) = (self.states(), self.constraints.len());
        let mut found = vec![0.0; count];
        for _ in 0..MOST {
            let place = self.near.state.iter().chain(&found);
            let place: Vec<Interval> = place
                .chain([&self.near.parameter])
                .map(|x| Interval::point(*x))
                .collect();
            let at = self.differentiated(&place, |x| self.followed_only(x))?;
            let matrix = Matrix::from_fn(count, count, |i, j| at.jacobian[i][states + j].middle());
            let side = at.residual.iter().map(|x| -x.middle());
            let mut step = Vector::from_iterator(count, side);
            if !Factors::new(&matrix).solve(&mut step) {
                return None;
            }
            let moved = found.iter().zip(step.iter()).map(|(force, by)| force + by);
            let moved: Vec<f64> = moved.collect();
            if moved == found {
                break;
            }
            found = moved;
        }
        found.iter().all(|force| force.is_finite()).then_some(found)
    }

    /// What the unknowns beside the states follow from, with derivatives in all unknowns.
    pub fn followed_only(&self, x: &[Seeded]) -> Option<Vec<Seeded>> {
        let followed = self.followed(&plain(&x[..self.size]), plain_one(x[self.size]))?;
        Some(followed.into_iter().map(|row| row.value).collect())
    }
}

/// Units of the forces of contacts at the first equilibrium of a branch: the least of those that move a state by its unit in that of time.
pub fn units_of_forces(
    system: &System,
    (values, parameter): (&[Decimal], usize),
    scales: &EquilibriumScales,
) -> Vec<f64> {
    type Once = Gradient<Interval, 1>;
    let number = |x: &f64| Once::constant(Interval::point(*x));
    let states = system.source.states.len();
    let place: Vec<Once> = scales.first.iter().map(number).collect();
    let unit = |contact: usize| -> Option<f64> {
        let force = |index: usize| match index == contact {
            true => Once::variable(Interval::ZERO, 0),
            false => number(&0.0),
        };
        let forces = (0..system.contacts.len()).map(force).collect();
        let values = values
            .iter()
            .enumerate()
            .map(|(index, value)| match index == parameter {
                true => place.get(states).copied(),
                false => Some(Once::constant(value.interval())),
            });
        let names = [
            place.get(..states)?.to_vec(),
            forces,
            values.collect::<Option<_>>()?,
        ];
        let names = NameValues::new(system, names, Once::constant(PI));
        let rates = (0..system.modes.len()).filter_map(|mode| names.rates(mode));
        let moved = rates.flat_map(|rates| {
            let by = rates.into_iter().map(|rate| rate.by[0].magnitude());
            by.zip(&scales.units)
                .map(|(by, unit)| unit * scales.rate / by)
        });
        moved.filter(|unit| unit.is_normal()).reduce(f64::min)
    };
    (0..system.contacts.len())
        .map(|contact| unit(contact).unwrap_or(1.0))
        .collect()
}

/// The columns of some unknowns.
pub fn inner(rows: &Rows, from: usize, to: usize) -> Rows {
    rows.iter().map(|row| row[from..to].to_vec()).collect()
}
