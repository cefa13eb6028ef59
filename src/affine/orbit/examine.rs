//! Every inequality of every zone, decided over the whole zone by bounds and not by samples.

use super::layout::{AffineOrbit, OrbitAt};
use super::margin::{Margin, Watch};
use super::multiplier::{Multiplier, is_told, own};
use super::passage::{Passage, PassageStage, share};
use super::setting::OrbitFailure;
use super::shots::ZoneGrowth;
use super::turning::Smooth;
use crate::affine::flow::{Expansion, FlowPiece, MOST_PIECES, ModeFlow, counted};
use crate::affine::mode::{Guard, Row};
use crate::affine::series::BEYOND;
use crate::linalg::{Vector, product};
use crate::orbit::located::AT_ZERO;
use crate::orbit::sign::SignVerdict;
use crate::orbit::{Examined, Growth};

/// What an examination found.
#[derive(Clone, Debug)]
pub struct Examination {
    /// All margins, in the order of the zones.
    pub margins: Vec<Margin>,
    /// Whether every inequality holds everywhere.
    pub verdict: SignVerdict,
    /// Least and largest value of every state.
    pub extremes: Vec<(f64, f64)>,
    /// ẋ at the first entry, in units of the states.
    pub rate: Vector,
    /// How much a motion grows over every zone.
    pub growths: Vec<ZoneGrowth>,
    /// Functions that change their sign where the stability changes: those of
    /// [`super::monodromy::Monodromy::tests`]. Empty where it is not looked for, and where the period is prescribed: beside a
    /// wave there are perturbations of other wavelengths.
    pub tests: Vec<f64>,
    /// All multipliers, the largest first: none at a graze, or where stability is not looked for.
    pub multipliers: Vec<Multiplier>,
}

impl Examination {
    /// Takes the sign of one more inequality into account.
    fn judge(&mut self, one: SignVerdict) {
        self.verdict = self.verdict.and(one);
    }
}

impl Examined for Examination {
    type Margin = Margin;

    fn margins(&self) -> &[Margin] {
        &self.margins
    }

    fn verdict(&self) -> SignVerdict {
        self.verdict
    }

    fn tests(&self) -> &[f64] {
        &self.tests
    }

    fn is_told(&self, test: usize) -> bool {
        is_told(&self.multipliers, test)
    }

    fn growths(&self) -> Option<Vec<Growth>> {
        let growth = |one: &Multiplier| Growth {
            log: one.value.norm().ln(),
            error: one.error / one.value.norm(),
            told: !one.is_on_circle(),
        };
        // those of a prescribed period tell no stability
        let known = !self.tests.is_empty() && !self.multipliers.is_empty();
        known.then(|| own(&self.multipliers).map(growth).collect())
    }
}

/// Where the rate of a guard at the beginning of an orbit without switches is less than this in its own units, a
/// minimum may lie there.
const AT_BEGINNING: f64 = 1e-12;

/// A piece of a zone.
pub(super) struct Part {
    /// The piece.
    pub piece: FlowPiece,
    /// Time of its beginning after the entry of the zone.
    pub begun: f64,
    /// How much of the piece it is.
    pub part: f64,
    is_first: bool,
    is_last: bool,
}

/// The parts of a zone of positive length; the last two are of one length, so that none is tiny. How many they would
/// be where they are too many.
pub(super) fn parts(flow: &ModeFlow, entry: Vector, duration: f64) -> Result<Vec<Part>, f64> {
    /// Room for more parts is made as they come.
    const MOST_AT_ONCE: f64 = 64.0;
    let (mut piece, mut begun, mut before) = (flow.piece(entry), 0.0, duration);
    // the last but one of a zone may be cut in two
    let room = (duration / piece.length).min(MOST_AT_ONCE) as usize + 2;
    let mut parts = Vec::with_capacity(room);
    loop {
        let rest = duration - begun;
        // what is stiff begins with pieces much shorter than those that follow
        before = counted(before, flow.longest(&piece));
        let count = parts.len() as f64 + rest / before;
        if count.is_nan() || count > MOST_PIECES {
            return Err(count);
        }
        let time = share(rest, piece.length);
        let part = time / piece.length;
        let next = match part {
            _ if time == rest => None,
            1.0 => Some(flow.advance(&piece)),
            _ => Some(flow.within(&piece, time)),
        };
        parts.push(Part {
            piece,
            begun,
            part,
            is_first: parts.is_empty(),
            is_last: next.is_none(),
        });
        let Some(next) = next else {
            return Ok(parts);
        };
        piece = flow.piece(next);
        begun += time;
    }
}

