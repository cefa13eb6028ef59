//! Short names of long sequences of modes, and the key to them.
//!
//! Contacts make modes with long names, `forward.stick.backward`, and an orbit may pass twenty of them. Names that a
//! legend has no room for are shortened twice: the states of contacts to the fewest letters that tell them apart, `fsb`; and where
//! that is still too long, each mode to one letter, `abac`. The key says what each letter stands for.

/// Letters of the longest sequence that a picture shows as it is: about half a line of a legend.
const LONG: usize = 48;

/// What stands between modes, and between the states of contacts in the name of one.
const BETWEEN: char = '-';
const WITHIN: char = '.';

/// What stands before the name of a switch by which a mode follows itself.
const LABEL: char = '(';

/// The short names of the modes in some sequences.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Codes {
    /// Each state of a contact with its letters; empty where no name is shortened.
    states: Vec<(String, String)>,
    /// Each mode with its letter; empty where sequences are short without.
    modes: Vec<(String, String)>,
}

impl Codes {
    /// The codes of sequences, as far as the longest of them needs any.
    pub(crate) fn of<'a>(sequences: impl Iterator<Item = &'a str>) -> Codes {
        let sequences: Vec<&str> = sequences.collect();
        let mut codes = Codes::default();
        let is_long = |name: &str| name.chars().count() > LONG;
        if !sequences.iter().any(|sequence| is_long(sequence)) {
            return codes;
        }
        let mut modes: Vec<&str> = Vec::new();
        for mode in sequences.iter().flat_map(|all| all.split(BETWEEN)) {
            if !modes.contains(&mode) {
                modes.push(mode);
            }
        }
        if modes.iter().any(|mode| parted(mode).0.contains(WITHIN)) {
            codes.states = states(&modes);
        }
        if sequences.iter().any(|all| is_long(&codes.name(all))) {
            let letters = modes.iter().enumerate();
            let letters =
                letters.map(|(place, mode)| ((*mode).to_owned(), letter(place, modes.len())));
            codes.modes = letters.collect();
        }
        codes
    }

    /// The name of a sequence in a picture.
    pub(crate) fn name(&self, sequence: &str) -> String {
        let modes = sequence.split(BETWEEN);
        let names: Vec<String> = modes.map(|mode| self.mode(mode)).collect();
        // letters stand side by side
        let lettered = !self.modes.is_empty() && names.iter().all(|name| name.chars().count() == 1);
        names.join(if lettered { "" } else { "-" })
    }

    /// The name of a mode in a picture.
    pub(crate) fn mode(&self, mode: &str) -> String {
        let known = self.modes.iter().find(|(known, _)| known == mode);
        known.map_or_else(|| self.shortened(mode), |(_, letter)| letter.clone())
    }

    /// The same, and what its letter stands for.
    pub(crate) fn explained(&self, mode: &str) -> String {
        let known = self.modes.iter().find(|(known, _)| known == mode);
        let short = self.shortened(mode);
        match known {
            Some((_, letter)) => format!("{letter} = {short}"),
            None => short,
        }
    }

    /// What the short names stand for, mode by mode, then state by state.
    pub(crate) fn key(&self) -> Vec<String> {
        let modes = self.modes.iter().map(|(mode, _)| self.explained(mode));
        let states = self.states.iter().filter(|(state, short)| state != short);
        let states = states.map(|(state, short)| format!("{short} = {state}"));
        modes.chain(states).collect()
    }

    /// The name of a mode with the states of contacts shortened.
    fn shortened(&self, mode: &str) -> String {
        let short = |state: &str| {
            let known = self.states.iter().find(|(known, _)| known == state);
            known.map_or_else(|| state.to_owned(), |(_, short)| short.clone())
        };
        let (mode, label) = parted(mode);
        let parts: Vec<String> = mode.split(WITHIN).map(short).collect();
        let mut letters = self.states.iter().map(|(_, short)| short.chars().count());
        let lettered = !self.states.is_empty() && letters.all(|count| count == 1);
        parts.join(if lettered { "" } else { "." }) + label
    }
}

/// The name of a mode, and the label of its end.
fn parted(mode: &str) -> (&str, &str) {
    mode.split_at(mode.find(LABEL).unwrap_or(mode.len()))
}

/// The states in the names of modes, each with the shortest beginning that no other has.
fn states(modes: &[&str]) -> Vec<(String, String)> {
    let mut states: Vec<&str> = Vec::new();
    for state in modes.iter().flat_map(|mode| parted(mode).0.split(WITHIN)) {
        if !states.contains(&state) {
            states.push(state);
        }
    }
    let beginning = |state: &str, count: usize| state.chars().take(count).collect::<String>();
    let short = |state: &&str| {
        let alone = |count: &usize| {
            let mut others = states.iter().filter(|other| *other != state);
            others.all(|other| beginning(other, *count) != beginning(state, *count))
        };
        let count = (1..state.chars().count()).find(alone);
        count.map_or_else(|| (*state).to_owned(), |count| beginning(state, count))
    };
    states
        .iter()
        .map(|state| ((*state).to_owned(), short(state)))
        .collect()
}

/// The letter of a mode, or its number where there are not enough letters for all.
fn letter(place: usize, all: usize) -> String {
    let letters = || ('a'..='z').chain('A'..='Z');
    let letter = letters().nth(place).filter(|_| all <= letters().count());
    letter.map_or_else(|| (place + 1).to_string(), |letter| letter.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are shortened as far as they must be, and no two become one.
    #[test]
    fn long_sequences_have_letters_and_a_key() {
        let short = ["early-late", "free"];
        let codes = Codes::of(short.into_iter());
        assert_eq!(codes, Codes::default());
        for name in ["early-late", "open.closed-open.open"] {
            assert_eq!(codes.name(name), name);
        }
        let two = "backward.backward-backward.stick-stick.backward-stick.stick-backward.backward";
        let codes = Codes::of([two].into_iter());
        assert_eq!(codes.name(two), "bb-bs-sb-ss-bb");
        assert_eq!(codes.key(), ["b = backward", "s = stick"]);
        let labelled = two.replace("-stick.stick-", "-stick.stick(hit)-");
        let codes = Codes::of([labelled.as_str()].into_iter());
        assert_eq!(codes.name(&labelled), "bb-bs-sb-ss(hit)-bb");
        assert_eq!(codes.key(), ["b = backward", "s = stick"]);
        let states = ["forward", "free", "stick"];
        let modes = states
            .iter()
            .flat_map(|one| states.iter().map(move |other| format!("{one}.{other}")));
        let modes: Vec<String> = modes.collect();
        let long = [&modes[..], &modes[..]].concat().join("-");
        let codes = Codes::of([long.as_str()].into_iter());
        assert_eq!(codes.name(&long), "abcdefghiabcdefghi");
        assert_eq!(codes.key()[..2], ["a = fo.fo", "b = fo.fr"]);
        assert_eq!(codes.key().last().map(String::as_str), Some("s = stick"));
    }

    /// There are names for any number of modes, and whatever they are.
    #[test]
    fn odd_names_have_codes() {
        let many: Vec<String> = (0..90).map(|mode| format!("m{mode}")).collect();
        let many = many.join("-");
        let codes = Codes::of([many.as_str()].into_iter());
        assert!(codes.name(&many).starts_with("1-2-3-"));
        let odd = format!("{}..-.-{}", "a.".repeat(40), "stick.sticky");
        let codes = Codes::of([odd.as_str(), ""].into_iter());
        assert!(codes.name(&odd).len() < odd.len());
        assert_eq!(codes.mode("unknown"), "unknown");
    }
}
