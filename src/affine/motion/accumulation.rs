//! The last zones of a motion: whether infinitely many of them end in finite time, and where that leads.

use super::halt::Halt;
use crate::affine::mode::{AffineSystem, Exit, MatrixBy};
use crate::linalg::Vector;

/// Zones shorter than this, in units of a piece of their mode, are those of a chattering that ends: the next
/// digits of the state are rounding.
const CHATTER: f64 = 1e-12;

/// So many of them in a row are a chattering, and so many switches without time a livelock.
const IN_A_ROW: usize = 8;

/// So many zones in a row that are shorter than the last but one are sliding of second order, where each is shorter than
/// this part of a piece of its mode: their lengths fall in proportion to themselves, and no end of them comes.
const EVER_FASTER: usize = 64;
const FAST: f64 = 0.05;

/// The ratio of successive durations that fall geometrically. The last of them are rounding, as differences of times, or
/// zero: the earlier half tells. Where they fall at once to rounding, in one zone, there is none.
fn ratio(durations: &[f64]) -> Option<f64> {
    /// The least that would be told, while zones last longer than this part of the first.
    const LEAST: f64 = 1e-8;
    const LONG: f64 = 1e-3;
    let long = LONG * durations.first()?;
    let mut pairs = durations.windows(2);
    if pairs.any(|pair| pair[0] >= long && pair[1] < LEAST * pair[0]) {
        return None;
    }
    let lasting: Vec<f64> = durations
        .iter()
        .copied()
        .take_while(|time| *time > 0.0)
        .collect();
    let middle = lasting.len() / 2;
    let (first, later) = (lasting.first()?, lasting.get(middle)?);
    let ratio = (later / first).powf(1.0 / middle.max(1) as f64);
    (ratio < 1.0).then_some(ratio)
}

/// A zone that has ended.
pub(super) struct EndedZone<'a> {
    /// Its mode.
    pub mode: usize,
    /// The guard of it that is zero.
    pub guard: usize,
    /// The exit taken.
    pub exit: &'a Exit,
    /// Its time.
    pub time: f64,
    /// How long the zone has lasted.
    pub lasted: f64,
    /// Length of a piece of its mode.
    pub unit: f64,
    /// z there.
    pub z: &'a Vector,
}

/// What is known of the last zones.
#[derive(Clone, Debug)]
pub(super) struct Accumulation {
    /// Durations of the last zones, each shorter than the one before but for rounding.
    falling: Vec<f64>,
    /// How many of the last zones were short.
    short: usize,
    /// The mode in which infinitely many of these end, and the reset of the last of them that leads there.
    rest: Option<(usize, MatrixBy)>,
    /// How many of the last zones were fast, and shorter than the last but one; how long the last two were.
    faster: usize,
    lasted: [f64; 2],
    /// The sliding mode that has ended at a guard of one of its sides, if the mode that is just beginning begins there.
    left: Option<(usize, usize)>,
}

impl Default for Accumulation {
    fn default() -> Accumulation {
        Accumulation {
            falling: Vec::new(),
            short: 0,
            rest: None,
            faster: 0,
            lasted: [f64::INFINITY; 2],
            left: None,
        }
    }
}

impl Accumulation {
    /// Takes in the end of a zone; where infinitely many come to theirs: the mode in which they end, and the reset that leads there.
    ///
    /// # Errors
    /// Zones that become shorter and shorter, or that lead back and forth.
    pub(super) fn ended(
        &mut self,
        system: &AffineSystem,
        end: &EndedZone,
    ) -> Result<Option<(usize, MatrixBy)>, Halt> {
        let is_short = end.lasted <= CHATTER * end.unit;
        self.short = if is_short { self.short + 1 } else { 0 };
        self.rest = self.rest.take().filter(|_| is_short);
        if let Some(rest) = end.exit.rest.filter(|_| is_short) {
            self.rest = Some((rest, end.exit.reset.clone()));
        }
        if !is_short && self.falling.last().is_some_and(|last| end.lasted >= *last) {
            self.falling.clear();
        }
        self.falling.push(end.lasted);
        self.check_surfaces(system, end)?;
        self.check_order(system, end, is_short)?;
        if self.short <= IN_A_ROW {
            return Ok(None);
        }
        let rest = self.rest.take().ok_or_else(|| self.endless(system, end))?;
        (self.short, self.falling) = (0, Vec::new());
        Ok(Some(rest))
    }

    /// Refuses sliding in one surface that leaves at a guard into sliding which comes back at once.
    fn check_surfaces(&mut self, system: &AffineSystem, end: &EndedZone) -> Result<(), Halt> {
        let known = &system.modes[end.mode];
        let leaves = known.sides.is_some() && known.guards[end.guard].written.is_some();
        let back = |(before, _): &(usize, usize)| leaves && *before == end.exit.to;
        if let Some((mode, guard)) = self.left.filter(back)
            && end.lasted == 0.0
        {
            let time = end.time;
            return Err(Halt::TwoSurfaces { time, mode, guard });
        }
        self.left = leaves.then_some((end.mode, end.guard));
        Ok(())
    }

    /// Refuses sliding of second order.
    fn check_order(
        &mut self,
        system: &AffineSystem,
        end: &EndedZone,
        is_short: bool,
    ) -> Result<(), Halt> {
        let EndedZone {
            time,
            mode,
            guard,
            lasted,
            ..
        } = *end;
        let faster = !is_short && lasted < self.lasted[0] && lasted < FAST * end.unit;
        self.faster = match faster && system.is_of_second_order(mode, guard, end.exit.to) {
            true => self.faster + 1,
            false => 0,
        };
        self.lasted = [self.lasted[1], lasted];
        match self.faster > EVER_FASTER {
            true => Err(Halt::SecondOrder {
                time,
                mode,
                guard,
                duration: lasted,
            }),
            false => Ok(()),
        }
    }

    /// Why no mode begins where infinitely many zones end.
    fn endless(&self, system: &AffineSystem, end: &EndedZone) -> Halt {
        let EndedZone {
            time, mode, guard, ..
        } = *end;
        if let Some(ratio) = ratio(&self.falling) {
            return Halt::Chattering { time, ratio };
        }
        let lasted = self.falling.iter().any(|lasted| *lasted > 0.0);
        let value = system.modes[mode].guards[guard].row.at.dot(end.z);
        match end.exit.to == mode {
            _ if !lasted && value < 0.0 => Halt::Outside { mode, guard, value },
            true if lasted => Halt::Outward { time, mode, guard },
            _ => Halt::Livelock { time, mode, guard },
        }
    }
}

/// Leaves what comes to rest in a mode no velocity: of an impact after which it is held at zero only so much is left that it is.
pub(super) fn stop(
    system: &AffineSystem,
    mode: usize,
    (before, after): (&[f64], &mut [f64]),
    phase: f64,
) {
    let states = [before, after].map(|state| system.lift(mode, state, phase));
    let held = system.modes[mode].held.iter();
    let mut turned = held.filter_map(|row| {
        let [before, after] = states.each_ref().map(|z| row.value(z));
        (before * after < 0.0).then(|| before / (before - after))
    });
    let Some(part) = turned.next() else { return };
    for (after, before) in after.iter_mut().zip(before) {
        *after = before + part * (*after - before);
    }
}
