//! Any small scene that a sequence of numbers says: ordinary things, and what is hard for numerics, through cameras of every kind.

use super::cameras::{MeshShape, mesh_camera, raymap};
use super::file::camera_of;
use super::layered::{chain, wavy};
use super::rng::Rng;
use super::{ALL_T, FORWARD, camera, mesh, scene};
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::geometry::instances::{Instances, at_places};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::spheres::{Join, round_of};
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::input::Limits;
use anamorph::internals::scene::Scene;
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

type Triangle = [DVec3; 3];

/// A scene about the origin, or elsewhere and of another size, and a camera that sees it.
pub fn any(rng: &mut Rng, size: (u32, u32)) -> (Scene, Camera) {
    let scale = if rng.below(4) == 0 { 10f64.powi(rng.below(13) as i32 - 6) } else { 1.0 };
    let offset = if rng.below(4) == 0 { 10f64.powi(rng.below(6) as i32) * rng.vector() } else { DVec3::ZERO };
    let (camera, is_placed) = any_camera(rng, size, |v| scale * (v + offset));
    let mut mesh = any_mesh(rng);
    if is_placed {
        mesh.positions.iter_mut().for_each(|p| *p = scale * (*p + offset));
    }
    (scene(mesh), camera)
}

/// Such a scene whose vertices go to random places while the frame is taken, row by row or with an open shutter.
#[allow(dead_code)] // not of all programs that have this module
pub fn any_moving(rng: &mut Rng, size: (u32, u32)) -> (Scene, Camera) {
    let (mut scene, mut camera) = any(rng, size);
    expose(rng, &mut scene, size);
    camera.sample = (rng.below(2) == 0).then_some(Sample { number: 1, count: 3 });
    (scene, camera)
}

/// Lets the vertices of a scene go to random places while the frame is taken.
#[allow(dead_code)] // not of all programs that have this module
pub fn expose(rng: &mut Rng, scene: &mut Scene, size: (u32, u32)) {
    let extent = scene.bounds().map_or(1.0, |(lo, hi)| (hi - lo).length());
    let times: Vec<f64> = (0..2 + rng.below(4)).map(|k| k as f64 - 1.0).collect();
    let part = [1.0, 0.3, 0.01, 1e-6][rng.below(4)];
    let step = |_: &f64| {
        let moved = scene.mesh.positions.iter().map(|p| *p + part * extent * rng.vector());
        TimeStep { positions: moved.collect(), normals: scene.mesh.normals.clone() }
    };
    let steps = times.iter().map(step).collect();
    scene.steps = TimeSteps::new(times, steps).map(Into::into);
    let order = [LineOrder::Down, LineOrder::Up, LineOrder::Right, LineOrder::Left][rng.below(4)];
    let lines = Lines { first: -1.0, line_time: 3.0 / f64::from(size.1), order, count: size.1 };
    scene.exposure = Exposure { readout: Readout::Lines(lines), shutter: rng.unit(), is_even: rng.below(2) == 0 };
}

/// A random scene whose objects move from frame to frame, and a camera of one kind that goes along a path.
#[allow(dead_code)] // not of all programs that have this module
pub struct Path {
    pub scene: Scene,
    size: (u32, u32),
    /// Keys of the camera, with `POSE` in place of those of its pose.
    keys: String,
    /// Scale of the distance from the eye to its target.
    distance: f64,
}

