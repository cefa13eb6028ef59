//! Names in a panel: where there is room for them.

use super::frame::PanelFrame;
use super::picture::{Layer, PanelName};
use super::surface::Place;
use super::text::width;

pub(super) const NAME_SIZE: f64 = 14.0;

/// Least distance of a name from a line, and from the frame.
const CLEAR: f64 = 4.0;
const EDGE: f64 = 8.0;

/// The room of a text.
struct Room {
    centre: Place,
    half: Place,
}

impl Room {
    /// Whether a rectangle of these half sides around a place reaches into the room.
    fn meets(&self, place: Place, half: Place) -> bool {
        (place.0 - self.centre.0).abs() < self.half.0 + half.0
            && (place.1 - self.centre.1).abs() < self.half.1 + half.1
    }

    /// Whether the room lies within the frame, clear of its border.
    fn inside(&self, frame: &PanelFrame) -> bool {
        let (centre, half) = (self.centre, self.half);
        centre.0 - half.0 - EDGE >= frame.from.0
            && centre.0 + half.0 + EDGE <= frame.to.0
            && centre.1 - half.1 - EDGE >= frame.from.1
            && centre.1 + half.1 + EDGE <= frame.to.1
    }
}

/// The names that are written, each with its middle at its place: of each group the first that lies
/// within the frame and covers neither a line nor another name.
pub(super) fn written<'a>(
    frame: &PanelFrame,
    layers: &[Layer],
    names: &'a [PanelName],
) -> Vec<(Place, &'a str)> {
    let places = |layer: &Layer| -> Vec<Place> {
        let Layer::Line(points, _) = layer else {
            return Vec::new();
        };
        let drawn = points.iter().filter_map(|point| frame.place(*point));
        drawn.collect()
    };
    let lines: Vec<Vec<Place>> = layers.iter().map(places).collect();
    let middle = |pair: &[Place]| (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
    let mut taken: Vec<(usize, Room)> = Vec::new();
    let mut written = Vec::new();
    for name in names {
        let Some(centre) = frame.place(name.at) else {
            continue;
        };
        let half = (0.5 * width(&name.text, NAME_SIZE), 0.6 * NAME_SIZE);
        let room = Room { centre, half };
        let crossed = lines.iter().any(|line| {
            let middles = line.windows(2).map(middle);
            line.iter()
                .copied()
                .chain(middles)
                .any(|place| room.meets(place, (CLEAR, CLEAR)))
        });
        let refused = taken
            .iter()
            .any(|(group, other)| *group == name.group || room.meets(other.centre, other.half));
        if room.inside(frame) && !crossed && !refused {
            written.push((centre, name.text.as_str()));
            taken.push((name.group, room));
        }
    }
    written
}

#[cfg(test)]
mod tests {
    use super::super::axis::{Axis, Extent, Scale, Ticks};
    use super::super::palette::{BLUE, Pen};
    use super::*;

    /// A name stands with its middle at the place that it was computed for, or nowhere.
    #[test]
    fn names_stand_at_their_places() {
        let scale = |low, high| {
            let axis = Axis::new(("parameter", "p"), Extent::Fixed(low, high));
            Scale::of(&axis, std::iter::empty(), Ticks::About(5))
        };
        let frame = PanelFrame {
            from: (60.0, 40.0),
            to: (460.0, 340.0),
            x: scale(2.0, 4.0),
            y: scale(0.0, 0.3),
            figures: 20.0,
            labelled_below: true,
        };
        let line = (0..=300)
            .map(|step| (3.0, 0.001 * f64::from(step)))
            .collect();
        let layers = [Layer::Line(line, Pen::solid(BLUE, 2.0))];
        let name = |group, at, text: &str| PanelName {
            group,
            at,
            text: text.to_owned(),
        };
        let names = [
            // across the curve, then clear of it
            name(0, (3.05, 0.1), "sl-st"),
            name(0, (3.5, 0.1), "sl-st"),
            name(0, (3.6, 0.2), "sl-st"),
            name(1, (2.5, 0.15), "3 waves sl-st"),
            // over the edge of the frame
            name(3, (2.02, 0.05), "the pair grows"),
            // over another name
            name(4, (2.52, 0.151), "stable"),
        ];
        let written = written(&frame, &layers, &names);
        assert_eq!(written.len(), 2);
        let wanted = [((360.0, 240.0), "sl-st"), ((160.0, 190.0), "3 waves sl-st")];
        for ((found, text), (place, name)) in written.into_iter().zip(wanted) {
            assert_eq!(text, name);
            assert!((found.0 - place.0).abs() < 1e-9 && (found.1 - place.1).abs() < 1e-9);
        }
    }
}
