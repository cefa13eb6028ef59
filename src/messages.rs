//! The sentences about what happens along a branch or a curve, made from data.

use std::fmt::{self, Display, Formatter};

use crate::affine::equilibrium::EquilibriumCurve;
use crate::affine::motion::Halt;
use crate::affine::orbit::{self as affine, AffineOrbit};
use crate::affine::system::System;
use crate::branch::VerdictReason;
use crate::branch::special::{Change, InadmissibleWave, OfWaves, WaveMargin, WaveNote, WaveStop};
use crate::continuation::walk::End;
use crate::curve::{self, Gone, PointType, What};
use crate::hybrid;
use crate::hybrid::equilibrium::EquilibriumNote;
use crate::hybrid::scan::Lack;
use crate::map::Missing;
use crate::orbit::{self, EventType, Orbit};
use crate::problem::{Doubt, Rotation};
use crate::tube::model::signature::Regime;
use crate::tube::model::{Impact, Landing};
use crate::tube::stability::track::Remark;
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::WaveWatch;

/// What is left of a wave where D = 0.
const D_ZERO: &str = "D = 0: nothing drives a wave here; what is left is steady sliding with a linear wave \
                      of arbitrary amplitude, which neither grows nor decays";

#[cfg_attr(not(feature = "cli"), allow(dead_code))]
impl Landing {
    /// Its name, for captions too.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Landing::Impact(Impact::Frictionless) => "frictionless impact",
            Landing::Impact(Impact::Coulomb) => "Coulomb impact",
            Landing::Damped => "damped landing",
        }
    }

    pub(crate) fn remark(self) -> &'static str {
        match self {
            Landing::Impact(Impact::Frictionless) => {
                "the law of the 2008 paper, which is not the limit of any damped model; \
                 `impact: Coulomb` is (docs/waves.md)"
            }
            Landing::Impact(Impact::Coulomb) => {
                "the limit of small material damping (docs/waves.md)"
            }
            Landing::Damped => "with material damping there is no impact (docs/waves.md)",
        }
    }
}

/// Why a motion does not go on, with the names of its modes.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn halt(system: &System, halt: &Halt) -> String {
    let (mode, guard) = halt.place().unwrap_or_default();
    let name = format!("the mode `{}`", system.mode_name(mode));
    let words = halt.named(&name, &system.guard_name(mode, guard));
    match halt {
        Halt::Chattering { .. } => {
            format!("{words}; `rest` of a switch names the mode that begins there")
        }
        Halt::Fast { .. } => format!("{words}; ask for less time, or scale what is so fast"),
        _ => words,
    }
}

/// What a motion does that has no samples.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) const AWAY: &str = "the motion does not come to the section";

/// Why a value of a scan has fewer samples than asked for.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn lack(system: &System, lack: &Lack) -> String {
    match lack {
        Lack::System(error) => format!("the system makes no sense here: {error}"),
        Lack::Halted(reason) => halt(system, reason),
        Lack::Away { time } => format!("{AWAY} for a time of {time}"),
        Lack::Outside => "no random state lies within the mode that motions begin in".to_owned(),
    }
}

impl Display for Doubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Doubt::Supersonic { gamma } => write!(
                f,
                "gamma = {gamma}: the surface of the shaft runs at {:.3e} times the speed of sound sqrt(E/rho); \
                 gamma is rho R^2 Omega^2/E",
                gamma.sqrt()
            ),
            Doubt::Interference { mismatch } => write!(
                f,
                "the shaft is {:.3} % thicker than the bore of the tube: the model is linear, for small strains; \
                 the mismatch is d/R",
                100.0 * mismatch
            ),
            Doubt::Fast { speed, rotation } => {
                write!(
                    f,
                    "the surface of the shaft runs at {speed:.0} m/s, faster than in any brake"
                )?;
                match rotation {
                    Rotation::RadPerSecond(_) => {
                        f.write_str("; revolutions per minute are written `Rpm(600.0)`")
                    }
                    Rotation::Rpm(_) => Ok(()),
                }
            }
            Doubt::Inaudible { hertz, mode, bare } => {
                let kilohertz = hertz / 1e3;
                write!(
                    f,
                    "waves of mode {mode} have about {kilohertz:.0} kHz, which nobody hears"
                )?;
                match bare {
                    true => f.write_str("; `output.rotation` is in rad/s"),
                    false => Ok(()),
                }
            }
        }
    }
}

