//! Waves of the tube as orbits that the engine follows.

use super::EventType;
use super::special::{InadmissibleWave, OfWaves, WaveMargin, WaveTermination};
use crate::continuation::Node;
use crate::continuation::newton::Equations;
use crate::linalg::{Matrix, Vector};
use crate::orbit::located::AT_ZERO;
use crate::orbit::sign::SignVerdict;
use crate::orbit::{
    Bifurcations, Candidate, Changes, CoordinateChanges, Covers, Examined, Inequalities,
    MarginFunction, Monitored, Situation, SpecialType, TerminationType, Terminations,
    WITHOUT_LENGTH, Zones, entry, follow,
};
use crate::tube::flow::FlowError;
use crate::tube::model::Parameter;
use crate::tube::model::signature::{Regime, Signature, WaveZone, ZoneEntry};
use crate::tube::stability::track::Remark;
use crate::tube::wave::admissibility::{
    MarginConstraint, RegimeMargin, WaveExamination, WaveWatch, examine,
};
use crate::tube::wave::successor::candidates;
use crate::tube::wave::{Wave, WaveAt};

/// A point of a branch of waves.
pub type Found = follow::LocatedPoint<Wave>;
/// A branch of waves being followed.
pub type Follower = follow::Follower<Wave>;
/// The state of a branch of waves between two steps.
pub type State = follow::BranchState<Signature>;
/// Why a candidate for a wave is not entered.
pub type NotEntered = entry::NotEntered<Wave>;

/// Excess speed |c|/√a − 1 below which a branch may be seen to tend to √a, and how little everything
/// else changes then while it falls by the factor e.
const SONIC: f64 = 1e-4;
const SETTLED: f64 = 1e-3;

impl Examined for WaveExamination {
    type Margin = RegimeMargin;

    fn margins(&self) -> &[RegimeMargin] {
        &self.margins
    }

    fn verdict(&self) -> SignVerdict {
        self.verdict
    }
}

impl Zones for Wave {
    type Signature = Signature;
    type Parameter = Parameter;
    type Margin = RegimeMargin;
    type Examination = WaveExamination;

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn posed(&self, signature: Signature) -> Option<Wave> {
        (!signature.is_empty()).then(|| self.with_signature(signature))
    }

    fn is_rotation(&self, signature: &Signature) -> bool {
        signature.is_rotation_of(&self.signature)
    }

    fn parameter(&self) -> Parameter {
        self.parameter
    }

    fn column(parameter: &Parameter) -> &str {
        parameter.column()
    }

    fn duration_index(&self, zone: usize) -> usize {
        self.width() * zone + 2
    }

    fn unit(&self) -> f64 {
        self.scales.parameter
    }

    fn examination(&self, point: &Vector) -> Result<WaveExamination, FlowError> {
        examine(self, point)
    }

    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64> {
        self.parameter_rounding(matrix, point, last)
    }
}

impl MarginFunction for RegimeMargin {
    fn value(&self) -> f64 {
        self.jet.value
    }

    fn is_same(&self, other: &RegimeMargin) -> bool {
        (self.watch, self.zone) == (other.watch, other.zone)
    }

    /// Slip that comes to V̇ = 1 with V̈ = 0.
    fn grazes(&self) -> bool {
        self.watch == WaveWatch::Rate
    }

    /// A zone without length says most.
    fn precedence(&self) -> usize {
        WITHOUT_LENGTH + usize::from(self.watch != WaveWatch::Duration)
    }
}

impl Inequalities for Wave {
    type Inequality = WaveMargin;
    type Inadmissible = InadmissibleWave;

    fn margin_at(&self, seen: &RegimeMargin, point: &Vector) -> Result<RegimeMargin, FlowError> {
        MarginConstraint { margin: *seen }.margin_at(self, point)
    }

    fn add_gradient(&self, margin: &RegimeMargin, gradient: &mut [f64]) {
        margin.add_gradient(self, gradient);
    }

    fn slope(&self, margin: &RegimeMargin, direction: &Vector) -> f64 {
        margin.slope(self, direction)
    }

    fn reach(&self, margin: &RegimeMargin, changes: &Vector) -> f64 {
        margin.reach(self, changes)
    }

    fn is_alike(&self, margin: &RegimeMargin, other: &Wave, of_other: &RegimeMargin) -> bool {
        self.inequality(margin) == other.inequality(of_other)
    }

