//! Cameras of several views, joined by segments into one continuous picture (Popescu et al., section 3).
//!
//! A [`Graph`] is a triangulation of the image and, for each of its vertices, the points through which the ray there passes.
//! Where a leg of the rays is straight, its points at the vertices are interpolated linearly over the image triangles:
//! the leg is a layer of pieces, and the end of one is the start of the next at every place of the image. Pinhole views
//! are cut by planes parallel to their own image planes, on which points are linear in the image; so pinhole and
//! connecting (CGLC) segments are pieces alike, with weights of 1, so there are no gaps.
//!
//! * `view`: a pinhole view, wherever in the image it lands.
//! * `connect`: how a graph becomes layers: straight, in straight parts, curved; `morph`.
//! * `outline`: triangles for image regions of any shape; `overlay`: for those that overlap.
//! * `volume`, `fold`: segments that intersect, and rays that cross.
//! * `legs`, `roots`: legs from a root view into others, and cubes of views.
//! * `path`, `blend`: detours around the occluders of a target, and several of them on one net; `coarse`: on one of few
//!   triangles; `moving`, `lattice`: those of targets that move.
//! * [`bottom_up`], [`top_down`], [`track`]: the constructors.
//!
//! The piece of a pixel is found by its tile's own list, whose length does not grow with the graph.

mod blend;
pub mod bottom_up;
mod coarse;
mod connect;
mod fold;
mod lattice;
mod legs;
mod moving;
mod outline;
mod overlay;
mod path;
mod roots;
pub mod top_down;
pub mod track;
mod view;
mod volume;

use connect::Bend;

use glam::{DVec2, DVec3};

/// A triangulation of the image.
#[derive(Debug, Clone, Default)]
struct Net {
    /// Pixels, from the image's top left corner; they may lie outside the image.
    places_px: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
}

/// A leg of all rays: lists of one point a vertex of the net, world units.
#[derive(Debug, Clone)]
enum Leg {
    /// From the first point to the second.
    Straight([Vec<DVec3>; 2]),
    /// Between two views: the Bezier points of a curve that goes on straight into the legs before and after. The ends
    /// alone are a plain connecting segment.
    Connecting([Vec<DVec3>; 4]),
}

/// Rays over an image, leg by leg from the eye outwards; each leg starts where the one before ends.
#[derive(Debug, Clone, Default)]
struct Graph {
    net: Net,
    legs: Vec<Leg>,
}

impl Leg {
    fn points(&self) -> &[Vec<DVec3>] {
        match self {
            Leg::Straight(p) => p,
            Leg::Connecting(p) => p,
        }
    }

    fn points_mut(&mut self) -> &mut [Vec<DVec3>] {
        match self {
            Leg::Straight(p) => p,
            Leg::Connecting(p) => p,
        }
    }
}

impl Graph {
    /// The graph with every point interpolated towards that of `plain`, which is reached at 0 (section 3.1, Fig. 6).
    fn morphed(mut self, plain: &Graph, morph: f64) -> Graph {
        for (leg, goal) in self.legs.iter_mut().zip(&plain.legs) {
            for (points, goals) in leg.points_mut().iter_mut().zip(goal.points()) {
                points.iter_mut().zip(goals).for_each(|(p, g)| *p = g.lerp(*p, morph));
            }
        }
        self
    }
}
