//! The mesh of an annulus with its displacements as a legacy VTK file, which ParaView opens.

use std::fmt::Write;

use crate::simulation::annulus::Annulus;

/// A structured grid: nodes from the inner circle outwards, with displacement and velocity as
/// vectors, their radial and tangential parts, and pressure and shear on the inner circle.
pub(crate) fn annulus(annulus: &Annulus, title: &str) -> String {
    let setup = annulus.setup();
    let (around, across) = (setup.around, setup.across);
    // a whole circle repeats its first points, so that the last elements are drawn too
    let columns = if annulus.closed() { around + 1 } else { around };
    let points = columns * (across + 1);
    let state = annulus.state();
    let mut text = String::with_capacity(points * 200);
    let line: String = title
        .chars()
        .filter(|c| !c.is_control())
        .take(200)
        .collect();
    let _ = writeln!(
        text,
        "# vtk DataFile Version 3.0\n{line}\nASCII\nDATASET STRUCTURED_GRID\n\
         DIMENSIONS {columns} {} 1\nPOINTS {points} double",
        across + 1
    );
    let nodes = || (0..=across).flat_map(|circle| (0..columns).map(move |point| (circle, point)));
    for (circle, point) in nodes() {
        let [x, y] = annulus.place(circle, point);
        let _ = writeln!(text, "{x:.9e} {y:.9e} 0");
    }
    let _ = writeln!(text, "POINT_DATA {points}");
    // fields of the contact line and of all but the outer circle, which is at rest
    let value = |field: &[f64], circle: usize, point: usize| {
        let known = field.get(circle * around + point % around);
        known.copied().unwrap_or(0.0)
    };
    let vectors = [
        ("displacement", &state.radial, &state.tangential),
        ("velocity", &state.radial_rate, &state.tangential_rate),
    ];
    for (name, radial, tangential) in vectors {
        let _ = writeln!(text, "VECTORS {name} double");
        for (circle, point) in nodes() {
            let (sine, cosine) = (annulus.width() * point as f64).sin_cos();
            let [u, v] = [radial, tangential].map(|field| value(field, circle, point));
            let (x, y) = (u * cosine - v * sine, u * sine + v * cosine);
            let _ = writeln!(text, "{x:.9e} {y:.9e} 0");
        }
    }
    let scalars = [
        ("radial_displacement", &state.radial),
        ("tangential_displacement", &state.tangential),
        ("tangential_velocity", &state.tangential_rate),
        ("pressure", &state.pressure),
        ("shear", &state.shear),
    ];
    for (name, field) in scalars {
        let _ = writeln!(text, "SCALARS {name} double 1\nLOOKUP_TABLE default");
        for (circle, point) in nodes() {
            let _ = writeln!(text, "{:.9e}", value(field, circle, point));
        }
    }
    text
}

/// V̇ of the first points of a grid, which are those of the contact line.
pub(crate) fn velocity(bytes: &[u8], around: usize) -> Vec<f64> {
    let text = String::from_utf8_lossy(bytes);
    let field = text.split("SCALARS tangential_velocity").nth(1);
    let values = field.unwrap_or_default().lines().skip(2).take(around);
    values.map_while(|value| value.parse().ok()).collect()
}