/// Something that comes so close to zero on a branch that its sign is not known.
fn near_zero(f: &mut Formatter<'_>, column: &str, value: f64, what: &impl Display) -> fmt::Result {
    write!(
        f,
        "{column} = {value:.12}: here, or since the point before, {what} comes so close to zero that \
         rounding decides: two events may be missing, or the regimes may be others"
    )
}

/// Orbits whose changes of signature have sentences.
pub(crate) trait Told: Orbit {
    /// What its orbits are.
    const NAME: &'static str;

    /// What happens at a change, without what comes of it.
    fn event(change: &orbit::special::Change<Self>) -> String;
}

impl<O: Told> Display for orbit::special::Special<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::Special;
        match self {
            Special::Start => f.write_str("start"),
            Special::Fold(parameter) => write!(f, "fold in {}", O::column(parameter)),
            Special::User(parameter, value) => {
                write!(f, "user point {} = {value}", O::column(parameter))
            }
            Special::Monitor(name, value) => write!(f, "user point {name} = {value}"),
            Special::Edge(parameter, value) => {
                write!(f, "edge of the range, {} = {value}", O::column(parameter))
            }
            Special::Closed => f.write_str("the branch closes on its first point"),
            Special::Change(change) => change.fmt(f),
            Special::Failed(failure) => failure.fmt(f),
            Special::Own(special) => special.fmt(f),
        }
    }
}

impl Display for OfWaves {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            OfWaves::HopfPoint => f.write_str("the Hopf point of steady sliding"),
            OfWaves::StickOpens => f.write_str("V̇ reaches 1: a stick zone opens"),
            OfWaves::CoulombLimit => f.write_str(
                "edge of the range, stiffness_damping = 0: the limit of little damping is this wave \
                 with Coulomb impacts, whatever `impact` says",
            ),
            OfWaves::Crossing {
                sector,
                omega,
                grows,
            } => {
                let what = if omega.is_some() {
                    "complex pair"
                } else {
                    "real eigenvalue"
                };
                let becomes = if *grows { "unstable" } else { "stable" };
                write!(f, "a {what} of sector {sector} becomes {becomes}")
            }
            OfWaves::Repeats => f.write_str("the wave is one of half its wavelength"),
        }
    }
}

impl Told for AffineOrbit {
    const NAME: &'static str = "orbit";

    fn event(change: &orbit::special::Change<AffineOrbit>) -> String {
        let affine::Held { mode, guard, .. } = &change.held;
        match (change.margin.watch, change.kind) {
            (affine::Watch::Duration, EventType::GR) => {
                format!("a zone of `{mode}` between two of one mode shrinks to nothing: grazing")
            }
            (affine::Watch::Duration, _) => format!("a zone of `{mode}` shrinks to nothing"),
            (affine::Watch::Inside(_), _) => {
                format!("{guard} of `{mode}` touches zero from inside: grazing")
            }
            (affine::Watch::Speed | affine::Watch::Onset(_), EventType::GR) => {
                format!("{guard} of `{mode}` is met at no speed: grazing")
            }
            (_, EventType::SL) => {
                format!(
                    "a condition where {guard} of `{mode}` is zero vanishes: the switch leads elsewhere"
                )
            }
            (affine::Watch::End(_), _) => {
                format!("{guard} of `{mode}` is zero at its end, too: two switches coalesce")
            }
            _ => format!("{guard} of `{mode}` is zero as it begins or ends"),
        }
    }
}

