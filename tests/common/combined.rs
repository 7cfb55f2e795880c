//! Frames that combine features: any set of them on a plain scene, and random ones on random scenes.

use super::any::{any, any_mesh, any_on_the_mesh, expose, with_spheres};
use super::file::{camera_of, load};
use super::gpu::{ids, words};
use super::rng::Rng;
use super::volumes::{bumps, grid, volume};
use super::{camera, layered, soup};
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{LineOrder, Lines, Readout, Sample};
use anamorph::internals::camera::moving::Moving;
use anamorph::internals::engine::combinations::{Asked, Feature};
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::plan::{Rows, Wanted};
use anamorph::internals::engine::{Engine, Method, Rendered, RunOptions};
use anamorph::internals::geometry::load::Object;
use anamorph::internals::geometry::mesh::{Material, NO_UV};
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, Plane};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::AmbientOcclusion;
use anamorph::internals::scene::projector_light::{ProjectorLight, Throw};
use anamorph::internals::scene::style::{Line, Style};
use anamorph::internals::scene::volume::Mode;
use glam::{DQuat, DVec3, Vec2};
use half::f16;
use std::collections::BTreeSet;
use std::sync::Arc;

pub const COLORS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

const MIRROR: &str = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }\n\
    mirror = { shape = \"sphere\", center = [0, 0, 0], radius = 1, count = 60 }";
const PINHOLE: &str = "kind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40";
const DISPLAY: &str = "kind = \"lightfield\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\nup = [0, 1, 0]\nwidth = 2\nheight = 2\n\
    views = [8, 8]\nfov = 40";
const COMPOSED: &str = "kind = \"composite\"\nmaster = 0\ncameras = [
    { camera = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 } },
    { camera = { kind = \"pinhole\", eye = [1, 0, 5], target = [0, 0, 0], vfov = 40 }, objects = [\"second\"] }]";
const CAUSTICS: &str = r#"image = { width = 64, height = 64 }
[camera]
kind = "pinhole"
eye = [0, 3, 6]
target = [0, 0, 0]
vfov = 45
[[mesh]]
builtin = "plane"
size = 12
[caustics]
light = { kind = "reflection",
  eye = { kind = "pinhole", eye = [0, 1.5, 0], target = [0, 3, 0], up = [0, 0, 1], vfov = 60 },
  mirror = { shape = "quadric", vertex = [0, 3, 0], axis = [0, -1, 0], curvature = 0, radius = 2 } }
receivers = [{ origin = [-2, 0, 2], u = [4, 0, 0], v = [0, 0, -4], texels = [40, 40] }]"#;

/// Features that come with a scene and a camera of their own.
const CAMERAS: [Feature; 8] = [
    Feature::Caustics,
    Feature::Curves,
    Feature::Layers,
    Feature::Optics,
    Feature::Incoherent,
    Feature::Chunks,
    Feature::CameraInMotion,
    Feature::Composed,
];

/// Features of a random scene's shapes, which are made before all others.
const MADE_FIRST: [Feature; 3] = [Feature::AlphaMasks, Feature::Blended, Feature::Spheres];

/// Features of random frames that go with any scene and camera. Pixels of an atlas show the nearest texel, which no reference has.
const RANDOM: [Feature; 16] = [
    Feature::Samples,
    Feature::Analytic,
    Feature::Certified,
    Feature::Outlines,
    Feature::Rows,
    Feature::Moving,
    Feature::AlphaMasks,
    Feature::Blended,
    Feature::Shadows,
    Feature::Pictures,
    Feature::Bands,
    Feature::Timed,
    Feature::Spheres,
    Feature::Volume,
    Feature::Gradients,
    Feature::CoverageGradients,
];

/// A frame that is asked for.
#[derive(Clone)]
pub struct Case {
    pub scene: Scene,
    pub camera: Camera,
    pub wanted: Wanted,
    pub run: RunOptions,
    /// Size of the adapter's bindings and tables, bytes.
    pub limit: u64,
    pub has: BTreeSet<Feature>,
    pub size: (u32, u32),
}

/// Bindings of 128 MiB, which split no image and no scene here.
pub const WHOLE: u64 = 1 << 27;

/// Bindings that split images into bands, and large scenes into chunks.
pub const SMALL: u64 = 1 << 15;

/// Gives all triangles an alpha mask.
fn mask(scene: &mut Scene) {
    let mesh = Arc::make_mut(&mut scene.mesh);
    let rgba = [1.0, 0.0].map(|opacity| [0.9, 0.6, 0.3, opacity].map(f16::from_f32)).to_vec();
    let texels = Arc::new(Texels { width: 2, height: 1, rgba });
    let texture = Texture { cutoff: Some(0.5), ..Texture::new(texels) };
    mesh.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::Y];
    mesh.corner_uvs = vec![[0, 1, 2]; mesh.triangles.len()];
    mesh.materials.iter_mut().for_each(|m: &mut Material| m.texture = Some(texture.clone()));
}

/// Gives all triangles an opacity.
fn blend(scene: &mut Scene) {
    mask(scene);
    let materials = &mut Arc::make_mut(&mut scene.mesh).materials;
    materials.iter_mut().for_each(|m: &mut Material| m.blend = Some(0.75));
}

/// The rows of an image see the scene one after the other, from half a frame before the frame's time to half a frame after it.
fn row_by_row(rows: u32) -> Readout {
    Readout::Lines(Lines { first: -0.5, line_time: 1.0 / f64::from(rows), order: LineOrder::Down, count: rows })
}

/// A picture of one colour, from which no surface hides another.
fn picture() -> Arc<ProjectorLight> {
    let texels = Arc::new(Texels { width: 1, height: 1, rgba: vec![[f16::ONE; 4]] });
    let throw = Throw { occlusion: false, ..Throw::default() };
    let camera = camera_of("", (1, 1), PINHOLE).unwrap();
    Arc::new(ProjectorLight::new(Arc::new(camera), Texture::new(texels), throw).unwrap())
}

impl Case {
    /// A frame of colour of a few triangles through a pinhole, one sample a pixel; or of many.
    pub fn plain(features: &[Feature], size: (u32, u32)) -> Case {
        let count = if features.contains(&Feature::Chunks) { 3000 } else { 60 };
        let scene = if features.contains(&Feature::Caustics) {
            load(CAUSTICS).unwrap()
        } else {
            super::scene(soup(&mut Rng(5), count, 0.3))
        };
        let (kind, range) = (scene.camera.kind.clone(), scene.camera.t_range);
        Case::new(scene, camera(kind, size, range), size)
    }

    /// A frame of colour, one sample a pixel.
    fn new(mut scene: Scene, camera: Camera, size: (u32, u32)) -> Case {
        // one camera of composites shows the second object, the other one all the rest
        let first = scene.mesh.triangle_count() / 2;
        let second = scene.mesh.triangle_count() - first;
        scene.objects = [("first", first), ("second", second)]
            .map(|(name, triangles)| Object { name: name.into(), triangles })
            .into();
        Case {
            camera,
            scene,
            wanted: Wanted::of(COLORS.to_vec()),
            run: RunOptions::default(),
            limit: WHOLE,
            has: BTreeSet::from([Feature::OneSample]),
            size,
        }
    }

    /// A random scene with these features, but for those that are refused beside the ones before them; the camera is a random one if none of
    /// the features has its own.
    pub fn any(rng: &mut Rng, features: &[Feature], size: (u32, u32)) -> Case {
        let has = |feature: Feature| features.contains(&feature);
        let (mut scene, camera) = match features.iter().any(|feature| CAMERAS.contains(feature)) {
            true => {
                let Case { mut scene, camera, .. } = Case::plain(features, size);
                let mut own = any_mesh(rng);
                let turn = DQuat::from_axis_angle(rng.direction(), 3.0 * rng.signed());
                own.positions.iter_mut().for_each(|p| *p = turn * *p);
                scene.mesh = match has(Feature::Chunks) || has(Feature::Caustics) {
                    true => place::merge(vec![(**scene.mesh).clone(), own]).unwrap().into(),
                    false => own.into(),
                };
                (scene, camera)
            }
            false if rng.below(4) == 0 => any_on_the_mesh(rng, size),
            false => any(rng, size),
        };
        // spheres have no masks
        if has(Feature::Blended) {
            blend(&mut scene);
        } else if has(Feature::AlphaMasks) {
            mask(&mut scene);
        }
        if has(Feature::Spheres) {
            with_spheres(rng, &mut scene);
        }
        let mut case = Case::new(scene, camera, size);
        for feature in features.iter().filter(|feature| !MADE_FIRST.contains(feature)) {
            let mut more = case.clone();
            match feature {
                Feature::Timed => expose(rng, &mut more.scene, size),
                other => more.add(*other),
            }
            if Asked::of(&more.scene, &more.camera, &more.wanted, &more.run).check().is_ok() {
                case = more;
            }
        }
        case.run.method = [Method::Auto, Method::Trace, Method::Raster][rng.below(3)];
        case
    }

    /// A set of features, in the order in which [`Case::any`] adds them: at most one that has a camera of its own, or a composite that moves.
    pub fn any_features(rng: &mut Rng) -> Vec<Feature> {
        let mut set: BTreeSet<Feature> = (0..1 + rng.below(5)).map(|_| RANDOM[rng.below(RANDOM.len())]).collect();
        if rng.below(2) == 0 {
            let own = CAMERAS[rng.below(CAMERAS.len())];
            set.insert(own);
            if own == Feature::Composed && rng.below(2) == 0 {
                set.insert(Feature::CameraInMotion);
            }
        }
        if set.contains(&Feature::Chunks) {
            // that this pair is refused turns out in the plan
            set.remove(&Feature::Analytic);
        }
        set.into_iter().collect()
    }

    /// With these features and those that come with them; `None`: they need different cameras or counts of samples.
    pub fn of(features: &[Feature], size: (u32, u32)) -> Option<Case> {
        use Feature::{Analytic, OneSample};
        let mut case = Case::plain(features, size);
        let many = features.iter().any(|f| matches!(f, Feature::Samples | Feature::Separate));
        let few = features.contains(&OneSample);
        let counts = [many, few];
        let kinds = [
            Feature::Layers,
            Feature::Curves,
            Feature::Incoherent,
            Feature::Atlas,
            Feature::CameraInMotion,
            Feature::Composed,
        ];
        let cameras =
            features.iter().filter(|f| kinds.contains(f)).count() + usize::from(features.contains(&Feature::Optics));
        // the scene with caustics is too small for bands and chunks: these pairs are left out
        let is_large = features.iter().any(|f| matches!(f, Feature::Bands | Feature::Chunks));
        let is_lit_anew = features.contains(&Feature::Caustics) && is_large;
        // a composite may move: this pair needs one camera
        let cameras = if features == [Feature::CameraInMotion, Feature::Composed] { 1 } else { cameras };
        if counts.into_iter().filter(|c| *c).count() > 1 || cameras > 1 || is_lit_anew {
            return None;
        }
        for feature in features {
            case.add(*feature);
        }
        if features.contains(&Analytic) && !few && !many {
            case.add(Feature::Samples);
        }
        let apart = [
            Feature::Timed,
            Feature::Spheres,
            Feature::Volume,
            Feature::Caustics,
            Feature::Blended,
            Feature::Curves,
            Feature::Optics,
            Feature::Incoherent,
            Feature::Composed,
            Feature::CameraInMotion,
        ];
        if case.wanted.samples > 1 && apart.iter().any(|feature| case.has.contains(feature)) {
            case.has.insert(Feature::Separate);
        }
        Some(case)
    }

    fn add(&mut self, feature: Feature) {
        self.has.insert(feature);
        let (wanted, run) = (&mut self.wanted, &mut self.run);
        let several = wanted.samples.max(4);
        let mut samples = |n: u32, more: &[Feature]| {
            wanted.samples = n;
            self.has.remove(&Feature::OneSample);
            self.has.extend(more);
        };
        match feature {
            Feature::OneSample => {}
            Feature::Samples => samples(several, &[]),
            // more than a frame takes
            Feature::Separate => samples(40, &[Feature::Samples]),
            Feature::Analytic => wanted.analytic = true,
            Feature::Certified => wanted.channels.push(Channel::Certified),
            Feature::Outlines => {
                let borders = Some(Line { colour: [0.0; 3], width: 2.0, depth: f64::INFINITY });
                self.scene.style = Style { borders, ..Style::default() };
            }
            Feature::Rows => wanted.rows = Some(Rows { first: 8, count: 16 }),
            Feature::Moving => run.moving = true,
            // its scene is there from the start
            Feature::Caustics => {}
            Feature::AlphaMasks => mask(&mut self.scene),
            Feature::Blended => {
                blend(&mut self.scene);
                self.has.insert(Feature::AlphaMasks);
            }
            Feature::Shadows => self.scene.ambient_occlusion = Some(AmbientOcclusion { rays: 4, reach: 1.0 }),
            Feature::Pictures => self.scene.projector_lights = vec![picture()],
            Feature::Layers => self.camera = layered::chain(8, 2, (3, 2), Default::default(), self.size),
            Feature::Curves => self.camera = layered::wavy(2, 0.5, false, self.size),
            Feature::Optics => self.camera = camera_of("", self.size, MIRROR).unwrap(),
            Feature::Atlas => {
                self.camera = camera_of("", self.size, &format!("{MIRROR}\nfacets = \"normals\"\natlas = 4")).unwrap();
                self.has.insert(Feature::Optics);
            }
            Feature::Incoherent => self.camera = camera_of("", self.size, DISPLAY).unwrap(),
            Feature::Bands => self.limit = SMALL,
            Feature::Chunks => {
                self.limit = SMALL;
                self.has.insert(Feature::Bands);
            }
            Feature::Timed => {
                let at = |x: f64| TimeStep {
                    positions: self.scene.mesh.positions.iter().map(|p| *p + DVec3::X * x).collect(),
                    normals: self.scene.mesh.normals.clone(),
                };
                self.scene.steps = TimeSteps::new(vec![-0.5, 0.5], vec![at(-0.5), at(0.5)]).map(Arc::new);
                self.scene.exposure.readout = row_by_row(self.size.1);
            }
            Feature::Spheres => {
                // in the place of a triangle, without its mask
                let mesh = Arc::make_mut(&mut self.scene.mesh);
                mesh.corner_uvs.first_mut().into_iter().for_each(|uvs| *uvs = [NO_UV; 3]);
                mesh.material_of[0] = mesh.materials.len() as u32;
                mesh.materials.push(Material::default());
                let centre = mesh.triangles[0][0];
                mesh.triangles[0] = [centre; 3];
                mesh.radii = vec![0.0; mesh.triangles.len()];
                mesh.radii[0] = 0.25;
            }
            Feature::Volume => {
                let points = [[0.0, 1.0, 1.0, 1.0, 0.0], [1.0, 1.0, 1.0, 1.0, 1.0]];
                let own = grid([3, 3, 3], DQuat::IDENTITY, bumps);
                self.scene.volume = Some(volume(own, &points, Mode::Composite, false));
            }
            Feature::CameraInMotion => {
                let ends = [PINHOLE.into(), PINHOLE.replace("eye = [0,", "eye = [0.3,")];
                let ends = ends.map(|keys: String| camera_of("", self.size, &keys).unwrap());
                self.scene.exposure.readout = row_by_row(self.size.1);
                self.scene.exposure.shutter = 0.1;
                let moving = Moving::new(self.scene.exposure.clone(), vec![-0.5, 0.5], ends.into()).unwrap();
                self.camera = moving.camera(None).unwrap();
            }
            Feature::Gradients => wanted.gradients = true,
            Feature::CoverageGradients => {
                (wanted.gradients, wanted.coverage_gradients) = (true, true);
                self.has.insert(Feature::Gradients);
            }
            Feature::Composed => {
                let composed = camera_of("", self.size, COMPOSED).unwrap();
                let moved = camera_of("", self.size, &COMPOSED.replace("eye = [0,", "eye = [0.3,")).unwrap();
                self.camera = match self.has.contains(&Feature::CameraInMotion) {
                    true => {
                        let ends = vec![composed, moved];
                        Moving::new(self.scene.exposure.clone(), vec![-0.5, 0.5], ends).unwrap().camera(None).unwrap()
                    }
                    false => composed,
                };
            }
        }
    }
}

/// What the reference says of a frame, pixel by pixel.
#[derive(Debug)]
pub struct Verdict {
    /// Safe pixels with another triangle than the reference's.
    pub wrong_safe: u64,
    /// Other pixels with none of the triangles near by.
    pub not_near: u64,
    /// Proven pixels with another triangle than the reference's.
    pub wrongly_proven: u64,
    pub proven: u64,
    pub safe: Vec<bool>,
    /// The first pixel that shows neither the reference's triangle nor a near candidate, and what it shows.
    pub first: Option<(usize, u32)>,
}

impl Verdict {
    pub fn wrong(&self) -> u64 {
        self.wrong_safe + self.not_near + self.wrongly_proven
    }
}

pub fn verdict(scene: &Scene, camera: &Camera, frame: &Frame) -> Verdict {
    let judged = judge(scene, camera, frame);
    let seen = compare(frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)).unwrap();
    let proven = frame.u32(Channel::Certified).unwrap_or_default();
    let is_proven = |k: &usize| proven[*k] > 0;
    let differ = |k: &usize| ids(frame)[*k] != ids(&judged.truth)[*k];
    Verdict {
        wrong_safe: seen.wrong_safe.unwrap(),
        not_near: judged.not_near,
        wrongly_proven: (0..proven.len()).filter(is_proven).filter(differ).count() as u64,
        proven: (0..proven.len()).filter(is_proven).count() as u64,
        first: (0..judged.safe.len()).find(|k| !judged.near[*k]).map(|k| (k, ids(frame)[k])),
        safe: judged.safe,
    }
}

