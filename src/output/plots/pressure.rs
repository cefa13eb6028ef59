//! Contact pressure over the wavelength.

use super::Settings;
use super::axis::{self, Axis};
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{GREY, Pen};
use super::profile::{NONE, Profiles, Shown, angle};
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark, usual_length};

/// Composes the picture.
pub fn compose(profiles: &Profiles, settings: &Settings) -> Result<String, PlotError> {
    let shown = profiles.shown();
    let pressure = Quantity::new("pressure", "P");
    let values = shown
        .iter()
        .flat_map(|one| one.profile.pressure.iter().copied());
    let y = if shown.is_empty() {
        Axis::blank(&pressure)
    } else {
        // Zero is where contact is lost and belongs into the picture.
        Axis::around(values.chain([0.0]), &pressure, 5)
    };
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(along(&shown), y)],
        legend: values_legend(&shown, settings),
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            if shown.is_empty() {
                remark(canvas, frame, NONE);
                continue;
            }
            let ends = [(frame.x.low, 0.0), (frame.x.high, 0.0)];
            frame.curve(canvas, ends, Pen::solid(GREY, 1.2));
            for one in &shown {
                let points = one.profile.theta.iter().zip(&one.profile.pressure);
                let pen = Pen::solid(one.colour, 1.9);
                frame.curve(canvas, points.map(|(x, y)| (*x, *y)), pen);
            }
        }
    })
}

/// The axis along the wave.
pub fn along(shown: &[Shown<'_>]) -> Axis {
    let values = shown
        .iter()
        .flat_map(|one| one.profile.theta.iter().copied());
    match axis::range(values) {
        Some((low, high)) => Axis::fitted(low, high, &angle(), usual_length()),
        None => Axis::blank(&angle()),
    }
}

/// Explains which colour belongs to which value of the parameter.
pub fn values_legend(shown: &[Shown<'_>], settings: &Settings) -> Legend {
    let mut legend = Legend::default();
    let quantity = Quantity::of_column(&settings.parameter);
    if !shown.is_empty() {
        legend.add(
            &format!("{} =", quantity.short()),
            shown
                .iter()
                .map(|one| (Key::Line(Pen::solid(one.colour, 2.4)), one.text.clone())),
        );
    }
    legend
}
