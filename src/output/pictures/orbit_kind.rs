//! What the orbits of a map are called in its legend.

use super::codes::Codes;
use super::tables::NO_SWITCH;

/// Longest signature in a legend, in characters.
const LONGEST: usize = 48;

/// Orbits of one period and one sequence, and of one attractor where these have numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OrbitKind {
    /// The number of the attractor.
    pub number: Option<usize>,
    /// Periods of the forcing; empty without one.
    periods: String,
    /// The sequence in the first of its cyclic forms, as far as it does not repeat itself.
    pub signature: String,
    /// How many zones that has, and how often it is repeated.
    zones: usize,
    times: usize,
    /// Whether the orbit never switches.
    is_still: bool,
}

impl OrbitKind {
    /// Reads `2: 1 free-free 0`: number of the attractor, periods, sequence, and `0` where nothing switches. `None` for what is no
    /// orbit.
    pub fn read(kind: &str) -> Option<OrbitKind> {
        let (number, kind) = match kind.split_once(": ") {
            Some((number, kind)) => (Some(number.parse().ok()?), kind),
            None => (None, kind),
        };
        let [periods, regimes, switches] = kind.split(' ').collect::<Vec<_>>()[..] else {
            return None;
        };
        let mut modes: Vec<&str> = regimes.split('-').collect();
        let turned = |start: &usize| [&modes[*start..], &modes[..*start]].concat();
        let first = (0..modes.len()).min_by_key(turned).unwrap_or(0);
        modes.rotate_left(first);
        let count = modes.len();
        let repeats = |length: &usize| {
            let same = |at: usize| modes[at] == modes[at - length];
            count.is_multiple_of(*length) && (*length..count).all(same)
        };
        let zones = (1..=count).find(repeats).unwrap_or(count);
        Some(OrbitKind {
            number,
            periods: periods.to_owned(),
            signature: modes[..zones].join("-"),
            zones,
            times: count / zones,
            is_still: switches == "0",
        })
    }

    /// Its name in a legend with these short names of modes: `2T: 3 free`.
    pub fn words(&self, codes: &Codes) -> String {
        let mut signature = codes.name(&self.signature);
        if signature.chars().count() > LONGEST {
            let begun: String = signature.chars().take(LONGEST).collect();
            signature = format!("{begun}… of {} zones", self.zones);
        }
        let signature = match (self.times, self.zones) {
            (1, _) => signature,
            (times, 1) => format!("{times} {signature}"),
            (times, _) => format!("{times} ({signature})"),
        };
        let number = self.number.map(|number| format!("{number}: "));
        let periods = match &*self.periods {
            "" => String::new(),
            "1" => "T: ".to_owned(),
            periods => format!("{periods}T: "),
        };
        let still = if self.is_still { NO_SWITCH } else { "" };
        number.unwrap_or_default() + &periods + &signature + still
    }
}

/// The name of what motions settle on, with its modes in full.
pub(super) fn orbit_name(kind: &str) -> String {
    let orbit = OrbitKind::read(kind);
    orbit.map_or_else(|| kind.to_owned(), |orbit| orbit.words(&Codes::default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One name for all cyclic forms and for what is traversed several times; an orbit that never switches has another
    /// than one with a switch.
    #[test]
    fn orbits_are_named_by_period_and_signature() {
        for (kind, name) in [
            ("1 free 0", "T: free, no switch"),
            ("1 free ", "T: free"),
            ("2 free-free-free ", "2T: 3 free"),
            ("1 free(hit)-free(hit) ", "T: 2 free(hit)"),
            (" slip-stick-slip-stick ", "2 (slip-stick)"),
            (" stick-slip ", "slip-stick"),
            ("3: 1 free ", "3: T: free"),
            ("not periodic", "not periodic"),
        ] {
            assert_eq!(orbit_name(kind), name);
        }
        let long = vec!["a"; 39].join("-") + "-b";
        let named = orbit_name(&format!("1 {long} "));
        assert!(
            named.starts_with("T: a-a-") && named.ends_with("… of 40 zones"),
            "{named}"
        );
        // with a letter for each mode there is room for all of it
        let orbit = OrbitKind::read(&format!("1 {long} ")).unwrap();
        let words = orbit.words(&Codes::of([orbit.signature.as_str()].into_iter()));
        assert_eq!(words, format!("T: {}b", "a".repeat(39)));
    }
}
