//! The lines that say what a scene's meshes look like: creases, borders and outlines.

use crate::arrays::MapEach;
use crate::geometry::mesh::Mesh;
use crate::geometry::weld::first_in_place;
use glam::{DVec2, DVec3};
use indexmap::IndexMap;

/// Lines that are drawn at most, the longest ones.
const LINES_MAX: usize = 10_000;
/// Points that stand for meshes of more than [`TRIANGLES_MAX`].
const POINTS_MAX: usize = 3000;
const TRIANGLES_MAX: usize = 1 << 20;
/// Faces that turn by less than 30 degrees make no crease: the cosine.
const CREASE_COS: f64 = 0.866;

/// What is drawn of a mesh.
pub enum Wires {
    /// Some of so many lines.
    Lines(Vec<[DVec3; 2]>, usize),
    /// Vertices, where there are too many triangles.
    Points(Vec<DVec3>),
}

/// An edge and the third vertices of the triangles on it.
struct Edge {
    ends: [DVec3; 2],
    thirds: Vec<DVec3>,
}

/// Projects a world direction onto a page.
pub type OnPage<'a> = &'a dyn Fn(DVec3) -> DVec2;

/// The creases and borders of a mesh; as seen on a page also its outlines, and lengths are those on the page.
pub fn of(mesh: &Mesh, on_page: Option<OnPage>) -> Wires {
    if mesh.triangles.len() > TRIANGLES_MAX {
        let step = mesh.positions.len().div_ceil(POINTS_MAX);
        return Wires::Points(mesh.positions.iter().step_by(step).copied().collect());
    }
    let length = |edge: &Edge| {
        let along = edge.ends[1] - edge.ends[0];
        on_page.map_or(along.length(), |on_page| on_page(along).length())
    };
    let is_shown = |edge: &Edge| is_crease(edge) || on_page.is_some_and(|on_page| is_outline(edge, on_page));
    let shown = edges(mesh).into_iter().filter(is_shown);
    let mut lines: Vec<(f64, [DVec3; 2])> = shown.map(|e| (length(&e), e.ends)).filter(|(l, _)| *l > 0.0).collect();
    let count = lines.len();
    // stable: equal lengths stay in the order of the triangles
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    lines.truncate(LINES_MAX);
    Wires::Lines(lines.into_iter().map(|(_, ends)| ends).collect(), count)
}

/// All edges in the order of their first triangles; vertices at one place are one.
fn edges(mesh: &Mesh) -> Vec<Edge> {
    let same = first_in_place(mesh.positions.len() as u32, |v| mesh.positions[v as usize]);
    let at = |v: u32| mesh.positions[v as usize];
    let mut edges: IndexMap<(u32, u32), Edge> = IndexMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map_each(|v| same[v as usize]);
        for (from, to, third) in [(a, b, c), (b, c, a), (c, a, b)] {
            let (from, to) = (from.min(to), from.max(to));
            let edge = edges.entry((from, to));
            edge.or_insert_with(|| Edge { ends: [at(from), at(to)], thirds: Vec::new() }).thirds.push(at(third));
        }
    }
    edges.into_values().collect()
}

/// A border, or an edge where the surface turns sharply.
fn is_crease(edge: &Edge) -> bool {
    let [a, b] = edge.ends;
    let [c, d] = edge.thirds.as_slice() else { return true };
    // the faces' ways from the edge: opposite where they are one plane
    let away = |p: DVec3| (p - a).reject_from_normalized((b - a).normalize_or(DVec3::X)).normalize_or_zero();
    -away(*c).dot(away(*d)) < CREASE_COS
}

/// Both faces lie on one side of the edge as the viewer sees it.
fn is_outline(edge: &Edge, on_page: OnPage) -> bool {
    let [a, b] = edge.ends;
    let side = |p: &DVec3| on_page(b - a).perp_dot(on_page(*p - a));
    match edge.thirds.as_slice() {
        [c, d] => side(c) * side(d) > 0.0,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{Builtin, generate};
    use crate::input::Limits;

    fn lines(builtin: Builtin) -> (usize, usize) {
        let mesh = generate(&builtin, Limits::default()).unwrap();
        // seen from the side, a little from above
        let (right, up) = (DVec3::new(0.8, 0.0, -0.6), DVec3::new(-0.24, 0.9, -0.32));
        match of(&mesh, Some(&|d| DVec2::new(right.dot(d), -up.dot(d)))) {
            Wires::Lines(lines, count) => (lines.len(), count),
            Wires::Points(_) => panic!("a small mesh"),
        }
    }

    #[test]
    fn a_box_has_twelve_edges_and_a_ball_an_outline() {
        assert_eq!(lines(Builtin::Box), (12, 12));
        assert_eq!(lines(Builtin::Plane { size: 4.0, divisions: 5 }), (20, 20));
        // 1280 triangles; a closed outline crosses some 2 pi / 0.14 of the faces' sides
        let (drawn, count) = lines(Builtin::Icosphere { level: 3 });
        assert!(drawn == count && (30..100).contains(&count), "{count}");
    }

    #[test]
    fn the_longest_lines_of_many_are_drawn() {
        let (drawn, count) = lines(Builtin::City { seed: 1, blocks: None, triangles: 15_000 });
        assert!(drawn == LINES_MAX && count > LINES_MAX, "{drawn} of {count}");
    }
}
