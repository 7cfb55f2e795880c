//! What triangles make stiff: needles, swarms, what lies on the rays, far away, or one behind the other.

use super::{ALONG_Z, BY_PIECES, Family, Rng, Triangle, cloud, glc, scene};
use crate::bench::case::Source;
use glam::DVec3;

pub fn families() -> Vec<Family> {
    vec![
        Family {
            name: "edge-on",
            parameter: "width of the triangles as seen",
            values: &[1e-1, 1e-3, 1e-5, 1e-7, 1e-10, 1e-13],
            scene: edge_on,
            rivals: BY_PIECES,
        },
        Family {
            name: "needles",
            parameter: "width over length",
            values: &[1e-1, 1e-3, 1e-5, 1e-7, 1e-10, 1e-13],
            scene: needles,
            rivals: BY_PIECES,
        },
        Family {
            name: "swarm",
            parameter: "px that a triangle is large",
            values: &[3.0, 1.0, 1e-1, 1e-2, 1e-3, 1e-5],
            scene: swarm,
            rivals: BY_PIECES,
        },
        Family {
            name: "vertices on rays",
            parameter: "px from the rays to the vertices",
            values: &[1e-1, 1e-4, 1e-7, 1e-10, 1e-13, 0.0],
            scene: vertices_on_rays,
            rivals: BY_PIECES,
        },
        Family {
            name: "eye on the mesh",
            parameter: "distance from the eye to the triangle that it lies on",
            values: &[1e-1, 1e-4, 1e-8, 1e-12, 1e-15, 0.0],
            scene: eye_on_the_mesh,
            rivals: BY_PIECES,
        },
        Family {
            name: "far from the origin",
            parameter: "distance over the scene's size",
            values: &[1e1, 1e3, 1e5, 1e7, 1e9, 1e11, 1e13],
            scene: far_away,
            rivals: BY_PIECES,
        },
        Family {
            name: "deep",
            parameter: "farthest over nearest",
            values: &[1e1, 1e2, 1e4, 1e7, 1e10, 1e14],
            scene: deep,
            rivals: BY_PIECES,
        },
        Family {
            name: "nearly equal depths",
            parameter: "distance of the layers over theirs from the eye",
            values: &[1e-2, 1e-4, 1e-6, 1e-8, 1e-11, 1e-14],
            scene: equal_depths,
            rivals: BY_PIECES,
        },
        Family {
            name: "small",
            parameter: "size of the whole scene",
            values: &[1e-2, 1e-5, 1e-10, 1e-15, 1e-20, 1e-30, 1e-40],
            scene: |k| scaled(k),
            rivals: BY_PIECES,
        },
        Family {
            name: "large",
            parameter: "size of the whole scene",
            values: &[1e2, 1e5, 1e8, 1e12, 1e20, 1e30, 1e38],
            scene: |k| scaled(k),
            rivals: BY_PIECES,
        },
    ]
}

/// Upright triangles, turned by so little from the rays.
fn edge_on(k: f64) -> Source {
    let mut rng = Rng(11);
    let turned: Vec<Triangle> = (0..400)
        .map(|_| {
            let at = rng.vector();
            [0, 1, 2].map(|_| at + DVec3::new(k * rng.signed(), 0.3 * rng.signed(), 0.6 * rng.signed()))
        })
        .collect();
    scene(ALONG_Z, &turned)
}

fn needles(k: f64) -> Source {
    let mut rng = Rng(12);
    let mut needles = Vec::new();
    for _ in 0..300 {
        let (at, half_axis, side) = (rng.vector(), rng.vector(), rng.vector());
        needles.push([at - half_axis, at + half_axis, at + k * side]);
    }
    scene(&glc(|x, y| [1.4 * x, 0.8 * y]), &needles)
}

fn swarm(k: f64) -> Source {
    scene(&glc(|x, y| [1.4 * x, 0.8 * y]), &cloud(13, 20_000, DVec3::ZERO, DVec3::ONE, k / 48.0))
}

