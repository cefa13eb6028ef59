//! A branch as an iterator.

use crate::orbit::legs::Run as _;
use std::collections::VecDeque;

use super::begin::RunError;
use super::item::WaveItem;

use super::run::{End, WaveRunner};
use crate::problem::{Continuation, Problem};

/// The points of a branch in their order, special ones with their events, computed as they are asked for.
pub struct Branch {
    runner: WaveRunner,
    /// Points of the last step that are not yet handed out.
    waiting: VecDeque<WaveItem>,
}

impl Branch {
    /// The branch of a problem, from its first wave.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub fn follow(problem: &Problem, continuation: &Continuation) -> Result<Branch, RunError> {
        Ok(Branch {
            runner: WaveRunner::begin(problem, continuation, None)?,
            waiting: VecDeque::new(),
        })
    }

    /// How the branch ended; `None` while it goes on.
    pub fn end(&self) -> Option<&End> {
        self.runner.progress().end.as_ref()
    }
}

impl Iterator for Branch {
    type Item = WaveItem;

    fn next(&mut self) -> Option<WaveItem> {
        // a step may find nothing to hand out
        while self.waiting.is_empty() && self.end().is_none() {
            self.waiting.extend(self.runner.step());
        }
        self.waiting.pop_front()
    }
}
