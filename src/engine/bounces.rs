//! The bounces of a frame at a mirror or a lens: a tree of branches, each bounce below the one whose rays it reflects or refracts.

use crate::camera::optics::{Branch, Optics};
use glam::DVec2;

/// What is seen along rays, after so many bounces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounce {
    /// 0: the rays of the eye.
    pub count: u32,
    /// What the last bounce made of the rays.
    pub branch: Branch,
    /// Of normals, at all bounces.
    pub tilt: DVec2,
    /// Of the light, at the last bounce.
    pub scale: f64,
    /// It says what is seen; others only add light.
    pub is_main: bool,
}

/// All bounces in depth-first order, starting with the eye's rays: each table of rays is read by all bounces that depend on it before the
/// next bounce of the same depth overwrites it.
pub fn bounces(optics: Option<&Optics>) -> Vec<Bounce> {
    let eye = Bounce { count: 0, branch: Branch::Main, tilt: DVec2::ZERO, scale: 1.0, is_main: true };
    let mut list = vec![eye];
    let Some(optics) = optics.filter(|o| o.atlas.is_none()) else { return list };
    let tilts = optics.tilts();
    for (k, tilt) in tilts.iter().enumerate() {
        let first = Bounce { tilt: *tilt, scale: 1.0 / tilts.len() as f64, is_main: k == 0, ..eye };
        add_below(&mut list, optics, first);
    }
    list
}

fn add_below(list: &mut Vec<Bounce>, optics: &Optics, above: Bounce) {
    if above.count == optics.depth {
        return;
    }
    for &branch in optics.branches() {
        let scale = if above.count == 0 { above.scale } else { 1.0 };
        let is_main = above.is_main && branch == Branch::Main;
        let bounce = Bounce { count: above.count + 1, branch, scale, is_main, ..above };
        list.push(bounce);
        add_below(list, optics, bounce);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::optics::{self, Quadric, Smooth, Surface};
    use glam::DVec3;

    fn optics(depth: u32, fresnel: bool, rays: u32) -> Optics {
        let ball = Surface::Smooth(Smooth::Quadrics(vec![Quadric::sphere(DVec3::ZERO, 1.0)]));
        let roughness = if rays > 1 { 0.1 } else { 0.0 };
        Optics { fresnel, roughness, rays, ..Optics::new(optics::Bounce::Refract { ior: 1.5 }, ball, depth) }
    }

    #[test]
    fn every_word_of_branches_is_walked_once_and_rays_are_there_when_they_bounce() {
        assert_eq!(bounces(None).len(), 1);
        for (depth, fresnel, rays, count) in [(1, false, 1, 2), (4, false, 1, 5), (3, true, 1, 15), (2, true, 5, 31)] {
            let list = bounces(Some(&optics(depth, fresnel, rays)));
            assert_eq!(list.len(), count);
            // rays of count k come from the last bounce of count k - 1
            for pair in list.windows(2) {
                assert!(pair[1].count <= pair[0].count + 1 && pair[1].count > 0);
            }
            assert_eq!(list.iter().filter(|p| p.is_main).count() as u32, depth + 1);
            let light: f64 = list.iter().filter(|p| p.count == 1 && p.branch == Branch::Main).map(|p| p.scale).sum();
            assert!((light - 1.0).abs() < 1e-15);
        }
    }
}
