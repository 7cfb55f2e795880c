//! The passes of a frame whose rays are turned: a tree of branches, each pass below the one whose rays it turns.

use crate::camera::optics::{Branch, Optics};
use glam::DVec2;

/// One look along rays, after so many turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    pub turns: u32,
    /// What the last turn made of the rays.
    pub branch: Branch,
    /// Of normals, at all turns.
    pub tilt: DVec2,
    /// Of the light, at the last turn.
    pub scale: f64,
    /// It says what is seen; others only add light.
    pub is_main: bool,
}

/// All passes, each after the one whose rays it turns and before any other of as many turns or fewer: the rays after a number
/// of turns are needed until the next pass of as many. The first is the eye's own.
pub fn passes(optics: Option<&Optics>) -> Vec<Pass> {
    let eye = Pass { turns: 0, branch: Branch::Main, tilt: DVec2::ZERO, scale: 1.0, is_main: true };
    let mut list = vec![eye];
    let Some(optics) = optics.filter(|o| o.atlas.is_none()) else { return list };
    let tilts = optics.tilts();
    for (k, tilt) in tilts.iter().enumerate() {
        let first = Pass { tilt: *tilt, scale: 1.0 / tilts.len() as f64, is_main: k == 0, ..eye };
        add_below(&mut list, optics, first);
    }
    list
}

fn add_below(list: &mut Vec<Pass>, optics: &Optics, above: Pass) {
    if above.turns == optics.depth {
        return;
    }
    for &branch in optics.branches() {
        let scale = if above.turns == 0 { above.scale } else { 1.0 };
        let is_main = above.is_main && branch == Branch::Main;
        let pass = Pass { turns: above.turns + 1, branch, scale, is_main, ..above };
        list.push(pass);
        add_below(list, optics, pass);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::optics::{Quadric, Smooth, Surface, Turn};
    use glam::DVec3;

    fn optics(depth: u32, fresnel: bool, rays: u32) -> Optics {
        let ball = Surface::Smooth(Smooth::Quadrics(vec![Quadric::sphere(DVec3::ZERO, 1.0)]));
        let roughness = if rays > 1 { 0.1 } else { 0.0 };
        Optics { fresnel, roughness, rays, ..Optics::new(Turn::Refract { ior: 1.5 }, ball, depth) }
    }

    #[test]
    fn every_word_of_branches_is_walked_once_and_rays_are_there_when_they_are_turned() {
        assert_eq!(passes(None).len(), 1);
        for (depth, fresnel, rays, count) in [(1, false, 1, 2), (4, false, 1, 5), (3, true, 1, 15), (2, true, 5, 31)] {
            let list = passes(Some(&optics(depth, fresnel, rays)));
            assert_eq!(list.len(), count);
            // rays after k turns come from the last pass of k - 1 turns
            for pair in list.windows(2) {
                assert!(pair[1].turns <= pair[0].turns + 1 && pair[1].turns > 0);
            }
            assert_eq!(list.iter().filter(|p| p.is_main).count() as u32, depth + 1);
            let light: f64 = list.iter().filter(|p| p.turns == 1 && p.branch == Branch::Main).map(|p| p.scale).sum();
            assert!((light - 1.0).abs() < 1e-15);
        }
    }
}
