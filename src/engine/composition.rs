//! Frames of composites whose cameras have frames of their own: each camera's frame is rendered, and every pixel takes all channels of one
//! of them. Which one, and what of blended colours, is found in f64 from the triangles that the frames name: `docs/reference/definitions.md`,
//! composite.

use super::combinations::Asked;
use super::left_out::LeftOut;
use super::plan::{Rows, Wanted};
use super::{Engine, Rendered, RunOptions};
use crate::camera::composition::{Composition, Held};
use crate::camera::{Camera, Rays};
use crate::geometry::primitive::Primitive;
use crate::image::frame::{Channel, Frame, NO_ID, Plane};
use crate::image::opaque8;
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::Scene;
use glam::DVec3;
use std::mem::discriminant;

const COLOURS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

fn lacking() -> Error {
    Error::work("a camera's frame lacks a channel")
}

/// What is known of a camera's frame: the triangle of each pixel and its t, rounded.
struct Layer<'a> {
    ids: &'a [u32],
    t: &'a [f32],
}

impl<'a> Layer<'a> {
    fn of(rendered: &'a Rendered) -> Option<Layer<'a>> {
        Some(Layer { ids: rendered.frame.u32(Channel::TriangleId)?, t: rendered.frame.f32(Channel::T)? })
    }
}

struct Composing<'a> {
    scene: &'a Scene,
    composition: &'a Composition,
    layers: Vec<Layer<'a>>,
}

