//! Other unknowns for the orbits of a signature.

use super::Zones;
use crate::continuation::Node;
use crate::linalg::Vector;

/// Other unknowns for the same orbits.
pub trait CoordinateChanges: Zones {
    /// A node of orbits of a signature by every set of unknowns of this one, next to another node, that gives the same orbit
    /// with the same tangent.
    fn aliases(&self, signature: &Self::Signature, node: &Node, _near: &Node) -> Vec<Node> {
        let is_own = signature == self.signature();
        is_own.then(|| node.clone()).into_iter().collect()
    }

    /// The same orbits in unknowns that suit one of them better, where there are any; `creeps` where steps are short.
    fn renewed(
        &self,
        _point: &Vector,
        _examination: &Self::Examination,
        _creeps: bool,
    ) -> Option<Self> {
        None
    }

    /// A point and a direction there in the unknowns of [`CoordinateChanges::renewed`].
    fn carried(&self, _renewed: &Self, _node: &Node) -> Option<Node> {
        None
    }

    /// The tangent in those unknowns alone that all sets of unknowns of these orbits share.
    fn tangent_of_zones(&self, node: &Node) -> Vector {
        node.tangent.clone()
    }
}
