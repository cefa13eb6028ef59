//! Which sliding bifurcation changes the sequence of an orbit, after di Bernardo, Budd, Champneys and Kowalczyk
//! (Piecewise-smooth Dynamical Systems, 2008, chapter 8).

use std::fmt;

use serde::{Deserialize, Serialize};

use super::margin::{Margin, Watch};
use super::signature::Sequence;
use crate::affine::system::System;

/// A sliding bifurcation of a periodic orbit. F and G are the modes on the two sides of a surface, S slides in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlidingBifurcation {
    /// F-G becomes F-S-G: an orbit that crosses the surface comes to the boundary of sliding, and slides a little beyond.
    Crossing,
    /// F becomes F-S-F: an orbit touches the surface, where sliding ends by the same field, and slides a little beyond.
    Grazing,
    /// F-S becomes F-G-S: an orbit comes to the surface beside the boundary of sliding, crosses it, and comes back.
    Switching,
    /// S becomes S-F-S: sliding touches its own boundary, and leaves the surface for a while beyond.
    Adding,
}

impl fmt::Display for SlidingBifurcation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            SlidingBifurcation::Crossing => "crossing-sliding",
            SlidingBifurcation::Grazing => "grazing-sliding",
            SlidingBifurcation::Switching => "switching-sliding",
            SlidingBifurcation::Adding => "adding-sliding",
        })
    }
}

/// What a margin that vanishes tells of the zones that come or go.
#[derive(Clone, Copy)]
enum ZoneTold {
    Nothing,
    /// A zone of this mode closes.
    Closes(usize),
    /// A zone of this mode is cut.
    Touches(usize),
}

impl ZoneTold {
    /// Whether a zone of one mode may come or go within one of another.
    fn fits(self, around: usize, own: usize) -> bool {
        match self {
            ZoneTold::Nothing => true,
            ZoneTold::Closes(mode) => mode == own,
            ZoneTold::Touches(mode) => mode == around,
        }
    }
}

/// A change of the sequences of a system, and what is told of it.
struct SlidingChange<'a> {
    system: &'a System,
    told: ZoneTold,
}

/// Most places of one period at which the sequence changes at once: of a symmetric orbit both halves do.
const PLACES: usize = 4;

impl SlidingBifurcation {
    const ALL: [SlidingBifurcation; 4] = [
        SlidingBifurcation::Crossing,
        SlidingBifurcation::Grazing,
        SlidingBifurcation::Switching,
        SlidingBifurcation::Adding,
    ];

    /// The one that leads from one of two sequences of a system to the other, where a margin of the first vanishes; `None` where none
    /// does, or several may. Where both modes of a surface follow one another already the sequences tell no grazing from adding:
    /// what vanishes does.
    pub fn between(
        system: &System,
        one: &Sequence,
        other: &Sequence,
        margin: &Margin,
    ) -> Option<SlidingBifurcation> {
        let (short, long) = match one.len() <= other.len() {
            true => (one, other),
            false => (other, one),
        };
        let modes = |sequence: &Sequence| -> Vec<usize> {
            sequence.0.iter().map(|zone| zone.mode).collect()
        };
        // an orbit that never switches is cut nowhere
        let whole = short.switches() == 0;
        let (short, long) = (modes(short), modes(long));
        let mode = one.zone(margin.zone).mode;
        let kinds = |told: ZoneTold| {
            let change = SlidingChange { system, told };
            let leads = |kind: &SlidingBifurcation| match whole {
                true => kind.cuts(&long, short[0], &change),
                false => kind.leads(&short, &long, &change),
            };
            let mut kinds = SlidingBifurcation::ALL.into_iter().filter(leads);
            (kinds.next(), kinds.next())
        };
        match kinds(ZoneTold::Nothing) {
            (Some(_), Some(_)) => {
                let (only, None) = kinds(match margin.watch {
                    Watch::Duration => ZoneTold::Closes(mode),
                    _ => ZoneTold::Touches(mode),
                }) else {
                    return None;
                };
                only
            }
            (first, _) => first,
        }
    }

    /// Zones that it puts in.
    fn width(self) -> usize {
        match self {
            SlidingBifurcation::Crossing | SlidingBifurcation::Switching => 1,
            SlidingBifurcation::Grazing | SlidingBifurcation::Adding => 2,
        }
    }

    /// Whether a zone may be the first of those that it puts in, by its neighbours.
    fn fits(self, [before, own, after]: [usize; 3], change: &SlidingChange) -> bool {
        let sides = |mode: usize| change.system.sides(mode);
        let of = |sliding: usize, side: usize| {
            let mut sides = sides(sliding).into_iter();
            sides.find(|sides| sides.contains(&side))
        };
        match self {
            SlidingBifurcation::Crossing => sides(own)
                .iter()
                .any(|sides| *sides == [before, after] || *sides == [after, before]),
            SlidingBifurcation::Switching => {
                own != before && of(after, own).is_some_and(|sides| sides.contains(&before))
            }
            SlidingBifurcation::Grazing => {
                before == after && of(own, before).is_some() && change.told.fits(before, own)
            }
            SlidingBifurcation::Adding => {
                before == after && of(before, own).is_some() && change.told.fits(before, own)
            }
        }
    }

