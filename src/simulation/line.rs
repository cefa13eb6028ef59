//! The contact line: what both bodies show of themselves.

/// What a point of the contact line does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineRegime {
    /// U > δ.
    Separation,
    /// V̇ < 1.
    Slip,
    /// V̇ = 1.
    Stick,
    /// V̇ > 1.
    Reverse,
}

impl LineRegime {
    /// All regimes in the order of their codes.
    pub(crate) const ALL: [LineRegime; 4] = [
        LineRegime::Separation,
        LineRegime::Slip,
        LineRegime::Stick,
        LineRegime::Reverse,
    ];

    /// Name as in the tables of waves.
    pub fn name(self) -> &'static str {
        match self {
            LineRegime::Separation => "separation",
            LineRegime::Slip => "slip",
            LineRegime::Stick => "stick",
            LineRegime::Reverse => "reverse",
        }
    }

    /// 0 to 3, for tables of codes.
    pub fn code(self) -> u8 {
        self as u8
    }

    /// Of a point with this V̇; `within` is the half-width of what counts as stick, 0 for the
    /// set-valued law, which gives V̇ = 1 exactly.
    pub fn of(contact: bool, rate: f64, within: f64) -> LineRegime {
        match rate - 1.0 {
            _ if !contact => LineRegime::Separation,
            d if d.abs() <= within => LineRegime::Stick,
            d if d < 0.0 => LineRegime::Slip,
            _ => LineRegime::Reverse,
        }
    }
}

/// The contact line at an instant; rates stand half a step earlier.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Angle between neighbouring points.
    pub width: f64,
    /// U.
    pub radial: Vec<f64>,
    /// V.
    pub tangential: Vec<f64>,
    /// U̇.
    pub radial_rate: Vec<f64>,
    /// V̇.
    pub tangential_rate: Vec<f64>,
    /// Pressure: P of the ring, p of the annulus.
    pub pressure: Vec<f64>,
    /// Shear: Q of the ring, q of the annulus.
    pub shear: Vec<f64>,
    /// Regimes.
    pub regimes: Vec<LineRegime>,
}

impl Line {
    /// Share of the line in each regime, in the order of [`LineRegime::ALL`].
    pub(crate) fn fractions(&self) -> [f64; 4] {
        LineRegime::ALL.map(|regime| {
            let count = self.regimes.iter().filter(|one| **one == regime).count();
            count as f64 / self.regimes.len().max(1) as f64
        })
    }

    /// (2/N) Σ V e^{−ikφ}: half-range amplitude and phase of a mode of V.
    pub(crate) fn harmonic(&self, mode: u32) -> [f64; 2] {
        let scale = 2.0 / self.tangential.len().max(1) as f64;
        let mut sum = [0.0; 2];
        for (point, value) in self.tangential.iter().enumerate() {
            let (sine, cosine) = (f64::from(mode) * self.width * point as f64).sin_cos();
            sum[0] += value * cosine;
            sum[1] -= value * sine;
        }
        sum.map(|part| part * scale)
    }

    /// How unlike the `waves` parts of the line are: the mean square of V less the mean of all
    /// turns by 2π/k, relative to that of V less its mean. None where the points do not divide.
    pub fn asymmetry(&self, waves: usize) -> Option<f64> {
        let count = self.tangential.len();
        if waves == 0 || !count.is_multiple_of(waves) {
            return None;
        }
        let part = count / waves;
        let alike: Vec<f64> = (0..part)
            .map(|point| {
                let sum: f64 = (0..waves)
                    .map(|wave| self.tangential[wave * part + point])
                    .sum();
                sum / waves as f64
            })
            .collect();
        let mean = alike.iter().sum::<f64>() / part as f64;
        let (mut unlike, mut whole) = (0.0, 0.0);
        for (point, value) in self.tangential.iter().enumerate() {
            unlike += (value - alike[point % part]).powi(2);
            whole += (value - mean).powi(2);
        }
        (whole > 0.0).then(|| unlike / whole)
    }
}