/// A height field whose vertices lie on the rays of every third pixel, up to so much.
fn vertices_on_rays(k: f64) -> Source {
    let mut rng = Rng(14);
    let side = 32;
    // exact, and so are all sums with it
    let px = 1.0 / 32.0;
    let at: Vec<DVec3> = (0..=side * side + 2 * side)
        .map(|n| {
            let [i, j] = [n % (side + 1), n / (side + 1)].map(|v| f64::from(3 * v) + 0.5);
            let off = k * px * rng.vector();
            DVec3::new(i * px - 1.5 + off.x, 1.5 - j * px + off.y, 0.5 * rng.signed())
        })
        .collect();
    let mut triangles = Vec::new();
    for (i, j) in (0..side * side).map(|n| (n % side, n / side)) {
        let [a, b] = [j, j + 1].map(|row| (row * (side + 1) + i) as usize);
        triangles.push([at[a], at[b], at[a + 1]]);
        triangles.push([at[a + 1], at[b], at[b + 1]]);
    }
    scene(&ALONG_Z.replace("height = 2", "height = 3"), &triangles)
}

/// Triangles between the points of a lattice, many of them in one plane or in one place, around an eye on one of them.
fn eye_on_the_mesh(k: f64) -> Source {
    let mut rng = Rng(19);
    let mut lattice = || 0.5 * (2.0 * rng.vector()).round();
    let triangles: Vec<Triangle> = (0..120).map(|_| [0, 1, 2].map(|_| lattice())).collect();
    // not all of them are slivers or points
    let on = triangles
        .iter()
        .find(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 0.1)
        .map_or(DVec3::ZERO, |t| 0.5 * t[0] + 0.25 * (t[1] + t[2]));
    let eye = on + k * DVec3::new(0.6, 0.0, 0.8);
    let target = eye - DVec3::Z;
    scene(
        &format!("kind = \"pinhole\"\neye = {:?}\ntarget = {:?}\nvfov = 90", eye.to_array(), target.to_array()),
        &triangles,
    )
}

/// The camera too.
fn far_away(k: f64) -> Source {
    let there = DVec3::new(k, -0.7 * k, 0.4 * k);
    let cloud = cloud(15, 200, there, DVec3::ONE, 0.35);
    let eye = (there + DVec3::new(0.2, 0.3, 4.0)).to_array();
    scene(&format!("kind = \"pinhole\"\neye = {eye:?}\ntarget = {:?}\nvfov = 35", there.to_array()), &cloud)
}

/// As large as seen at all depths, and a strip from near to far.
fn deep(k: f64) -> Source {
    let mut rng = Rng(16);
    let mut triangles: Vec<Triangle> = (0..300)
        .map(|_| {
            let depth = k.powf(rng.signed() / 2.0);
            let at = DVec3::new(rng.signed(), rng.signed(), -1.0);
            [0, 1, 2].map(|_| depth * (at + 0.3 * rng.vector() * DVec3::new(1.0, 1.0, 0.5)))
        })
        .collect();
    let (near, far) = (k.powf(-0.5), k.sqrt());
    let floor = |x: f64, d: f64| d * DVec3::new(x, -0.6, -1.0);
    triangles.push([floor(-1.0, near), floor(1.0, near), floor(0.4, far)]);
    scene("kind = \"pinhole\"\neye = [0, 0, 0]\ntarget = [0, 0, -1]\nvfov = 90", &triangles)
}

/// Large parallel triangles in turn, one so little behind the other.
fn equal_depths(k: f64) -> Source {
    let mut rng = Rng(17);
    let layers: Vec<Triangle> = (0..60)
        .map(|n| {
            let z = -2.0 * k * f64::from(n % 6);
            [0, 1, 2].map(|_| DVec3::new(1.3 * rng.signed(), 1.3 * rng.signed(), z))
        })
        .collect();
    scene(&glc(|x, y| [1.4 * x, 0.8 * y]), &layers)
}

fn scaled(k: f64) -> Source {
    let cloud = cloud(18, 200, DVec3::ZERO, DVec3::ONE, 0.35);
    let cloud: Vec<Triangle> = cloud.into_iter().map(|t| t.map(|v| k * v)).collect();
    let eye = [0.2 * k, 0.3 * k, 4.0 * k];
    scene(&format!("kind = \"pinhole\"\neye = {eye:?}\ntarget = [0, 0, 0]\nvfov = 35"), &cloud)
}