    /// Whether it cuts an orbit that never switches, in one mode, into these zones.
    fn cuts(self, long: &[usize], mode: usize, change: &SlidingChange) -> bool {
        let pairs = long.chunks(2).all(|pair| match *pair {
            [one, other] if one == mode => self.fits([mode, other, mode], change),
            [one, other] if other == mode => self.fits([mode, one, mode], change),
            _ => false,
        });
        self.width() == 2 && pairs
    }

    /// Whether a cycle of modes becomes another where it puts in zones at some places at once.
    fn leads(self, short: &[usize], long: &[usize], change: &SlidingChange) -> bool {
        let more = long.len() - short.len();
        let count = more / self.width();
        if more == 0 || !more.is_multiple_of(self.width()) || count > PLACES {
            return false;
        }
        let at = |index: usize| long[index % long.len()];
        let places: Vec<usize> = (0..long.len())
            .filter(|place| {
                let neighbours = [at(place + long.len() - 1), at(*place), at(place + 1)];
                self.fits(neighbours, change)
            })
            .collect();
        let without = |chosen: &[usize]| {
            let mut left = vec![true; long.len()];
            let taken = chosen
                .iter()
                .flat_map(|place| (*place..place + self.width()).map(|place| place % long.len()));
            taken.for_each(|place| left[place] = false);
            let rest: Vec<usize> = (0..long.len())
                .filter(|place| left[*place])
                .map(at)
                .collect();
            rest.len() == short.len()
                && (0..rest.len()).any(|shift| {
                    (0..rest.len()).all(|k| rest[(k + shift) % rest.len()] == short[k])
                })
        };
        let mut open = vec![(Vec::new(), 0)];
        while let Some((chosen, from)) = open.pop() {
            if chosen.len() == count {
                if without(&chosen) {
                    return true;
                }
                continue;
            }
            for (index, place) in places.iter().enumerate().skip(from) {
                let mut more = chosen.clone();
                more.push(*place);
                open.push((more, index + 1));
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::super::signature::{Way, Zone};
    use super::*;
    use crate::affine::system::{ModeSource, Source, SwitchSource};

    /// F for x > 0, G for x < 0, S between them.
    fn system() -> System {
        let mode = |zero: &str, to: &str| ModeSource {
            rates: [("x", "1")].into(),
            until: vec![SwitchSource {
                zero: zero.into(),
                to: to.into(),
                ..SwitchSource::default()
            }],
        };
        let source = Source {
            states: vec!["x".into()],
            modes: [("F", mode("x", "G")), ("G", mode("-x", "F"))].into(),
            sliding: super::super::super::system::Ordered(vec![(
                "S".into(),
                ("F".into(), "G".into()),
            )]),
            ..Source::default()
        };
        System::new(source).unwrap()
    }

    fn sequence(system: &System, names: &str) -> Sequence {
        let way = (names.len() > 1).then_some(Way { guard: 0, exit: 0 });
        let zone = |name: &str| Zone::new(system.mode(name).unwrap(), way, name.to_owned());
        Sequence(names.split('-').map(zone).collect())
    }

    #[test]
    fn sequences_tell_which_of_the_four_it_is() {
        use SlidingBifurcation::{Adding, Crossing, Grazing, Switching};
        let system = system();
        let margin = |watch: Watch, zone: usize| Margin {
            watch,
            zone,
            time: 0.0,
            value: 0.0,
            gradient: Vec::new(),
        };
        for (one, other, kind) in [
            ("F-G", "F-S-G", Some(Crossing)),
            ("F-G", "F-S-G-S", Some(Crossing)),
            ("F-S-G", "F-G", Some(Crossing)),
            ("F", "F-S", Some(Grazing)),
            ("F-G", "F-S-F-G", Some(Grazing)),
            ("F-S", "F-G-S", Some(Switching)),
            ("F-S-G-S", "F-G-S-G-F-S", Some(Switching)),
            ("S", "F-S", Some(Adding)),
            ("F-S", "F-S-G-S", Some(Adding)),
            ("F-G", "F-G-F-G", None),
            ("F-S", "F-G", None),
            ("F", "F-G", None),
        ] {
            let [one, other] = [one, other].map(|names| sequence(&system, names));
            for (one, other) in [(&one, &other), (&other, &one)] {
                let at = margin(Watch::Speed, 0);
                let found = SlidingBifurcation::between(&system, one, other, &at);
                assert_eq!(found, kind, "{one} to {other}");
            }
        }
        // either zone of F-S may have come twice: it is told by the one that closes, or is touched from inside
        let [one, other] = ["F-S", "F-S-F-S"].map(|names| sequence(&system, names));
        let closes = |zone: usize| {
            SlidingBifurcation::between(&system, &other, &one, &margin(Watch::Duration, zone))
        };
        let touches = |zone: usize| {
            SlidingBifurcation::between(&system, &one, &other, &margin(Watch::Inside(0), zone))
        };
        assert_eq!([closes(0), closes(1)], [Some(Adding), Some(Grazing)]);
        assert_eq!([touches(0), touches(1)], [Some(Grazing), Some(Adding)]);
    }
}
