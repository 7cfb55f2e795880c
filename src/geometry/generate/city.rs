//! A town of boxes: blocks between streets, buildings of one to three tiers, and windows until the count is met.

mod plan;

use glam::DVec3;

use super::boxes::{OPEN_BOX_TRIANGLES, push_open_box};
use super::{MAX_BLOCKS, materials};
use crate::geometry::mesh::{MAX_TRIANGLES, Mesh};
use crate::input::{Error, Result};
use plan::{GLASS, MATERIALS, PITCH, Plan, STREET, Tier};

/// Triangles a block has on average before windows: ground 2, slab 10, and about four buildings of one to three
/// tiers; and as much again for windows. It affects only the appearance.
const TRIANGLES_PER_BLOCK: f64 = 160.0;

/// Windows fill this much of their share of a wall, in width and in height.
const WINDOW_SHARE: f64 = 0.6;
/// How far windows stand out, in scene units at most, and at most in parts of their width.
const WINDOW_DEPTH: f64 = 0.04;
const WINDOW_DEPTH_PER_WIDTH: f64 = 0.25;

/// A city of exactly `triangles` triangles on `blocks` x `blocks` blocks (by default about 1 per 160 triangles),
/// each 6.25 x 6.25 units with its streets: 100 x 100 units for 16 blocks a side, about the origin, streets on
/// y = 0, towers in the middle up to about 26 high. No normals: all is flat. Materials: asphalt, pavement, park, five
/// kinds of wall, glass.
///
/// Ids run block by block: first all ground (2 a block), then each block's slab, and its buildings tier by tier
/// with their windows. Up to 9 of the ground's triangles make the count exact.
///
/// # Errors
/// [`Error::Input`] naming `triangles` if the city without windows has more, or over 2^28.
pub fn city(seed: u64, blocks: Option<u32>, triangles: u64) -> Result<Mesh> {
    let plan = match blocks {
        Some(blocks) => Plan::new(seed, blocks),
        None => plan_for(seed, triangles),
    };
    let plain = plan.plain_triangles();
    if triangles < plain || triangles > MAX_TRIANGLES as u64 {
        let blocks = plan.blocks;
        return Err(Error::input(format!(
            "triangles = {triangles}: use {plain} to {MAX_TRIANGLES} for a city with blocks = {blocks}"
        )));
    }
    let (windows, odd) = ((triangles - plain) / OPEN_BOX_TRIANGLES, (triangles - plain) % OPEN_BOX_TRIANGLES);
    let mut mesh = Mesh {
        triangles: Vec::with_capacity(triangles as usize),
        material_of: Vec::with_capacity(triangles as usize),
        materials: materials(&MATERIALS),
        ..Mesh::default()
    };
    push_ground(&mut mesh, plan.blocks, odd as u32);
    let mut windows = Windows { total: windows, all_walls: plan.wall_area(), walls_so_far: 0.0, made: 0 };
    let last = plan.tiers.iter().rposition(|tier| tier.has_windows);
    for (k, tier) in plan.tiers.iter().enumerate() {
        let edges = [DVec3::Z * tier.size.z, DVec3::X * tier.size.x, DVec3::Y * tier.size.y];
        push_open_box(&mut mesh, tier.low, edges, tier.material);
        if tier.has_windows {
            windows.push_on(&mut mesh, tier, Some(k) == last);
        }
    }
    Ok(mesh)
}

/// The largest plan near the usual density that `triangles` suffice for; one block if none does.
fn plan_for(seed: u64, triangles: u64) -> Plan {
    let mut blocks = ((triangles as f64 / TRIANGLES_PER_BLOCK).sqrt().round() as u32).clamp(1, MAX_BLOCKS as u32);
    loop {
        let plan = Plan::new(seed, blocks);
        if blocks == 1 || plan.plain_triangles() <= triangles {
            return plan;
        }
        blocks -= 1;
    }
}

/// Appends the grid of `blocks` x `blocks` squares on y = 0, of two triangles each. The last has `odd` triangles
/// more: a fan to points on its outer edge.
fn push_ground(mesh: &mut Mesh, blocks: u32, odd: u32) {
    let place = |k: u32| PITCH * (f64::from(k) - f64::from(blocks) / 2.0);
    let side = blocks + 1;
    for row in 0..side {
        mesh.positions.extend((0..side).map(|column| DVec3::new(place(column), 0.0, place(row))));
    }
    for row in 0..blocks {
        for column in 0..blocks {
            let a = row * side + column;
            let (b, c, d) = (a + 1, a + side, a + side + 1);
            mesh.triangles.push([a, c, d]);
            let is_last = row + 1 == blocks && column + 1 == blocks;
            let mut from = d;
            for k in (1..=odd).rev().filter(|_| is_last) {
                let z = place(row) + PITCH * f64::from(k) / f64::from(odd + 1);
                let to = mesh.positions.len() as u32;
                mesh.positions.push(DVec3::new(place(blocks), 0.0, z));
                mesh.triangles.push([a, from, to]);
                from = to;
            }
            mesh.triangles.push([a, from, b]);
        }
    }
    mesh.material_of.resize(mesh.triangles.len(), STREET);
}

