//! Reorders pixels so that neighbours have similar rays.
//!
//! Neighbouring pixels of a lenslet display or of a scanner's shot list look in all directions, so bounds on the rays of a tile cull
//! nothing. Sorted by their rays, they fill tiles as narrow as any camera's. The frame is put back in order after read-back.

use super::project::beam::Beam;
use super::project::tree::morton;
use super::{Camera, Field, Rays};
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::geometry::interleave::{KEY_BITS, interleaved};
use crate::parallel;
use glam::DVec3;

/// Number of tiles sampled to decide whether rays are incoherent.
const TILES_SAMPLED: u32 = 64;

/// Rays are incoherent where those of a tile differ by this share of what those of the whole image do, on average. Of an image
/// whose rays rotate steadily it is some 8 pixels over its width.
const INCOHERENT: f64 = 0.25;

/// The camera with its pixels in the order of their rays ([`Camera::pixel_order`]), if it is one field of incoherent rays, which look at a
/// scene about `centre`.
pub fn reordered(camera: &Camera, centre: DVec3) -> Option<Camera> {
    let field = incoherent_field(camera)?;
    let order = order(field, centre);
    let layers = vec![Rays::Field(field.reordered(&order))];
    Some(Camera { layers, pixel_order: Some(order.into()), ..camera.clone() })
}

/// Values of a reordered image in the camera's own order.
pub fn restored<T: Copy + Default>(order: &[u32], values: &[T]) -> Vec<T> {
    let mut own = vec![T::default(); values.len()];
    order.iter().zip(values).for_each(|(k, v)| own[*k as usize] = *v);
    own
}

/// For each pixel of the reordered image the index of the field's pixel.
fn order(field: &Field, centre: DVec3) -> Vec<u32> {
    let count = field.width * field.height;
    let ray = |k: u32| field.ray(k % field.width, k / field.width);
    let starts: Vec<DVec3> = (0..count).filter_map(|k| ray(k).map(|(p, _)| p)).collect();
    let far = (centre - starts.iter().sum::<DVec3>() / starts.len().max(1) as f64).length();
    // where a ray starts, and the vector from there to the distance of the scene's centre: a tile bounds these separately, so
    // that its rays must be near each other in both
    let parts = |k: u32| ray(k).map(|(p, d)| [p, far * d.normalize()]);
    let about = |k: u32| parts(k).map(|[p, d]| Beam::about(p, d, 0.0, 0.0));
    let all = parallel::reduce(0..count, about, |a, b| a.joined(&b)).unwrap_or(Beam::NONE);
    let [lo, hi] = [0, 1].map_each(|end| [all.p[end], all.d[end]]);
    let size = [0, 1].map_each(|k| (hi[k] - lo[k]).max_element()).into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let unit = f64::from((1 << KEY_BITS) - 1) / size;
    // pixels without a ray go last
    let key = |k: u32| parts(k).map_or(u64::MAX, |p| interleaved([0, 1].map_each(|k| (p[k] - lo[k]) * unit)));
    let mut sorted: Vec<(u64, u32)> = parallel::map(0..count, |k| (key(k), k));
    parallel::sort(&mut sorted);
    let mut source = vec![0; count as usize];
    for (place, (_, k)) in tile_by_tile(field.width, field.height).into_iter().zip(sorted) {
        source[place as usize] = k;
    }
    source
}

/// Whether the rays are incoherent, or were before sorting.
pub fn is_incoherent(camera: &Camera) -> bool {
    is_reordered(camera) || incoherent_field(camera).is_some()
}

/// Whether the camera's pixels are sorted by their rays.
pub fn is_reordered(camera: &Camera) -> bool {
    matches!(camera.layers.as_slice(), [Rays::Field(field)] if field.is_reordered)
}

/// The camera's one field of incoherent rays.
fn incoherent_field(camera: &Camera) -> Option<&Field> {
    let [Rays::Field(field)] = camera.layers.as_slice() else { return None };
    (!field.is_stacked() && has_incoherent_rays(field)).then_some(field)
}

