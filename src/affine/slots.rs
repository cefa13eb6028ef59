//! Things with numbers that are made when they are first asked for.

use std::fmt;
use std::sync::OnceLock;

use elsa::sync::FrozenMap;

/// Most things that have a place of their own from the beginning.
const FEW: usize = 128;

/// Things with numbers, each made once, when it is first asked for.
pub struct Slots<T>(Kept<T>);

enum Kept<T> {
    Few(Vec<OnceLock<T>>),
    Many(FrozenMap<usize, Box<T>>),
}

impl<T> Slots<T> {
    /// For so many, none of which is made.
    pub fn new(count: usize) -> Slots<T> {
        Slots(match count <= FEW {
            true => Kept::Few((0..count).map(|_| OnceLock::new()).collect()),
            false => Kept::Many(FrozenMap::new()),
        })
    }

    /// The thing of a number.
    pub fn get_or_make(&self, index: usize, make: impl FnOnce() -> T) -> &T {
        match &self.0 {
            Kept::Few(slots) => slots[index].get_or_init(make),
            // made outside of the lock: two that are the same may be made, of which one is kept
            Kept::Many(known) => match known.get(&index) {
                Some(known) => known,
                None => known.insert(index, Box::new(make())),
            },
        }
    }
}

impl<T> Slots<T> {
    /// Keeps what has been made where that is to be; the rest will be made again.
    pub fn retain(&mut self, mut keep: impl FnMut(usize, &mut T) -> bool) {
        match &mut self.0 {
            Kept::Few(slots) => {
                for (index, slot) in slots.iter_mut().enumerate() {
                    if slot.get_mut().is_some_and(|thing| !keep(index, thing)) {
                        slot.take();
                    }
                }
            }
            Kept::Many(known) => known.as_mut().retain(|index, thing| keep(*index, thing)),
        }
    }
}

impl<T> Clone for Slots<T> {
    /// The same number of slots, all empty: what is in them is made again.
    fn clone(&self) -> Slots<T> {
        Slots(match &self.0 {
            Kept::Few(slots) => Kept::Few((0..slots.len()).map(|_| OnceLock::new()).collect()),
            Kept::Many(_) => Kept::Many(FrozenMap::new()),
        })
    }
}

impl<T> fmt::Debug for Slots<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Slots(..)")
    }
}