    fn inequality(&self, margin: &RegimeMargin) -> WaveMargin {
        WaveMargin {
            regime: self.signature.zone(margin.zone).regime,
            watch: margin.watch,
        }
    }

    fn inadmissible(&self, examination: &WaveExamination) -> InadmissibleWave {
        InadmissibleWave::of(self, examination)
    }
}

impl CoordinateChanges for Wave {}

impl Changes for Wave {
    type Remark = Remark;

    fn candidates(
        &self,
        point: &Vector,
        margin: &RegimeMargin,
    ) -> Result<Vec<Candidate<Wave>>, FlowError> {
        candidates(self, point, margin)
    }

    /// The same from either side, one of which sees open what the other sees close.
    fn classify(before: &Signature, after: Option<&Signature>, margin: &RegimeMargin) -> EventType {
        // reverse slip that begins at V̇ = 1: what lands in reverse slip is arrested before it closes
        let begins_at_rest = |zone: WaveZone| {
            zone.regime == Regime::Reverse
                && matches!(zone.entry, ZoneEntry::Reversal | ZoneEntry::ArrestedLanding)
        };
        let closed = (margin.watch == WaveWatch::Duration).then(|| before.zone(margin.zone));
        // a zone that begins with a touch closes on the impact, not at zero pressure
        let lifts =
            |zone: WaveZone| zone.regime == Regime::Separation && zone.entry != ZoneEntry::Touch;
        if margin.watch == WaveWatch::Pressure || closed.is_some_and(lifts) {
            return EventType::GR;
        }
        let Some(after) = after else {
            let reverses = closed.is_some_and(begins_at_rest)
                && before.zone(margin.zone + 1).regime == Regime::Stick;
            return match (closed.map(|zone| zone.regime), margin.watch) {
                (Some(Regime::Stick), _) | (None, WaveWatch::UpperForce | WaveWatch::Rate) => {
                    EventType::ST
                }
                (None, WaveWatch::LowerForce) => EventType::RV,
                _ if reverses => EventType::RV,
                _ => EventType::CO,
            };
        };
        if before.count(Regime::Stick) != after.count(Regime::Stick) {
            return EventType::ST;
        }
        let reverses = |signature: &Signature| {
            let before_stick = |index: &usize| {
                let (zone, next) = (signature.zone(*index), signature.zone(index + 1));
                begins_at_rest(zone) && next.regime == Regime::Stick
            };
            (0..signature.len()).filter(before_stick).count()
        };
        let others = [Regime::Slip, Regime::Separation];
        if reverses(before) != reverses(after)
            && before.len() != after.len()
            && others.map(|regime| before.count(regime)) == others.map(|regime| after.count(regime))
        {
            return EventType::RV;
        }
        EventType::CO
    }

    /// Beyond the opening of a separation zone the branch starts with no change of the parameter.
    fn opens(&self, point: &Vector) -> bool {
        let opens = |zone: usize| {
            self.signature.zone(zone).entry == ZoneEntry::TakeOff
                && self.duration_at(point, zone) == 0.0
        };
        (0..self.zones()).any(opens)
    }

    fn closes(&self, point: &Vector) -> bool {
        self.thinner_than_a_layer(point)
    }

    fn is_layered(&self) -> bool {
        self.material
    }
}

impl SpecialType<Signature> for OfWaves {
    fn kind(&self) -> EventType {
        match self {
            OfWaves::HopfPoint | OfWaves::CoulombLimit => EventType::EP,
            OfWaves::StickOpens => EventType::ST,
            OfWaves::Crossing { omega: None, .. } | OfWaves::Repeats => EventType::BP,
            OfWaves::Crossing { .. } => EventType::HB,
        }
    }

    fn beyond(&self) -> Option<Signature> {
        (*self == OfWaves::StickOpens).then(Signature::slip_stick)
    }
}

impl Bifurcations for Wave {
    type Special = OfWaves;

    fn edge(&self, value: f64) -> Option<OfWaves> {
        let limit = self.parameter == Parameter::StiffnessDamping
            && self.signature.has(Regime::Separation)
            && value == 0.0;
        limit.then_some(OfWaves::CoulombLimit)
    }
}

impl TerminationType<Signature> for WaveTermination {
    /// The waves that are left at a Hopf point all have its value of the parameter.
    fn completes(&self) -> bool {
        matches!(
            self,
            WaveTermination::SlipAlone | WaveTermination::Misses | WaveTermination::Repeats { .. }
        )
    }