impl Display for hybrid::Note {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let hybrid::Note::Close {
            parameter,
            value,
            what,
        } = self;
        near_zero(f, parameter, *value, what)
    }
}

impl Told for EquilibriumCurve {
    const NAME: &'static str = "equilibrium";

    fn event(change: &orbit::special::Change<EquilibriumCurve>) -> String {
        let held = &change.held;
        match &change.after {
            None => format!("{held} is zero: a boundary equilibrium"),
            Some(after) if change.turned_back => {
                format!("nonsmooth fold: {held} is zero, and in `{after}` the branch goes on")
            }
            Some(after) => format!("persistence: {held} is zero, and it goes on in `{after}`"),
        }
    }
}

impl Display for EquilibriumNote {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let EquilibriumNote::Close {
            parameter,
            value,
            what,
        } = self;
        near_zero(f, parameter, *value, what)
    }
}

impl Told for Wave {
    const NAME: &'static str = "wave";

    fn event(change: &Change) -> String {
        let regime = change.before.zone(change.margin.zone).regime;
        let name = regime.name();
        let closes = change.margin.watch == WaveWatch::Duration;
        match change.kind {
            EventType::GR if closes => "the separation zone closes".into(),
            EventType::GR => {
                format!("the pressure touches zero in a {name} zone: separation opens")
            }
            EventType::RV if closes => "the reverse-slip zone closes before stick".into(),
            EventType::RV => "reverse slip opens before stick".into(),
            EventType::ST if closes && regime == Regime::Stick => "the stick zone vanishes".into(),
            EventType::ST => "a stick zone opens".into(),
            _ if closes => {
                let after = change.after.as_ref();
                if after.is_some_and(|after| after.len() == change.before.len()) {
                    format!("V̇ = 1 at both ends of a {name} zone: it gives way to another")
                } else {
                    format!("the {name} zone between its neighbours shrinks to nothing")
                }
            }
            _ => match change.margin.watch {
                WaveWatch::Gap => "the separated surface touches the shaft".into(),
                WaveWatch::Rate => format!("V̇ = 1 is touched inside a {name} zone"),
                WaveWatch::LandingRate => "landing passes through V̇ = 1".into(),
                WaveWatch::LandingPressure => "the pressure after landing reaches zero".into(),
                WaveWatch::Tension => {
                    "the tension after a touch reaches zero: contact begins".into()
                }
                WaveWatch::Impulse => "the impulse of landing no longer arrests the surface".into(),
                _ => "two switching points coalesce".into(),
            },
        }
    }
}

impl<O: Told> Display for orbit::special::Change<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&O::event(self))?;
        // sequences of the same modes may differ by their guards
        let after = self.after.as_ref().map(ToString::to_string);
        let mut others: Vec<String> = self.others.iter().map(ToString::to_string).collect();
        let mut told: Vec<String> = after.into_iter().collect();
        others.retain(|other| {
            let is_new = !told.contains(other);
            told.push(other.clone());
            is_new
        });
        if !others.is_empty() {
            write!(f, "; also admissible: {}", others.join(", "))?;
        }
        if let Some(end) = &self.end {
            write!(f, "; {end}")?;
        }
        if self.turned_back {
            f.write_str("; the branch turns back in the parameter here")?;
        }
        if let Some(remark) = &self.spectrum {
            write!(f, "; {remark}")?;
        }
        Ok(())
    }
}

impl Display for Remark {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Remark::Unpaid => f.write_str(
                "more eigenvalues cross the imaginary axis here than could be located: take a smaller \
                 `max_frequency` or `ds_max`",
            ),
            Remark::Lost => f.write_str(
                "the unstable count changes here and the crossing could not be located",
            ),
            Remark::Jump { before, after } => {
                let counts = |counts: &[(usize, usize)]| {
                    let words = counts.iter();
                    let words = words.map(|(sector, count)| format!("{count} in sector {sector}"));
                    list(&words.collect::<Vec<_>>(), ", ")
                };
                write!(
                    f,
                    "the spectrum is discontinuous here and the unstable count jumps without a crossing: \
                     {} before, {} after",
                    counts(before),
                    counts(after)
                )
            }
        }
    }
}

