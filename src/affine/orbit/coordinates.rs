//! Other unknowns for the same orbits: rotated, in other shots, or begun in another section.

use super::examine::Examination;
use super::layout::AffineOrbit;
use super::signature::Sequence;
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::CoordinateChanges;

impl CoordinateChanges for AffineOrbit {
    /// The phase of the first entry counts up to a turn, and a sequence may begin with another zone: one that repeats itself
    /// with each part, one that changes have led back to with any.
    fn aliases(&self, signature: &Sequence, node: &Node, near: &Node) -> Vec<Node> {
        let rotations = signature.rotations_to(&self.sequence).into_iter();
        let rotated = |shift: usize| {
            let count = self.zones();
            let shots = (0..count).map(|zone| self.shots((zone + count - shift) % count));
            let shots: Vec<usize> = shots.collect();
            let is_own = (0..count).all(|zone| signature.zone(zone).shots() == shots[zone])
                && signature.zone(0).section() == self.sequence.zone(0).section();
            if is_own {
                return self.rotated(node, shift);
            }
            let own = self.with_sequence(signature.clone())?;
            let mut node = match count {
                1 => own.carried_to(self, node)?,
                _ => own.carried_to(&own.in_shots(&shots)?, node)?,
            };
            node.tangent.normalize_mut();
            self.rotated(&node, shift)
        };
        let aliases = rotations.filter_map(rotated);
        aliases.map(|node| self.turned(node, near)).collect()
    }

    fn renewed(
        &self,
        point: &Vector,
        examination: &Examination,
        creeps: bool,
    ) -> Option<AffineOrbit> {
        let parted = self.in_shots_for_growth(point, &examination.growths, creeps);
        parted.or_else(|| self.in_sharper_section(point, examination))
    }

    fn carried(&self, renewed: &AffineOrbit, node: &Node) -> Option<Node> {
        self.carried_to(renewed, node)
    }

    /// What an orbit changes by does not depend on its shots: the tangent has length 1 in the unknowns of the zones and of the
    /// parameter alone.
    fn tangent_of_zones(&self, node: &Node) -> Vector {
        let (entries, all) = (self.width() * self.zones(), self.unknowns_of_zones());
        let mut tangent = node.tangent.clone();
        if all > entries {
            tangent.rows_mut(entries, all - entries).fill(0.0);
            tangent.normalize_mut();
        }
        tangent
    }
}
