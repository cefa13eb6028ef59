//! An axis: its range, its ticks and its caption.

use super::canvas::text_width;
use super::number;
use super::quantity::Quantity;

/// Size of the figures at the ticks.
pub const TICK_SIZE: f64 = 16.0;

/// Values beyond this are taken for overflow and not drawn.
const HUGE: f64 = 1e150;

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where.
    pub value: f64,
    /// Its figures.
    pub text: String,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Marks between the ends.
    pub ticks: Vec<Tick>,
    /// Text along the axis.
    pub caption: String,
}

impl Axis {
    /// An axis with some room on either side of the values, with about `count` ticks.
    pub fn around(
        values: impl IntoIterator<Item = f64>,
        quantity: &Quantity,
        count: usize,
    ) -> Self {
        match range(values) {
            Some((low, high)) => {
                let room = 0.05 * (high - low);
                Axis::over(low - room, high + room, quantity, count)
            }
            None => Axis::blank(quantity),
        }
    }

    /// An axis without figures, for a frame without data.
    pub fn blank(quantity: &Quantity) -> Self {
        Axis {
            low: 0.0,
            high: 1.0,
            ticks: Vec::new(),
            caption: quantity.caption(),
        }
    }

    /// An axis between two ends.
    pub fn over(low: f64, high: f64, quantity: &Quantity, count: usize) -> Self {
        let step = step(low, high, count);
        let notation = Notation::of(low, high, step);
        let first = (low / step - 1e-9).ceil();
        let last = (high / step + 1e-9).floor();
        let ticks = (0..=(last - first).clamp(0.0, 50.0) as usize)
            .map(|index| (first + index as f64) * step)
            .filter(|value| *value <= high + 1e-9 * step)
            .map(|value| Tick {
                value,
                text: notation.figures(value),
            })
            .collect();
        Axis {
            low,
            high,
            ticks,
            caption: notation.caption(quantity),
        }
    }

    /// An axis along the bottom of a frame: as many ticks as fit beside each other.
    pub fn fitted(low: f64, high: f64, quantity: &Quantity, length: f64) -> Self {
        let mut axis = Axis::over(low, high, quantity, 3);
        for count in [4, 5, 6, 7] {
            let candidate = Axis::over(low, high, quantity, count);
            let needed: f64 = candidate
                .ticks
                .iter()
                .map(|tick| text_width(&tick.text, TICK_SIZE) + 1.1 * TICK_SIZE)
                .sum();
            if needed > length {
                break;
            }
            axis = candidate;
        }
        axis
    }

    /// Where a value lies between the ends, from 0 to 1.
    pub fn part(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Width of the widest figures.
    pub fn figures_width(&self) -> f64 {
        self.ticks
            .iter()
            .map(|tick| text_width(&tick.text, TICK_SIZE))
            .fold(0.0, f64::max)
    }
}

/// Whether a value can be drawn.
pub fn drawable(value: f64) -> bool {
    value.is_finite() && value.abs() < HUGE
}

/// Smallest and largest drawable value; widened where they are the same up to rounding.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.into_iter().filter(|value| drawable(*value)).fold(
        None,
        |ends, value| match ends {
            None => Some((value, value)),
            Some((low, high)) => Some((f64::min(low, value), f64::max(high, value))),
        },
    )?;
    let magnitude = low.abs().max(high.abs());
    if magnitude < 1e-250 {
        return Some((-1.0, 1.0));
    }
    if high - low > 1e-10 * magnitude {
        Some((low, high))
    } else {
        Some((low - 0.05 * magnitude, high + 0.05 * magnitude))
    }
}

/// Distance of the ticks: 1, 2 or 5 times a power of ten.
fn step(low: f64, high: f64, count: usize) -> f64 {
    let rough = (high - low) / count.max(1) as f64;
    let power = 10f64.powi(number::decade(rough));
    let factor = rough / power;
    let rounded = if factor < 1.45 {
        1.0
    } else if factor < 3.2 {
        2.0
    } else if factor < 7.1 {
        5.0
    } else {
        10.0
    };
    rounded * power
}

/// How an axis writes its figures: `(value − base) · 10^−exponent` with some decimals.
struct Notation {
    base: f64,
    base_decimals: usize,
    exponent: i32,
    decimals: usize,
}

impl Notation {
    fn of(low: f64, high: f64, step: f64) -> Self {
        let magnitude = low.abs().max(high.abs());
        let top = number::decade(magnitude);
        let fine = number::decade(step);
        if top - fine > 4 {
            // Too many figures in common: they are subtracted, and the caption says so.
            let coarse = fine + 2;
            let unit = 10f64.powi(coarse);
            return Notation {
                base: (0.5 * (low + high) / unit).round() * unit,
                base_decimals: (-coarse).max(0) as usize,
                exponent: fine,
                decimals: 0,
            };
        }
        let exponent = if (-2..=4).contains(&top) { 0 } else { top };
        Notation {
            base: 0.0,
            base_decimals: 0,
            exponent,
            decimals: (exponent - fine).max(0) as usize,
        }
    }

    fn figures(&self, value: f64) -> String {
        let scaled = (value - self.base) / 10f64.powi(self.exponent);
        number::fixed(scaled, self.decimals)
    }

    fn caption(&self, quantity: &Quantity) -> String {
        let factor = if self.exponent == 0 {
            String::new()
        } else {
            format!(" × 10{}", number::superscript(-self.exponent))
        };
        if self.base == 0.0 {
            return format!("{}{factor}", quantity.caption());
        }
        let sign = if self.base < 0.0 { "+" } else { "−" };
        let base = number::trimmed(&number::fixed(self.base.abs(), self.base_decimals));
        let difference = format!("({} {sign} {base}){factor}", quantity.short());
        if quantity.symbol.is_empty() {
            difference
        } else {
            quantity.around(&difference)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|tick| tick.text.as_str()).collect()
    }

    #[test]
    fn figures_are_rounded() {
        let axis = Axis::over(0.0, 0.42, &Quantity::of_column("friction"), 5);
        assert_eq!(texts(&axis), ["0", "0.1", "0.2", "0.3", "0.4"]);
    }

    #[test]
    fn common_figures_move_to_the_caption() {
        let axis = Axis::over(-1.0440, -1.0439, &Quantity::of_column("speed"), 5);
        assert_eq!(texts(&axis), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(axis.caption, "speed (c + 1.044) × 10⁵");
    }

    #[test]
    fn small_values_are_scaled() {
        let axis = Axis::over(0.0, 3e-12, &Quantity::of_column("residual"), 3);
        assert_eq!(texts(&axis), ["0", "1", "2", "3"]);
        assert_eq!(axis.caption, "residual × 10¹²");
    }

    #[test]
    fn constant_values_get_room() {
        for value in [0.0, 3.0, -1e-200, 1e149] {
            let (low, high) = range([value, value]).unwrap();
            assert!(low < value && value < high);
        }
        assert_eq!(range([f64::NAN, f64::INFINITY]), None);
    }
}
