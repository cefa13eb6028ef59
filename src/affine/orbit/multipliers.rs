//! Floquet multipliers: eigenvalues of the product of the flows of the zones and of the jumps between them, which is
//! never formed.
//!
//! A perturbation reaches a guard earlier or later; compared at equal time it jumps by S = Rₓ + (f⁺ − Rż⁻)gᵀ/ġ. States are
//! in units that balance all factors, so that nothing depends on those of the file, and where one grows by much within a
//! zone, as the potential of a neuron does before it is reset, in larger ones at its end. Without forcing the shift in time is
//! divided out of every factor, since each takes ẋ at its beginning to ẋ at its end.

use super::layout::{AffineOrbit, OrbitAt};
use super::monodromy::Monodromy;
use super::multiplier::Multiplier;
use super::passage::Passage;
use super::saltation::{NOTHING, Saltation, Sides, rank, sizes_of_product};
use super::setting::{OrbitFailure, Scales};

use super::signature::exit_of;
use crate::affine::mode::{Exit, Row};
use crate::linalg::periodic_schur::{Factor, balance, eigenvalues, regular_part, units_along};
use crate::linalg::{Matrix, Vector, product};
use crate::orbit::located::AT_ZERO;

/// A jump at a switch, in the states.
struct Jump {
    /// S.
    matrix: Matrix,
    /// Number of states less its rank.
    lost: usize,
    /// ẋ just after it.
    after: Vector,
}

/// From just after one switch to just after the next, in the states.
struct Link {
    /// Along the zone.
    flow: Matrix,
    /// What rounding may be of the entries of that which are left out for it.
    noise: Matrix,
    /// ẋ at its entry and at its end.
    rates: [Vector; 2],
    /// At its end, where there is a switch.
    jump: Option<Jump>,
    /// How well its end and the next entry agree, in units of the states: this far from an orbit the factors are known.
    closes: f64,
    /// How fast the guard falls, scaled to order one.
    fall: f64,
    /// Whether the jump grows without bound as that comes to zero.
    has_pole: bool,
    /// How much larger an error of the state is in the jump, which is divided by that.
    magnified: f64,
    /// What is left out of the flow, relative to its size.
    error: f64,
}

impl Link {
    /// One without a switch at its end.
    fn without_jump(
        [flow, noise]: [Matrix; 2],
        rates: [Vector; 2],
        (closes, error): (f64, f64),
    ) -> Link {
        Link {
            flow,
            noise,
            rates,
            jump: None,
            closes,
            fall: 1.0,
            has_pole: false,
            magnified: 1.0,
            error,
        }
    }

    /// The same as several, one after another: flows along parts of it, with ẋ at the beginning of each.
    fn in_parts(self, parts: Vec<(Matrix, Vector)>) -> Vec<Link> {
        let next = parts.iter().skip(1).map(|(_, rate)| rate.clone());
        let ends: Vec<Vector> = next.chain([self.rates[1].clone()]).collect();
        let parts = parts.into_iter().zip(ends);
        let links = parts.map(|((flow, begin), end)| {
            let noise = Matrix::zeros(flow.nrows(), flow.ncols());
            Link::without_jump([flow, noise], [begin, end], (0.0, self.error))
        });
        let mut links: Vec<Link> = links.collect();
        // what the whole has at its end the last part has
        if let Some(last) = links.pop() {
            links.push(Link {
                flow: last.flow,
                noise: last.noise,
                rates: last.rates,
                ..self
            });
        }
        links
    }
}

/// Error of a factor relative to its norm: the rounding of an exponential, or of a series.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A guard that falls more slowly than this, scaled to order one, is looked at for what vanishes with its speed.
const SLOW: f64 = 1e-3;

/// A jump of a rate that is smaller than this, in units of the state over that of time, is looked at for whether it is nothing but
/// the rounding of the guard.
const LITTLE: f64 = 1e-6;