#[allow(dead_code)] // not of all programs that have this module
impl Path {
    pub fn new(rng: &mut Rng, size: (u32, u32)) -> Path {
        let eye = "eye = { kind = \"pinhole\", vfov = 60, POSE }";
        let keys = match rng.below(9) {
            0 => format!("kind = \"pinhole\"\nvfov = {}\nPOSE", 10.0 + 120.0 * rng.unit()),
            1 => format!("kind = \"fisheye\"\nfov = {}\nPOSE", 30.0 + 320.0 * rng.unit()),
            2 => format!("kind = \"fisheye\"\nfov = 150\npieces = {}\nPOSE", 200 + rng.below(200)),
            3 => format!("kind = \"cylinder\"\nvfov = {}\nPOSE", 20.0 + 140.0 * rng.unit()),
            4 => format!("kind = \"cylinder\"\nfov = 250\nstrips = {}\nPOSE", 2 + rng.below(6)),
            5 => format!("kind = \"ods\"\nipd = {}\nPOSE", 0.5 * rng.unit()),
            6 => format!(
                "kind = \"cross_slit\"\nheight = 2\nslits = [{{ distance = 3, angle = {} }}, {{ distance = 2, angle = 0 }}]\nPOSE",
                20.0 + 140.0 * rng.unit()
            ),
            7 => format!(
                "kind = \"reflection\"\ndepth = 2\nmirror = {{ shape = \"sphere\", center = [0.2, 0.1, -0.3], radius = 0.7 }}\n{eye}"
            ),
            _ => format!(
                "kind = \"reflection\"\nfacets = \"normals\"\nmirror = {{ shape = \"sphere\", center = [0.2, 0.1, -0.3], radius = 0.7, count = 40 }}\n{eye}"
            ),
        };
        let distance = if rng.below(4) == 0 { 10f64.powi(1 + rng.below(3) as i32) } else { 1.0 };
        Path { scene: scene(any_mesh(rng)), size, keys, distance }
    }

    /// The same with a mesh that stands in several places, which change from frame to frame.
    pub fn placed(rng: &mut Rng, size: (u32, u32)) -> Path {
        let mut path = Path::new(rng, size);
        place_mesh(rng, &mut path.scene);
        path
    }

    /// Whether a mirror reflects the camera's rays.
    pub fn is_reflected(&self) -> bool {
        self.keys.contains("mirror")
    }

    /// Moves some of the triangles, or none, and returns the camera at its next pose.
    pub fn step(&mut self, rng: &mut Rng) -> Camera {
        if let Some(places) = self.scene.mesh.instances().map(|instances| instances.list.len()) {
            for k in (rng.below(3)..places).step_by(3) {
                let to = any_place(rng, &self.scene);
                Arc::make_mut(&mut self.scene.mesh).place(k, Some(to));
            }
        } else if rng.below(2) == 0 {
            let mesh = Arc::make_mut(&mut self.scene.mesh);
            let triangles = mesh.triangles.len();
            let first = rng.below(triangles);
            let (last, by) = (first + rng.below(triangles - first) + 1, 0.5 * rng.vector());
            mesh.positions[3 * first..3 * last].iter_mut().for_each(|p| *p += by);
        }
        let target = 0.3 * rng.vector();
        let eye = target + self.distance * (2.0 * rng.direction() + 0.3 * rng.vector());
        let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
        let pose = [("eye", eye), ("target", target), ("up", up)].map(|(key, v)| format!("{key} = {:?}", v.to_array()));
        let separator = if self.is_reflected() { ", " } else { "\n" };
        camera_of("", self.size, &self.keys.replace("POSE", &pose.join(separator))).unwrap()
    }
}

/// Such a scene whose mesh stands in several places: turned, sheared, mirrored, a tenth and ten times as large, and through each other.
#[allow(dead_code)] // not of all programs that have this module
pub fn any_placed(rng: &mut Rng, size: (u32, u32)) -> (Scene, Camera) {
    let (mut scene, camera) = any(rng, size);
    place_mesh(rng, &mut scene);
    (scene, camera)
}

/// Puts the mesh of a scene in several places, and a part of it in one.
fn place_mesh(rng: &mut Rng, scene: &mut Scene) {
    let mesh = (**scene.mesh).clone();
    let places: Vec<DAffine3> = (0..1 + rng.below(8)).map(|_| any_place(rng, scene)).collect();
    let parts = match rng.below(2) {
        0 => vec![at_places(mesh, places)],
        _ => vec![(mesh.clone(), None), at_places(mesh, places)],
    };
    scene.mesh = Arc::new(Arc::new(Instances::new(parts).unwrap()).into());
}

