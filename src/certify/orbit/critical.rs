//! The null vector at a fold or at a multiplier on the unit circle, among the unknowns.

use crate::interval::Interval;

/// What is looked for beside the orbit.
#[derive(Clone, Debug)]
pub struct NullVector {
    /// μ in doubles; its angle is an unknown where it is not real.
    pub factor: [f64; 2],
    /// v in doubles: its real part, and its imaginary part where μ is not real.
    pub vectors: Vec<Vec<f64>>,
    /// ℓ.
    pub normals: Vec<Vec<f64>>,
    /// How many unknowns an orbit has beside the parameter.
    pub orbit: usize,
}

impl NullVector {
    /// Parts of v: one, or a real and an imaginary one.
    pub fn directions(&self) -> usize {
        self.vectors.len()
    }

    /// Where a part of v begins.
    pub fn first(&self, direction: usize) -> usize {
        self.orbit + 1 + direction * self.orbit
    }

    /// Unknowns beside those of the orbit, in doubles.
    pub fn guess(&self) -> Vec<f64> {
        let mut guess = self.vectors.concat();
        if self.directions() == 2 {
            let [re, im] = self.factor;
            guess.push(im.atan2(re));
        }
        guess
    }

    /// μ − 1 and, where μ is not real, dμ/dθ.
    pub fn shifted(&self, x: &[Interval]) -> ([Interval; 2], [Interval; 2]) {
        match (self.directions(), x.last()) {
            (2, Some(angle)) => {
                let (cosine, sine) = (angle.cos(), angle.sin());
                ([cosine - Interval::ONE, sine], [-sine, cosine])
            }
            _ => {
                let less = Interval::point(self.factor[0] - 1.0);
                ([less, Interval::ZERO], [Interval::ZERO; 2])
            }
        }
    }
}
