//! Where an orbit begins that neither switches nor is forced: where one of its states is greatest, so that its rate is zero.

use super::layout::AffineOrbit;
use super::posed::Posed;
use super::setting::OrbitFailure;
use crate::linalg::Vector;

/// The state that is greatest where an orbit begins: the first that moves, by a part that counts of what the others do in their units.
pub fn of_orbit(extremes: &[(f64, f64)], units: &[f64]) -> Option<usize> {
    /// Most cycles move all of their states; of one that hardly moves the extremes are rounding.
    const COUNTS: f64 = 0.1;
    let pairs = extremes.iter().zip(units);
    let ranges: Vec<f64> = pairs
        .map(|((low, high), unit)| (high - low) / unit)
        .collect();
    let largest = ranges.iter().copied().fold(0.0, f64::max);
    let moves = |range: &f64| largest > 0.0 && *range >= COUNTS * largest;
    ranges.iter().position(moves)
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
    /// The same orbit without switches and forcing, begun where its state is greatest.
    pub(super) fn begun_at_section(&self, point: &Vector) -> Result<Vector, OrbitFailure> {
        let at = self.at(point)?;
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
