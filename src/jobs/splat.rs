//! Splatting: each pixel shows the nearest of the points whose images lie in it.

use super::project::CHUNK;
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::project::Projector;
use crate::engine::stage::splat::Splat;
use crate::gpu::Gpu;
use crate::image::frame::{Channel, Frame, NO_ID, Plane};
use crate::image::srgb8;
use crate::input::{Error, Result};
use crate::parallel;
use glam::DVec3;

/// The nearest point of each pixel of a camera's image.
#[derive(Debug, Clone, PartialEq)]
pub struct Splatted {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The point, by its place in the list; [`NO_ID`] where there is none. W x H, row by row from the top.
    pub index: Vec<u32>,
    /// Its ray parameter; +inf where there is none. W x H.
    pub t: Vec<f64>,
    /// Points that are on a slit, or an eye, and have a curve of images, or an area: these are not drawn.
    pub degenerate: u64,
    /// Points of which a kernel proved that others hide them: the host did not project them.
    pub by_kernel: u64,
}

/// Draws points: every image of each goes to the pixel that it lies in, and the image of the least t is seen; of several at one t that of the
/// lowest index. With a device the kernels leave out points that others hide; what is seen is the same.
///
/// # Errors
/// [`Error::Work`] where the device fails, or there are 2^32 - 1 points or more.
pub fn splat(camera: &Camera, points: &[DVec3], gpu: Option<&Gpu>) -> Result<Splatted> {
    if points.len() >= NO_ID as usize {
        return Err(Error::work(format!(
            "{} points are too many to number; splat at most {}",
            points.len(),
            NO_ID - 1
        )));
    }
    let projector = Projector::new(camera);
    let pixels = camera.width as usize * camera.height as usize;
    let mut all = Splatted {
        width: camera.width,
        height: camera.height,
        index: vec![NO_ID; pixels],
        t: vec![f64::INFINITY; pixels],
        degenerate: 0,
        by_kernel: 0,
    };
    let kernels = gpu.map(|gpu| Splat::new(gpu, &projector)).transpose()?.flatten();
    let Some(mut kernels) = kernels else {
        for (part, chunk) in points.chunks(CHUNK).enumerate() {
            all.draw(&projector, points, (part * CHUNK..part * CHUNK + chunk.len()).collect());
        }
        return Ok(all);
    };
    kernels.adapt(points)?;
    let size = CHUNK.min(kernels.points_most().max(1));
    let mut chunks = points.chunks(size).enumerate();
    let mut start =
        || chunks.next().map(|(part, c)| Ok::<_, Error>((part * size, c.len(), kernels.start(c)?))).transpose();
    let mut ahead = start()?;
    while let Some((first, count, started)) = ahead {
        let left = kernels.finish(started)?;
        ahead = start()?;
        all.by_kernel += (count - left.len()) as u64;
        all.draw(&projector, points, left.into_iter().map(|k| first + k).collect());
    }
    Ok(all)
}

impl Splatted {
    /// Draws those of the points, ascending.
    fn draw(&mut self, projector: &Projector, points: &[DVec3], which: Vec<usize>) {
        let (width, height) = (self.width, self.height);
        let of = |k: &usize| {
            let images = projector.project(points[*k]);
            let pixel = |i: &crate::camera::project::Image| {
                // the right and the lower border belong to the last column and row
                let (x, y) = ((i.x.floor() as u32).min(width - 1), (i.y.floor() as u32).min(height - 1));
                (y as usize * width as usize + x as usize, i.t)
            };
            (images.images.iter().map(pixel).collect::<Vec<_>>(), images.degenerate.is_some())
        };
        let drawn = parallel::map(&which, of);
        for (k, (images, is_degenerate)) in which.into_iter().zip(drawn) {
            self.degenerate += u64::from(is_degenerate);
            for (pixel, t) in images {
                if t < self.t[pixel] {
                    (self.t[pixel], self.index[pixel]) = (t, k as u32);
                }
            }
        }
    }

    /// Of a list with a value for each point, that of each pixel's; `none` where there is no point.
    pub fn of_points<T: Copy>(&self, list: &[T], none: T) -> Vec<T> {
        self.index.iter().map(|k| list.get(*k as usize).copied().unwrap_or(none)).collect()
    }

    /// Of each pixel the linear colour of its point, white if none are given; `None` where there is no point.
    fn colors(&self, colors: Option<&[[f32; 3]]>) -> impl Iterator<Item = Option<[f32; 3]>> {
        self.index.iter().map(move |k| match (*k, colors) {
            (NO_ID, _) => None,
            (_, None) => Some([1.0; 3]),
            (k, Some(colors)) => Some(colors.get(k as usize).copied().unwrap_or_default()),
        })
    }

    /// 8-bit sRGB and coverage, four bytes a pixel, of linear colours of the points; white without them.
    pub fn rgba(&self, colors: Option<&[[f32; 3]]>) -> Vec<u8> {
        let rgba = |color: Option<[f32; 3]>| {
            let [r, g, b] = color?.map_each(srgb8);
            Some([r, g, b, 255])
        };
        self.colors(colors).flat_map(|color| rgba(color).unwrap_or_default()).collect()
    }

    /// Channels R, G, B (linear), A and t, as those of a render.
    pub fn frame(&self, colors: Option<&[[f32; 3]]>) -> Frame {
        let own: Vec<[f32; 3]> = self.colors(colors).map(Option::unwrap_or_default).collect();
        let plane = |k: usize| Plane::F32(own.iter().map(|c| c[k]).collect());
        let coverage = self.index.iter().map(|k| if *k == NO_ID { 0.0 } else { 1.0 }).collect();
        let t = self.t.iter().map(|t| *t as f32).collect();
        let planes = vec![
            (Channel::R, plane(0)),
            (Channel::G, plane(1)),
            (Channel::B, plane(2)),
            (Channel::A, Plane::F32(coverage)),
            (Channel::T, Plane::F32(t)),
        ];
        Frame { width: self.width, height: self.height, planes }
    }
}