/// Shares `total` windows out over all walls by area.
struct Windows {
    total: u64,
    all_walls: f64,
    walls_so_far: f64,
    made: u64,
}

impl Windows {
    /// Appends the windows of a tier's four walls; the last tier takes what rounding has left.
    fn push_on(&mut self, mesh: &mut Mesh, tier: &Tier, is_last: bool) {
        let (low, size) = (tier.low, tier.size);
        let (x, z) = (DVec3::X * size.x, DVec3::Z * size.z);
        // Each wall: its lower left corner and its edge to the right, seen from outside.
        let walls = [(low + z, x), (low + x + z, -z), (low + x, -x), (low, z)];
        for (k, (corner, right)) in walls.into_iter().enumerate() {
            let width = right.length();
            self.walls_so_far += width * size.y;
            let share = (self.walls_so_far / self.all_walls * self.total as f64) as u64;
            let target_count = if is_last && k + 1 == walls.len() { self.total } else { share.min(self.total) };
            push_windows(mesh, corner, right / width, width, size.y, target_count - self.made);
            self.made = target_count;
        }
    }
}

/// Appends `count` windows in rows from below to a wall `width` x `height`, evenly spaced.
fn push_windows(mesh: &mut Mesh, corner: DVec3, right: DVec3, width: f64, height: f64, count: u64) {
    if count == 0 {
        return;
    }
    let columns = ((count as f64 * width / height).sqrt().ceil() as u64).clamp(1, count);
    let rows = count.div_ceil(columns);
    let cell = DVec3::new(width / columns as f64, height / rows as f64, 0.0);
    let depth = WINDOW_DEPTH.min(WINDOW_DEPTH_PER_WIDTH * WINDOW_SHARE * cell.x.min(cell.y));
    let margin = (1.0 - WINDOW_SHARE) / 2.0;
    let edges = [right * (WINDOW_SHARE * cell.x), DVec3::Y * (WINDOW_SHARE * cell.y), right.cross(DVec3::Y) * depth];
    for k in 0..count {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        let origin = corner + right * ((column + margin) * cell.x) + DVec3::Y * ((row + margin) * cell.y);
        push_open_box(mesh, origin, edges, GLASS);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_sound, bounds};
    use super::*;

    #[test]
    fn every_count_is_exact() {
        for triangles in (15_000..15_020).chain([600, 35_000, 250_007]) {
            let mesh = city(5, None, triangles).unwrap();
            assert_eq!(mesh.triangles.len() as u64, triangles);
        }
        for blocks in [1, 2, 3] {
            assert_eq!(city(9, Some(blocks), 20_003).unwrap().triangles.len(), 20_003);
        }
        let plain = Plan::new(5, 16).plain_triangles();
        assert_eq!(city(5, Some(16), plain).unwrap().triangles.len() as u64, plain);
        let message = city(5, Some(16), plain - 1).unwrap_err().to_string();
        assert!(message.contains(&format!("use {plain} to")), "{message}");
    }

    #[test]
    fn sixteen_blocks_are_a_hundred_units() {
        let mesh = city(1, Some(16), 35_000).unwrap();
        assert_sound(&mesh);
        let (low, high) = bounds(&mesh);
        assert_eq!((low, high.x, high.z), (DVec3::new(-50.0, 0.0, -50.0), 50.0, 50.0));
        assert!((8.0..27.0).contains(&high.y), "{high}");
        let used = |m: u32| mesh.material_of.contains(&m);
        assert!((0..MATERIALS.len() as u32).all(used));
        assert_ne!(mesh, city(2, Some(16), 35_000).unwrap());
    }

    #[test]
    fn no_triangle_faces_down_to_the_ground_or_has_no_area() {
        let mesh = city(3, Some(4), 12_345).unwrap();
        for ([a, b, c], material) in mesh.triangles.iter().zip(&mesh.material_of) {
            let [a, b, c] = [a, b, c].map(|&i| mesh.positions[i as usize]);
            let cross = (b - a).cross(c - a);
            assert!(cross != DVec3::ZERO);
            // Only windows have undersides.
            assert!(*material == GLASS || cross.y >= 0.0);
        }
    }
}