impl Display for InadmissibleWave {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let InadmissibleWave::Margin {
            regime,
            watch,
            value,
        } = self
        else {
            return f.write_str(match self {
                InadmissibleWave::Undecided => {
                    "an inequality is closer to zero than rounding can tell"
                }
                _ => "a switching condition is crossed the wrong way",
            });
        };
        let what = match watch {
            WaveWatch::Duration => "would have a negative length",
            WaveWatch::Pressure | WaveWatch::LandingPressure => "would have a negative pressure",
            WaveWatch::Rate | WaveWatch::LandingRate => "would pass through V̇ = 1",
            WaveWatch::Gap => "would penetrate the shaft",
            WaveWatch::LandingSpeed => "would land from below",
            WaveWatch::Tension => "would stay in contact",
            WaveWatch::LowerForce | WaveWatch::UpperForce => "would violate the friction law",
            WaveWatch::Impulse => "would land with too small an impulse",
            WaveWatch::Release => "would be released into reverse slip",
            WaveWatch::Coupling => {
                return f.write_str("D = 0 is passed: waves run in the direction of D");
            }
        };
        write!(f, "the {} zone {what} ({value:.1e})", regime.name())
    }
}

impl<O: Orbit> Display for orbit::special::OrbitRefusal<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::OrbitRefusal;
        match self {
            OrbitRefusal::Flow(error) => error.fmt(f),
            OrbitRefusal::Inadmissible(reason) => reason.fmt(f),
            OrbitRefusal::NotFound => {
                f.write_str("a fold or a user point inside the step was not found")
            }
            OrbitRefusal::NotLocated(count) => write!(
                f,
                "{count} inequalities fail within the step and none is located"
            ),
            OrbitRefusal::Uncertain {
                parameter,
                value,
                error,
            } => write!(
                f,
                "what happens near {} = {value:.6} is known to {error:.0e} only",
                O::column(parameter)
            ),
            OrbitRefusal::Order => f.write_str("the order of two events is not resolved"),
            OrbitRefusal::NoSolution => {
                f.write_str("the orbit of the event does not solve its equations")
            }
        }
    }
}

impl<O: Orbit> Display for orbit::special::BranchStop<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::BranchStop;
        match self {
            BranchStop::NoSignature => {
                f.write_str("no sequence of regimes solves the equations beyond this event")
            }
            BranchStop::NoneAdmissible(tried) => {
                f.write_str("no admissible signature continues beyond this event; tried ")?;
                let (no_solutions, refused): (Vec<_>, Vec<_>) =
                    tried.iter().partition(|tried| tried.is_no_solution());
                f.write_str(&list(&refused, "; "))?;
                let signatures = no_solutions
                    .iter()
                    .filter_map(|tried| tried.signature.as_ref());
                let signatures: Vec<_> = signatures.collect();
                if signatures.is_empty() {
                    return Ok(());
                }
                let between = if refused.is_empty() { "" } else { "; " };
                write!(
                    f,
                    "{between}of {} the orbit of the event does not solve the equations",
                    list(&signatures, ", ")
                )
            }
            BranchStop::Converges {
                kind,
                changes,
                ratio,
                parameter,
                limit,
                error,
            } => write!(
                f,
                "a sequence without end: {changes} events {kind} in a row add the same zones each, and the distances of \
                 their values fall by {ratio:.3} from one to the next; they converge at {} = {limit:.9} ± {error:.0e}",
                O::column(parameter)
            ),
            BranchStop::Flow(error) => error.fmt(f),
            BranchStop::Own(stop) => stop.fmt(f),
        }
    }
}

