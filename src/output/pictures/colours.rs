//! The colours of regimes and of their sequences, in every picture, on the page of a report, in the reader
//! for Python and in `docs/wave.svg`.
//!
//! A regime has one hue: full for lines, pale for zones behind curves. Colours of sequences are never pale, so
//! that a picture may use paleness for something else.

use plotters::style::RGBColor;

use crate::output::render::{
    BLACK, BLUE, CATEGORIES, GREEN, ORANGE, PURPLE, SKY, VERMILLION, WHITE, hexadecimal, mix,
};
use crate::tube::model::signature::Regime;

/// Colours of sequences beyond the commonest ones: indigo, wine, olive, forest, rose, brown, slate.
pub(super) const RARE: [RGBColor; 7] = [
    RGBColor(51, 34, 136),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(17, 119, 51),
    RGBColor(204, 102, 119),
    RGBColor(140, 86, 75),
    RGBColor(70, 90, 110),
];

/// Colour of a regime's lines; of an unknown one purple.
pub(super) fn of_regime(regime: Option<Regime>) -> RGBColor {
    match regime {
        Some(Regime::Slip) => BLUE,
        Some(Regime::Stick) => BLACK,
        Some(Regime::Separation) => GREEN,
        Some(Regime::Reverse) => VERMILLION,
        Some(Regime::Contact) | None => PURPLE,
    }
}

/// Pale colour of a regime's zone, behind curves; the luminances 0.88, 0.78, 0.59 and 0.45 of the first four
/// tell them apart in grey too.
pub(super) fn of_zone(regime: Option<Regime>) -> RGBColor {
    match regime {
        Some(Regime::Slip) => mix(WHITE, SKY, 0.15),
        Some(Regime::Separation) => mix(WHITE, GREEN, 0.20),
        Some(Regime::Reverse) => mix(WHITE, VERMILLION, 0.38),
        Some(Regime::Stick) => mix(WHITE, BLACK, 0.30),
        Some(Regime::Contact) | None => mix(WHITE, PURPLE, 0.3),
    }
}

/// Background of the page of a report in its dark theme.
const DARK: RGBColor = RGBColor(22, 24, 27);

/// A zone on the page of a report.
pub(crate) struct ZoneColours {
    /// Of its area in the light theme, and in the dark one.
    areas: [RGBColor; 2],
    /// The same of its line.
    lines: [RGBColor; 2],
}

/// The colours of a zone of a wave.
pub(crate) fn of_wave_zone(regime: Option<Regime>) -> ZoneColours {
    let line = of_regime(regime);
    let dark = match regime {
        Some(Regime::Stick) => mix(DARK, WHITE, 0.35),
        _ => mix(DARK, line, 0.4),
    };
    ZoneColours {
        areas: [of_zone(regime), dark],
        lines: [line, mix(line, WHITE, 0.4)],
    }
}

/// The colours of a mode of a user's own by its place.
pub(crate) fn of_mode_zone(place: usize) -> ZoneColours {
    let line = distinct(place);
    ZoneColours {
        areas: [mix(WHITE, line, 0.22), mix(DARK, line, 0.45)],
        lines: [line, mix(line, WHITE, 0.4)],
    }
}

/// The colours of zones as style sheets of a page, by their places: the light theme, the dark one.
pub(crate) fn style_sheets(zones: &[ZoneColours]) -> [String; 2] {
    [0, 1].map(|theme| {
        let rule = |(place, zone): (usize, &ZoneColours)| {
            let [area, line] = [zone.areas, zone.lines].map(|colours| hexadecimal(colours[theme]));
            format!(".zone-{place} {{ fill: {area}; }}\n.line-{place} {{ stroke: {line}; }}\n")
        };
        zones.iter().enumerate().map(rule).collect()
    })
}

/// Colours of what has no colour of its own, modes and sequences of a user's system, in the order of use.
pub(crate) fn distinct(place: usize) -> RGBColor {
    let colours = CATEGORIES.iter().chain(&RARE);
    colours
        .copied()
        .cycle()
        .nth(place % (CATEGORIES.len() + RARE.len()))
        .unwrap_or(BLACK)
}

/// Colour of a sequence of regimes, the same in every picture of every run. Beyond the commonest ones it follows
/// from the sequence, and two may share one.
pub(super) fn of_sequence(regimes: &[Option<Regime>]) -> RGBColor {
    use Regime::{Reverse, Separation, Slip, Stick};
    let known: Option<Vec<Regime>> = regimes.iter().copied().collect();
    match known.as_deref() {
        Some([Slip, Stick]) => BLUE,
        Some([Slip, Reverse, Stick]) => VERMILLION,
        Some([Slip, Separation, Slip, Reverse, Stick]) => GREEN,
        Some([Slip, Separation, Reverse, Stick]) => PURPLE,
        Some([Slip, Separation, Slip, Stick]) => ORANGE,
        Some([Slip, Separation, Stick]) => SKY,
        Some([Slip, Separation, Reverse]) => BLACK,
        Some([Slip, Separation]) => RARE[1],
        _ => {
            let digit = |one: &Option<Regime>| one.map_or(0, |regime| regime as usize + 1);
            let digits = regimes.iter().map(digit);
            let sum = digits.fold(0_usize, |sum, digit| {
                sum.wrapping_mul(31).wrapping_add(digit)
            });
            RARE[sum % RARE.len()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The drawing of the tube has the colours of the pictures.
    #[test]
    fn regimes_have_one_colour_everywhere() {
        let drawing = include_str!("../../../docs/wave.svg");
        use Regime::{Reverse, Separation, Slip, Stick};
        let pale = [Separation, Slip, Stick, Reverse].map(|one| hexadecimal(of_zone(Some(one))));
        for (regime, zone) in [Separation, Slip, Stick, Reverse].into_iter().zip(&pale) {
            assert!(
                drawing.contains(&format!("height=\"340\" fill=\"{zone}\"")),
                "{regime:?}"
            );
            let ring = format!(
                "stroke=\"{}\" stroke-width=\"9\"",
                hexadecimal(of_regime(Some(regime)))
            );
            assert!(
                regime == Separation || drawing.contains(&ring),
                "{regime:?}"
            );
        }
    }

    /// No colour of a sequence is pale: paleness means something else where maps show stability.
    #[test]
    fn sequences_are_not_pale() {
        for colour in RARE {
            let RGBColor(red, green, blue) = colour;
            let light = 0.3 * f64::from(red) + 0.59 * f64::from(green) + 0.11 * f64::from(blue);
            assert!(light < 160.0, "{colour:?}");
        }
    }
}