impl Composing<'_> {
    /// The camera whose channels a pixel has, by its number; `None`: no region holds it.
    fn owner(&self, (i, j): (u32, u32), at: usize) -> Option<usize> {
        let Held { held, .. } = self.composition.held(i, j);
        self.seen((i, j), at, &held)
    }

    /// How a pixel's triangle is proven, as in the channel `certified`: the weakest proof of the frames that decide which camera shows; 0 where
    /// depths decide.
    fn proof(&self, (i, j): (u32, u32), at: usize, certified: &[&[u32]]) -> u32 {
        let Composition { order, master, members, .. } = self.composition;
        let Held { held, .. } = self.composition.held(i, j);
        let mut holding = order.iter().copied().filter(|k| held[*k]);
        if master.is_none() {
            return holding.next().map_or(0, |k| certified[k][at]);
        }
        let mut weakest = u32::MAX;
        let mut hit = None;
        for k in holding {
            match hit {
                Some(priority) if priority > members[k].priority => break,
                Some(_) if self.layers[k].ids[at] != NO_ID => return 0,
                None if self.layers[k].ids[at] != NO_ID => hit = Some(members[k].priority),
                _ => {}
            }
            weakest = weakest.min(certified[k][at]);
        }
        if weakest == u32::MAX { 0 } else { weakest }
    }

    /// The cameras whose colours a pixel has, and the share of each: that of the places of the borders, from one side of the strips to the
    /// other, at which the pixel would show the camera.
    fn shares(&self, (i, j): (u32, u32), at: usize) -> Vec<(Option<usize>, f64)> {
        if !self.composition.is_feathered() {
            return Vec::new();
        }
        let Held { weights, .. } = self.composition.held(i, j);
        let mut levels: Vec<f64> = weights.iter().copied().chain([1.0]).filter(|w| *w > 0.0).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let mut below = 0.0;
        let mut share = |level: f64| {
            let held: Vec<bool> = weights.iter().map(|w| *w >= level).collect();
            let width = level - below;
            below = level;
            (self.seen((i, j), at, &held), width)
        };
        levels.into_iter().map(&mut share).collect()
    }

    /// The camera that is seen of those that hold a pixel.
    fn seen(&self, pixel: (u32, u32), at: usize, held: &[bool]) -> Option<usize> {
        let Composition { order, master, members, .. } = self.composition;
        let mut holding = order.iter().copied().filter(|k| held[*k]);
        let Some(master) = *master else { return holding.next() };
        let mut best: Option<(usize, f64)> = None;
        let mut last = None;
        // by descending priority, then as listed
        for k in holding {
            last = Some(k);
            if self.layers[k].ids[at] == NO_ID {
                continue;
            }
            match best {
                Some((other, _)) if members[other].priority > members[k].priority => break,
                Some((_, nearest)) => {
                    let depth = self.depth(master, k, pixel, at);
                    if depth < nearest {
                        best = Some((k, depth));
                    }
                }
                None => best = Some((k, self.depth(master, k, pixel, at))),
            }
        }
        let nothing = if held[master] { Some(master) } else { last };
        best.map(|(k, _)| k).or(nothing)
    }

    /// How far the hit of a camera's pixel lies along the master's ray of the pixel; 0 where that has none.
    fn depth(&self, master: usize, k: usize, (i, j): (u32, u32), at: usize) -> f64 {
        let members = &self.composition.members;
        let Some(ray) = members[master].camera.ray(i, j) else { return 0.0 };
        let Some(point) = self.point(&members[k].camera, (i, j), self.layers[k].ids[at], self.layers[k].t[at]) else {
            return 0.0;
        };
        (point - ray.origin).dot(ray.direction.normalize())
    }

    /// Where a pixel's ray or curve hits a triangle or sphere, in f64, from a rounded t.
    fn point(&self, camera: &Camera, (i, j): (u32, u32), id: u32, t: f32) -> Option<DVec3> {
        let primitive = self.scene.primitive_at(id, self.scene.moment(camera, (i, j)));
        // 0 on the surface, and its gradient there
        let height = |x: DVec3| {
            let normal = primitive.normal_at(x);
            match primitive {
                Primitive::Triangle([v0, ..]) => ((x - v0).dot(normal), normal),
                Primitive::Round(capsule) => (normal.length_squared() - capsule.radius * capsule.radius, 2.0 * normal),
            }
        };
        let along: Box<dyn Fn(f64) -> (DVec3, DVec3)> = match camera.layers.first()? {
            Rays::Curves(_) => {
                let (_, curve) = camera.curve(0, i, j)?;
                Box::new(move |t| (curve.at(t), curve.tangent(t)))
            }
            _ => {
                let ray = camera.ray(i, j)?;
                Box::new(move |t| (ray.origin + t * ray.direction, ray.direction))
            }
        };
        let mut t = f64::from(t);
        for _ in 0..NEWTON_STEPS {
            let (x, tangent) = along(t);
            let (value, gradient) = height(x);
            let slope = gradient.dot(tangent);
            let step = value / slope;
            if !step.is_finite() {
                break;
            }
            t -= step;
        }
        Some(along(t).0)
    }

    fn plane(
        &self,
        channel: Channel,
        rendered: &[Rendered],
        owners: &[Option<usize>],
        shares: &[Vec<(Option<usize>, f64)>],
    ) -> Option<Plane> {
        if channel.is_id() {
            let planes: Vec<&[u32]> = rendered.iter().map(|r| r.frame.u32(channel)).collect::<Option<_>>()?;
            let value = |(at, owner): (usize, &Option<usize>)| match (*owner, channel) {
                (None, _) => NO_ID,
                (Some(k), Channel::PieceId) if planes[k][at] != NO_ID => k as u32,
                (Some(k), _) => planes[k][at],
            };
            return Some(Plane::U32(owners.iter().enumerate().map(value).collect()));
        }
        let planes: Vec<&[f32]> = rendered.iter().map(|r| r.frame.f32(channel)).collect::<Option<_>>()?;
        let beyond = self.beyond(channel);
        let number = |at: usize, owner: Option<usize>| owner.map_or(beyond, |k| planes[k][at]);
        let is_blended = COLOURS.contains(&channel) && !shares.is_empty();
        let value = |(at, owner): (usize, &Option<usize>)| match shares {
            [] => number(at, *owner),
            _ if !is_blended => number(at, *owner),
            shares => match &shares[at][..] {
                [] => number(at, *owner),
                [(only, _)] => number(at, *only),
                several => several.iter().map(|(k, share)| share * f64::from(number(at, *k))).sum::<f64>() as f32,
            },
        };
        Some(Plane::F32(owners.iter().enumerate().map(value).collect()))
    }

    /// The value of a channel where there is no ray.
    fn beyond(&self, channel: Channel) -> f32 {
        match COLOURS.iter().position(|c| *c == channel) {
            Some(k) => self.scene.background[k],
            None => f32::from_bits(crate::image::frame::PixelValues::MISS.word(channel)),
        }
    }
}

