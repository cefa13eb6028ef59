//! The types of special points: what a problem file asks for and a branch finds.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Kind of a special point, two letters after the habit of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum EventType {
    /// End point of the branch: an edge of the range, the start, or a requested stop.
    EP,
    /// The continuation failed here; the reason is in [`Event::what`].
    MX,
    /// User point: a value asked for in `stop_at`.
    UZ,
    /// Limit point (fold) in the continuation parameter.
    LP,
    /// Of orbits of systems: a multiplier is −1, the period doubles.
    PD,
    /// Of orbits of systems: a pair of multipliers crosses the unit circle.
    NS,
    /// A complex pair of eigenvalues crosses Re λ = 0, of waves in the named Bloch sector; of equilibria of systems, a
    /// Hopf point.
    HB,
    /// A real eigenvalue crosses zero in the named Bloch sector other than by a fold; of orbits of systems, a
    /// multiplier is 1 other than by a fold.
    BP,
    /// Take-off at zero pressure: a separation zone opens or closes. Of orbits of systems: a guard of the mode
    /// is touched from inside (grazing).
    GR,
    /// A reverse-slip zone opens or closes between slip and stick.
    RV,
    /// Two switching points coalesce: a zone vanishes or is born between others.
    CO,
    /// The number of stick zones changes: one vanishes or opens.
    ST,
    /// Of orbits of systems: an `if` or a sliding condition reaches zero, so that a switch leads elsewhere beyond.
    SL,
    /// Of equilibria of systems: a guard of the mode is zero at one.
    BE,
    /// Of orbits of systems: the branch ends at a homoclinic orbit, a cycle of connections between saddles, or an orbit that
    /// comes to rest where it would switch.
    HC,
}

impl EventType {
    /// All types, in the order in which legends list them.
    pub const ALL: [EventType; 15] = [
        EventType::EP,
        EventType::MX,
        EventType::UZ,
        EventType::LP,
        EventType::PD,
        EventType::NS,
        EventType::HB,
        EventType::BP,
        EventType::GR,
        EventType::RV,
        EventType::CO,
        EventType::ST,
        EventType::SL,
        EventType::BE,
        EventType::HC,
    ];

    /// Whether events of this type are found in the spectrum, the multipliers of a system's orbit: those of
    /// waves have a sector and an Im λ.
    pub(crate) fn of_spectrum(self) -> bool {
        use EventType::{BP, HB, NS, PD};
        matches!(self, HB | BP | PD | NS)
    }

    /// Whether the sequence of regimes changes at events of this type.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn of_regimes(self) -> bool {
        use EventType::{BE, CO, GR, RV, SL, ST};
        matches!(self, GR | RV | CO | ST | SL | BE)
    }

    /// Whether waves of a tube have events of this type.
    pub(crate) fn of_waves(self) -> bool {
        use EventType::{BE, HC, NS, PD, SL};
        !matches!(self, PD | NS | SL | BE | HC)
    }

    /// Whether orbits of systems of one's own have events of this type.
    pub(crate) fn of_systems(self) -> bool {
        use EventType::{BE, HB, RV, ST};
        !matches!(self, HB | RV | ST | BE)
    }

    /// Whether branches of equilibria of such systems have events of this type.
    pub(crate) fn of_equilibria(self) -> bool {
        use EventType::{BE, BP, EP, HB, LP, MX, UZ};
        matches!(self, EP | MX | UZ | LP | BP | HB | BE)
    }
}

impl fmt::Display for EventType {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            EventType::EP => "EP",
            EventType::MX => "MX",
            EventType::UZ => "UZ",
            EventType::LP => "LP",
            EventType::PD => "PD",
            EventType::NS => "NS",
            EventType::HB => "HB",
            EventType::BP => "BP",
            EventType::GR => "GR",
            EventType::RV => "RV",
            EventType::CO => "CO",
            EventType::ST => "ST",
            EventType::SL => "SL",
            EventType::BE => "BE",
            EventType::HC => "HC",
        })
    }
}

/// A text that names no type of special point.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not an event type")]
pub struct UnknownType(String);

impl FromStr for EventType {
    type Err = UnknownType;

    fn from_str(text: &str) -> Result<Self, UnknownType> {
        let named = |kind: &EventType| kind.to_string() == text;
        let kind = EventType::ALL.into_iter().find(named);
        kind.ok_or_else(|| UnknownType(text.to_owned()))
    }
}