/// The parts of a zone that has been integrated.
fn of_stages(stages: &[PassageStage]) -> Vec<Part> {
    let part = |(index, stage): (usize, &PassageStage)| Part {
        piece: FlowPiece::integrated(stage.series.clone(), stage.length),
        begun: stage.begun,
        part: stage.time / stage.length,
        is_first: index == 0,
        is_last: index + 1 == stages.len(),
    };
    stages.iter().enumerate().map(part).collect()
}

/// z at a time after the entry of a zone of these parts; `None` where it has none.
pub(super) fn after(flow: &ModeFlow, parts: &[Part], time: f64) -> Option<Vector> {
    let part = parts.iter().rfind(|part| part.begun <= time);
    let Part { piece, begun, .. } = part.or(parts.first())?;
    let time = time - begun;
    Some(match time <= piece.length {
        true => flow.within(piece, time),
        false => flow.after(&piece.z, time),
    })
}

/// The stationary place of a form next to a time, by Newton's method; the period is the unit of time.
pub(super) fn stationary(
    flow: &ModeFlow,
    row: &Vector,
    parts: &[Part],
    mut time: f64,
    period: f64,
) -> f64 {
    /// Steps taken at most.
    const STEPS: usize = 8;
    /// Beyond this, in units of the period, the place moves the value by less than rounding.
    const NEAR: f64 = 1e-9;
    for _ in 0..STEPS {
        let Some(z) = after(flow, parts, time.max(0.0)) else {
            break;
        };
        let [_, rate, curvature] = flow.slopes(row, &z);
        let step = rate / curvature;
        if !step.is_finite() {
            break;
        }
        time = (time - step).max(0.0);
        if step.abs() <= NEAR * period {
            break;
        }
    }
    time
}

