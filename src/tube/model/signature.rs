//! Regimes, the switches between them, and signatures: the sequence of zones of a wave.
//!
//! | regime | holds while | switch that ends it |
//! |---|---|---|
//! | stick | U = δ, V̇ = 1, P > 0, \|Q\| < fP | release Q = fP → slip |
//! | slip | U = δ, V̇ < 1, P > 0 | V̇ = 1 → stick or reverse; P = 0 → separation |
//! | reverse | U = δ, V̇ > 1, P > 0 | V̇ = 1 → stick or slip; P = 0 → separation |
//! | contact | U = δ, P > 0, friction a smooth function of V̇ | P = 0 → separation |
//! | separation | U > δ, P = Q = 0 | landing U = δ → slip, reverse, contact (or stick with a Coulomb impact, or with β > 0); touch U = δ → separation |

use std::fmt;

use serde::{Deserialize, Serialize};

use super::laws::{FrictionLaw, Impact};

/// Contact regime of a zone, in the order in which a cycle without stick begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Regime {
    /// The surface moves with the shaft: V̇ = 1.
    Stick,
    /// The surface lags behind the shaft: V̇ < 1, Q = fP.
    Slip,
    /// No contact: P = Q = 0.
    Separation,
    /// The surface overtakes the shaft: V̇ > 1, Q = −fP.
    Reverse,
    /// Contact under a friction law that is smooth through V̇ = 1: no stick, no sliding direction.
    Contact,
}

impl Regime {
    pub(crate) const ALL: [Regime; 5] = [
        Regime::Slip,
        Regime::Stick,
        Regime::Reverse,
        Regime::Separation,
        Regime::Contact,
    ];

    /// The regime of this name.
    pub fn named(name: &str) -> Option<Regime> {
        Regime::ALL.into_iter().find(|regime| regime.name() == name)
    }

    /// Its word in tables, files and the names of signatures: "slip".
    pub fn name(self) -> &'static str {
        match self {
            Regime::Stick => "stick",
            Regime::Slip => "slip",
            Regime::Reverse => "reverse",
            Regime::Separation => "separation",
            Regime::Contact => "contact",
        }
    }

    /// Direction of sliding σ: +1 slip, −1 reverse; `None` where nothing slides.
    pub fn sliding(self) -> Option<f64> {
        match self {
            Regime::Slip => Some(1.0),
            Regime::Reverse => Some(-1.0),
            Regime::Stick | Regime::Separation | Regime::Contact => None,
        }
    }
}

impl FrictionLaw {
    /// Whether a regime occurs under the law: stick and sliding directions, or contact as a whole.
    pub fn has(self, regime: Regime) -> bool {
        let smooth = matches!(self, FrictionLaw::Regularised { .. });
        match regime {
            Regime::Separation => true,
            Regime::Contact => smooth,
            Regime::Stick | Regime::Slip | Regime::Reverse => !smooth,
        }
    }
}

/// How a zone is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ZoneEntry {
    /// stick → slip at Q = fP; V̇ = 1 and V̈ = 0, the whole state is reset.
    Release,
    /// Sliding comes to V̇ = 1 and |Q| ≤ fP holds: stick begins.
    Arrest,
    /// Sliding passes through V̇ = 1 and changes its direction.
    Reversal,
    /// Contact is lost at P = 0.
    TakeOff,
    /// Landing at U = δ; the velocity stays on its side of V̇ = 1.
    Landing,
    /// Landing with a Coulomb impact large enough to bring V̇ to 1; with stiffness-proportional damping
    /// landing at V̇ = 1.
    ArrestedLanding,
    /// V̇ = 0 rising: nothing switches, but a wave without switches needs a phase. V is periodic, so
    /// that V̇ passes zero in every wave.
    Section,
    /// Landing where contact would need tension: the impact stops U̇, and separation goes on. With
    /// stiffness-proportional damping a concentrated reaction that takes a part of Ü.
    Touch,
}

/// One zone of a signature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveZone {
    /// Regime that holds in the zone.
    pub regime: Regime,
    /// Switch at its beginning; that at its end is the entry of the next zone.
    pub entry: ZoneEntry,
}

