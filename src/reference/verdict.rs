//! Whether a pixel's answer is constant within 1/16 px of its centre, and the other candidates.

use super::beam::Beam;
use super::finding::PLACES;
use super::intersect::{Aim, Corners};
use super::margin::{Depth, MARGIN_PX, Sides, beyond, clears};
use super::{GAP, Hit, Reference, cover, nearer, upright};
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::perturb::PERTURB;
use glam::DVec3;

/// The answer for one pixel and whether it is proven safe.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The visible hit at the centre.
    pub hit: Option<Hit>,
    /// Proven: every ray of every bundle within [`MARGIN_PX`] of the centre has the same answer, and no other surface is within a
    /// relative gap of [`GAP`] in `t`.
    pub safe: bool,
    /// Ascending ids of all triangles that may be visible somewhere in the box, ties included.
    pub candidates: Vec<u32>,
    /// Some ray of the box may hit nothing.
    pub may_miss: bool,
}

/// A triangle that may be visible somewhere in the box.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    id: u32,
    corners: Corners,
    depth: Depth,
    /// Hit everywhere in the box, in range, on a visible face.
    covers: bool,
    /// Its alpha mask has no hole there.
    solid: bool,
}

/// Where a triangle's alpha mask leaves it opaque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Presence {
    Everywhere,
    Nowhere,
    Somewhere,
}

