//! Passages through integrated zones that are known: a point is looked at many times, and a point of a curve in two
//! parameters by orbits that are posed in either of them.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::passage::Integrated;
use crate::affine::mode::AffineMode;
use crate::linalg::Vector;

/// Most passages that are kept, and most pieces of them: those of some orbits next to each other.
const MOST: usize = 64;
const MOST_STAGES: usize = 2048;

/// A passage, and all that it follows from.
#[derive(Debug)]
struct Known {
    mode: usize,
    values: Vec<f64>,
    /// The parameters of its derivatives, in their order.
    varying: Vec<usize>,
    entry: Vector,
    time: f64,
    passage: Arc<Integrated>,
}

/// The last passages of a sequence of zones.
#[derive(Debug, Default)]
pub struct Memory(Mutex<VecDeque<Known>>);

impl Memory {
    /// The passage from z through a mode of this number, at values of all parameters, and the place of the first of
    /// `varying` among the parameters of its derivatives.
    pub fn passage(
        &self,
        (number, mode): (usize, &AffineMode),
        (values, varying): (&[f64], &[usize]),
        entry: &Vector,
        time: f64,
    ) -> (Arc<Integrated>, usize) {
        let find = |known: &VecDeque<Known>| {
            known.iter().find_map(|known| {
                let same = known.mode == number
                    && known.time.to_bits() == time.to_bits()
                    && known.entry == *entry
                    && known.values == values
                    && known.varying.len() == varying.len();
                let place = || known.varying.iter().position(|one| *one == varying[0]);
                let passage = known.passage.clone();
                same.then(place).flatten().map(|place| (passage, place))
            })
        };
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = find(&lock()) {
            return known;
        }
        let passage = Arc::new(Integrated::new(mode, entry, time));
        let mut known = lock();
        known.truncate(MOST - 1);
        let mut stages = passage.stages.len();
        let kept = known.iter().take_while(|known| {
            stages += known.passage.stages.len();
            stages <= MOST_STAGES
        });
        let kept = kept.count();
        known.truncate(kept);
        known.push_front(Known {
            mode: number,
            values: values.to_vec(),
            varying: varying.to_vec(),
            entry: entry.clone(),
            time,
            passage: passage.clone(),
        });
        (passage, 0)
    }
}
