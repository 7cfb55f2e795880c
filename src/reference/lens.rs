//! Rays of calibrated lenses, computed from the models' definitions. Nothing of the camera's inversion is used, so that `--check` finds
//! its faults.
//!
//! The rule is the camera's: a place has the ray on the branch of the middle, up to the first fold or pole on the straight line from
//! the middle to it. Here the preimage of that line is traced through the plane of rays by arc length. Its tangent is `adj(J) q`,
//! which needs no inverse and is smooth up to the fold. Behind a pole that cancels, it is traced from a circle about the middle. Where the model is radial, interval arithmetic proves that it grows, and
//! bisection with secants finds the radius.

pub mod brown;
mod poles;
mod projection;
mod radial;
mod walk;

use crate::camera::calibration::{Calibrated, Coefficients, Intrinsics, Model, Projection};
use crate::camera::{Camera, Field, Ray, RayMap, Rays};
use glam::{DQuat, DVec2, DVec3};
use poles::Branch;
use std::borrow::Cow;
use std::sync::Arc;

/// The camera, the rays of its calibrated lenses replaced by the reference's own.
pub fn own(camera: &Camera) -> Cow<'_, Camera> {
    with(camera, Field::kept)
}

/// The same for few pixels: rays are computed when they are needed.
#[cfg(any(feature = "cli", feature = "view"))]
pub fn own_for_few(camera: &Camera) -> Cow<'_, Camera> {
    with(camera, |field| field)
}

fn with(camera: &Camera, finish: fn(Field) -> Field) -> Cow<'_, Camera> {
    let own = |rays: &Rays| match rays {
        Rays::Field(field) => {
            let lens = field.map()?.calibrated()?;
            Some(Rays::Field(finish(
                field.by_map(Arc::new(Own { calibrated: lens.clone(), lens: Lens::new(&lens.model) })),
            )))
        }
        _ => None,
    };
    let layers: Vec<Option<Rays>> = camera.layers.iter().map(own).collect();
    if layers.iter().all(Option::is_none) {
        return Cow::Borrowed(camera);
    }
    let layers = layers.into_iter().zip(&camera.layers).map(|(own, rays)| own.unwrap_or_else(|| rays.clone()));
    Cow::Owned(Camera { layers: layers.collect(), ..camera.clone() })
}

#[derive(Debug)]
struct Own {
    calibrated: Calibrated,
    lens: Lens,
}

impl RayMap for Own {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let Calibrated { eye, view, intrinsics, shutter, .. } = &self.calibrated;
        let Intrinsics { size: (w, h), scale, centre } = intrinsics;
        let (u, v) = (a * f64::from(*w) - 0.5, b * f64::from(*h) - 0.5);
        let d = self.lens.direction(scale.inverse() * (DVec2::new(u, v) - *centre))?;
        let time = v * shutter.line_time;
        let rotation = DQuat::from_scaled_axis(time * shutter.angular);
        // x right, y down, z forward
        let direction = rotation * (d.x * view.right - d.y * view.up + d.z * view.forward);
        Some(Ray { origin: *eye + time * shutter.velocity, direction })
    }
}

/// A lens with the branches of its distortions.
#[derive(Debug)]
pub struct Lens {
    projection: Projection,
    /// Each with its branches, if there are several.
    distortions: Vec<(Coefficients, Vec<Branch>)>,
}

impl Lens {
    pub fn new(model: &Model) -> Lens {
        let distortions = model.distortions.iter().map(|k| (*k, poles::branches(k)));
        Lens { projection: model.projection.clone(), distortions: distortions.collect() }
    }

    /// The direction that is seen at the place `q` of the plane.
    pub fn direction(&self, q: DVec2) -> Option<DVec3> {
        let p = self.distortions.iter().rev().try_fold(q, |q, (k, branches)| match q == DVec2::ZERO {
            true => Some(q),
            false if branches.is_empty() => undistorted(k, q),
            false => branches.iter().find_map(|branch| branch.undistorted(k, q)),
        })?;
        projection::direction(&self.projection, p)
    }
}

/// The point of the plane whose distorted place is `q`, which is not the middle.
fn undistorted(k: &Coefficients, q: DVec2) -> Option<DVec2> {
    if k.is_radial() && k.tilt == [0.0; 2] {
        let radius = q.length();
        let r = radial::brown(k, radius)?;
        return Some(DVec2::new(q.x * r / radius, q.y * r / radius));
    }
    walk::to(k, q)
}
