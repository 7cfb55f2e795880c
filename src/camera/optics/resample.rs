//! Resampling of a mesh mirror to a given number of facets, by simplification or subdivision.
//!
//! Hou, Wei, Shum and Guo 2006, section 2.3, simplify the mirror to the camera triangles that a frame can afford.

use super::facets::Facets;
use crate::arrays::MapEach;
use crate::input::Result;
use std::collections::HashMap;

impl Facets {
    /// About `count` facets: fewer by collapsing edges where that changes the surface least; more by splitting all in four, again
    /// and again, until there are as many, with normals between those of the corners. What does not close to fewer stays.
    ///
    /// # Errors
    /// [`Error::Input`](crate::input::Error::Input) for fewer in a library that was built without the feature `simplify`.
    pub fn resampled(&self, count: usize) -> Result<Facets> {
        let mut facets = if count < self.triangles.len() { self.simplified(count)? } else { self.clone() };
        while 4 * facets.triangles.len() <= count {
            facets = facets.quartered();
        }
        Ok(facets)
    }

    #[cfg(not(feature = "simplify"))]
    fn simplified(&self, count: usize) -> Result<Facets> {
        let facets = self.triangles.len();
        Err(crate::input::Error::input(format!(
            "camera: {count} facets of a mesh of {facets}: this library is built without the feature simplify"
        )))
    }

    /// Every facet in four, by the middles of its edges.
    fn quartered(&self) -> Facets {
        let mut facets =
            Facets { positions: self.positions.clone(), normals: self.normals.clone(), ..Facets::default() };
        let (mut places, mut directions) = (HashMap::new(), HashMap::new());
        for (t, n) in self.triangles.iter().zip(&self.corner_normals) {
            let edge = |[a, b]: [usize; 2], of: &[u32; 3]| (of[a].min(of[b]), of[a].max(of[b]));
            let edges = [[0, 1], [1, 2], [2, 0]];
            let p = edges.map_each(|e| {
                let (a, b) = edge(e, t);
                *places.entry((a, b)).or_insert_with(|| {
                    facets.positions.push((self.positions[a as usize] + self.positions[b as usize]) / 2.0);
                    facets.positions.len() as u32 - 1
                })
            });
            let q = edges.map_each(|e| {
                let (a, b) = edge(e, n);
                *directions.entry((a, b)).or_insert_with(|| {
                    let sum = self.normals[a as usize] + self.normals[b as usize];
                    facets.normals.push(sum.try_normalize().unwrap_or(self.normals[a as usize]));
                    facets.normals.len() as u32 - 1
                })
            });
            let four = |c: &[u32; 3], m: [u32; 3]| [[c[0], m[0], m[2]], [m[0], c[1], m[1]], [m[2], m[1], c[2]], m];
            facets.triangles.extend(four(t, p));
            facets.corner_normals.extend(four(n, q));
        }
        facets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{icosphere, teapot};

    fn area(facets: &Facets) -> f64 {
        let one = |k: usize| {
            let [a, b, c] = facets.facet(k).corners;
            (b - a).cross(c - a).length() / 2.0
        };
        (0..facets.triangles.len()).map(one).sum()
    }

    #[test]
    fn a_ball_keeps_its_shape_with_fewer_and_with_more_facets() {
        let ball = Facets::of_mesh(&icosphere(4)).unwrap();
        for count in [100, 512, 1600] {
            let fewer = ball.resampled(count).unwrap();
            let n = fewer.triangles.len();
            assert!(n <= count && n + 8 >= count, "{n} for {count}");
            // inscribed polyhedra lose some 6 / n of the area
            assert!(area(&fewer) < area(&ball) && area(&fewer) > area(&ball) * (1.0 - 20.0 / n as f64));
            for k in 0..n {
                let f = fewer.facet(k);
                let out = (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]);
                assert!(out.dot(f.corners[0]) > 0.0, "facet {k} is flipped");
                assert!(f.corners.iter().zip(f.normals).all(|(p, n)| (*p - n).length() < 1e-6));
            }
        }
        let more = ball.resampled(100_000).unwrap();
        assert_eq!(more.triangles.len(), 16 * ball.triangles.len());
        assert!((area(&more) / area(&ball) - 1.0).abs() < 1e-12);
        assert_eq!(ball.resampled(ball.triangles.len()).unwrap(), ball);
    }

    #[test]
    fn the_papers_teapots_of_100_256_and_512_cameras() {
        let pot = Facets::of_mesh(&teapot(10)).unwrap();
        for count in [100, 256, 512] {
            let n = pot.resampled(count).unwrap().triangles.len();
            assert!(n <= count && n as f64 >= 0.9 * count as f64, "{n} for {count}");
        }
    }
}