impl Display for WaveStop {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            WaveStop::Undriven => f.write_str(D_ZERO),
            WaveStop::Against => f.write_str(
                "D = 0: waves run in the direction of D, and beyond it this one would run against it; \
                 such waves are not followed",
            ),
            WaveStop::Sonic {
                excess,
                parameter,
                value,
            } => write!(
                f,
                "the speed tends to √a: |c|/√a − 1 = {excess:.1e} falls without end while everything \
                 else tends to a limit, {} to {value:.6}; waves must be faster than √a",
                parameter.column()
            ),
            WaveStop::SlipAlone => f.write_str(
                "what is left is one zone of slip around the whole circumference: linear waves on \
                 steady sliding at its Hopf point, of every amplitude down to none at this one value; \
                 `start: Hopf` lists them",
            ),
            WaveStop::Repeats { mode } => write!(
                f,
                "the wave is one of mode {mode}, traversed twice: beyond it the branch retraces itself with its halves \
                 exchanged"
            ),
        }
    }
}

impl<O: Orbit> Display for orbit::special::Tried<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.signature {
            Some(signature) => write!(f, "{signature}: {}", self.reason),
            None => self.reason.fmt(f),
        }
    }
}

impl<R: Display, E: Display> Display for End<R, E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            End::Edge => f.write_str("the edge of the range is reached"),
            End::Closed => f.write_str("the branch closes on its first point"),
            End::MaxPoints { most } => write!(
                f,
                "max_points = {most} points are reached before the end of the range; raise \
                 `max_points` to go on, or the steps `ds` and `ds_max` if they are small"
            ),
            End::Creeps { steps, longest } => write!(
                f,
                "the branch does not get on: none of its last {steps} steps is as long as \
                 {longest:.0e}, and longer ones fail"
            ),
            End::NoStep { ds_min, reason } => {
                write!(
                    f,
                    "no step of at least ds_min = {ds_min:e} succeeds: {reason}"
                )
            }
            End::Own(end) => end.fmt(f),
        }
    }
}

impl<O: Orbit> Display for orbit::special::BranchFailure<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use orbit::special::BranchFailure;
        match self {
            BranchFailure::Ended(end) => end.fmt(f),
            BranchFailure::NoLeg(reason) => reason.fmt(f),
        }
    }
}

impl<H: Display> Display for orbit::special::Close<H> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            orbit::special::Close::Margin(held) => held.fmt(f),
            orbit::special::Close::Fold => {
                f.write_str("the slope of the parameter, which vanishes at a fold,")
            }
        }
    }
}

impl Display for WaveMargin {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let WaveMargin { regime, watch } = self;
        let regime = regime.name();
        match watch {
            WaveWatch::Duration => write!(f, "the length of a {regime} zone"),
            WaveWatch::Pressure => write!(f, "the least pressure in a {regime} zone"),
            WaveWatch::LandingPressure | WaveWatch::Tension => {
                f.write_str("the pressure after a landing")
            }
            WaveWatch::Rate => write!(f, "|1 − V̇| inside a {regime} zone"),
            WaveWatch::LandingRate => f.write_str("|1 − V̇| after a landing"),
            WaveWatch::Gap => f.write_str("the gap inside a separation zone"),
            WaveWatch::LandingSpeed => f.write_str("the speed of a landing"),
            WaveWatch::Impulse => f.write_str("what the impulse of a landing can arrest"),
            WaveWatch::LowerForce | WaveWatch::UpperForce | WaveWatch::Release => {
                f.write_str("the distance of the friction force from its limit")
            }
            WaveWatch::Coupling => f.write_str("D"),
        }
    }
}

