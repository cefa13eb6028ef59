//! The modes of a system: all of them laid out, or made when they are first asked for.

use std::fmt;
use std::ops::Index;
use std::sync::{Arc, OnceLock};

use elsa::sync::FrozenMap;

use super::mode::AffineMode;

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

/// Makes a mode of its number.
type Make = Box<dyn Fn(usize) -> AffineMode + Send + Sync>;

/// The modes of a system at given parameters.
#[derive(Clone)]
pub struct Modes(Kind);

#[derive(Clone)]
enum Kind {
    Written(Vec<AffineMode>),
    Made(Arc<Made>),
}

struct Made {
    count: usize,
    make: Make,
    slots: Slots<AffineMode>,
}

impl Modes {
    /// All of them.
    pub(super) fn of(modes: Vec<AffineMode>) -> Modes {
        Modes(Kind::Written(modes))
    }

    /// So many, which are made when they are asked for.
    pub(super) fn made(count: usize, make: Make) -> Modes {
        let slots = Slots::new(count);
        Modes(Kind::Made(Arc::new(Made { count, make, slots })))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.0 {
            Kind::Written(modes) => modes.len(),
            Kind::Made(made) => made.count,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The mode of a number, if there is one.
    pub fn get(&self, index: usize) -> Option<&AffineMode> {
        (index < self.len()).then(|| &self[index])
    }

    /// Whether the flow of every mode is exact: modes that are made when they are asked for are all alike.
    pub fn are_exact(&self) -> bool {
        match &self.0 {
            Kind::Written(modes) => modes.iter().all(|mode| mode.field.is_exact),
            Kind::Made(_) => self[0].field.is_exact,
        }
    }

    /// Those that are laid out from the beginning.
    pub fn written(&self) -> &[AffineMode] {
        match &self.0 {
            Kind::Written(modes) => modes,
            Kind::Made(_) => &[],
        }
    }

    /// See [`Modes::written`]; none can be added to others.
    pub(super) fn written_mut(&mut self) -> &mut Vec<AffineMode> {
        if let Kind::Made(_) = self.0 {
            self.0 = Kind::Written(Vec::new());
        }
        match &mut self.0 {
            Kind::Written(modes) => modes,
            Kind::Made(_) => unreachable!("it has been replaced"),
        }
    }
}

impl Index<usize> for Modes {
    type Output = AffineMode;

    fn index(&self, index: usize) -> &AffineMode {
        match &self.0 {
            Kind::Written(modes) => &modes[index],
            Kind::Made(made) => made.slots.get_or_make(index, || (made.make)(index)),
        }
    }
}

impl PartialEq for Modes {
    fn eq(&self, other: &Modes) -> bool {
        match (&self.0, &other.0) {
            (Kind::Written(one), Kind::Written(other)) => one == other,
            (Kind::Made(one), Kind::Made(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

impl fmt::Debug for Modes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Kind::Written(modes) => modes.fmt(formatter),
            Kind::Made(made) => write!(
                formatter,
                "{} modes, made when they are asked for",
                made.count
            ),
        }
    }
}
