//! Axes: what they show, their ranges, their ticks and captions.

use super::number;
use super::text::width;

/// Size of the figures at the ticks.
pub(crate) const TICK_SIZE: f64 = 16.0;

/// Decades below which a logarithmic axis has figures at 2 and 5 times the powers of ten, too.
const FEW_DECADES: f64 = 2.5;

/// Values beyond this are taken for overflow and not drawn.
const HUGE: f64 = 1e150;

/// A quantity by its word and its symbol; either may be empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Quantity {
    /// Word, such as `mismatch`.
    pub word: String,
    /// Symbol, such as `δ`.
    pub symbol: String,
    /// The unit of the tables, such as `R`; empty for a number.
    pub unit: &'static str,
    /// Whether the unit is written.
    pub dimensional: bool,
}

impl From<(&str, &str)> for Quantity {
    fn from((word, symbol): (&str, &str)) -> Self {
        Quantity {
            word: word.to_owned(),
            symbol: symbol.to_owned(),
            ..Quantity::default()
        }
    }
}

impl From<(&str, &str, &'static str)> for Quantity {
    fn from((word, symbol, unit): (&str, &str, &'static str)) -> Self {
        Quantity {
            unit,
            ..(word, symbol).into()
        }
    }
}

impl Quantity {
    /// Word and symbol, and the unit where it is written.
    pub(crate) fn caption(&self) -> String {
        self.measured(self.around(&self.symbol))
    }

    /// A caption with the unit after it, where that is written.
    fn measured(&self, caption: String) -> String {
        match (self.dimensional, self.unit) {
            (false, _) | (true, "") => caption,
            (true, unit) => format!("{caption} ({unit})"),
        }
    }

    /// The symbol, or the word where there is none.
    pub(crate) fn short(&self) -> &str {
        if self.symbol.is_empty() {
            &self.word
        } else {
            &self.symbol
        }
    }

    /// The word followed by an expression instead of the symbol.
    fn around(&self, expression: &str) -> String {
        format!("{} {expression}", self.word).trim().to_owned()
    }
}

/// How far an axis reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Extent {
    /// Over the data, with this part of their range more on either side.
    Data(f64),
    /// From one value to another.
    Fixed(f64, f64),
    /// Over whole decades around the data, logarithmically.
    Decades,
    /// Over the data, logarithmically, with this part of their range more on either side.
    Logarithmic(f64),
}

/// An axis as it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    pub quantity: Quantity,
    pub extent: Extent,
    /// Its ticks; where there are none they are chosen.
    pub ticks: Vec<Tick>,
}

impl Axis {
    /// An axis of this extent with ticks of the renderer's choice.
    pub(crate) fn new(quantity: impl Into<Quantity>, extent: Extent) -> Self {
        Axis {
            quantity: quantity.into(),
            extent,
            ticks: Vec::new(),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    pub text: String,
}

/// An axis as it is drawn; one over nothing has no ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Lower end, of the logarithm for decades.
    pub low: f64,
    pub high: f64,
    pub logarithmic: bool,
    pub ticks: Vec<Tick>,
    pub caption: String,
}

/// How many ticks an axis has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ticks {
    About(usize),
    /// As many as fit beside each other on this length.
    Within(f64),
}

impl Scale {
    /// The axis over these values.
    pub(crate) fn of(axis: &Axis, values: impl Iterator<Item = f64>, ticks: Ticks) -> Scale {
        let quantity = &axis.quantity;
        let logarithmic = matches!(axis.extent, Extent::Decades | Extent::Logarithmic(_));
        let roomy = |(low, high): (f64, f64), room: f64| {
            let room = room * (high - low);
            (low - room, high + room)
        };
        let exponents = |values: &mut dyn Iterator<Item = f64>| {
            range(values.filter(|value| *value > 0.0).map(f64::log10))
        };
        let mut values = values;
        let ends = match axis.extent {
            Extent::Fixed(low, high) => Some((low, high)).filter(|_| low < high),
            Extent::Data(room) => range(values).map(|ends| roomy(ends, room)),
            Extent::Decades => {
                exponents(&mut values).map(|(low, high)| ((low - 0.2).floor(), (high + 0.2).ceil()))
            }
            Extent::Logarithmic(room) => exponents(&mut values).map(|ends| roomy(ends, room)),
        };
        let chosen = |(low, high)| match ticks {
            _ if !axis.ticks.is_empty() => (axis.ticks.clone(), quantity.caption()),
            _ if logarithmic => (decades(low, high), quantity.caption()),
            Ticks::About(count) => rounded(low, high, quantity, count),
            Ticks::Within(length) => {
                let needed = |ticks: &[Tick]| -> f64 {
                    let widths = ticks.iter().map(|tick| width(&tick.text, TICK_SIZE));
                    widths.map(|width| width + 1.1 * TICK_SIZE).sum()
                };
                let attempts = (4..=7).map(|count| rounded(low, high, quantity, count));
                let fitting = attempts.take_while(|(ticks, _)| needed(ticks) <= length);
                fitting
                    .last()
                    .unwrap_or_else(|| rounded(low, high, quantity, 3))
            }
        };
        let (ticks, caption) = ends.map_or_else(|| (Vec::new(), quantity.caption()), chosen);
        let (low, high) = ends.unwrap_or((0.0, 1.0));
        Scale {
            low,
            high,
            logarithmic,
            ticks,
            caption,
        }
    }

    /// Where a value lies between the ends, from 0 to 1; what is infinite lies at an end.
    pub(crate) fn part(&self, value: f64) -> f64 {
        let value = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        (value - self.low) / (self.high - self.low)
    }