impl OrbitAt<'_> {
    /// z at times since the entry of a zone, in order.
    ///
    /// # Errors
    /// The zone has too many pieces.
    pub(super) fn along(
        &self,
        zone: usize,
        times: impl Iterator<Item = f64>,
    ) -> Result<Vec<Vector>, OrbitFailure> {
        let flow = self.posed.flow(self.orbit.sequence.zone(zone).mode);
        let parts = self.parts(zone)?;
        let mut here = 0;
        let of = |time: f64| {
            while parts.get(here + 1).is_some_and(|next| next.begun <= time) {
                here += 1;
            }
            match parts.get(here) {
                Some(part) => flow.within(&part.piece, time - part.begun),
                None => self.entry(zone),
            }
        };
        Ok(times.map(of).collect())
    }

    /// Times since the entry of a zone that part it into so many even intervals, or more where a flow that is integrated has
    /// short pieces.
    ///
    /// # Errors
    /// The zone has too many pieces.
    pub(super) fn times(&self, zone: usize, intervals: usize) -> Result<Vec<f64>, OrbitFailure> {
        /// Intervals of a piece at least: over one a motion moves by some part of its size.
        const LEAST: usize = 4;
        let duration = self.zones[zone].duration;
        let part = |begun: f64, time: f64, count: usize| {
            (0..count).map(move |index| begun + time * index as f64 / count as f64)
        };
        if self.mode(zone).field.is_exact || duration <= 0.0 {
            let even = part(0.0, duration, intervals.max(1));
            return Ok(even.chain([duration]).collect());
        }
        let parts = self.parts(zone)?;
        let of_part = |own: &Part| {
            let time = own.part * own.piece.length;
            let even = (intervals as f64 * time / duration).ceil() as usize;
            part(own.begun, time, even.max(LEAST))
        };
        Ok(parts.iter().flat_map(of_part).chain([duration]).collect())
    }

    /// The parts of a zone, those of one shot after those of another.
    pub(super) fn parts(&self, zone: usize) -> Result<Vec<Part>, OrbitFailure> {
        let shots = self.orbit.shots(zone);
        let mut all = self.parts_of(zone, 0)?;
        for shot in 1..shots {
            let begun = self.share(zone) * shot as f64;
            if let Some(last) = all.last_mut() {
                last.is_last = false;
            }
            all.extend(self.parts_of(zone, shot)?.into_iter().map(|part| Part {
                begun: begun + part.begun,
                is_first: false,
                ..part
            }));
        }
        Ok(all)
    }

    /// The parts of a shot.
    fn parts_of(&self, zone: usize, shot: usize) -> Result<Vec<Part>, OrbitFailure> {
        let duration = self.share(zone);
        if duration.is_nan() || duration <= 0.0 {
            return Ok(Vec::new());
        }
        let number = self.orbit.sequence.zone(zone).mode;
        let (flow, entry) = (self.posed.flow(number), self.shot_entry(zone, shot));
        if !self.mode(zone).field.is_exact {
            // what has been integrated is not integrated again
            let stages = &self.known(number, &entry, duration).0.stages;
            if !stages.is_empty() {
                return Ok(of_stages(stages));
            }
        }
        let name = &self.orbit.sequence.zone(zone).name;
        parts(flow, entry, duration).map_err(|count| OrbitFailure::long(name, duration, count))
    }

    /// The stationary place of a guard next to a time, by Newton's method.
    fn stationary(&self, guard: usize, zone: usize, parts: &[Part], time: f64) -> f64 {
        let row = &self.mode(zone).guards[guard].row.at;
        let flow = self.posed.flow(self.orbit.sequence.zone(zone).mode);
        stationary(flow, row, parts, time, self.orbit.setting.scales.time)
    }

    /// A local minimum of a guard that was seen nearby.
    pub(super) fn inside_again(
        &self,
        guard: usize,
        zone: usize,
        near: f64,
    ) -> Result<Margin, OrbitFailure> {
        let time = self.stationary(guard, zone, &self.parts(zone)?, near);
        self.inside(guard, zone, time)
    }

    /// Margins and verdict, and the least and the largest value of every state.
    pub(super) fn examine(&self) -> Result<Examination, OrbitFailure> {
        let passages = self.passages()?;
        let parts = self.all_parts()?;
        let mut examination = Examination {
            margins: Vec::new(),
            verdict: SignVerdict::Positive,
            extremes: self.extremes_of_ends(&passages, &parts),
            rate: self.first_rate(&passages[0]),
            growths: self.growths(&passages, false),
            tests: Vec::new(),
            multipliers: Vec::new(),
        };
        for (zone, parts) in parts.iter().enumerate() {
            let shots = self.of_zone(&passages, zone);
            self.examine_zone(zone, shots, parts, &mut examination)?;
        }
        if self.orbit.setting.stability {
            let monodromy = self.monodromy(&passages);
            let multipliers = monodromy.as_ref().map(|one| one.multipliers());
            examination.multipliers = multipliers.unwrap_or_default();
            if self.orbit.setting.prescribed.is_none() {
                let tests = monodromy.map(|one| one.tests(&examination.multipliers));
                examination.tests = tests.unwrap_or_default().to_vec();
            }
        }
        Ok(examination)
    }

    fn first_rate(&self, passage: &Passage) -> Vector {
        let units = &self.orbit.setting.scales.states;
        let rate = product(&self.mode(0).matrix.at, &passage.entry);
        Vector::from_iterator(
            units.len(),
            rate.iter().zip(units).map(|(rate, unit)| rate / unit),
        )
    }

    fn all_parts(&self) -> Result<Vec<Vec<Part>>, OrbitFailure> {
        (0..self.zones.len()).map(|zone| self.parts(zone)).collect()
    }

    /// Least and largest value of every state where parts of the zones meet: few go further between.
    fn extremes_of_ends(&self, passages: &[Passage], parts: &[Vec<Part>]) -> Vec<(f64, f64)> {
        let mut extremes = vec![(f64::INFINITY, f64::NEG_INFINITY); self.orbit.states()];
        for (zone, parts) in parts.iter().enumerate() {
            let shots = self.of_zone(passages, zone);
            let ends = shots.iter().flat_map(|shot| {
                let end = parts.last().map_or(&shot.entry, |_| &shot.end);
                [&shot.entry, end]
            });
            let within = parts.iter().skip(1).map(|part| &part.piece.z);
            for z in ends.chain(within) {
                for ((low, high), value) in extremes.iter_mut().zip(z) {
                    (*low, *high) = (low.min(*value), high.max(*value));
                }
            }
        }
        extremes
    }

    fn examine_zone(
        &self,
        zone: usize,
        shots: &[Passage],
        parts: &[Part],
        examination: &mut Examination,
    ) -> Result<(), OrbitFailure> {
        let first = examination.margins.len();
        self.examine_edges(zone, shots, examination);
        let mut watched = self.watched(zone, &shots[0].entry);
        self.examine_parts(zone, parts, &mut watched, examination);
        // beyond a guard it is looked at only to find the place of that
        if examination.verdict == SignVerdict::Positive {
            self.check_values(zone, parts)?;
        }
        let edges = &examination.margins[first..];
        let inside = watched.into_iter();
        let inside = inside.filter_map(|one| self.least(one, zone, parts, edges));
        let inside: Vec<(usize, f64)> = inside.collect();
        for (guard, time) in inside {
            let time = self.stationary(guard, zone, parts, time);
            examination.margins.push(self.inside(guard, zone, time)?);
        }
        Ok(())
    }

    /// Whether the rates have values all along a zone, with whose pieces they are looked at: none of these passes from where they have values
    /// to where they have none.
    ///
    /// # Errors
    /// Somewhere they have none.
    fn check_values(&self, zone: usize, parts: &[Part]) -> Result<(), OrbitFailure> {
        if !self.mode(zone).field.ends() {
            return Ok(());
        }
        let own = self.orbit.sequence.zone(zone);
        let flow = self.posed.flow(own.mode);
        for Part {
            piece, begun, part, ..
        } in parts
        {
            for place in [0.0, 0.5, 1.0] {
                let time = place * part * piece.length;
                if flow.lacks_value(&flow.within(piece, time), BEYOND) {
                    return Err(OrbitFailure::NoValue {
                        mode: own.name.clone(),
                        time: begun + time,
                    });
                }
            }
        }
        Ok(())
    }

    /// The inequalities at the ends of a zone.
    fn examine_edges(&self, zone: usize, shots: &[Passage], examination: &mut Examination) {
        for watch in self.edges(zone) {
            let margin = self.edge(watch, zone, shots);
            let is_positive = margin.as_ref().is_some_and(|margin| margin.value > 0.0);
            examination.judge(match is_positive {
                true => SignVerdict::Positive,
                false => SignVerdict::Negative,
            });
            examination.margins.extend(margin);
        }
    }

    /// The guards that are looked at within a zone.
    fn watched(&self, zone: usize, entry: &Vector) -> Vec<Watched<'_>> {
        let way = self.orbit.sequence.zone(zone).way;
        let facts = &self.posed.facts[zone];
        let flow = self.posed.flow(self.orbit.sequence.zone(zone).mode);
        let guards = self.mode(zone).guards.iter().enumerate();
        let watched = guards.filter_map(|(guard, Guard { row, .. })| {
            // without switches the beginning is a place like any other: a minimum may lie there
            let rate = || flow.slopes(&row.at, entry)[1];
            let slow = AT_BEGINNING * self.orbit.size(row) / self.orbit.setting.scales.time;
            Some(Watched {
                guard,
                row,
                order: facts.at_entry[guard]?,
                falling: way.is_none() && rate() <= slow,
                places: Vec::new(),
            })
        });
        watched.collect()
    }

    /// Goes through the parts of a zone: signs and minima of its guards, and bounds of the states.
    fn examine_parts(
        &self,
        zone: usize,
        parts: &[Part],
        watched: &mut [Watched],
        examination: &mut Examination,
    ) {
        let way = self.orbit.sequence.zone(zone).way;
        let facts = &self.posed.facts[zone];
        let flow = self.posed.flow(self.orbit.sequence.zone(zone).mode);
        let mut expansion = Expansion::default();
        for part in parts {
            let Part { piece, begun, .. } = part;
            let states = examination.extremes.len();
            flow.expand(piece, part.part, states, &mut expansion);
            for one in &mut *watched {
                let (mut taylor, remainder) =
                    flow.guard_of(one.guard, (piece, part.part), &expansion);
                let at_start = if part.is_first { one.order } else { 0 };
                taylor[..at_start].fill(0.0);
                let at_end = facts.at_end[one.guard].filter(|_| part.is_last && way.is_some());
                let (holds, minima) = Smooth::new(&taylor, remainder).examined(
                    at_start,
                    at_end.unwrap_or(0),
                    &mut one.falling,
                );
                examination.judge(holds);
                let time = |place: f64| begun + place * part.part * piece.length;
                one.places.extend(minima.into_iter().map(time));
            }
            expansion.widen(flow, (piece, part.part), &mut examination.extremes);
        }
    }

    /// The guard with the time of its least minimum within a zone whose margins at its ends are known.
    ///
    /// What follows from a margin at an end that is negative is no minimum of its own; one that is zero takes no more than
    /// rounding away.
    fn least(
        &self,
        watched: Watched,
        zone: usize,
        parts: &[Part],
        edges: &[Margin],
    ) -> Option<(usize, f64)> {
        let Watched {
            guard,
            row,
            order,
            mut places,
            ..
        } = watched;
        let way = self.orbit.sequence.zone(zone).way;
        let flow = self.posed.flow(self.orbit.sequence.zone(zone).mode);
        let value = |time: &f64| {
            let z = after(flow, parts, *time);
            z.map_or(f64::INFINITY, |z| row.at.dot(&z))
        };
        let follows = |watch: Watch, time: Option<&f64>| {
            let at_end = edges.iter().find(|margin| margin.watch == watch);
            let at_end = at_end.map(|margin| margin.value);
            let deep = |time: &f64| value(time) < -AT_ZERO * self.orbit.size(row);
            at_end
                .filter(|value| *value <= 0.0)
                .is_some_and(|at_end| at_end < -AT_ZERO || !time.is_some_and(deep))
        };
        if order > 0 && follows(Watch::Onset(guard), places.first()) && !places.is_empty() {
            places.remove(0);
        }
        let ends = way.is_some_and(|way| way.guard == guard);
        if ends && follows(Watch::Speed, places.last()) {
            places.pop();
        }
        let places = places.into_iter();
        let least = places.min_by(|one, other| value(one).total_cmp(&value(other)))?;
        Some((guard, least))
    }
}

