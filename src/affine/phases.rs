//! Guards at every phase of the forcing, in interval arithmetic: where what rests lies by them.

use std::f64::consts::TAU;

use super::mode::AffineSystem;
use super::steady::Admissibility;
use crate::interval::Interval;
use crate::linalg::Vector;

/// Parts of the period over which guards are bounded.
const PARTS: usize = 4000;

impl AffineSystem {
    /// Whether a form depends on the phase.
    pub(super) fn turns(&self, row: &Vector) -> bool {
        let base = self.size() - self.program.made();
        let phases: Vec<usize> = (self.states + 1..base).collect();
        let mut components = (0..row.len()).filter(|c| row[*c] != 0.0);
        components.any(|c| self.program.depends(c, &phases))
    }

    /// Where states in these intervals lie by the guards of a mode.
    pub(super) fn place(&self, mode: usize, states: &[Interval]) -> Admissibility {
        let mut place = (f64::INFINITY, Admissibility::Admissible);
        for (guard, own) in self.modes[mode].guards.iter().enumerate() {
            let least = self.least(mode, &own.row.at, states);
            let here = match least {
                LeastOverPhases { low, .. } if low > 0.0 => continue,
                LeastOverPhases { high, .. } if high < 0.0 => Admissibility::Virtual {
                    guard,
                    at_times: !least.is_negative,
                },
                _ => Admissibility::Boundary { guard },
            };
            // what is negative for certain comes first
            let key = if matches!(here, Admissibility::Virtual { .. }) {
                least.high
            } else {
                0.0
            };
            if key < place.0 {
                place = (key, here);
            }
        }
        place.1
    }

    /// Bounds of the least value of a form over all phases, where the states lie in these intervals; no finer than its
    /// sign takes.
    fn least(&self, mode: usize, row: &Vector, states: &[Interval]) -> LeastOverPhases {
        let (n, base) = (self.states, self.size() - self.program.made());
        let at = |phase: Interval| {
            let z = self.enclosed(mode, states, phase);
            let terms = row.iter().zip(&z).filter(|(c, _)| **c != 0.0);
            let sum = terms.fold(Interval::ZERO, |sum, (c, z)| sum + Interval::point(*c) * *z);
            let sum = if sum.is_empty() {
                Interval::ENTIRE
            } else {
                sum
            };
            (sum, z)
        };
        // of harmonics alone the slope is known: about the middle of a part the form is off by the square of the part
        let has_slope = (base..row.len()).all(|c| row[c] == 0.0);
        let over = |phase: Interval| {
            let (sum, z) = at(phase);
            if !has_slope {
                return sum;
            }
            let slope = (1..=(base - n - 1) / 2).fold(Interval::ZERO, |slope, harmonic| {
                let (cosine, sine) = (n + 2 * harmonic - 1, n + 2 * harmonic);
                let turned =
                    Interval::point(row[sine]) * z[cosine] - Interval::point(row[cosine]) * z[sine];
                slope + Interval::point(harmonic as f64) * turned
            });
            let middle = Interval::point(phase.middle());
            sum.intersection(at(middle).0 + slope * (phase - middle))
        };
        if !self.turns(row) {
            let Interval { low, high } = at(Interval::ZERO).0;
            return LeastOverPhases {
                low,
                high,
                is_negative: true,
            };
        }
        // parts of the period with the form over each; the one that may have the least value is halved
        let mut parts = vec![(Interval::new(0.0, TAU.next_up()), Interval::ENTIRE)];
        let mut least = f64::INFINITY;
        let mut largest = f64::NEG_INFINITY;
        loop {
            let lowest = (0..parts.len())
                .min_by(|one, other| parts[*one].1.low.total_cmp(&parts[*other].1.low));
            let Some(lowest) = lowest else { break };
            let low = parts[lowest].1.low;
            if low > 0.0 || least < 0.0 || parts.len() >= PARTS {
                break;
            }
            let (part, _) = parts.swap_remove(lowest);
            let middle = part.middle();
            for part in [
                Interval::new(part.low, middle),
                Interval::new(middle, part.high),
            ] {
                parts.push((part, over(part)));
            }
            let inside = at(Interval::point(middle)).0;
            (least, largest) = (least.min(inside.high), largest.max(inside.low));
        }
        // whether it is positive at times is seen at phases alone
        let phases = (0..64).map(|part| at(Interval::point(TAU * f64::from(part) / 64.0)).0.low);
        LeastOverPhases {
            low: parts
                .iter()
                .fold(f64::INFINITY, |low, (_, values)| low.min(values.low)),
            high: least,
            is_negative: phases.fold(largest, f64::max) <= 0.0,
        }
    }

    /// z where states and phase lie in intervals.
    fn enclosed(&self, mode: usize, states: &[Interval], phase: Interval) -> Vec<Interval> {
        let n = self.states;
        let base = self.size() - self.program.made();
        let mut z = states.to_vec();
        z.resize(n + 1, Interval::ONE);
        for harmonic in 1..=(base - n - 1) / 2 {
            let angle = Interval::point(harmonic as f64) * phase;
            z.extend([angle.cos(), angle.sin()]);
        }
        self.modes[mode].field.enclose(&mut z);
        z
    }
}

/// Bounds of the least value of a form over all phases.
struct LeastOverPhases {
    low: f64,
    high: f64,
    /// Whether it is nowhere seen to be positive.
    is_negative: bool,
}