    /// Width of the widest figures.
    pub(crate) fn figures_width(&self) -> f64 {
        let widths = self.ticks.iter().map(|tick| width(&tick.text, TICK_SIZE));
        widths.fold(0.0, f64::max)
    }
}

/// Whether a value can be drawn.
pub(crate) fn drawable(value: f64) -> bool {
    value.is_finite() && value.abs() < HUGE
}

/// Smallest and largest drawable value; widened where they are the same up to rounding.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let drawn = values.into_iter().filter(|value| drawable(*value));
    let ends = drawn.map(|value| (value, value));
    let (low, high) = ends.reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))?;
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

/// About `count` ticks at round values, and the caption that goes with their figures.
fn rounded(low: f64, high: f64, quantity: &Quantity, count: usize) -> (Vec<Tick>, String) {
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
        });
    (ticks.collect(), notation.caption(quantity))
}

/// Ticks between two exponents: figures at powers of ten, eight at most, or at 1, 2 and 5 times these
/// over few decades; after these, strokes without figures at the other multiples.
fn decades(low: f64, high: f64) -> Vec<Tick> {
    let span = high - low;
    let step = (span / 7.0).ceil().max(1.0) as i32;
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let within = |value: &f64| (low - 1e-9..=high + 1e-9).contains(&value.log10());
    let named = |digit: i32, exponent: i32| match digit {
        1 => (exponent - first) % step == 0,
        2 | 5 => span < FEW_DECADES,
        _ => false,
    };
    let digits = |exponent| (1..10).map(move |digit| (digit, exponent));
    let all: Vec<(bool, i32, f64)> = (first..=last)
        .flat_map(digits)
        .map(|(digit, exponent)| {
            let value = f64::from(digit) * 10f64.powi(exponent);
            (named(digit, exponent), exponent, value)
        })
        .filter(|(.., value)| within(value))
        .collect();
    let figures = |exponent, value| match span < FEW_DECADES {
        true => number::significant(value, 1),
        false => number::power_of_ten(exponent),
    };
    let with = all.iter().filter(|tick| tick.0).map(|tick| Tick {
        value: tick.2,
        text: figures(tick.1, tick.2),
    });
    let without = all.iter().filter(|tick| !tick.0 && step == 1);
    let without = without.map(|tick| Tick {
        value: tick.2,
        text: String::new(),
    });
    with.chain(without).collect()
}

/// Distance of the ticks: 1, 2 or 5 times a power of ten.
fn step(low: f64, high: f64, count: usize) -> f64 {
    let rough = (high - low) / count.max(1) as f64;
    let power = 10f64.powi(number::decade(rough));
    let rounded = match rough / power {
        factor if factor < 1.45 => 1.0,
        factor if factor < 3.2 => 2.0,
        factor if factor < 7.1 => 5.0,
        _ => 10.0,
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
        let factor = match self.exponent {
            0 => String::new(),
            exponent => format!(" × {}", number::power_of_ten(-exponent)),
        };
        if self.base == 0.0 {
            let caption = format!("{}{factor}", quantity.around(&quantity.symbol));
            return quantity.measured(caption);
        }
        let sign = if self.base < 0.0 { "+" } else { "−" };
        let base = number::trimmed(&number::fixed(self.base.abs(), self.base_decimals));
        let difference = format!("({} {sign} {base}){factor}", quantity.short());
        quantity.measured(if quantity.symbol.is_empty() {
            difference
        } else {
            quantity.around(&difference)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(low: f64, high: f64, word: &str, symbol: &str, count: usize) -> Scale {
        let axis = Axis::new((word, symbol), Extent::Fixed(low, high));
        Scale::of(&axis, std::iter::empty(), Ticks::About(count))
    }

    fn texts(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|tick| tick.text.as_str()).collect()
    }

    #[test]
    fn figures_are_rounded() {
        let scale = over(0.0, 0.42, "friction", "f", 5);
        assert_eq!(texts(&scale), ["0", "0.1", "0.2", "0.3", "0.4"]);
    }

    #[test]
    fn common_figures_move_to_the_caption() {
        let scale = over(-1.0440, -1.0439, "speed", "c", 5);
        assert_eq!(texts(&scale), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(scale.caption, "speed (c + 1.044) × 10⁵");
    }

    #[test]
    fn small_values_are_scaled() {
        let scale = over(0.0, 3e-12, "residual", "", 3);
        assert_eq!(texts(&scale), ["0", "1", "2", "3"]);
        assert_eq!(scale.caption, "residual × 10¹²");
    }

    #[test]
    fn decades_are_whole_and_powers_of_ten() {
        let axis = Axis::new(("error", ""), Extent::Decades);
        let values = [3e-9, 2e-4, f64::NAN, 0.0, -1.0];
        let scale = Scale::of(&axis, values.into_iter(), Ticks::About(5));
        assert_eq!((scale.low, scale.high), (-9.0, -3.0));
        assert_eq!(texts(&scale)[..2], ["10⁻⁹", "10⁻⁸"]);
        assert_eq!(scale.part(1e-6), 0.5);
        // strokes without figures at the other multiples come after those with figures
        assert_eq!(texts(&scale)[7..], [""; 48]);
    }

    #[test]
    fn few_decades_have_figures_between() {
        let axis = Axis::new(("smoothing", "ε"), Extent::Logarithmic(0.0));
        let scale = Scale::of(&axis, [0.005, 0.1].into_iter(), Ticks::About(5));
        assert_eq!(texts(&scale)[..5], ["0.005", "0.01", "0.02", "0.05", "0.1"]);
        assert!((scale.part(0.005 * 20f64.sqrt()) - 0.5).abs() < 1e-12);
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