/// A matrix that puts the mesh of a scene anywhere about the scene's centre.
#[allow(dead_code)] // not of all programs that have this module
fn any_place(rng: &mut Rng, scene: &Scene) -> DAffine3 {
    let (lo, hi) = scene.bounds().unwrap_or((-DVec3::ONE, DVec3::ONE));
    let (centre, extent) = ((lo + hi) / 2.0, (hi - lo).length());
    let turn = match rng.below(3) {
        0 => DMat3::IDENTITY,
        1 => DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2 * rng.below(4) as f64),
        _ => DMat3::from_axis_angle(rng.direction(), 3.0 * rng.signed()),
    };
    let scale = |rng: &mut Rng| match rng.below(4) {
        0 => 10f64.powf(rng.signed()),
        1 => -1.0,
        _ => 1.0,
    };
    let sizes =
        if rng.below(3) == 0 { DVec3::new(scale(rng), scale(rng), scale(rng)) } else { DVec3::splat(scale(rng)) };
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(rng.signed(), 1.0, 0.0), DVec3::new(0.0, rng.signed(), 1.0));
    let matrix = turn * DMat3::from_diagonal(sizes) * if rng.below(3) == 0 { shear } else { DMat3::IDENTITY };
    let by = if rng.below(4) == 0 { DVec3::ZERO } else { 0.5 * extent * rng.vector() };
    DAffine3 { matrix3: matrix, translation: centre + by - matrix * centre }
}

/// Such a scene with spheres or capsules between its triangles.
#[allow(dead_code)] // not of all programs that have this module
pub fn any_with_spheres(rng: &mut Rng, size: (u32, u32)) -> (Scene, Camera) {
    let (mut scene, camera) = any(rng, size);
    with_spheres(rng, &mut scene);
    (scene, camera)
}

/// Adds spheres to a random scene, or capsules that join their centres: in it and around it, tiny and huge, two in one place, and with a
/// common centre.
#[allow(dead_code)] // not of all programs that have this module
pub fn with_spheres(rng: &mut Rng, scene: &mut Scene) {
    let (lo, hi) = scene.bounds().unwrap_or((-DVec3::ONE, DVec3::ONE));
    let extent = (hi - lo).length().max(1e-9).min(1e9 * (hi - lo).length().max(1.0));
    let mut list: Vec<(DVec3, f64)> = Vec::new();
    for _ in 0..1 + rng.below(40) {
        let centre = match rng.below(5) {
            0 => scene.mesh.positions[rng.below(scene.mesh.positions.len())],
            1 if !list.is_empty() => list[rng.below(list.len())].0,
            _ => lo + 0.5 * (rng.vector() + 1.0) * (hi - lo),
        };
        let radius = match rng.below(6) {
            0 => extent * 10f64.powf(-8.0 * rng.unit()),
            1 if !list.is_empty() => list[rng.below(list.len())].1,
            _ => 0.1 * extent * rng.unit() + 1e-3 * extent,
        };
        list.push((centre, radius));
    }
    let join = [None, None, Some(Join::Line), Some(Join::Pairs)][rng.below(4)];
    if list.len() % 2 == 1 && join == Some(Join::Pairs) {
        list.push(list[0]);
    }
    let (centres, radii) = list.into_iter().unzip();
    let mut own = round_of(centres, radii, None, join, Limits::default()).unwrap();
    own.materials[0].two_sided = rng.below(3) > 0;
    let mut all = vec![(**scene.mesh).clone(), own];
    if rng.below(2) == 0 {
        all.swap(0, 1);
    }
    scene.mesh = place::merge(all).unwrap().into();
}

