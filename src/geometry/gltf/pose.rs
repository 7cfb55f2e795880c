//! A document at a time of one of its animations: where its nodes are, and how its vertices are moved by morph targets and skins.

use super::json::Local;
use super::source::Source;
use super::top_nodes;
use crate::geometry::spec::AnimationSpec;
use crate::input::{Error, Result};
use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::animation::{Channel, Interpolation, Property};
use gltf::json::Root;
use gltf::json::validation::Checked;
use gltf::{Node, Primitive, Semantic, Skin};

/// Nodes and weights at a time.
pub(super) struct Pose {
    /// Of each node.
    parent_from_node: Vec<DMat4>,
    world_from_node: Vec<DMat4>,
    /// Of the morph targets of each node's mesh; fewer than there are count as 0.
    weights: Vec<Vec<f64>>,
}

/// The values of a node that animations change: its transform, and the weights of its morph targets.
type Posed = (Local, Vec<f64>);

impl Pose {
    /// At a time of an animation.
    ///
    /// # Errors
    /// [`Error::Input`] naming the animation and the channel: no such animation, or values that do not fit.
    pub fn at(source: &Source, animation: &AnimationSpec) -> Result<Pose> {
        let document = &source.document;
        check_indices(document.as_json())?;
        let nodes = source.kept.nodes.iter();
        let mut posed: Vec<Posed> = nodes.map(|node| (node.local, node.weights.clone().unwrap_or_default())).collect();
        let count = document.animations().len();
        let is_asked = |a: &gltf::Animation| match animation.name.parse::<usize>() {
            Ok(index) => a.index() == index || a.name() == Some(&animation.name),
            Err(_) => a.name() == Some(&animation.name),
        };
        let Some(found) = document.animations().find(is_asked) else {
            let name = |a: gltf::Animation| a.name().map_or_else(|| a.index().to_string(), |name| format!("{name:?}"));
            let known: Vec<String> = document.animations().map(name).collect();
            let known = if count == 0 { "it has none".into() } else { format!("it has {}", known.join(", ")) };
            return Err(Error::input(format!("has no animation {:?}; {known}", animation.name)));
        };
        let json = &document.as_json().animations[found.index()];
        for (k, channel) in found.channels().enumerate() {
            let at = |e: Error| e.at(format!("animation {}, channel {k}", found.index()));
            let of_channel = &json.channels[k];
            if of_channel.target.path == Checked::Invalid {
                // what it moves is no part of a node
                continue;
            }
            if json.samplers[of_channel.sampler.value()].interpolation == Checked::Invalid {
                return Err(at(Error::input(
                    "its interpolation is none of LINEAR, STEP and CUBICSPLINE; export it again",
                )));
            }
            apply(source, &channel, animation.time, &mut posed[channel.target().node().index()]).map_err(at)?;
        }
        let parent_from_node: Vec<DMat4> = posed.iter().map(|(local, _)| local.parent_from_node()).collect();
        let world_from_node = world_from_nodes(source, &parent_from_node)?;
        Ok(Pose { parent_from_node, world_from_node, weights: posed.into_iter().map(|(_, weights)| weights).collect() })
    }

    pub fn parent_from_node(&self, node: &Node) -> DMat4 {
        self.parent_from_node[node.index()]
    }

    /// Adds what morph targets move of a primitive's positions or normals.
    pub fn morph(
        &self,
        source: &Source,
        node: &Node,
        primitive: &Primitive,
        what: Semantic,
        values: &mut [DVec3],
    ) -> Result<()> {
        for (target, weight) in primitive.morph_targets().zip(&self.weights[node.index()]) {
            let accessor = if what == Semantic::Positions { target.positions() } else { target.normals() };
            let Some(accessor) = accessor.filter(|_| *weight != 0.0) else { continue };
            let moves = source.read_vectors(&accessor)?;
            if moves.len() != values.len() {
                let (n, count) = (moves.len(), values.len());
                return Err(Error::input(format!("a morph target of {n} vectors for {count} vertices; give one each")));
            }
            values.iter_mut().zip(moves).for_each(|(value, by)| *value += *weight * by);
        }
        Ok(())
    }

