//! A branch as an iterator.

use crate::orbit::legs::Run as _;
use std::collections::VecDeque;

use super::begin::RunError;
use super::item::Item;

use super::run::{End, Runner};
use crate::problem::{Continuation, Problem};

/// The points of a branch in their order, special ones with their events, computed as they are asked for.
pub struct Branch {
    runner: Runner,
    /// Points of the last step that are not yet handed out.
    waiting: VecDeque<Item>,
}

impl Branch {
    /// The branch of a problem, from its first wave.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub fn follow(problem: &Problem, continuation: &Continuation) -> Result<Branch, RunError> {
        Ok(Branch {
            runner: Runner::begin(problem, continuation, None)?,
            waiting: VecDeque::new(),
        })
    }

    /// How the branch ended; `None` while it goes on.
    pub fn end(&self) -> Option<&End> {
        self.runner.progress().end.as_ref()
    }
}

impl Iterator for Branch {
    type Item = Item;

    fn next(&mut self) -> Option<Item> {
        // a step may find nothing to hand out
        while self.waiting.is_empty() && self.end().is_none() {
            self.waiting.extend(self.runner.step());
        }
        self.waiting.pop_front()
    }
}