impl Reference<'_> {
    /// Judges a pixel. `bundles[0]` owns it, each bundle centred on the pixel; the others are of pieces that
    /// come within [`MARGIN_PX`] of the centre too. No bundle at all is a safe miss.
    pub fn verdict(&self, bundles: &[Bundle], t_range: [f64; 2]) -> Verdict {
        let mut all = bundles.iter().map(|b| self.verdict_of(b, t_range));
        let Some(mut verdict) = all.next() else {
            return Verdict { hit: None, safe: true, candidates: Vec::new(), may_miss: true };
        };
        for other in all {
            verdict.safe &= other.safe && verdict.candidates == other.candidates;
            verdict.may_miss |= other.may_miss;
            verdict.candidates.extend(other.candidates);
            verdict.candidates.sort_unstable();
            verdict.candidates.dedup();
        }
        verdict
    }

    fn verdict_of(&self, bundle: &Bundle, t_range: [f64; 2]) -> Verdict {
        if bundle.d == [DVec3::ZERO; 3] {
            // no ray anywhere near
            return Verdict { hit: None, safe: true, candidates: Vec::new(), may_miss: true };
        }
        let boxed = upright(bundle).and_then(|b| Beam::over(&b, MARGIN_PX).map(|beam| (b, beam)));
        let Some((bundle, beam)) = boxed else {
            // The rays break off within the box.
            let hit = self.hit(bundle, t_range);
            let candidates = hit.iter().map(|h| h.triangle).collect();
            return Verdict { hit, safe: false, candidates, may_miss: true };
        };
        let candidates = self.candidates(&bundle, &beam, t_range);
        let aim = Aim::new(bundle, self.scene_size);
        let hit = candidates.iter().filter_map(|c| self.hit_of(&aim, c.id, t_range)).fold(None, nearer);
        let covered = candidates.iter().any(|c| c.covers);
        let ids: Vec<u32> = candidates.iter().map(|c| c.id).collect();
        let may_miss = !covered && (ids.is_empty() || !cover::is_proven(self, &bundle, t_range));
        let safe = ids.is_empty() || (ids.len() == 1 && covered);
        Verdict { hit, safe, candidates: ids, may_miss }
    }

    /// All triangles that may be visible somewhere in the box, ascending by id.
    fn candidates(&self, bundle: &Bundle, beam: &Beam, t_range: [f64; 2]) -> Vec<Candidate> {
        let mut found: Vec<Candidate> = Vec::new();
        let mut front: Option<Candidate> = None;
        self.walk_in_range(bundle, beam, t_range, |id| {
            if let Some(c) = self.candidate(bundle, beam, id, t_range) {
                found.push(c);
                let key = |c: &Candidate| (c.depth.span[1], c.id);
                if c.covers && front.is_none_or(|f| key(&c) < key(&f)) {
                    front = Some(c);
                }
            }
            front.map_or(f64::INFINITY, |f| beyond(f.depth.span[1]))
        });
        if let Some(f) = front {
            found.retain(|c| {
                let hidden = clears(f.depth.span[1], c.depth.span[0])
                    || f.depth.hides(&c.depth, f.corners.parity * c.corners.parity);
                c.id == f.id || !hidden
            });
        }
        self.drop_hidden_twins(&mut found);
        found
    }

    fn candidate(&self, bundle: &Bundle, beam: &Beam, id: u32, t_range: [f64; 2]) -> Option<Candidate> {
        let corners = self.solid_corners(id)?;
        let sides = Sides::over_box(bundle, &corners, self.scene_size);
        if !sides.may_hit() {
            return None;
        }
        let presence = self.presence(bundle, id, &corners);
        if presence == Presence::Nowhere {
            return None;
        }
        let mut depth = Depth::over_box(bundle, beam, &corners, self.scene_size);
        let in_range = depth.take_ends(bundle, &corners, t_range, (self.scene_size, self.has_layers));
        let may_be = |sign: i8| sides.may_be(sign) && depth.facing != -sign;
        let may_be_seen = may_be(-1) || (may_be(1) && self.two_sided(id));
        let [near, far] = depth.span;
        let solid = presence == Presence::Everywhere;
        let covers = solid && sides.covers() && in_range;
        let in_reach = far >= t_range[0] && near <= t_range[1];
        (may_be_seen && in_reach).then_some(Candidate { id, corners, depth, covers, solid })
    }

    /// The opaque part of a triangle in the box. Holes are *sampled*, as curves are, see [`super::finding`]; at each place the weights of the
    /// corners are off by up to [`GAP`], or by what [`PERTURB`] changes, since rays that start on the triangle all meet it at one point.
    fn presence(&self, bundle: &Bundle, id: u32, corners: &Corners) -> Presence {
        if !self.mesh.has_alpha(self.own(id)) {
            return Presence::Everywhere;
        }
        let (mut there, mut gone) = (0, 0);
        for (x, y) in PLACES {
            let ray = bundle.ray(x * MARGIN_PX, y * MARGIN_PX);
            let ([u, v], change) = corners.weights_on_plane(ray.origin, ray.direction, PERTURB * self.scene_size);
            let off = GAP.max(change);
            // a ray that runs along the triangle meets all of it
            if off < 1.0 && self.is_there(id, [u + x * off, v + y * off]) {
                there += 1;
            } else if off < 1.0 {
                gone += 1;
            }
        }
        match (there, gone) {
            (0, n) if n == PLACES.len() => Presence::Nowhere,
            (n, 0) if n == PLACES.len() => Presence::Everywhere,
            _ => Presence::Somewhere,
        }
    }

    /// Of triangles over the same three positions, drops each that a lower one hides wherever it is visible
    /// itself. Leaves the rest ascending by id.
    fn drop_hidden_twins(&self, found: &mut Vec<Candidate>) {
        let place = |c: &Candidate| c.corners.v.map_each(|v| v.to_array().map_each(|x| (x + 0.0).to_bits()));
        found.sort_by_cached_key(|c| (place(c), c.id));
        let mut kept: Vec<Candidate> = Vec::with_capacity(found.len());
        for c in found.iter() {
            let hidden = kept
                .iter()
                .rev()
                .take_while(|k| k.corners.v == c.corners.v)
                .filter(|k| k.solid)
                .any(|k| self.two_sided(k.id) || (!self.two_sided(c.id) && k.corners.parity == c.corners.parity));
            if !hidden {
                kept.push(*c);
            }
        }
        kept.sort_unstable_by_key(|c| c.id);
        *found = kept;
    }
}