    /// For each vertex of a primitive the transform into the world that its joints give; `None`: its node has no skin.
    pub fn skinned(
        &self,
        source: &Source,
        node: &Node,
        primitive: &Primitive,
        count: usize,
    ) -> Result<Option<Vec<DMat4>>> {
        let Some(skin) = node.skin() else { return Ok(None) };
        // four joints a set
        let mut sets: Vec<(Vec<DVec4>, Vec<DVec4>)> = Vec::new();
        let set = |k: u32| Some((primitive.get(&Semantic::Joints(k))?, primitive.get(&Semantic::Weights(k))?));
        while let Some((joints, weights)) = set(sets.len() as u32) {
            let (joints, weights) = (source.read_fours(&joints)?, source.read_fours(&weights)?);
            if joints.len() != count || weights.len() != count {
                return Err(Error::input(format!(
                    "{} joints and {} weights for {count} vertices; give one each",
                    joints.len(),
                    weights.len()
                )));
            }
            sets.push((joints, weights));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let world_from_bind = self.joints(source, &skin)?;
        let of_joint = |joint: f64| {
            let wrong = || Error::input(format!("joint {joint} of {}; export it again", world_from_bind.len()));
            world_from_bind.get(joint as usize).copied().ok_or_else(wrong)
        };
        let of_vertex = |k: usize| {
            let sum: f64 = sets.iter().map(|(_, weights)| weights[k].element_sum()).sum();
            if sum == 0.0 {
                // exporters mean the first joint
                return of_joint(sets[0].0[k].x);
            }
            let mut matrix = DMat4::ZERO;
            for (joints, weights) in &sets {
                let shares = joints[k].to_array().into_iter().zip(weights[k].to_array());
                for (joint, weight) in shares.filter(|(_, weight)| *weight != 0.0) {
                    matrix += of_joint(joint)? * (weight / sum);
                }
            }
            Ok(matrix)
        };
        (0..count).map(of_vertex).collect::<Result<_>>().map(Some)
    }

    /// For each joint of a skin the transform from where it was bound to the world.
    fn joints(&self, source: &Source, skin: &Skin) -> Result<Vec<DMat4>> {
        let bind = skin.inverse_bind_matrices().map(|accessor| source.read_matrices(&accessor)).transpose()?;
        let joint_from_bind = |k: usize| bind.as_ref().map_or(Some(DMat4::IDENTITY), |all| all.get(k).copied());
        let all =
            skin.joints().enumerate().map(|(k, joint)| Some(self.world_from_node[joint.index()] * joint_from_bind(k)?));
        all.collect::<Option<_>>().ok_or_else(|| {
            Error::input(format!("skin {}: has fewer inverse bind matrices than joints; export it again", skin.index()))
        })
    }
}

/// Every index of animations and skins: the crate does not look at all of them.
fn check_indices(root: &Root) -> Result<()> {
    let (nodes, accessors) = (root.nodes.len(), root.accessors.len());
    for (k, animation) in root.animations.iter().enumerate() {
        let samplers = animation.samplers.len();
        let is_wrong =
            animation.channels.iter().any(|c| c.target.node.value() >= nodes || c.sampler.value() >= samplers)
                || animation.samplers.iter().any(|s| s.input.value() >= accessors || s.output.value() >= accessors);
        if is_wrong {
            return Err(Error::input(format!("animation {k}: an index is out of range; export it again")));
        }
    }
    for (k, skin) in root.skins.iter().enumerate() {
        let is_wrong = skin.joints.iter().any(|joint| joint.value() >= nodes)
            || skin.inverse_bind_matrices.is_some_and(|a| a.value() >= accessors);
        if is_wrong {
            return Err(Error::input(format!("skin {k}: an index is out of range; export it again")));
        }
    }
    match root.nodes.iter().position(|node| node.skin.is_some_and(|skin| skin.value() >= root.skins.len())) {
        Some(k) => Err(Error::input(format!("node {k}: its skin is out of range; export it again"))),
        None => Ok(()),
    }
}

/// The transforms of all nodes into the world, parents before children.
fn world_from_nodes(source: &Source, parent_from_node: &[DMat4]) -> Result<Vec<DMat4>> {
    let mut world = vec![None; parent_from_node.len()];
    let mut todo: Vec<(Node, DMat4)> =
        top_nodes(&source.document).into_iter().map(|root| (root, DMat4::IDENTITY)).collect();
    while let Some((node, world_from_parent)) = todo.pop() {
        let own = world_from_parent * parent_from_node[node.index()];
        if world[node.index()].replace(own).is_some() {
            return Err(Error::input(format!("node {} is reached twice; nodes must form trees", node.index())));
        }
        todo.extend(node.children().map(|child| (child, own)));
    }
    // nodes of a ring have no root
    Ok(world.into_iter().map(Option::unwrap_or_default).collect())
}

/// Sets what a channel says of its node at a time.
fn apply(source: &Source, channel: &Channel, time: f64, (local, weights): &mut Posed) -> Result<()> {
    let sampler = channel.sampler();
    let times = source.read_scalars(&sampler.input())?;
    let values = source.read(&sampler.output())?;
    if times.is_empty() || !times.is_sorted() {
        return Err(Error::input("its times must ascend; export it again"));
    }
    let is_cubic = sampler.interpolation() == Interpolation::CubicSpline;
    let elements = times.len() * if is_cubic { 3 } else { 1 };
    let width = match channel.target().property() {
        Property::Translation | Property::Scale => 3,
        Property::Rotation => 4,
        Property::MorphTargetWeights => values.len() / elements,
    };
    if width == 0 || values.len() != width * elements {
        let (n, keys) = (values.len(), times.len());
        return Err(Error::input(format!("{n} numbers for {keys} times; export it again")));
    }
    let keys = Keys { times: &times, values: &values, width, interpolation: sampler.interpolation() };
    let is_rotation = channel.target().property() == Property::Rotation;
    let value = keys.at(time, is_rotation);
    if channel.target().property() == Property::MorphTargetWeights {
        *weights = value;
        return Ok(());
    }
    // the specification has no animations of nodes with a matrix
    let Local::Parts { translation, rotation, scale } = local else { return Ok(()) };
    match channel.target().property() {
        Property::Translation => *translation = DVec3::new(value[0], value[1], value[2]),
        Property::Scale => *scale = DVec3::new(value[0], value[1], value[2]),
        _ => *rotation = DQuat::from_xyzw(value[0], value[1], value[2], value[3]).normalize(),
    }
    Ok(())
}

/// The keys of a channel.
struct Keys<'a> {
    times: &'a [f64],
    /// Of each key `width` numbers; of a cubic spline an incoming tangent, a value and an outgoing tangent.
    values: &'a [f64],
    width: usize,
    interpolation: Interpolation,
}