/// A guard while a zone is gone through.
struct Watched<'a> {
    guard: usize,
    row: &'a Row,
    /// Order of its zero at the entry.
    order: usize,
    /// Whether it falls.
    falling: bool,
    /// Times of its local minima.
    places: Vec<f64>,
}

impl Expansion {
    /// Widens bounds of the states that hold at both ends of a part so that they hold in between. Most states stay within them by far: it
    /// is not asked then what the expansion leaves out.
    fn widen(&self, flow: &ModeFlow, part: (&FlowPiece, f64), extremes: &mut [(f64, f64)]) {
        let states = extremes.len();
        let mut left_out = None;
        for (state, extremes) in extremes.iter_mut().enumerate() {
            let taylor = self.taylor(state);
            if Smooth::new(taylor, 0.0).stays(*extremes) {
                continue;
            }
            let left_out = left_out.get_or_insert_with(|| flow.left_out(part, states, self));
            Smooth::new(taylor, left_out[state]).widen(extremes);
        }
    }
}

impl AffineOrbit {
    /// Least and largest value of every state over the orbit.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn extremes(&self, point: &Vector) -> Result<Vec<(f64, f64)>, OrbitFailure> {
        let at = self.at(point)?;
        let parts = at.all_parts()?;
        let mut extremes = at.extremes_of_ends(&at.passages()?, &parts);
        for (zone, parts) in parts.iter().enumerate() {
            let flow = at.posed.flow(self.sequence.zone(zone).mode);
            let mut expansion = Expansion::default();
            for Part { piece, part, .. } in parts {
                flow.expand(piece, *part, extremes.len(), &mut expansion);
                expansion.widen(flow, (piece, *part), &mut extremes);
            }
        }
        Ok(extremes)
    }
}
