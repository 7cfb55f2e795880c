//! What rays make stiff: slits, double and complex roots, caustics, folds and poles.

use super::{BY_CURVES, BY_PIECES, BY_RAYS, Family, Rng, Triangle, cloud, glc, scene};
use crate::bench::case::Source;
use glam::DVec3;

pub fn families() -> Vec<Family> {
    vec![
        Family {
            name: "slit in the scene",
            parameter: "size across the slit of the triangles on it",
            values: &[1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12],
            scene: slit_in_the_scene,
            rivals: BY_PIECES,
        },
        Family {
            name: "slits at infinity",
            parameter: "share by which the image grows over the scene",
            values: &[1e-1, 1e-4, 1e-7, 1e-10, 1e-13, 1e-15],
            scene: slits_at_infinity,
            rivals: BY_PIECES,
        },
        Family {
            name: "double root",
            parameter: "half the distance of two slits",
            values: &[3e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: double_root,
            rivals: BY_PIECES,
        },
        Family {
            name: "complex roots",
            parameter: "image at the narrowest place",
            values: &[3e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: complex_roots,
            rivals: BY_PIECES,
        },
        Family {
            name: "before and behind the image plane",
            parameter: "depth of the scene about it",
            values: &[1.0, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: about_the_plane,
            rivals: BY_PIECES,
        },
        Family {
            name: "both faces of a triangle",
            parameter: "share of the rays along its normal",
            values: &[3e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: both_faces,
            rivals: BY_PIECES,
        },
        Family {
            name: "caustic surface",
            parameter: "size of the triangles on it",
            values: &[3e-1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6],
            scene: caustic_surface,
            rivals: BY_PIECES,
        },
        Family {
            name: "all around an axis",
            parameter: "distance of the triangles from it",
            values: &[3e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: around_an_axis,
            rivals: BY_RAYS,
        },
        Family {
            name: "pieces smaller than a pixel",
            parameter: "pieces",
            values: &[1e2, 1e3, 1e4, 1e5, 1e6],
            scene: small_pieces,
            rivals: BY_PIECES,
        },
        Family {
            name: "folded volume",
            parameter: "how far the middle surface is moved",
            values: &[3e-1, 1.0, 3.0, 1e1, 3e1, 1e2],
            scene: folded_volume,
            rivals: BY_CURVES,
        },
        Family {
            name: "pole of a surface",
            parameter: "degrees of latitude about it",
            values: &[3e1, 1.0, 1e-2, 1e-4, 1e-7, 1e-10],
            scene: pole,
            rivals: BY_RAYS,
        },
        Family {
            name: "layers of a chain",
            parameter: "how far the face between them is bent",
            values: &[3e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12],
            scene: bent_layers,
            rivals: BY_PIECES,
        },
    ]
}

fn about(z: f64, half_z: f64) -> Vec<Triangle> {
    cloud(1, 200, DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 1.0, half_z), 0.35)
}

/// Along x the rays meet at z = 0, where some of the triangles are as narrow as the rays.
fn slit_in_the_scene(k: f64) -> Source {
    let narrow = cloud(2, 200, DVec3::ZERO, DVec3::new(1.0, 1.0, 1.0), 0.35);
    let narrow = narrow.into_iter().map(|t| t.map(|v| v * DVec3::new(k, 1.0, k)));
    scene(&glc(|x, y| [-x, 1.3 * y]), &narrow.chain(about(-1.5, 0.2)).collect::<Vec<_>>())
}

fn slits_at_infinity(k: f64) -> Source {
    scene(&glc(|x, y| [(1.0 + k) * x, (1.0 + 2.0 * k) * y]), &about(0.0, 1.0))
}

/// Rays pass the axis along x at z = k and along y at z = -k.
fn double_root(k: f64) -> Source {
    scene(&glc(|x, y| [x * (-2.0 - k) / (2.0 - k), y * (-2.0 + k) / (2.0 + k)]), &about(-1.2, 0.6))
}

/// Turned by almost half a turn from one plane to the other, the image is `k` of its size in the middle.
fn complex_roots(k: f64) -> Source {
    let (sin, cos) = (std::f64::consts::PI - 2.0 * k.atan()).sin_cos();
    scene(&glc(|x, y| [cos * x - sin * y, sin * x + cos * y]), &about(-1.2, 0.6))
}

fn about_the_plane(k: f64) -> Source {
    let flat: Vec<Triangle> =
        about(0.0, 1.0).into_iter().map(|t| t.map(|v| DVec3::new(v.x, v.y, 2.0 + k * v.z))).collect();
    scene(&format!("{}\nt_range = [-inf, inf]", glc(|x, y| [1.4 * x, 0.8 * y])), &flat)
}

/// Upright triangles along the view, seen from the left and from the right by rays that lean by `k`.
fn both_faces(k: f64) -> Source {
    let mut rng = Rng(3);
    let upright: Vec<Triangle> = (0..120)
        .map(|_| {
            let (x, y) = (rng.signed(), rng.signed());
            [0, 1, 2].map(|_| DVec3::new(x, y + 0.5 * rng.signed(), 1.5 * rng.signed()))
        })
        .collect();
    scene(&glc(|x, y| [x * (1.0 + 4.0 * k) + 2.0 * k * y, y]), &upright)
}

/// Where three rays of neighbouring pixels meet in one place: det(dX/da, dX/db, D) = 0, a cubic in t.
fn caustic_surface(k: f64) -> Source {
    let (near, far) = (
        [[-1.0, 1.0, 2.0], [1.0, 1.0, 2.3], [-1.0, -1.0, 1.6]],
        [[1.1, 0.9, -1.0], [-0.7, 0.4, -2.0], [0.3, -1.2, -1.4]],
    );
    let [n, f] = [near, far].map(|c| c.map(DVec3::from_array));
    let (steps, mut rng) = (24, Rng(4));
    let mut triangles = Vec::new();
    for (i, j) in (0..steps * steps).map(|n| (n / steps, n % steps)) {
        let [a, b] = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(steps));
        let over = |c: &[DVec3; 3]| c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]);
        let (p, d) = (over(&n), over(&f) - over(&n));
        let wide = |t: f64| {
            let [da, db] = [1, 2].map(|k| (n[k] - n[0]) * (1.0 - t) + (f[k] - f[0]) * t);
            da.dot(db.cross(d))
        };
        let ts: Vec<f64> = (0..=64).map(|k| f64::from(k) / 64.0 * 1.5).collect();
        for pair in ts.windows(2).filter(|p| wide(p[0]) * wide(p[1]) < 0.0) {
            let (mut lo, mut hi) = (pair[0], pair[1]);
            for _ in 0..60 {
                let middle = 0.5 * (lo + hi);
                if wide(lo) * wide(middle) <= 0.0 { hi = middle } else { lo = middle }
            }
            triangles.push([0, 1, 2].map(|_| p + lo * d + k * rng.vector()));
        }
    }
    scene(&format!("kind = \"glc\"\nnear = {near:?}\nfar = {far:?}"), &triangles)
}

/// Above and below the eye, and behind it where the picture's left and right border join.
fn around_an_axis(k: f64) -> Source {
    let at = |middle: DVec3, half: DVec3| cloud(5, 60, middle, half, 0.6);
    let near = |y: f64| {
        at(DVec3::ZERO, DVec3::ONE).into_iter().map(move |t| t.map(|v| DVec3::new(k * v.x, y + 0.3 * v.y, k * v.z)))
    };
    let behind = at(DVec3::new(0.0, 0.0, 3.0), DVec3::new(k, 1.5, 0.5));
    let camera = "kind = \"cylinder\"\neye = [0, 0, 0]\ntarget = [0, 0, -1]\nvfov = 170";
    scene(camera, &near(1.5).chain(near(-1.5)).chain(behind).collect::<Vec<_>>())
}

fn small_pieces(k: f64) -> Source {
    let camera = format!(
        "kind = \"fisheye\"\neye = [0, 0, 2.5]\ntarget = [0, 0, 0]\nfov = 150\nframe = \"full\"\npieces = {k:.0}"
    );
    scene(&camera, &about(0.0, 1.0))
}

/// Quadratic curves whose middle is pulled through the whole scene and beyond.
fn folded_volume(k: f64) -> Source {
    let plane = |x: f64, z: f64| {
        format!("{{ kind = \"plane\", origin = [{:?}, 1, {z:?}], u = [2, 0, 0], v = [0, -2, 0] }}", x - 1.0)
    };
    let bent = format!(
        "{{ kind = \"bilinear\", corners = [[{k:?}, 1, 0.2], [{:?}, 1.3, -0.4], [-1, {:?}, 0.1], [1, -1, {k:?}]] }}",
        -k, -k
    );
    let camera = format!("kind = \"projector\"\nsurfaces = [{}, {bent}, {}]", plane(0.0, 2.0), plane(0.2, -2.0));
    scene(&camera, &about(0.0, 1.0))
}

/// Straight rays from a small sphere to a large one, the image's upper border at the pole.
fn pole(k: f64) -> Source {
    let sphere = |radius: f64| {
        format!(
            "{{ kind = \"sphere\", center = [0, 0, 0], radius = {radius:?}, lon = [0, 360], lat = [90, {:?}] }}",
            90.0 - k
        )
    };
    let small = cloud(6, 200, DVec3::ZERO, DVec3::ONE, 0.5);
    // as wide as the rays at height 1.5
    let wide = 1.5 * k.to_radians().min(1.0).sin();
    let at = small.into_iter().map(|t| t.map(|v| DVec3::new(wide * v.x, 1.5 + 0.4 * v.y, wide * v.z)));
    scene(&format!("kind = \"projector\"\nsurfaces = [{}, {}]", sphere(0.5), sphere(3.0)), &at.collect::<Vec<_>>())
}

/// Two layers whose common face is bent by `k`, and triangles that lie along it.
fn bent_layers(k: f64) -> Source {
    let layer = |z0: [f64; 4], z1: [f64; 4]| {
        let vertex = |n: usize| {
            let [a, b] = [n % 2, n / 2].map(|v| v as f64);
            let at = |z: f64| [2.0 * a - 1.0, 1.0 - 2.0 * b, z];
            format!("{{ image = [{a:?}, {b:?}], near = {:?}, far = {:?} }}", at(z0[n]), at(z1[n]))
        };
        let vertices: Vec<String> = (0..4).map(vertex).collect();
        format!("{{ vertices = [{}], triangles = [[0, 1, 2], [1, 3, 2]] }}", vertices.join(", "))
    };
    let bent = [k, -k, -k, k];
    let camera = format!("kind = \"chain\"\nlayers = [{}, {}]", layer([2.0; 4], bent), layer(bent, [-2.0; 4]));
    let flat = about(0.0, 1.0).into_iter().map(|t| t.map(|v| DVec3::new(v.x, v.y, k * v.z)));
    scene(&camera, &flat.collect::<Vec<_>>())
}