/// ż at the end of a zone: by the law there or, where what it adds up cancels, as near rest, that at the entry as the flow
/// takes it along; every component by what tells it better.
fn rate_at_end(passage: &Passage, matrix: &Matrix) -> Vector {
    let at_entry = product(matrix, &passage.entry);
    let moved = product(&passage.flow, &at_entry);
    let by_law = sizes_of_product(matrix, &passage.end);
    let mut terms_at_entry = sizes_of_product(matrix, &passage.entry);
    let pairs = terms_at_entry.iter_mut().zip(&at_entry);
    pairs.for_each(|(size, rate)| *size += rate.abs());
    let by_flow = sizes_of_product(&passage.flow, &terms_at_entry);
    let told = |index: usize| match by_flow[index] < by_law[index] {
        true => moved[index],
        false => passage.rate[index],
    };
    Vector::from_fn(moved.len(), |index, _| told(index))
}

impl OrbitAt<'_> {
    fn link(&self, zone: usize, passage: &Passage) -> Link {
        if passage.shot + 1 < self.orbit.shots(zone) {
            return self.link_of_shots(zone, passage);
        }
        let n = self.orbit.states();
        let exit = exit_of(&self.posed.system, &self.orbit.sequence, zone);
        let (Some(exit), Some(way)) = (exit, self.orbit.sequence.zone(zone).way) else {
            return self.link_without_switch(zone, passage);
        };
        let row = &self.mode(zone).guards[way.guard].row;
        let rate = &match self.mode(zone).field.is_exact {
            true => rate_at_end(passage, &self.mode(zone).matrix.at),
            false => passage.rate.clone(),
        };
        let fall = row.at.dot(rate);
        let next = zone + 1;
        // what the reset makes of the state: at a graze the entry of the next zone has lost the speed in rounding
        let mut entry = passage.end.clone();
        entry
            .rows_mut(0, n)
            .copy_from(&product(&exit.reset.at, &passage.end));
        self.mode(next).field.complete(&mut entry);
        let normal = passage.gradient(row);
        let next_matrix = &self.mode(next).matrix.at;
        let mut saltation = Saltation::new(passage, exit, rate, (next_matrix, &entry));
        let speed = -fall * self.orbit.setting.scales.time / self.orbit.size(row);
        let ratios = self.ratios((zone, passage), (row, exit), (rate, speed), &mut saltation);
        let magnified = ratios.as_ref().map_or(speed.abs().recip(), |(_, by)| *by);
        let bounds = saltation.bounds(|j| match normal[j] {
            0.0 => 0.0,
            slope => (slope / fall).abs(),
        });
        let Saltation {
            reset,
            after,
            shift,
            ..
        } = saltation;
        let jumps = ratios.as_ref().map_or(&shift, |(ratios, _)| ratios);
        // what is a ratio by the structure does not grow as the speed falls, nor does it change its sign with that
        let has_pole = !exit.is_continuous() || ratios.as_ref().is_none_or(|(_, by)| *by > 0.0);
        let speed = if has_pole { speed } else { speed.abs() };
        let (jump, lost, fall, magnified) = match self.onto_surface(zone + 1) {
            // however slowly the motion comes to where sliding begins
            Some(surface) if self.comes_straight(zone) => (surface, 1, 1.0, 1.0),
            // nothing jumps: what a graze would magnify is zero
            None if jumps.amax() == 0.0 => {
                (reset.clone(), n - rank(reset, bounds), speed, magnified)
            }
            surface => {
                let entry = |i: usize, j: usize| match &ratios {
                    Some((ratios, _)) => reset[(i, j)] + ratios[i] * normal[j],
                    None => reset[(i, j)] + shift[i] * normal[j] / fall,
                };
                let jump = Matrix::from_fn(n, n, entry);
                let (jump, bounds) = match surface {
                    Some(surface) => (
                        &surface * &jump,
                        surface.abs() * (bounds + jump.abs() * NOTHING),
                    ),
                    None => (jump, bounds),
                };
                (jump.clone(), n - rank(jump, bounds), speed, magnified)
            }
        };
        let closes = self.closes(zone, &entry);
        let [flow, noise] = self.flow_of_states(zone, passage, closes);
        Link {
            flow,
            noise,
            rates: self.rates_of(zone, passage, rate),
            closes,
            jump: Some(Jump {
                matrix: jump,
                lost,
                after,
            }),
            fall,
            has_pole,
            magnified,
            error: self.error_of_flow(zone),
        }
    }

    /// What leads from a shot of a zone to the next one.
    fn link_of_shots(&self, zone: usize, passage: &Passage) -> Link {
        let next = self.shot_entry(zone, passage.shot + 1);
        let closes = self.apart(&next, &passage.end);
        self.link_within(zone, passage, closes)
    }

    /// What leads along a passage at whose end nothing switches.
    fn link_within(&self, zone: usize, passage: &Passage, closes: f64) -> Link {
        let flow = self.flow_of_states(zone, passage, closes);
        let rates = self.rates_of(zone, passage, &passage.rate);
        Link::without_jump(flow, rates, (closes, self.error_of_flow(zone)))
    }

    /// The jump of the rates at a switch over the speed of its guard, where that is low or nothing jumps by what the switch is, and how
    /// much larger an error of the state is in that. `None` where the guard falls fast, or where what is made of states is another
    /// function of those before a reset.
    fn ratios(
        &self,
        (zone, passage): (usize, &Passage),
        (guard, exit): (&Row, &Exit),
        (rate, speed): (&Vector, f64),
        saltation: &mut Saltation,
    ) -> Option<(Vector, f64)> {
        if exit.tangent.is_some() {
            return Some((Vector::zeros(self.orbit.states()), 0.0));
        }
        let mode = self.mode(zone);
        if !mode.field.is_exact && !exit.is_continuous() {
            return None;
        }
        let sides = Sides {
            reset: &exit.reset.at,
            modes: [&mode.matrix.at, &self.mode(zone + 1).matrix.at],
            guard: &guard.at,
            end: &passage.end,
        };
        let Scales { states, time, .. } = &self.orbit.setting.scales;
        saltation.without_guard(&sides, |state| LITTLE * states[state] / time);
        (speed.abs() < SLOW).then(|| {
            let (ratios, off) = saltation.refine(&sides, rate, guard.at.dot(rate));
            let parts = off.iter().zip(states).map(|(off, unit)| off / unit);
            (ratios, parts.fold(0.0, f64::max) * self.orbit.size(guard))
        })
    }

    /// What leads from a zone that no switch ends to itself a period later.
    fn link_without_switch(&self, zone: usize, passage: &Passage) -> Link {
        let closes = self.closes(zone, &passage.end);
        Link {
            jump: self.onto_surface(zone + 1).map(|matrix| Jump {
                matrix,
                lost: 1,
                after: passage.rate.rows(0, self.orbit.states()).into_owned(),
            }),
            ..self.link_within(zone, passage, closes)
        }
    }

    /// ∂x/∂x₀ of the states along a passage, without entries that are zero but for rounding, as those off the diagonal of half a
    /// turn are, and what these may be: units that balance all factors would make such an entry as large as one of another factor
    /// that is none, and a double multiplier would look like two. Rounding is measured in the units that balance the mode, beside what
    /// else is in the row and in the column.
    fn flow_of_states(&self, zone: usize, passage: &Passage, closes: f64) -> [Matrix; 2] {
        let mut flow = passage.forward();
        let n = flow.nrows();
        let mut noise = Matrix::zeros(n, n);
        if !self.mode(zone).field.is_exact {
            return [flow, noise];
        }
        let (scales, norm) = self.posed.balance(self.orbit.sequence.zone(zone).mode);
        let error = self.error_of_flow(zone) * (1.0 + norm * passage.time) + closes;
        let sizes = Matrix::from_fn(n, n, |i, j| flow[(i, j)].abs() * scales[j] / scales[i]);
        let rows: Vec<f64> = sizes.row_iter().map(|row| row.amax()).collect();
        for (j, column) in sizes.column_iter().enumerate() {
            let largest = column.amax();
            for (i, size) in column.iter().enumerate() {
                let rounding = error * rows[i].min(largest);
                // what acts on nothing is zero without rounding
                if i != j && *size > 0.0 && *size <= rounding {
                    flow[(i, j)] = 0.0;
                    noise[(i, j)] = rounding * scales[i] / scales[j];
                }
            }
        }
        [flow, noise]
    }

    /// Rates of the states at the entry of a zone and, as they are given, at its end.
    fn rates_of(&self, zone: usize, passage: &Passage, after: &Vector) -> [Vector; 2] {
        let before = product(&self.mode(zone).matrix.at, &passage.entry);
        let states = |rates: &Vector| rates.rows(0, self.orbit.states()).into_owned();
        [states(&before), states(after)]
    }

    /// Whether the orbit has shrunk to a point, by its rates: nothing is a shift in time there.
    fn stands(&self, rates: &[Vector]) -> bool {
        /// All are less than this, in units of the states over that of time: of their directions six digits are left at most.
        const POINT: f64 = 1e-10;
        let Scales { states, time, .. } = &self.orbit.setting.scales;
        let is_little = |(rate, unit): (&f64, &f64)| (rate * time).abs() < POINT * unit;
        let is_little = |rates: &Vector| rates.iter().zip(states).all(is_little);
        rates.iter().all(is_little)
    }

    /// How far the entry of the next zone is from what a zone leads to, in units of the states.
    fn closes(&self, zone: usize, led: &Vector) -> f64 {
        self.apart(&self.entry(zone + 1), led)
    }

    /// How far the states of two places are apart, in their units.
    fn apart(&self, one: &Vector, other: &Vector) -> f64 {
        let pairs = one.iter().zip(other).zip(&self.orbit.setting.scales.states);
        let off = pairs.map(|((x, led), unit)| (x - led).abs() / unit);
        off.fold(0.0, f64::max)
    }

    /// The same of half an orbit that never switches and the image of its entry.
    fn closes_at_image(&self, passage: &Passage, signs: &Vector) -> f64 {
        let entry = self.entry(0);
        let units = &self.orbit.setting.scales.states;
        let off = (0..signs.len())
            .map(|state| (passage.end[state] - signs[state] * entry[state]).abs() / units[state]);
        off.fold(0.0, f64::max)
    }

    fn links(&self, passages: &[Passage]) -> Vec<Link> {
        let zones = (0..self.zones.len())
            .flat_map(|zone| std::iter::repeat_n(zone, self.orbit.shots(zone)));
        let links = passages.iter().zip(zones);
        let links = links.flat_map(|(passage, zone)| {
            let whole = self.link(zone, passage);
            match self.parts_that_decay(zone, passage) {
                Some(parts) => whole.in_parts(parts),
                None => vec![whole],
            }
        });
        links.collect()
    }

    /// The linearised motion over half a period, with the image at its end: some states change their sign.
    pub(super) fn half_monodromy(&self, passages: &[Passage], signs: &Vector) -> Option<Monodromy> {
        let mut links = self.links(passages);
        let last = links.last_mut()?;
        let image = Matrix::from_diagonal(signs);
        if let Some(jump) = &mut last.jump {
            jump.matrix = image * &jump.matrix;
            jump.after.component_mul_assign(signs);
        } else {
            last.closes = self.closes_at_image(passages.last()?, signs);
            last.jump = Some(Jump {
                matrix: image,
                lost: 0,
                after: last.rates[1].component_mul(signs),
            });
        }
        self.over(links)
    }

    /// The linearised motion over a period; `None` where it is infinite, at a graze.
    pub(super) fn monodromy(&self, passages: &[Passage]) -> Option<Monodromy> {
        self.over(self.links(passages))
    }

    /// What is left out of the flow of a mode, relative to its size.
    fn error_of_flow(&self, zone: usize) -> f64 {
        match self.mode(zone).field.is_exact {
            true => ROUNDING,
            // that of some dozens of pieces
            false => 4.0 * ROUNDING + self.orbit.setting.system.flow_tolerance(),
        }
    }

    /// The linearised motion over links in a row.
    fn over(&self, links: Vec<Link>) -> Option<Monodromy> {
        let falls = links.iter().map(|link| link.fall).collect();
        let is_at_pole = |link: &Link| link.has_pole && link.fall <= AT_ZERO;
        let grazes = links.iter().any(is_at_pole);
        let mut factors = Vec::with_capacity(2 * links.len());
        let mut noises: Vec<(usize, Matrix)> = Vec::with_capacity(links.len());
        // ẋ at the beginning, and after every factor
        let mut rates: Vec<Vector> = Vec::with_capacity(2 * links.len() + 1);
        for link in links {
            let [before, after] = link.rates;
            if rates.is_empty() {
                rates.push(before);
            }
            rates.push(after);
            noises.push((factors.len(), link.noise));
            factors.push(Factor {
                matrix: link.flow,
                lost: 0,
                error: link.error + link.closes,
                size: 0.0,
            });
            // of a switch that only leads from one law to another nothing is left
            if let Some(jump) = link.jump.filter(|jump| !jump.matrix.is_identity(0.0)) {
                rates.push(jump.after);
                factors.push(Factor {
                    matrix: jump.matrix,
                    lost: jump.lost,
                    // it is divided by the speed at the guard, of which less is left the nearer it is to a graze
                    error: ROUNDING * link.magnified.max(1.0),
                    size: 0.0,
                });
            }
        }
        let moves = !self.orbit.is_forced() && !self.stands(&rates);
        let conserved = &self.orbit.conserved;
        if !conserved.is_empty() {
            for factor in &mut factors {
                factor.matrix = conserved.within(&factor.matrix);
            }
            for (_, noise) in &mut noises {
                *noise = conserved.within(noise).abs();
            }
            for rate in &mut rates {
                *rate = conserved.left(rate);
            }
        }
        let finite = |one: &Factor| one.matrix.iter().all(|x| x.is_finite());
        if !factors.iter().all(finite) {
            return None;
        }
        let common = balance(&matrices(&factors));
        in_units(&mut factors, &mut rates, |_| &common);
        let along = units_along(&matrices(&factors));
        in_units(&mut factors, &mut rates, |place| {
            &along[place % along.len()]
        });
        add_noise(&mut factors, &noises, |place| {
            let along = &along[place % along.len()];
            common
                .iter()
                .zip(along)
                .map(|(one, other)| one * other)
                .collect()
        });
        let shifts = moves && rates.iter().all(|rate| rate.norm() > 0.0);
        let factors = match shifts {
            true => across(factors, &rates),
            false => factors,
        };
        let (factors, zeros) = regular_part(factors);
        let own = eigenvalues(&factors);
        let own = own.iter().map(|one| Multiplier {
            value: one.value(),
            trivial: false,
            error: one.error(),
        });
        Some(Monodromy {
            own: own.collect(),
            falls,
            grazes,
            zeros: zeros + conserved.held(),
            ones: conserved.count() + usize::from(shifts),
        })
    }
}

