//! The orbit beside an event to which motions lead.
//!
//! The sequences that follow from the switches at an event make zones of no length. Where zones of some length come at once, as
//! where a motion that is arrested goes on elsewhere and is led back, or where many zones change together, motions
//! that begin on the orbit of the event, at values p ± δ of the parameter, come through the sequence that lies there. Where they come
//! back, and nearer the smaller δ is, their zones over one period are the guess of an orbit.

use super::discontinuity::Fate;
use super::layout::{AffineOrbit, OrbitAt};
use super::start::{Beginning, Search, Wanted, first, run};
use crate::affine::motion::Motion;
use crate::linalg::Vector;
use crate::orbit::Candidate;

/// δ, as parts of the range of the parameter: a zone that opens like the third root of the smaller one lasts half a per cent of the
/// period, and is well known.
const BESIDE: [f64; 2] = [1e-5, 1e-7];

/// The orbit is next to that of the event where it is off by less than this at the smaller δ, as a part of the range of each
/// state, and by less than the second part of what it is off at the larger one: the third root falls to a fifth.
const NEAR: f64 = 1e-2;
const FALLS: f64 = 0.3;

/// Periods that a motion settles for.
const SETTLES: u32 = 2;

impl AffineOrbit {
    /// The orbit on one side of an event, with its point; `None` where motions do not tell.
    pub(super) fn by_motions_beside(
        &self,
        point: &Vector,
        side: f64,
    ) -> Option<Candidate<AffineOrbit>> {
        if !matches!(self.fate(point, None, side), Some(Fate::Returns)) {
            return None;
        }
        let [far, near] = BESIDE.map(|part| self.next_to(point, side * part));
        let ((before, _), (last, found)) = far.zip(near)?;
        // motions of a family need not keep what its branch keeps: beyond it they tell of what keeps nothing
        let is_single = [self, &found.orbit].map(|orbit| orbit.conserved.count() == 0);
        let tells = is_single.contains(&true);
        (tells && last <= NEAR && last <= FALLS * before).then_some(found)
    }

    /// The orbit by motion this far from an event, and how far off it is: from the orbit of the event, or from where that leads after a
    /// period or two, which is nearer to one that attracts, and has its sequence.
    fn next_to(&self, point: &Vector, by: f64) -> Option<(f64, Candidate<AffineOrbit>)> {
        let at = self.at(point).ok()?;
        let setting = &self.setting;
        let mut values = self.values_at(point);
        values[setting.parameter] += by * setting.scales.parameter;
        let period = at.period();
        let longest = self.longest(point)?;
        let posed = setting.system.at(&values, &[setting.parameter]).ok()?;
        let mut motion = Motion::new(&posed, at.middle(longest)?, period);
        let wanted = Wanted {
            system: setting.system.clone(),
            values,
            parameter: setting.parameter,
            width: setting.scales.parameter,
            periods: setting.periods,
            stability: setting.stability,
            prescribed: setting.prescribed.clone(),
        };
        (0..=SETTLES).find_map(|periods| {
            run(&mut motion, f64::from(periods) * period).ok()?;
            let begin = Beginning::from(motion.place().clone());
            let (found, solution) = first(&wanted, &begin, Search::Guess(period)).ok()?;
            if found.sequence.is_rotation_of(&self.sequence) {
                return None;
            }
            let there = found.at(&solution).ok()?;
            let off = at.off_entry(longest, &there)?;
            let orbit = self.with_sequence(found.sequence.clone())?;
            let point = orbit.pack(&there.zones, &there.values);
            let nascent = Vec::new();
            let candidate = Candidate {
                orbit,
                point,
                nascent,
            };
            Some((off, candidate))
        })
    }
}

impl OrbitAt<'_> {
    /// How far the entry of a zone is off the nearest one into its mode of another orbit, in units of each state.
    fn off_entry(&self, zone: usize, other: &OrbitAt) -> Option<f64> {
        let units = &self.orbit.setting.scales.states;
        let mode = self.orbit.sequence.zone(zone).mode;
        let offs = (0..other.zones.len())
            .filter(|index| other.orbit.sequence.zone(*index).mode == mode)
            .map(|index| {
                let states = self.zones[zone].state.iter().zip(&other.zones[index].state);
                let offs = states
                    .zip(units)
                    .map(|((one, other), unit)| (one - other).abs() / unit);
                offs.fold(0.0, f64::max)
            });
        offs.min_by(f64::total_cmp)
    }
}
