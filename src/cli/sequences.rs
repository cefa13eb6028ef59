//! Sequences of regimes as lines of a terminal show them: whole where they are short, and otherwise what changes in them.

/// Most zones of a sequence that is shown whole.
const MOST: usize = 8;

/// A sequence: of a long one its first zones and its last.
pub(crate) fn shown(regimes: &str) -> String {
    let zones: Vec<&str> = regimes.split('-').collect();
    match zones.as_slice() {
        [first, second, .., last] if zones.len() > MOST => {
            format!("{first}-{second}-…-{last} ({} zones)", zones.len())
        }
        _ => regimes.to_owned(),
    }
}

/// What a sequence changes into: of long ones the zones that differ, with one on either side.
pub(crate) fn changed(before: &str, after: &str) -> String {
    let [own, other]: [Vec<&str>; 2] = [before, after].map(|regimes| regimes.split('-').collect());
    if own.len().max(other.len()) <= MOST {
        return format!("{before} → {after}");
    }
    // a sequence begins where its name does: turned so that as much as possible is the same
    let turned = (0..other.len()).map(|first| [&other[first..], &other[..first]].concat());
    let alike = turned.map(|other| (common(&own, &other), other));
    let best = alike.rev().max_by_key(|([first, last], _)| first + last);
    let Some(([first, last], other)) = best else {
        return format!("{before} → {after}");
    };
    let part = |zones: &[&str]| {
        let from = first.saturating_sub(1);
        let to = (zones.len() - last + 1).min(zones.len());
        let mut text = zones[from..to].join("-");
        if from > 0 {
            text.insert_str(0, "…-");
        }
        if to < zones.len() {
            text.push_str("-…");
        }
        text
    };
    format!(
        "{} → {} ({} → {} zones)",
        part(&own),
        part(&other),
        own.len(),
        other.len()
    )
}

/// How many zones two sequences have in common at their beginnings, and then at their ends.
fn common(one: &[&str], other: &[&str]) -> [usize; 2] {
    let alike = one.iter().zip(other);
    let first = alike.take_while(|(one, other)| one == other).count();
    let (one, other) = (&one[first..], &other[first..]);
    let alike = one.iter().rev().zip(other.iter().rev());
    [first, alike.take_while(|(one, other)| one == other).count()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_sequences_show_what_changes() {
        assert_eq!(changed("a-b", "a-c-b"), "a-b → a-c-b");
        let long = "a-b-c-d-e-f-g-h-i";
        assert_eq!(shown(long), "a-b-…-i (9 zones)");
        assert_eq!(
            changed(long, "a-b-c-d-x-e-f-g-h-i"),
            "…-d-e-… → …-d-x-e-… (9 → 10 zones)"
        );
        // the same where the first zone is another
        assert_eq!(
            changed(long, "e-f-g-h-i-a-b-d"),
            "…-b-c-d-… → …-b-d-… (9 → 8 zones)"
        );
    }
}
