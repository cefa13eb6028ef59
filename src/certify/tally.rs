//! Numbers along a branch: between two points at which it is known how many multipliers are outside the unit circle, or how
//! many eigenvalues grow, that number changes by what the events between them make of it, and by nothing else.

use super::arc::Broken;
use super::certificate::{CertifiedPoint, GrowthTally, Provable};

/// Why an arc of a branch is not proven.
type BrokenArc<P> = Broken<<P as Provable>::Unproven, <P as Provable>::Beyond>;

/// Points whose number of growing multipliers or eigenvalues does not follow from that at an earlier one, and the points between
/// them, with the reason why no arc before them is proven.
pub fn miscounted<P: Provable>(points: &[CertifiedPoint<P>]) -> Vec<(usize, BrokenArc<P>)> {
    let mut found = Vec::new();
    // where the number was last known, and what it may be by now
    let mut known: Option<(usize, usize)> = None;
    let mut possible: Vec<usize> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        if index > 0 && points[index - 1].leg != point.leg {
            known = None;
        }
        match P::tally(point) {
            GrowthTally::Known { growing, neutral } => {
                let sides = [growing, growing + neutral];
                let reached = |side: &usize| possible.contains(side);
                let agrees = known.is_none() || sides.iter().any(reached);
                if let Some((from, count)) = known.filter(|_| !agrees) {
                    found.extend((from + 1..=index).map(|it| (it, Broken::Tally(count, growing))));
                }
                let fresh = known.is_none() || !agrees;
                // what comes from one side leaves on the other
                let leaves = [(growing, growing + neutral), (growing + neutral, growing)];
                let leaves = leaves.iter().filter(|(side, _)| fresh || reached(side));
                possible = leaves.map(|(_, other)| *other).collect();
                known = Some((index, growing));
            }
            GrowthTally::Passes(several) => {
                let change =
                    |count: &usize| [count.checked_add(several), count.checked_sub(several)];
                possible = possible.iter().flat_map(change).flatten().collect();
            }
            GrowthTally::Unknown => known = None,
        }
    }
    found
}
