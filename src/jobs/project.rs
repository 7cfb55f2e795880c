//! Images of many points, as arrays.

use crate::camera::project::{Degenerate, Images, Projector};
use crate::engine::stage::solve::{Solve, Solved};
use crate::gpu::Gpu;
use crate::input::Result;
use crate::parallel;
use glam::DVec3;

/// Points per chunk: the device is at work on one while the host finishes the one before.
pub const CHUNK: usize = 1 << 16;

/// The images of N points, M in all, point by point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Projected {
    /// N + 1 numbers: the images of point k are those from `first[k]` up to, and without, `first[k + 1]`.
    pub first: Vec<u64>,
    /// Pixels right of the image's left side and below its top; M each.
    pub x: Vec<f64>,
    /// See [`Projected::x`].
    pub y: Vec<f64>,
    /// Ray parameters, M; in a chain the layer's index plus the t in it.
    pub t: Vec<f64>,
    /// Pieces, M, numbered through all layers; 0 in a ray field.
    pub piece: Vec<u32>,
    /// Of each point, N: whether it also has a curve of images (it is on a slit) or an area of them (it is an eye).
    pub degenerate: Vec<Option<Degenerate>>,
    /// How many points a kernel finished alone: theirs are the images with an error, within the bound that was allowed.
    pub by_kernel: u64,
}

/// The images of a point in a few words.
type Place = (f64, f64, f64, u32);

/// All images of all points. With a device the kernels `sift` and `solve` prove where there are none; the others are found in f64, so that
/// the numbers are those without a device, to the last bit. Where `within_px` is over 0, images that the kernels prove to be within it are
/// taken as they are, of curves too.
///
/// # Errors
/// [`crate::input::Error::Work`] where the device fails.
pub fn project_many(projector: &Projector, points: &[DVec3], gpu: Option<&Gpu>, within_px: f64) -> Result<Projected> {
    let mut all = Projected { first: vec![0], ..Projected::default() };
    let exact = |images: Images| {
        let places = images.images.iter().map(|i| (i.x, i.y, i.t, i.piece)).collect::<Vec<Place>>();
        (places, images.degenerate, false)
    };
    let Some(gpu) = gpu else {
        for chunk in points.chunks(CHUNK) {
            all.add(parallel::map(chunk, |point| exact(projector.project(*point))));
        }
        return Ok(all);
    };
    let is_near_enough = projector.camera().layers.len() == 1 && within_px > 0.0;
    let mut solve = if is_near_enough { Solve::with_curves(gpu, projector)? } else { Solve::new(gpu, projector)? };
    each_solved(&mut solve, points, CHUNK, |solve, chunk, solved| {
        let of = |(k, point): (usize, &DVec3)| {
            let proven = solved.images(0, k).filter(|_| is_near_enough);
            if let Some(images) = proven.filter(|all| all.iter().all(|i| f64::from(i.error_px) <= within_px)) {
                let place = |i: &crate::gpu::layout::SolveImage| {
                    solve.place(0, i).map(|(place, piece)| (place.x, place.y, f64::from(i.t), piece))
                };
                let mut places: Vec<Place> = images.iter().filter_map(place).collect();
                // as the host lists them: cells are no pieces
                places.sort_by(|a, b| a.3.cmp(&b.3).then(a.2.total_cmp(&b.2)));
                return (places, None, true);
            }
            exact(projector.project_below(*point, |layer| solved.nodes(layer, k)))
        };
        all.add(parallel::map(0..chunk.len(), |k| of((k, &chunk[k]))));
        Ok(())
    })?;
    Ok(all)
}

/// Calls `visit` with each chunk of at most `chunk` points and what the kernels say of it; the device is a chunk ahead.
///
/// # Errors
/// [`crate::input::Error::Work`] where the device fails; those of `visit`.
pub fn each_solved<'p>(
    solve: &mut Solve,
    points: &'p [DVec3],
    chunk: usize,
    mut visit: impl FnMut(&Solve, &'p [DVec3], &Solved) -> Result<()>,
) -> Result<()> {
    solve.adapt(points)?;
    let mut chunks = points.chunks(chunk.min(solve.points_most().max(1)));
    let mut ahead = chunks.next().map(|c| Ok::<_, crate::input::Error>((c, solve.start(c)?))).transpose()?;
    while let Some((chunk, started)) = ahead {
        let solved = solve.finish(started)?;
        ahead = chunks.next().map(|c| Ok::<_, crate::input::Error>((c, solve.start(c)?))).transpose()?;
        visit(solve, chunk, &solved)?;
    }
    Ok(())
}

impl Projected {
    fn add(&mut self, chunk: Vec<(Vec<Place>, Option<Degenerate>, bool)>) {
        for (places, degenerate, is_by_kernel) in chunk {
            for (x, y, t, piece) in places {
                self.x.push(x);
                self.y.push(y);
                self.t.push(t);
                self.piece.push(piece);
            }
            self.first.push(self.x.len() as u64);
            self.degenerate.push(degenerate);
            self.by_kernel += u64::from(is_by_kernel);
        }
    }
}