/// The cyclic sequence of zones of a wave, time-forward along a material point.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Signature(pub Vec<WaveZone>);

impl Signature {
    /// One zone of slip: a wave on steady sliding at its Hopf point.
    pub(crate) fn slip_alone() -> Signature {
        Signature(vec![WaveZone {
            regime: Regime::Slip,
            entry: ZoneEntry::Section,
        }])
    }

    /// slip-stick, as it starts in closed form.
    pub fn slip_stick() -> Signature {
        Signature(vec![
            WaveZone {
                regime: Regime::Slip,
                entry: ZoneEntry::Release,
            },
            WaveZone {
                regime: Regime::Stick,
                entry: ZoneEntry::Arrest,
            },
        ])
    }

    /// Its regimes without the switches, which is what tables and messages call it by.
    pub fn regimes(&self) -> Regimes {
        Regimes(self.0.iter().map(|zone| zone.regime).collect())
    }

    /// Number of zones in one wavelength.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no zone.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether both are the same cycle: without stick a wave may begin anywhere.
    pub(crate) fn is_rotation_of(&self, other: &Signature) -> bool {
        self.len() == other.len()
            && (0..self.len()).any(|shift| {
                (0..self.len()).all(|index| self.0[index] == other.zone(index + shift))
            })
    }

    /// Where the cycle begins, so that a wave has one name however it was reached: at a release, or
    /// anywhere without stick; among these places where the sequence comes first in the order of
    /// regimes. Several places only where the cycle repeats itself.
    pub(crate) fn beginnings(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..self.len()).collect();
        if self.0.iter().any(|zone| zone.entry == ZoneEntry::Release) {
            places.retain(|&index| self.0[index].entry == ZoneEntry::Release);
        }
        let from = |index: usize| (0..self.len()).map(move |step| self.zone(index + step));
        let first = places
            .iter()
            .copied()
            .min_by(|&one, &other| from(one).cmp(from(other)));
        places.retain(|&index| first.is_some_and(|first| from(index).eq(from(first))));
        places
    }

    /// The zone at an index taken modulo the number of zones.
    pub fn zone(&self, index: usize) -> WaveZone {
        self.0[index % self.0.len()]
    }

    /// Whether a zone of this regime occurs.
    pub fn has(&self, regime: Regime) -> bool {
        self.0.iter().any(|zone| zone.regime == regime)
    }

    /// contact alone, cut at V̇ = 0, under a smooth friction law.
    pub fn contact() -> Signature {
        Signature(vec![WaveZone {
            regime: Regime::Contact,
            entry: ZoneEntry::Section,
        }])
    }

    /// How many zones have a regime.
    pub fn count(&self, regime: Regime) -> usize {
        self.0.iter().filter(|zone| zone.regime == regime).count()
    }
}

/// Its name: regimes joined by `-`.
impl fmt::Display for Signature {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.regimes().fmt(formatter)
    }
}

/// The regimes of a cycle in their order: what a signature is called by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Regimes(pub Vec<Regime>);

impl fmt::Display for Regimes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, regime) in self.0.iter().enumerate() {
            if index > 0 {
                formatter.write_str("-")?;
            }
            formatter.write_str(regime.name())?;
        }
        Ok(())
    }
}

/// Every switch that can lead from one regime into another under an impact law: the table above.
pub fn switches(from: Regime, to: Regime, impact: Impact) -> &'static [ZoneEntry] {
    use Regime::{Contact, Reverse, Separation, Slip, Stick};
    match (from, to) {
        (Stick, Slip) => &[ZoneEntry::Release],
        (Slip | Reverse, Stick) => &[ZoneEntry::Arrest],
        (Slip, Reverse) | (Reverse, Slip) => &[ZoneEntry::Reversal],
        (Slip | Reverse | Contact, Separation) => &[ZoneEntry::TakeOff],
        (Separation, Contact) => &[ZoneEntry::Landing],
        (Separation, Slip | Reverse) => match impact {
            Impact::Frictionless => &[ZoneEntry::Landing],
            Impact::Coulomb => &[ZoneEntry::Landing, ZoneEntry::ArrestedLanding],
        },
        (Separation, Separation) => &[ZoneEntry::Touch],
        (Separation, Stick) => match impact {
            Impact::Frictionless => &[],
            Impact::Coulomb => &[ZoneEntry::ArrestedLanding],
        },
        _ => &[],
    }
}