    fn left(&self) -> Option<Signature> {
        (*self == WaveTermination::SlipAlone).then(Signature::slip_alone)
    }
}

impl Terminations for Wave {
    type Termination = WaveTermination;

    fn termination(&self, situation: Situation<'_, RegimeMargin>) -> Option<WaveTermination> {
        match situation {
            Situation::At(node, range) => self.ends_in_range(node, range),
            Situation::NoStep(_) => None,
            // waves run in the direction of D
            Situation::Change(margin) => {
                (margin.watch == WaveWatch::Coupling).then_some(WaveTermination::Against)
            }
            Situation::NoCandidate(point, margin) => self.ends_at_change(point, margin),
        }
    }
}

impl Covers for Wave {
    fn repeats(&self, node: &Node) -> Option<(OfWaves, WaveTermination)> {
        let mode = 2 * self.mode;
        self.is_double(&node.point)
            .then_some((OfWaves::Repeats, WaveTermination::Repeats { mode }))
    }
}

impl Monitored for Wave {}

impl Wave {
    /// Why the branch ends where a margin vanishes and no candidate goes on.
    fn ends_at_change(&self, point: &Vector, margin: &RegimeMargin) -> Option<WaveTermination> {
        if self.at(point).is_ok_and(|at| is_undriven(&at)) {
            return Some(WaveTermination::Undriven);
        }
        let alone = margin.watch == WaveWatch::Duration && self.zones() == 2;
        let alone = alone.then_some(WaveTermination::SlipAlone);
        alone.or_else(|| {
            self.barely_sticks(point, margin)
                .then_some(WaveTermination::Misses)
        })
    }

    /// Whether what reaches V̇ = 1 inside a zone of slip is its end, where stick begins: V̈ vanishes there, and beyond V̇ stays below 1.
    fn barely_sticks(&self, point: &Vector, margin: &RegimeMargin) -> bool {
        /// So near to the end, in units of the period: places where V̈ vanishes are known to the root of what V̇ is.
        const AT_END: f64 = 1e-5;
        let zone = margin.zone;
        let left = self.duration_at(point, zone) - margin.time;
        margin.watch == WaveWatch::Rate
            && self.signature.zone(zone + 1).entry == ZoneEntry::Arrest
            && left.abs() <= AT_END * self.scales.time
    }

    /// D = 0; or the branch has no end in the range as its speed tends to √a: ln(|c|/√a − 1) falls
    /// without bound and everything else tends to a limit, as a power of the excess speed.
    fn ends_in_range(&self, node: &Node, (low, high): (f64, f64)) -> Option<WaveTermination> {
        let Node { point, tangent, .. } = node;
        let at = self.at(point).ok();
        if at.as_ref().is_some_and(is_undriven) {
            return Some(WaveTermination::Undriven);
        }
        let last = self.unknowns() - 1;
        let excess = self.excess_at(point);
        // change per e-fold of the excess speed: of everything, and of the parameter
        let fall = -tangent[last - 1];
        let rest = (1.0 - fall * fall).max(0.0).sqrt();
        let drift = tangent[last].abs() * self.scales.parameter;
        let value = self.parameter_at(point);
        let room = (value - low).min(high - value).min(value.abs());
        let sonic = fall > 0.0 && excess < SONIC && rest < SETTLED && drift < SETTLED * room;
        let sonic = sonic.then_some(WaveTermination::Sonic {
            excess,
            parameter: self.parameter,
            value,
        });
        sonic.or_else(|| loses_digits(&at?))
    }
}

/// Whether the end of a sliding zone is the sum of terms so large, in its units, that half of all digits are lost.
fn loses_digits(at: &WaveAt) -> Option<WaveTermination> {
    /// e¹⁸: the square root of the inverse of rounding.
    const LOST: f64 = 6.7e7;
    let WaveAt { wave, flows, .. } = at;
    let terms = |zone: usize| {
        let regime = wave.signature.zone(zone).regime;
        regime.sliding()?;
        let [y, w] = flows.contact(regime).terms(&at.slide(zone))?;
        let terms = (y / wave.scales.time).max(w / wave.scales.rate);
        (terms > LOST).then_some(WaveTermination::LosesDigits { regime, terms })
    };
    (0..wave.zones()).find_map(terms)
}

/// Whether D = 0 but for rounding.
fn is_undriven(at: &WaveAt) -> bool {
    at.flows.frame.at.kappa.abs() < AT_ZERO * at.wave.scales.pressure
}