impl Keys<'_> {
    fn part(&self, element: usize) -> &[f64] {
        &self.values[element * self.width..][..self.width]
    }

    fn value(&self, key: usize) -> &[f64] {
        self.part(if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key })
    }

    /// The value at a time, by the glTF specification (appendix C); constant before the first and after the last key.
    fn at(&self, time: f64, is_rotation: bool) -> Vec<f64> {
        let next = self.times.partition_point(|t| *t <= time);
        let Some(k) = next.checked_sub(1).filter(|_| next < self.times.len()) else {
            return self.value(next.min(self.times.len() - 1)).to_vec();
        };
        let length = self.times[next] - self.times[k];
        let t = (time - self.times[k]) / length;
        let (a, b) = (self.value(k), self.value(next));
        match self.interpolation {
            Interpolation::Step => a.to_vec(),
            Interpolation::Linear if is_rotation => {
                let q = |v: &[f64]| DQuat::from_xyzw(v[0], v[1], v[2], v[3]).normalize();
                q(a).slerp(q(b), t).to_array().to_vec()
            }
            Interpolation::Linear => a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect(),
            Interpolation::CubicSpline => {
                let (out, into) = (self.part(3 * k + 2), self.part(3 * next));
                let (t2, t3) = (t * t, t * t * t);
                let each = |n: usize| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * a[n]
                        + length * (t3 - 2.0 * t2 + t) * out[n]
                        + (3.0 * t2 - 2.0 * t3) * b[n]
                        + length * (t3 - t2) * into[n]
                };
                (0..self.width).map(each).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys<'a>(values: &'a [f64], width: usize, interpolation: Interpolation) -> Keys<'a> {
        Keys { times: &[1.0, 3.0], values, width, interpolation }
    }

    #[test]
    fn values_between_two_keys() {
        let linear = keys(&[0.0, 10.0, 4.0, 20.0], 2, Interpolation::Linear);
        assert_eq!(linear.at(1.5, false), [1.0, 12.5]);
        assert_eq!([linear.at(0.0, false), linear.at(9.0, false)], [[0.0, 10.0], [4.0, 20.0]]);
        let step = keys(&[5.0, 7.0], 1, Interpolation::Step);
        assert_eq!([1.0, 2.999, 3.0].map(|t| step.at(t, false)[0]), [5.0, 5.0, 7.0]);
        // the parabola (t - 1)^2 from 0 to 4, with its tangents 0 and 4
        let cubic = keys(&[9.0, 0.0, 0.0, 4.0, 4.0, 9.0], 1, Interpolation::CubicSpline);
        for t in [1.0, 1.3, 2.0, 2.9, 3.0] {
            assert!((cubic.at(t, false)[0] - (t - 1.0) * (t - 1.0)).abs() < 1e-15);
        }
        // a quarter turn about z, the shorter way
        let (sin, cos) = std::f64::consts::FRAC_PI_4.sin_cos();
        let turn = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -sin, -cos];
        let half = keys(&turn, 4, Interpolation::Linear).at(2.0, true);
        let (sin, cos) = std::f64::consts::FRAC_PI_8.sin_cos();
        let expected = [0.0, 0.0, sin, cos];
        let sign = half[3].signum();
        assert!(half.iter().zip(expected).all(|(a, b)| (a * sign - b).abs() < 1e-15), "{half:?}");
    }
}
