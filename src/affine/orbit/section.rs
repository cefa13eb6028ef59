//! Where an orbit begins that neither switches nor is forced: where one of its states is greatest, so that its rate is zero.
//!
//! Along a branch that maximum may become flat and vanish, where the orbit does not change at all. The orbit then begins where
//! another state is greatest.

use super::examine::Examination;
use super::layout::{AffineOrbit, OrbitAt};
use super::posed::Posed;
use super::setting::OrbitFailure;
use super::signature::Sequence;
use crate::continuation::Node;
use crate::linalg::Vector;

/// The states that move by a part that counts of what the others do in their units.
fn moving(extremes: &[(f64, f64)], units: &[f64]) -> impl Iterator<Item = usize> {
    /// Most cycles move all of their states; of one that hardly moves the extremes are rounding.
    const COUNTS: f64 = 0.1;
    let pairs = extremes.iter().zip(units);
    let ranges: Vec<f64> = pairs
        .map(|((low, high), unit)| (high - low) / unit)
        .collect();
    let largest = ranges.iter().copied().fold(0.0, f64::max);
    let moves = move |range: f64| largest > 0.0 && range >= COUNTS * largest;
    (0..ranges.len()).filter(move |state| moves(ranges[*state]))
}

/// The state that is greatest where an orbit begins: the first that moves.
pub fn of_orbit(extremes: &[(f64, f64)], units: &[f64]) -> Option<usize> {
    moving(extremes, units).next()
}

/// A maximum is flat where its second derivative is less than this part of that of a sine of the same range and period.
const FLAT: f64 = 0.1;

/// Another state is taken where its maximum is sharper by this factor.
const SHARPER: f64 = 4.0;

impl OrbitAt<'_> {
    /// The state whose maximum is sharpest, where that at which the orbit begins becomes flat.
    fn sharper(&self, examination: &Examination) -> Option<usize> {
        let number = self.orbit.sequence.zone(0).mode;
        let mode = self.mode(0);
        let own = self.orbit.section(mode);
        let period = self.zones[0].duration;
        let known = self.known(number, &self.entry(0), period).0;
        let rate = |state: usize| mode.matrix.row(state).at;
        // ẍ of a maximum as a part of that of a sine
        let part = |state: usize, second: f64| {
            let (low, high) = examination.extremes[state];
            let sine = 0.5 * (high - low) * (std::f64::consts::TAU / period).powi(2);
            -second / sine
        };
        let first = known.stages.first()?;
        let here = part(own, first.series.of(&rate(own), 1));
        if here >= FLAT {
            return None;
        }
        let greatest = |state: usize| {
            let rate = rate(state);
            let falls = known.stages.windows(2).filter_map(|pair| {
                let [before, after] = [&pair[0], &pair[1]].map(|one| one.series.of(&rate, 0));
                let height = pair[0].series.value(0, state);
                let second = (after - before) / pair[0].time;
                (before >= 0.0 && after < 0.0).then_some((height, part(state, second)))
            });
            let highest = falls.max_by(|one, other| one.0.total_cmp(&other.0));
            highest.map(|(_, part)| (state, part))
        };
        let units = &self.orbit.setting.scales.states;
        let others = moving(&examination.extremes, units).filter(|state| *state != own);
        let sharpest = others
            .filter_map(greatest)
            .max_by(|one, other| one.1.total_cmp(&other.1));
        let (state, part) = sharpest?;
        (part >= FLAT.max(SHARPER * here)).then_some(state)
    }
}

impl Posed {
    /// The time after z, within a period, at which a state is greatest.
    pub fn to_section(&self, mode: usize, section: usize, z: &Vector, period: f64) -> f64 {
        /// Places between which the rate is seen to fall through zero, and halvings of such a bracket.
        const PLACES: usize = 64;
        const HALVINGS: usize = 40;
        let flow = self.flow(mode);
        let rate = self.system.modes[mode].matrix.row(section).at;
        let value = |time: f64| rate.dot(&flow.after(z, time));
        let place = |index: usize| period * index as f64 / PLACES as f64;
        let all: Vec<Vector> = (0..=PLACES)
            .map(|index| flow.after(z, place(index)))
            .collect();
        let falls =
            |index: &usize| rate.dot(&all[*index]) >= 0.0 && rate.dot(&all[index + 1]) < 0.0;
        let height = |index: &usize| all[*index][section].max(all[index + 1][section]);
        let falling = (0..PLACES).filter(falls);
        let Some(index) = falling.max_by(|one, other| height(one).total_cmp(&height(other))) else {
            return 0.0;
        };
        let (mut low, mut high) = (place(index), place(index + 1));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if value(middle) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

impl AffineOrbit {
    /// The same orbits begun where another state is greatest, where the maximum at which they begin becomes flat. Those in several shots
    /// are left: there the whole orbit is no motion from one of its points.
    pub(super) fn in_sharper_section(
        &self,
        point: &Vector,
        examination: &Examination,
    ) -> Option<AffineOrbit> {
        if self.is_forced() || self.sequence.switches() > 0 || self.shots(0) > 1 {
            return None;
        }
        let at = self.at(point).ok()?;
        if at.mode(0).field.is_exact {
            return None;
        }
        let state = at.sharper(examination)?;
        let zone = self.sequence.zone(0).clone().begun_where(state);
        self.with_sequence(Sequence(vec![zone]))
    }

    /// A point and a direction there in the unknowns of the same orbits begun where another state is greatest. Period and parameters tell
    /// which way the direction goes; `None` where it has next to nothing of them.
    pub(super) fn carried_to_section(&self, other: &AffineOrbit, node: &Node) -> Option<Node> {
        /// Part of the direction that they must have.
        const TELLS: f64 = 1e-6;
        let point = other.begun_at_section(self, &node.point).ok()?;
        let mut tangent = Vector::zeros(point.len());
        tangent[self.states()] = node.tangent[self.states()];
        let [own, others] = [self, other].map(AffineOrbit::unknowns_of_zones);
        let parameters = node.tangent.rows(own, node.tangent.len() - own);
        tangent
            .rows_mut(others, parameters.len())
            .copy_from(&parameters);
        (tangent.norm() > TELLS).then(|| Node::at(point, tangent.normalize()))
    }

    /// An orbit without switches and forcing, which other unknowns give, begun where its state is greatest.
    pub(super) fn begun_at_section(
        &self,
        of: &AffineOrbit,
        point: &Vector,
    ) -> Result<Vector, OrbitFailure> {
        let at = of.at(point)?;
        let mut zone = at.zones[0].clone();
        let mode = self.sequence.zone(0).mode;
        let section = self.section(&at.posed.system.modes[mode]);
        let z = at.entry(0);
        let time = at.posed.to_section(mode, section, &z, zone.duration);
        let z = at.posed.flow(mode).after(&z, time);
        zone.state = z.rows(0, self.states()).iter().copied().collect();
        zone.inner.clear();
        Ok(self.pack(&[zone], &at.values))
    }
}
