//! Motions that come to rest, wholly or in some of their states, where an orbit is looked for.

use super::Wanted;
use super::failure::NoStart;
use super::switches::{Settling, Switches, moved};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Moment, Motion, Step, Switching};
use crate::affine::orbit::behaviour::RETURNED;
use crate::linalg::Vector;

/// A zone longer than this, and than the motion that settled, does not end.
pub(super) const ENDLESS: f64 = 1000.0;

/// Whether a motion would not move from a place by a part of its size that counts, in as long a time as was waited for
/// a switch. Its size is that of the states where it began and where it is: an equilibrium may have none.
pub(super) fn rests(system: &AffineSystem, place: &Moment, begun: &[f64]) -> bool {
    let states = begun.iter().chain(&place.state);
    let size = states.fold(0.0_f64, |size, x| size.max(x.abs()));
    speed(system, place) * ENDLESS <= RETURNED * size
}

/// The largest rate of a state at a place.
pub(super) fn speed(system: &AffineSystem, place: &Moment) -> f64 {
    let z = system.lift(place.mode, &place.state, place.phase);
    let rates = &system.modes[place.mode].matrix.at * z;
    rates.rows(0, system.states).amax()
}

/// Whether a motion without forcing spirals into a point on a surface, by its zones, the last one first: the
/// last ones move no state by a part that counts of its size over the whole motion, and by less than those before, and take as
/// long. Zones that accumulate become ever shorter.
pub(super) fn spirals_in<'a>(
    system: &AffineSystem,
    zones: impl Iterator<Item = (&'a Moment, &'a Switching)>,
    whole: &[f64],
) -> bool {
    /// Zones of the smallest group that is compared with those before it, and of the largest, each of twice as many.
    const LEAST: usize = 4;
    const MOST: usize = 32;
    /// An orbit on which a motion settles changes by much less.
    const FALLS: f64 = 0.99;
    const LASTS: f64 = 0.5;
    let told = zones.take(2 * MOST).map(|(entry, end)| {
        let moved = moved(system, entry, &end.before, end.time);
        (Vector::from_vec(moved), end.time - entry.time)
    });
    let told: Vec<(Vector, f64)> = told.collect();
    let whole = Vector::from_column_slice(whole);
    let whole = told
        .iter()
        .fold(whole, |whole, (moved, _)| whole.sup(moved));
    let part = |moved: &Vector| {
        let parts = moved.iter().zip(&whole);
        parts.fold(0.0_f64, |most, (moved, whole)| match *moved > 0.0 {
            true => most.max(moved / whole),
            false => most,
        })
    };
    let told: Vec<(f64, f64)> = told
        .iter()
        .map(|(moved, time)| (part(moved), *time))
        .collect();
    let farthest = |group: &[(f64, f64)]| group.iter().map(|zone| zone.0).fold(0.0, f64::max);
    let time = |group: &[(f64, f64)]| group.iter().map(|zone| zone.1).sum::<f64>();
    let shrinks = |count: usize| {
        let (last, before) = told[..2 * count].split_at(count);
        farthest(last) <= FALLS * farthest(before) && time(last) >= LASTS * time(before)
    };
    let mut counts = std::iter::successors(Some(LEAST), |count| Some(2 * count))
        .take_while(|count| 2 * count <= told.len());
    told.len() >= 2 * LEAST && farthest(&told[..LEAST]) <= RETURNED && counts.all(shrinks)
}

/// Where a motion spirals in that comes to no end but that of numbers: of what decays for ever they are lost.
pub(super) fn lost_in_a_point(system: &AffineSystem, begin: Moment, settle: f64) -> Option<Moment> {
    /// Switches at most.
    const MOST: usize = 1_000_000;
    let mut motion = Motion::new(system, begin.clone(), settle.max(1.0));
    let mut switches = Switches::new();
    while switches.len() < MOST {
        let until = motion.place().time + ENDLESS.max(settle);
        match motion.step(until) {
            Ok(Step::Switched(switching)) => switches.push((switching, motion.place().clone())),
            Ok(_) => return None,
            Err(_) => break,
        }
    }
    let place = motion.place();
    let settling = Settling::new(system, begin, switches, place);
    spirals_in(system, settling.zones().rev(), &settling.sizes).then(|| place.clone())
}

/// The states that stand still for ever in the mode of a place, whatever the others and the phase do, if one of them could
/// stand elsewhere as well: none where they do not, or where a law holds them where they are. Sizes are those of the states
/// over the whole motion.
fn standing(system: &AffineSystem, place: &Moment, sizes: &[f64]) -> Vec<usize> {
    let n = system.states;
    let matrix = &system.modes[place.mode].matrix.at;
    let rates = matrix * system.lift(place.mode, &place.state, place.phase);
    let stands = |state: &usize| rates[*state].abs() * ENDLESS <= RETURNED * sizes[*state];
    let mut all: Vec<usize> = (0..n).filter(stands).collect();
    loop {
        // states come first in z, and the constant after them
        let acts = |column: &usize| *column != n && !all.contains(column);
        let others: Vec<usize> = (0..matrix.ncols()).filter(acts).collect();
        let before = all.len();
        all.retain(|state| others.iter().all(|column| matrix[(*state, *column)] == 0.0));
        if all.len() == before {
            break;
        }
    }
    let is_free = |column: &usize| all.iter().all(|state| matrix[(*state, *column)] == 0.0);
    if all.iter().any(is_free) {
        all
    } else {
        Vec::new()
    }
}

/// Whether a motion that does not switch moves all states that could stand elsewhere, from this time on.
///
/// # Errors
/// It rests, or some of its states stand still for ever.
pub(super) fn moves(
    wanted: &Wanted,
    system: &AffineSystem,
    (place, time): (&Moment, f64),
    sizes: &[f64],
) -> Result<(), NoStart> {
    let states = standing(system, place, sizes);
    if states.len() == system.states {
        let place = place.clone();
        return Err(NoStart::Rests { time, place });
    }
    let mode = &system.modes[place.mode];
    // where they stand is kept along a branch of linear modes
    if states.is_empty() || mode.surface.is_none() && mode.field.is_exact {
        return Ok(());
    }
    // a state that is zero all along has no size
    let units = sizes
        .iter()
        .map(|size| if *size > 0.0 { *size } else { 1.0 });
    let units = Vector::from_iterator(sizes.len(), units);
    let surfaces = system.surfaces(place.mode, &place.state, place.phase, &units);
    // where a law holds them it is no choice
    let free = |state: &usize| surfaces.form_of(*state).is_none();
    if !states.iter().any(free) {
        return Ok(());
    }
    let names = &wanted.system.source.states;
    Err(NoStart::Stands {
        time,
        mode: wanted.system.mode_name(place.mode).into_owned(),
        states: states.iter().map(|state| names[*state].clone()).collect(),
    })
}