impl Display for WaveNote {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            WaveNote::CrossingLeftOut { parameter, value } => write!(
                f,
                "{} = {value:.12}: the wave at a crossing of the imaginary axis before this point could \
                 not be examined, and the crossing is left out",
                parameter.column()
            ),
            WaveNote::Spectrum {
                parameter,
                value,
                remark,
            } => write!(f, "{} = {value:.12}: {remark}", parameter.column()),
            WaveNote::Spent { points, allowance } => write!(
                f,
                "after point {points}: {} at {:.0e} a run; take a smaller `max_frequency`, fewer \
                 sectors or fewer points",
                VerdictReason::Spent,
                *allowance as f64
            ),
            WaveNote::Incomplete { point, reason } => write!(
                f,
                "point {point}: the spectrum is {reason}; see the column `why` for others"
            ),
            WaveNote::Close {
                parameter,
                value,
                what,
            } => near_zero(f, parameter.column(), *value, what),
            WaveNote::NotConverged {
                point,
                parameter,
                value,
                tolerance,
                known,
            } => {
                write!(
                    f,
                    "point {point}, {} = {value:.12}: not converged to the tolerance {tolerance:.0e}; ",
                    parameter.column()
                )?;
                if known.expected_error.is_nan() {
                    return f.write_str("its equations are singular to rounding");
                }
                write!(
                    f,
                    "the expected error is {:.1e}, the condition number {:.1e}",
                    known.expected_error, known.condition
                )
            }
        }
    }
}

impl<O: Told> Display for What<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            What::Begins => f.write_str("the event on the branch"),
            What::Edge(parameter, value) => {
                orbit::special::Special::<O>::Edge(parameter.clone(), *value).fmt(f)
            }
            What::Meeting {
                second,
                may_go_on,
                next,
            } => {
                let (event, kind) = (O::event(second), second.kind);
                write!(f, "another inequality fails: {event} ({kind})")?;
                match next {
                    Some(next) => write!(f, "; the curve goes on in {next}"),
                    None if *may_go_on => f.write_str("; no curve of this event goes on from here"),
                    None => Ok(()),
                }
            }
            What::Fold => write!(f, "the {} has a fold here too", O::NAME),
            What::Cusp => f.write_str("cusp: two folds meet and vanish"),
            What::Close(close) => write!(
                f,
                "here, or since the point before, {close} comes so close to zero that rounding decides"
            ),
            What::Other(PointType::BT) => {
                f.write_str("ω → 0: the pair meets on the real axis, and with it a fold")
            }
            What::Other(PointType::Resonance(order)) => match order {
                1 => f.write_str("resonance 1:1: the pair meets at 1"),
                2 => f.write_str("resonance 1:2: the pair meets at -1"),
                _ => write!(
                    f,
                    "resonance 1:{order}: the pair is at the angle 2π/{order}"
                ),
            },
            What::Other(PointType::GH) => {
                f.write_str("the first Lyapunov coefficient is zero: a degenerate Hopf point")
            }
            What::Other(PointType::ZH) => f.write_str("a pair is on the imaginary axis, too"),
            What::Other(PointType::HH) => {
                f.write_str("another pair is on the imaginary axis: two Hopf points")
            }
            What::Other(PointType::Two(EventType::HB, _)) => {
                f.write_str("a pair is on the imaginary axis, too")
            }
            What::Other(PointType::Two(_, EventType::PD)) => {
                f.write_str("a multiplier is -1 here too")
            }
            What::Other(PointType::Two(_, EventType::NS)) => {
                f.write_str("a pair of multipliers has the product 1 here too")
            }
            What::Other(kind) => write!(f, "{kind}"),
            What::Limit { kind, error } => {
                f.write_str(match kind {
                    PointType::GH => "the orbit shrinks to an equilibrium, a degenerate Hopf point",
                    PointType::Two(EventType::HB, EventType::BE) => {
                        "the orbit shrinks to an equilibrium, a Hopf point on its guard"
                    }
                    PointType::Two(_, EventType::BE) => {
                        "the orbit shrinks to an equilibrium on a boundary"
                    }
                    _ => "the orbit shrinks to an equilibrium, a Hopf point",
                })?;
                write!(
                    f,
                    ": the parameters there are limits, to {error:.0e} of their ranges"
                )
            }
            What::Passing([before, after]) => write!(
                f,
                "multipliers pass the unit circle together: {before} are outside it before, {after} after"
            ),
        }
    }
}