/// Every chain of zones that leads from `from` into `to` with at most `longest` zones between,
/// shortest first. The last zone of each chain is `to` with its entry.
pub fn paths(from: Regime, to: Regime, longest: usize, impact: Impact) -> Vec<Vec<WaveZone>> {
    let mut finished = Vec::new();
    let mut open: Vec<Vec<WaveZone>> = vec![Vec::new()];
    for length in 0..=longest {
        let mut longer = Vec::new();
        for chain in &open {
            let last = chain.last().map_or(from, |zone| zone.regime);
            for &entry in switches(last, to, impact) {
                let mut chain = chain.clone();
                chain.push(WaveZone { regime: to, entry });
                finished.push(chain);
            }
            if length == longest {
                continue;
            }
            for regime in Regime::ALL {
                for &entry in switches(last, regime, impact) {
                    let mut chain = chain.clone();
                    chain.push(WaveZone { regime, entry });
                    longer.push(chain);
                }
            }
        }
        open = longer;
    }
    finished
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever a cycle is cut, it begins at the same zone: with stick at the release, without stick
    /// with slip, and with separation after it where there is a choice.
    #[test]
    fn a_cycle_has_one_beginning() {
        use Regime::{Contact, Reverse, Separation, Slip, Stick};
        for (regimes, releases, name) in [
            (
                vec![Separation, Slip, Reverse, Slip],
                None,
                "slip-separation-slip-reverse",
            ),
            (
                vec![Reverse, Slip, Separation],
                None,
                "slip-separation-reverse",
            ),
            (vec![Contact, Separation], None, "separation-contact"),
            (
                vec![Slip, Stick, Slip, Separation, Slip, Stick],
                Some([0, 2]),
                "slip-stick-slip-separation-slip-stick",
            ),
        ] {
            let zones = regimes.iter().enumerate().map(|(index, &regime)| WaveZone {
                regime,
                entry: match releases {
                    Some(releases) if releases.contains(&index) => ZoneEntry::Release,
                    _ => ZoneEntry::Landing,
                },
            });
            let mut zones: Vec<WaveZone> = zones.collect();
            for _ in 0..zones.len() {
                zones.rotate_left(1);
                let places = Signature(zones.clone()).beginnings();
                assert_eq!(places.len(), 1);
                let mut begun = zones.clone();
                begun.rotate_left(places[0]);
                assert_eq!(Signature(begun).to_string(), name);
            }
        }
        // a cycle that repeats itself may begin at any of its parts
        let twice = [Separation, Slip, Separation, Slip].map(|regime| WaveZone {
            regime,
            entry: ZoneEntry::Landing,
        });
        assert_eq!(Signature(twice.to_vec()).beginnings(), [1, 3]);
    }

    #[test]
    fn paths_follow_the_switching_table() {
        let text = |chains: Vec<Vec<WaveZone>>| -> Vec<String> {
            chains
                .into_iter()
                .map(|chain| Signature(chain).to_string())
                .collect()
        };
        assert_eq!(
            text(paths(Regime::Slip, Regime::Slip, 1, Impact::Frictionless)),
            ["stick-slip", "reverse-slip", "separation-slip"]
        );
        assert_eq!(
            text(paths(
                Regime::Separation,
                Regime::Stick,
                1,
                Impact::Frictionless
            )),
            ["slip-stick", "reverse-stick"]
        );
        assert_eq!(
            text(paths(
                Regime::Separation,
                Regime::Separation,
                0,
                Impact::Frictionless
            )),
            ["separation"]
        );
        assert_eq!(
            text(paths(Regime::Separation, Regime::Stick, 0, Impact::Coulomb)),
            ["stick"]
        );
    }
}