/// Triangles on a coarse lattice and a camera on them: its eye or slit lies on a vertex, on an edge, within a triangle or in its plane, and its
/// rays run along the lattice.
#[allow(dead_code)] // not of all programs that have this module
pub fn any_on_the_mesh(rng: &mut Rng, size: (u32, u32)) -> (Scene, Camera) {
    let step = [1.0, 0.5, 1.0 / 3.0, 0.1][rng.below(4)];
    let reach = 2 + rng.below(3);
    let lattice = |rng: &mut Rng| {
        let one = |rng: &mut Rng| step * (rng.below(2 * reach + 1) as f64 - reach as f64);
        DVec3::new(one(rng), one(rng), one(rng))
    };
    let mut all: Vec<Triangle> = Vec::new();
    for _ in 0..1 + rng.below(40) {
        let corners = [0, 1, 2].map(|_| lattice(rng));
        all.push(match rng.below(8) {
            // in one place with another triangle, its corners in another order
            0 if !all.is_empty() => {
                let [a, b, c] = all[rng.below(all.len())];
                [c, a, b]
            }
            // shares an edge with another triangle
            1 if !all.is_empty() => {
                let [a, b, _] = all[rng.below(all.len())];
                [b, a, corners[2]]
            }
            // a sliver
            2 => [corners[0], corners[1], corners[0].lerp(corners[1], 0.5) + 1e-9 * rng.vector()],
            _ => corners,
        });
    }
    let on = |rng: &mut Rng| {
        let [a, b, c] = all[rng.below(all.len())];
        match rng.below(6) {
            0 => a,
            1 => a.lerp(b, 0.5),
            2 => (a + b + c) / 3.0,
            3 => 0.5 * a + 0.25 * (b + c),
            4 => a + (b - a) + (c - a),
            _ => lattice(rng),
        }
    };
    let eye = on(rng);
    let target = [lattice(rng), on(rng), eye + DVec3::Z][rng.below(3)];
    let target = if (target - eye).length() < 1e-6 { eye + DVec3::new(0.0, -1.0, 0.0) } else { target };
    let up = if (target - eye).normalize().y.abs() > 0.9 { [0, 0, 1] } else { [0, 1, 0] };
    let seen = format!("eye = {:?}\ntarget = {:?}\nup = {up:?}", eye.to_array(), target.to_array());
    let distance = (target - eye).length();
    let text = match rng.below(9) {
        0 => format!("kind = \"pinhole\"\n{seen}\nvfov = {}", [40, 60, 90, 120][rng.below(4)]),
        1 => format!("kind = \"orthographic\"\n{seen}\nheight = {}", 2.0 * step * reach as f64),
        2 => format!("kind = \"fisheye\"\n{seen}\nfov = {}", [90, 180, 250, 360][rng.below(4)]),
        3 => format!("kind = \"hinge\"\n{seen}\nvfov = 40\npath = {distance}\nangle = 20"),
        4 => format!("kind = \"cylinder\"\n{seen}\nvfov = 90"),
        5 => format!("kind = \"sphere\"\n{seen}"),
        6 => {
            let (end, look) = ((eye + target.any_orthogonal_vector()).to_array(), (target - eye).to_array());
            format!(
                "kind = \"pushbroom\"\nstart = {:?}\nend = {end:?}\nlook = {look:?}\nup = {up:?}\nvfov = 60",
                eye.to_array()
            )
        }
        7 => format!("kind = \"panini\"\n{seen}\nfov = 150"),
        _ => {
            let slits = "slits = [{ distance = DISTANCE, angle = 0 }, { distance = 3, angle = 90 }]";
            let slits = slits.replace("DISTANCE", &format!("{:?}", [0.5 * distance, distance][rng.below(2)]));
            format!("kind = \"cross_slit\"\n{seen}\nheight = 3\n{slits}")
        }
    };
    let range = ["", "", "t_range = [-inf, inf]", "t_range = [0, 1]", "t_range = [1, inf]"][rng.below(5)];
    let camera = camera_of("", size, &format!("{text}\n{range}"));
    let camera = camera
        .unwrap_or_else(|_| camera_of("", size, &format!("kind = \"pinhole\"\n{seen}\nvfov = 90\n{range}")).unwrap());
    let mut mesh = mesh_of(all);
    if rng.below(3) == 0 {
        mesh.materials.push(Material { two_sided: false, ..Material::default() });
        mesh.material_of.iter_mut().for_each(|m| *m = rng.below(2) as u32);
    }
    (scene(mesh), camera)
}