/// From t rounded to f32, relative errors of 2^-24: squared each time, two steps reach f64's precision, and one more its last bits. Planes
/// take one.
const NEWTON_STEPS: u32 = 4;

/// What two frames took, one after the other.
fn joined(mut all: Rendered, next: Rendered) -> Rendered {
    all.add_costs(&next);
    all.left_out.extend(next.left_out);
    all.left_out.dedup_by(|a, b| discriminant(a) == discriminant(b) && !matches!(a, LeftOut::NotInView(_)));
    all
}

impl Engine {
    /// Renders `scene` through `camera`, whose composition [is layered](Composition::is_layered).
    pub(super) fn compose(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        composition: &Composition,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Rendered> {
        Asked::of(scene, camera, wanted, run).check()?;
        composition.check(&scene.objects)?;
        let colours = COLOURS.into_iter().filter(|_| wanted.srgb8);
        let channels =
            Channel::in_order(wanted.channels.iter().copied().chain([Channel::TriangleId, Channel::T]).chain(colours));
        let each = Wanted { channels: channels.clone(), srgb8: false, sample_ids: false, ..wanted.clone() };
        let scenes = scene.of_each_camera(composition);
        let frames = scenes.iter().zip(&composition.members);
        let run = &RunOptions { share: run.share.part_of(scenes.len()), ..run.clone() };
        let rendered = frames.map(|(scene, member)| self.render(scene, member.camera.clone(), &each, run));
        let rendered: Vec<Rendered> = rendered.collect::<Result<_>>()?;
        let Rows { first, count: height } = wanted.rows.unwrap_or(Rows { first: 0, count: camera.height });
        let width = camera.width;
        let layers: Vec<Layer> = rendered.iter().map(Layer::of).collect::<Option<_>>().ok_or_else(lacking)?;
        let composing = Composing { scene, composition, layers };
        let place = |k: u32| (k % width, first + k / width);
        let pixels = 0..width * height;
        let shares: Vec<Vec<(Option<usize>, f64)>> =
            parallel::map(pixels.clone(), |k| composing.shares(place(k), k as usize));
        let owners: Vec<Option<usize>> = parallel::map(pixels.clone(), |k| composing.owner(place(k), k as usize));
        let plane = |channel: Channel| match channel {
            Channel::Certified => {
                let certified: Vec<&[u32]> = rendered.iter().map(|r| r.frame.u32(channel)).collect::<Option<_>>()?;
                let proof = |k: u32| composing.proof(place(k), k as usize, &certified);
                Some((channel, Plane::U32(parallel::map(pixels.clone(), proof))))
            }
            _ => composing.plane(channel, &rendered, &owners, &shares).map(|plane| (channel, plane)),
        };
        let planes = channels.into_iter().map(plane).collect::<Option<_>>().ok_or_else(lacking)?;
        let mut frame = Frame { width, height, planes };
        let srgb8 = if wanted.srgb8 { opaque8(&frame, scene.tone) } else { None };
        let ids = frame.u32(Channel::TriangleId).filter(|_| wanted.sample_ids);
        let sample_ids = ids.map(<[u32]>::to_vec).into_iter().collect();
        frame.planes.retain(|(channel, _)| wanted.channels.contains(channel));
        let costs = rendered.into_iter().reduce(joined).ok_or_else(lacking)?;
        Ok(Rendered { frame, srgb8, sample_ids, ..costs })
    }
}