fn matrices(factors: &[Factor]) -> Vec<&Matrix> {
    factors.iter().map(|one| &one.matrix).collect()
}

/// Takes factors, and the rates at the beginning and after every one, to other units of the states at these places.
fn in_units<'a>(
    factors: &mut [Factor],
    rates: &mut [Vector],
    units: impl Fn(usize) -> &'a Vec<f64>,
) {
    for (place, factor) in factors.iter_mut().enumerate() {
        for (j, (begin, end)) in units(place).iter().zip(units(place + 1)).enumerate() {
            factor.matrix.column_mut(j).scale_mut(*begin);
            factor.matrix.row_mut(j).scale_mut(end.recip());
        }
        factor.size = factor.matrix.norm();
    }
    for (place, rate) in rates.iter_mut().enumerate() {
        let scaled = rate.iter_mut().zip(units(place));
        scaled.for_each(|(rate, by)| *rate /= by);
    }
}

/// Adds what was left out of some factors for rounding, in the states, to their errors, by the units of the states at these places.
fn add_noise(
    factors: &mut [Factor],
    noises: &[(usize, Matrix)],
    units: impl Fn(usize) -> Vec<f64>,
) {
    for (place, noise) in noises {
        let [begin, end] = [*place, place + 1].map(&units);
        let scaled = noise.map_with_location(|i, j, noise| noise * begin[j] / end[i]);
        let factor = &mut factors[*place];
        factor.error += scaled.norm() / factor.size;
    }
}