fn mesh_of(triangles: Vec<Triangle>) -> Mesh {
    let faces = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    mesh(triangles.into_iter().flatten().collect(), faces)
}

/// The camera, and whether it is where `place` says.
fn any_camera(rng: &mut Rng, size: (u32, u32), place: impl Fn(DVec3) -> DVec3) -> (Camera, bool) {
    let t_range = if rng.below(4) == 0 { ALL_T } else { FORWARD };
    let of = |kind: CameraKind| (camera(kind, size, t_range), true);
    let shape =
        MeshShape { normalize: rng.below(3) == 0, weights: rng.below(3) == 0, discontinuous: rng.below(4) == 0 };
    let eye = 2.0 * rng.direction() + 0.3 * rng.vector();
    let target = 0.3 * rng.vector();
    let text = |text: String| (camera_of("", size, &text).unwrap(), false);
    let seen = format!("eye = {:?}\ntarget = {:?}", eye.to_array(), target.to_array());
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    match rng.below(12) {
        0 => {
            let (eye, target) = (place(eye), place(target));
            of(CameraKind::new("pinhole", Pinhole { eye, target, up, vfov: 10.0 + 120.0 * rng.unit() }))
        }
        1 => {
            let height = (place(DVec3::X) - place(DVec3::ZERO)).length() * (0.5 + 2.0 * rng.unit());
            let (eye, target) = (place(eye), place(target));
            of(CameraKind::new("orthographic", Orthographic { eye, target, up, height }))
        }
        // between any two triangles
        2..=4 => {
            let corner = |rng: &mut Rng, z: f64| [0, 1, 2].map(|_| 1.5 * rng.vector() + DVec3::new(0.0, 0.0, z));
            let (near, far) = (corner(rng, 2.0), corner(rng, -2.0));
            of(CameraKind::new("glc", Glc { near: near.map(&place), far: far.map(&place) }))
        }
        // between two squares, turned and narrowed to nothing but a little
        5 | 6 => {
            let narrow = [0, 1].map(|_| rng.signed() * 10f64.powi(-(rng.below(15) as i32)));
            let turn = if rng.below(2) == 0 { rng.signed() } else { 0.0 };
            let map = |x: f64, y: f64| [narrow[0] * x - turn * y, narrow[1] * y + turn * x];
            let corners = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)];
            let near = corners.map(|(x, y)| DVec3::new(x, y, 2.0));
            let far = corners.map(|(x, y)| DVec3::new(map(x, y)[0], map(x, y)[1], -2.0));
            of(CameraKind::new("glc", Glc { near: near.map(&place), far: far.map(&place) }))
        }
        7 => (
            camera(mesh_camera(rng.word(), 1 + rng.below(6) as u32, 1 + rng.below(6) as u32, shape), size, t_range),
            false,
        ),
        8 => (raymap(size.0, size.1, t_range), false),
        9 => (wavy(1 + rng.below(3), 2.0 * rng.unit(), rng.below(2) == 0, size), false),
        10 => {
            let cells = (1 + rng.below(3) as u32, 1 + rng.below(3) as u32);
            (
                chain(
                    rng.word(),
                    1 + rng.below(4),
                    cells,
                    MeshShape { discontinuous: false, normalize: false, ..shape },
                    size,
                ),
                false,
            )
        }
        _ => match rng.below(3) {
            0 => text(format!("kind = \"cylinder\"\n{seen}\nvfov = {}", 20.0 + 140.0 * rng.unit())),
            1 => {
                // few pieces of a wide view are refused
                let (fov, pieces) = (30.0 + 300.0 * rng.unit(), 1 + rng.below(200));
                let of = |pieces| {
                    camera_of("", size, &format!("kind = \"fisheye\"\n{seen}\nfov = {fov}\npieces = {pieces}"))
                };
                (of(pieces).unwrap_or_else(|_| of(200 + pieces).unwrap()), false)
            }
            _ => text(format!("kind = \"fisheye\"\n{seen}\nfov = {}", 30.0 + 320.0 * rng.unit())),
        },
    }
}

