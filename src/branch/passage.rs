//! A wave of a branch at a value of its parameter: the first passage, or a later one where the branch
//! turns back.

use super::EventType;
use super::run::{End, WaveItem, WaveRunner};
use crate::orbit::legs::Run as _;

/// Steps in which other passages are looked for, at least.
const STEPS_BEYOND: usize = 2000;

/// A search along a branch.
pub struct PassageSearch {
    branch: WaveRunner,
    /// Value of the parameter; the first wave of the branch where none is asked for.
    target: Option<f64>,
    /// The passage asked for, from 1.
    wanted: usize,
    passages: usize,
    steps: usize,
    /// Steps after which no more are looked for.
    most: usize,
    found: Option<WaveItem>,
}

impl PassageSearch {
    /// Looks for a passage through a value on a branch that stops there.
    pub fn new(branch: WaveRunner, target: Option<f64>, wanted: usize) -> PassageSearch {
        PassageSearch {
            branch,
            target,
            wanted,
            passages: 0,
            steps: 0,
            most: usize::MAX,
            found: None,
        }
    }

    /// Takes a step; false at the end of the search. Once the passage is found others are looked for: as
    /// far again as it was to come there.
    pub fn step(&mut self) -> bool {
        if self.branch.progress().end.is_some() || self.steps >= self.most {
            return false;
        }
        self.steps += 1;
        for item in self.branch.step() {
            if !self.meets(&item) {
                continue;
            }
            self.passages += 1;
            let first = self.target.is_none() && self.found.is_none();
            if self.passages == self.wanted || first {
                self.most = match self.target {
                    Some(_) => 2 * self.steps + STEPS_BEYOND,
                    None => self.steps,
                };
                self.found = Some(item);
            }
        }
        true
    }

    fn meets(&self, item: &WaveItem) -> bool {
        let parameter = self.branch.parameter();
        let saved = item.saved.as_ref();
        let here = saved.and_then(|saved| saved.model.value(parameter));
        let meets = self.target.is_none() || (item.point.label.is_some() && here == self.target);
        meets && item.point.kind != Some(EventType::MX)
    }

    /// Points of the branch so far.
    pub fn points(&self) -> usize {
        self.branch.progress().points
    }

    /// Passages so far.
    pub fn passages(&self) -> usize {
        self.passages
    }

    /// Steps so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// How the branch has ended; none where it goes on.
    pub fn end(&self) -> Option<&End> {
        self.branch.progress().end.as_ref()
    }

    /// The point that was asked for.
    pub fn found(&self) -> Option<&WaveItem> {
        self.found.as_ref()
    }
}