/// Whether directions differ within tiles nearly as much as between them. Of a tile with several parts of the image it is one part.
fn has_incoherent_rays(field: &Field) -> bool {
    // whole tiles, or one part of a tile where the image is narrower
    let (tiles_x, tiles_y) = ((field.width / TILE).max(1), (field.height / TILE).max(1));
    let tiles = tiles_x * tiles_y;
    if tiles < 4 {
        return false;
    }
    let is_inside = |i: u32, j: u32| i < field.width && j < field.height;
    let ray = |i: u32, j: u32| is_inside(i, j).then(|| field.ray(i, j)).flatten();
    let direction = |i: u32, j: u32| ray(i, j).map(|(_, d)| (field.part(i, j), d.normalize()));
    let step = tiles.div_ceil(TILES_SAMPLED);
    let spread = |list: &[DVec3]| {
        let mean = list.iter().sum::<DVec3>() / list.len().max(1) as f64;
        list.iter().map(|d| (*d - mean).length()).sum::<f64>() / list.len().max(1) as f64
    };
    let (mut all, mut within, mut tested) = (Vec::new(), 0.0, 0.0);
    for tile in (0..tiles).step_by(step as usize) {
        let corner = (tile % tiles_x * TILE, tile / tiles_x * TILE);
        let pixels = (0..TILE * TILE).filter_map(|k| direction(corner.0 + k % TILE, corner.1 + k / TILE));
        let mut pixels = pixels.peekable();
        let part = pixels.peek().map(|(part, _)| *part);
        let own: Vec<DVec3> = pixels.filter(|(of, _)| Some(*of) == part).map(|(_, d)| d).collect();
        if !own.is_empty() {
            within += spread(&own);
            tested += 1.0;
            all.extend(own);
        }
    }
    tested > 0.0 && within / tested > INCOHERENT * spread(&all)
}

/// All pixels, tile by tile, and the tiles in squares of squares.
fn tile_by_tile(width: u32, height: u32) -> Vec<u32> {
    let tiles = (0..height.div_ceil(TILE)).flat_map(|y| (0..width.div_ceil(TILE)).map(move |x| (x, y)));
    let mut tiles: Vec<(u32, u32)> = tiles.collect();
    tiles.sort_by_key(|&(x, y)| morton(x.into(), y.into()));
    let pixels = |(x, y): (u32, u32)| {
        let inside = move |(i, j): &(u32, u32)| *i < width && *j < height;
        let all = (0..TILE * TILE).map(move |k| (x * TILE + k % TILE, y * TILE + k / TILE));
        all.filter(inside).map(move |(i, j)| j * width + i)
    };
    tiles.into_iter().flat_map(pixels).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lenslets of `n` x `n` pixels, each with the same fan of directions.
    fn lenslets(width: u32, height: u32, n: u32) -> Field {
        let pixel = |k: u32| (k % width, k / width);
        let origin = |(i, j): (u32, u32)| DVec3::new(f64::from(i / n), f64::from(j / n), 0.0);
        let direction = |(i, j): (u32, u32)| DVec3::new(f64::from(i % n) / 8.0, f64::from(j % n) / 8.0, 1.0);
        let all: Vec<(u32, u32)> = (0..width * height).map(pixel).collect();
        let (p, d): (Vec<DVec3>, Vec<DVec3>) = all.into_iter().map(|q| (origin(q), direction(q))).unzip();
        Field::new(width, height, &p, &d).unwrap()
    }

    #[test]
    fn every_pixel_is_somewhere_and_comes_back() {
        let field = lenslets(53, 37, 8);
        let order = order(&field, DVec3::new(3.0, 2.0, 9.0));
        let mut seen = order.clone();
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..53 * 37));
        assert!(restored(&order, &order).into_iter().eq(0..53 * 37));
    }

    #[test]
    fn lenslets_are_incoherent_until_they_are_reordered() {
        let field = lenslets(128, 128, 8);
        assert!(has_incoherent_rays(&field));
        let order = order(&field, DVec3::new(8.0, 8.0, 20.0));
        assert!(!has_incoherent_rays(&field.reordered(&order)));
        // one lens over all of the image: an ordinary camera
        assert!(!has_incoherent_rays(&lenslets(128, 128, 128)));
    }

    #[test]
    fn images_of_one_row_or_column_may_be_incoherent_too() {
        // directions out of order
        let list = |n: usize| {
            let directions: Vec<DVec3> = (0..n).map(|k| DVec3::new((k * 37 % n) as f64 / n as f64, 0.3, 1.0)).collect();
            (vec![DVec3::ZERO; n], directions)
        };
        for size in [(256, 1), (1, 256), (64, 4)] {
            let (p, d) = list((size.0 * size.1) as usize);
            let field = Field::new(size.0, size.1, &p, &d).unwrap();
            assert!(has_incoherent_rays(&field), "{size:?}");
            let order = order(&field, DVec3::new(0.0, 0.0, 9.0));
            assert!(!has_incoherent_rays(&field.reordered(&order)), "{size:?}");
            let mut sorted = d.clone();
            sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
            // sorted they are an ordinary camera; but each of the four rows of 64 spans a quarter of all directions
            assert!(
                size == (64, 4) || !has_incoherent_rays(&Field::new(size.0, size.1, &p, &sorted).unwrap()),
                "{size:?}"
            );
        }
    }
}
