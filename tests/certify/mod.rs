//! What is called proven: the laws of intervals; special points of branches against figures of other
//! origin; what must not be proven; the command line.

mod arcs;
mod beside;
mod command;
mod contacts;
mod count;
mod equilibria;
mod laws;
mod layers;
mod orbits;
mod waves;
use std::collections::BTreeMap;

/// A certificate with a field more in one of its parts, for every kind of part, which its first field names.
fn with_a_field_more(certificate: &str) -> BTreeMap<&str, String> {
    let mut forged = BTreeMap::new();
    for (place, _) in certificate.match_indices('(') {
        let (before, rest) = certificate.split_at(place + 1);
        let name = |c: char| c.is_alphanumeric() || c == '_';
        let (first, follows) = rest.trim_start().split_once(':').unwrap_or_default();
        if first.chars().all(name) && follows.starts_with(' ') {
            let more = || format!("{before}stable: true, {rest}");
            forged.entry(first).or_insert_with(more);
        }
    }
    forged
}
