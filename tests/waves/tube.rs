//! The coefficients of the model a second way: quadrature instead of closed forms.

/// a, b, D, g, h of the equations of motion.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients {
    pub a: f64,
    pub b: f64,
    pub coupling: f64,
    pub g: f64,
    pub h: f64,
}

/// ∫ f over (low, high) by the five-point rule of Gauss on 64 panels.
fn integral(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PANELS: u32 = 64;
    let root = 2.0 * (10.0_f64 / 7.0).sqrt();
    let (inner, outer) = ((5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0);
    let spread = 13.0 * 70.0_f64.sqrt();
    let (near, far) = ((322.0 + spread) / 900.0, (322.0 - spread) / 900.0);
    let half = 0.5 * (high - low) / f64::from(PANELS);
    (0..PANELS)
        .map(|panel| {
            let middle = low + half * f64::from(2 * panel + 1);
            let pair = |place: f64| f(middle - half * place) + f(middle + half * place);
            half * (128.0 / 225.0 * f(middle) + near * pair(inner) + far * pair(outer))
        })
        .sum()
}

/// Virtual work of the displacement X(r) = (ξ²/r − r)/(ξ² − 1) in both directions.
pub fn coefficients(nu: f64, xi: f64, gamma: f64) -> Coefficients {
    let width = (xi - 1.0) * (xi + 1.0);
    let field = |r: f64| (xi - r) * (xi + r) / (r * width);
    let mass = integral(1.0, xi, |r| field(r).powi(2) * r);
    let shear = integral(1.0, xi, |r| field(r).powi(2) / r);
    let product = (1.0 + nu) * (1.0 - 2.0 * nu);
    let (c, lambda, mu) = ((1.0 - nu) / product, nu / product, 0.5 / (1.0 + nu));
    let scale = 1.0 / (gamma * mass);
    let stiffness = scale / ((1.0 + nu) * width);
    Coefficients {
        a: scale * c * shear,
        b: scale * mu * shear,
        coupling: -scale * (c * shear - 0.5 * lambda + mu * (shear + 0.5)),
        g: stiffness * (xi * xi + 1.0 / (1.0 - 2.0 * nu)),
        h: stiffness * xi * xi,
    }
}