impl Display for Gone {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Gone::Lower(zone) => write!(
                f,
                "another minimum inside the {zone} zone falls below zero first"
            ),
            Gone::Left(zone) => write!(
                f,
                "the minimum inside the {zone} zone reaches an end of the zone: no inequality fails there \
                 any more"
            ),
            Gone::Along(zone) => write!(
                f,
                "an inequality of the {zone} zone that vanishes along with the event fails"
            ),
            Gone::Opened => f.write_str(
                "beyond it the branches of equilibria come apart: none crosses another one any more",
            ),
            Gone::Asymmetric => f.write_str(
                "beyond it the system is not symmetric: no orbit is its own image half a period later",
            ),
        }
    }
}

impl Display for Missing {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Missing::NoStart(reason) => reason.fmt(f),
            Missing::NoBranch(reason) => write!(
                f,
                "{reason}; and no branch that begins elsewhere in the plane comes here"
            ),
            Missing::Cut(failure) => write!(f, "a branch ends before: {failure}"),
            Missing::ComesBack => {
                f.write_str("the branch comes back to waves it has passed before")
            }
            Missing::Elsewhere => f.write_str("the branch does not come here"),
            Missing::Listed => {
                f.write_str("what the branch meets here is listed under another start")
            }
        }
    }
}

impl Display for curve::RegionName {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::RegionName::Pair { grows: true } => f.write_str("the pair grows"),
            curve::RegionName::Pair { grows: false } => f.write_str("the pair decays"),
            curve::RegionName::Outside(0) | curve::RegionName::Growing(0) => f.write_str("stable"),
            curve::RegionName::Growing(1) => f.write_str("1 eigenvalue grows"),
            curve::RegionName::Growing(count) => write!(f, "{count} eigenvalues grow"),
            curve::RegionName::Outside(1) => f.write_str("1 multiplier outside"),
            curve::RegionName::Outside(count) => write!(f, "{count} multipliers outside"),
            curve::RegionName::Orbits { count, regimes } => {
                match count {
                    None => {}
                    Some((count, orbits)) => write!(f, "{count} {orbits} ")?,
                }
                f.write_str(&list(regimes, ", "))
            }
        }
    }
}

impl<P: curve::ParameterPlane> Display for curve::CurveRefusal<P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::CurveRefusal::Flow(error) => error.fmt(f),
            curve::CurveRefusal::Posed => f.write_str("an inequality fails as soon as it is posed"),
            curve::CurveRefusal::NotLocated => {
                f.write_str("a point of codimension two was not located")
            }
            curve::CurveRefusal::Gone(gone) => gone.fmt(f),
        }
    }
}

impl<P: curve::ParameterPlane> Display for curve::CurveEndReason<P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::CurveEndReason::There | curve::CurveEndReason::Unknown => Ok(()),
            curve::CurveEndReason::Gone(gone) => gone.fmt(f),
            curve::CurveEndReason::Closed => f.write_str("the curve closes on its start"),
            curve::CurveEndReason::MaxPoints { most } => {
                write!(f, "`max_points`, {most} in either direction, are reached")
            }
            curve::CurveEndReason::Creeps {
                steps,
                longest,
                beside: (zone, length),
            } => write!(
                f,
                "the last {steps} steps are all shorter than {longest:.0e}: Newton's method hardly \
                 converges beside a {zone} zone of length {length:.1e}"
            ),
            curve::CurveEndReason::Stands { points, moved } => write!(
                f,
                "over the last {points} points the parameters move by no more than {moved:.0e} of their ranges: its steps \
                 do not lead on"
            ),
            curve::CurveEndReason::NoStep { ds_min, reason } => {
                write!(
                    f,
                    "no step of at least ds_min = {ds_min:e} succeeds: {reason}"
                )
            }
        }
    }
}

fn list<T: Display>(things: &[T], between: &str) -> String {
    let words: Vec<String> = things.iter().map(T::to_string).collect();
    words.join(between)
}