/// A frame of these triangles.
pub fn frame_of_ids(camera: &Camera, ids: Vec<u32>) -> Frame {
    Frame { width: camera.width, height: camera.height, planes: vec![(Channel::TriangleId, Plane::U32(ids))] }
}

/// A frame of a case as rendered, with what is compared.
pub struct Compared {
    pub frame: Frame,
    pub wanted: Wanted,
    /// Rows that were wanted alone are not, to the byte, those of the whole image.
    pub rows_differ: bool,
    /// Of pixel centres; `None` for an atlas.
    pub centres: Option<Verdict>,
    /// Of some of the samples, by their numbers.
    pub samples: Vec<(u32, Verdict)>,
}

/// Renders a case and compares its triangles with the reference's, at pixel centres and at up to eight samples.
///
/// # Errors
/// What the engine says.
pub fn compared(case: &Case, engine: &mut Engine) -> Result<Compared> {
    let Case { scene, camera, run, .. } = case;
    let run = &RunOptions { repeat: u32::from(run.moving), ..run.clone() };
    // bands with lines have 24 rows, and small bindings hold five planes of these
    let t = (scene.style == Style::default()).then_some(Channel::T);
    let channels = case.wanted.channels.iter().copied().chain([Channel::TriangleId]).chain(t);
    let wanted = Wanted { channels: Channel::in_order(channels), sample_ids: true, ..case.wanted.clone() };
    let Rendered { frame, mut sample_ids, .. } = engine.render(scene, camera.clone(), &wanted, run)?;
    let mut all = Compared { frame, wanted, rows_differ: false, centres: None, samples: Vec::new() };
    if let Some(rows) = all.wanted.rows {
        // the whole image, with these rows in place of its own
        let whole = engine.render(scene, camera.clone(), &Wanted { rows: None, ..all.wanted.clone() }, run)?;
        let width = camera.width as usize;
        let (first, end) = (rows.first as usize * width, (rows.first + rows.count) as usize * width);
        let replaced = |own: &Plane, of_whole: &Plane| match (own, of_whole) {
            (Plane::F32(own), Plane::F32(all)) => Plane::F32([&all[..first], own, &all[end..]].concat()),
            (Plane::U32(own), Plane::U32(all)) => Plane::U32([&all[..first], own, &all[end..]].concat()),
            _ => unreachable!("planes of one channel"),
        };
        let pairs = all.frame.planes.iter().zip(&whole.frame.planes);
        let planes = pairs.map(|((channel, own), (_, of_whole))| (*channel, replaced(own, of_whole))).collect();
        let spliced = Frame { planes, ..whole.frame.clone() };
        all.rows_differ = words(&spliced) != words(&whole.frame);
        all.frame = spliced;
        sample_ids = whole.sample_ids;
    }
    if camera.optics.as_ref().is_some_and(|optics| optics.atlas.is_some()) {
        // pixels show the nearest texel; tests of mirrors compare that with mirrors without an atlas
        return Ok(all);
    }
    all.centres = Some(verdict(scene, camera, &all.frame));
    if all.wanted.samples > 1 {
        let offsets = sample_offsets(all.wanted.samples);
        if sample_ids.len() != offsets.len() {
            return Err(Error::work(format!("{} planes of samples, not {}", sample_ids.len(), offsets.len())));
        }
        let every = offsets.len().div_ceil(8);
        for ((number, offset), ids) in (0..).zip(offsets).zip(sample_ids).step_by(every) {
            let camera = camera.of_sample(offset.into(), Sample { number, count: all.wanted.samples })?;
            all.samples.push((number, verdict(scene, &camera, &frame_of_ids(&camera, ids))));
        }
    }
    Ok(all)
}