/// One to a hundred triangles.
pub fn any_mesh(rng: &mut Rng) -> Mesh {
    let mut all: Vec<Triangle> = Vec::new();
    for _ in 0..1 + rng.below(4) {
        let part = any_part(rng);
        all.extend(part);
    }
    // corners on a coarse grid meet each other, and the rays
    if rng.below(4) == 0 {
        let step = 0.5f64.powi(1 + rng.below(5) as i32);
        all.iter_mut().flatten().for_each(|v| *v = (*v / step).round() * step);
    }
    let mut mesh = mesh_of(all);
    if rng.below(3) == 0 {
        mesh.materials.push(Material { two_sided: false, ..Material::default() });
        mesh.material_of.iter_mut().for_each(|m| *m = rng.below(2) as u32);
    }
    mesh
}

fn any_part(rng: &mut Rng) -> Vec<Triangle> {
    let count = 1 + rng.below(30);
    let size = if rng.below(3) == 0 { 10f64.powi(-(rng.below(9) as i32)) } else { 0.5 };
    let around = |rng: &mut Rng, at: DVec3, size: f64| [0, 1, 2].map(|_| at + size * rng.vector());
    match rng.below(7) {
        // anywhere
        0 | 1 => (0..count)
            .map(|_| {
                let at = rng.vector();
                around(rng, at, size)
            })
            .collect(),
        // needles
        2 => (0..count)
            .map(|_| {
                let (at, half_axis) = (rng.vector(), rng.vector());
                [at - half_axis, at + half_axis, at + size * rng.vector()]
            })
            .collect(),
        // a height field, each edge shared
        3 => {
            let side = 2 + rng.below(4);
            let at: Vec<DVec3> = (0..(side + 1) * (side + 1))
                .map(|n| {
                    let [x, y] = [n % (side + 1), n / (side + 1)].map(|k| 2.0 * k as f64 / side as f64 - 1.0);
                    DVec3::new(x, y, size * rng.signed())
                })
                .collect();
            let cell = |n: usize| {
                let a = n / side * (side + 1) + n % side;
                [[at[a], at[a + side + 1], at[a + 1]], [at[a + 1], at[a + side + 1], at[a + side + 2]]]
            };
            (0..side * side).flat_map(cell).collect()
        }
        // around one vertex
        4 => {
            let (centre, n) = (rng.vector(), 3 + rng.below(8));
            let rim: Vec<DVec3> = (0..n).map(|_| centre + rng.vector()).collect();
            (0..n).map(|k| [centre, rim[k], rim[(k + 1) % n]]).collect()
        }
        // in one plane, or nearly, one over the other, and some twice
        5 => {
            let (at, u, v) = (rng.vector(), rng.vector(), rng.vector());
            let off = if rng.below(2) == 0 { 0.0 } else { 10f64.powi(-(rng.below(17) as i32)) };
            let mut flat: Vec<Triangle> = (0..count)
                .map(|_| [0, 1, 2].map(|_| at + rng.signed() * u + rng.signed() * v + off * rng.vector()))
                .collect();
            let twice = flat[rng.below(flat.len())];
            flat.push([twice[2], twice[0], twice[1]]);
            flat
        }
        // without area, and far larger than what is seen
        _ => {
            let (a, b) = (rng.vector(), rng.vector());
            vec![[a, b, 0.5 * (a + b)], [a, a, b], around(rng, a, 1e4), around(rng, b, 1e9 * size)]
        }
    }
}