/// Factors in coordinates of what is across the rate at their beginnings and ends, that of the first and after every one.
///
/// The rate at the end differs from that at the beginning by how well the orbit closes, which a product would carry into
/// the rest multiplied by its size: what is across the one goes to what is across the other. By how much a factor turns a
/// rate beside the next one, and the last one beside the first, is an error of it; how long they are is none, since what
/// is along a rate is left out.
fn across(factors: Vec<Factor>, rates: &[Vector]) -> Vec<Factor> {
    let Some(first) = rates.first() else {
        return factors;
    };
    let axis = first.iamax();
    let last = rates.len() - 1;
    let bases: Vec<Matrix> = rates
        .iter()
        .enumerate()
        .map(|(index, rate)| {
            let own = if index == last { axis } else { rate.iamax() };
            complement(rate, own)
        })
        .collect();
    let all = factors.into_iter().enumerate().map(|(index, factor)| {
        let [begin, end] = [&bases[index], &bases[index + 1]];
        let [rate, next] = [&rates[index], &rates[index + 1]];
        let image = &factor.matrix * rate;
        let off = end.tr_mul(&image).norm() / image.norm();
        let open = match index + 1 == last {
            true => bases[0].tr_mul(next).norm() / next.norm(),
            false => 0.0,
        };
        Factor {
            matrix: end.tr_mul(&(&factor.matrix * begin)),
            // an error of the factor turns the next rate by that of its image, which is what is left where it shrinks
            error: factor.error * (1.0 + factor.size * rate.norm() / next.norm()) + off + open,
            ..factor
        }
    });
    all.collect()
}

/// An orthonormal basis of what is perpendicular to a vector, which is not zero: the reflection that takes it to an
/// axis without the column of the axis.
fn complement(vector: &Vector, axis: usize) -> Matrix {
    let n = vector.len();
    let mut mirror = vector / vector.norm();
    mirror[axis] += 1.0_f64.copysign(mirror[axis]);
    let scale = 2.0 / mirror.norm_squared();
    let reflection = Matrix::identity(n, n) - &mirror * mirror.transpose() * scale;
    reflection.remove_column(axis)
}

impl AffineOrbit {
    /// The linearised motion over a period; `None` where it is infinite, at a graze.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn monodromy(&self, point: &Vector) -> Result<Option<Monodromy>, OrbitFailure> {
        let at = self.at(point)?;
        Ok(at.monodromy(&at.passages()?))
    }

    /// All Floquet multipliers at a point, the largest first; none at a graze, where they have no limit.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn multipliers(&self, point: &Vector) -> Result<Vec<Multiplier>, OrbitFailure> {
        let monodromy = self.monodromy(point)?;
        Ok(monodromy.map_or_else(Vec::new, |monodromy| monodromy.multipliers()))
    }
}
