//! The legs of rays that run from a root view through connecting segments into views of their own.

use super::view::View;
use super::{Graph, Leg, Net};
use glam::{DVec2, DVec3};

/// Where the legs of the rays of a root view end, as depths: `[cut, near, far]`.
pub type Depths = [f64; 3];

/// The rays of plain views, leg by leg: what a camera is straightened to. `views` gives each vertex its root; without
/// `depths` there is the one leg from the eye to `far`.
pub fn plain(net: &Net, root: impl Fn(usize) -> View, far: f64, depths: Option<Depths>) -> Graph {
    let at = |depth: f64| (0..net.places_px.len()).map(|k| root(k).point(net.places_px[k], depth)).collect::<Vec<_>>();
    let legs = match depths {
        None => vec![Leg::Straight([at(0.0), at(far)])],
        Some([cut, near, far]) => {
            let third = (near - cut) / 3.0;
            let middle = [at(cut), at(cut + third), at(near - third), at(near)];
            vec![Leg::Straight([at(0.0), at(cut)]), Leg::Connecting(middle), Leg::Straight([at(near), at(far)])]
        }
    };
    Graph { net: net.clone(), legs }
}

/// The rays of `plain` with other leaves: `leaf` gives the vertices' near and far points.
///
/// A connecting leg leaves along the root's rays and enters along the leaf's: its inner Bezier points lie a third of
/// its plain length on from its ends, so that a ray which is straight is one at even speed.
pub fn with_leaves(plain: &Graph, leaf: [Vec<DVec3>; 2], depths: Option<Depths>) -> Graph {
    let mut graph = plain.clone();
    let count = graph.legs.len();
    if let (Some([cut, near, far]), [Leg::Straight([eye, end]), Leg::Connecting(middle), _]) =
        (depths, &mut graph.legs[..])
    {
        let third = (near - cut) / 3.0;
        let on =
            |from: &[DVec3], to: &[DVec3], by: f64| from.iter().zip(to).map(|(f, t)| *f + by * (*t - *f)).collect();
        *middle = [
            end.clone(),
            on(eye, end, 1.0 + third / cut),
            on(&leaf[0], &leaf[1], -third / (far - near)),
            leaf[0].clone(),
        ];
    }
    graph.legs[count - 1] = Leg::Straight(leaf);
    graph
}

/// The mean length that connecting legs between `cut` and the near points of leaves have.
pub fn mean_length(net: &Net, root: impl Fn(usize) -> View, cut: f64, near: &[DVec3]) -> f64 {
    let lengths = near.iter().enumerate().map(|(k, n)| (*n - root(k).point(net.places_px[k], cut)).length());
    lengths.sum::<f64>() / near.len() as f64
}

/// The image's centre.
pub fn centre((width, height): (u32, u32)) -> DVec2 {
    DVec2::new(width as f64, height as f64) / 2.0
}
