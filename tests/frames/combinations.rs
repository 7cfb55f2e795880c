//! What goes together in a frame: every refused pair is tried and gives its own line, every other pair is planned, and the page says
//! what the table says.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{LineOrder, Lines, Readout, Sample};
use anamorph::internals::camera::moving::Moving;
use anamorph::internals::engine::combinations::{Asked, Feature, REFUSALS, Refusal};
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::plan::{Rows, Wanted};
use anamorph::internals::engine::planned::Planner;
use anamorph::internals::engine::rival::{Choice, MULTISAMPLES, NOT_RENDERED};
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::load::Object;
use anamorph::internals::geometry::mesh::Material;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::jobs::Backend;
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::AmbientOcclusion;
use anamorph::internals::scene::projector_light::{ProjectorLight, Throw};
use anamorph::internals::scene::style::{Line, Style};
use anamorph::internals::scene::volume::Mode;
use anamorph_lab::rivals::TECHNIQUES;
use common::file::{camera_of, load};
use common::gpu::{engine_on, ids, limit_bindings};
use common::rng::Rng;
use common::volumes::{bumps, grid, volume};
use common::{camera, layered, soup};
use glam::{DQuat, DVec3, Vec2};
use half::f16;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

const PAGE: &str = include_str!("../../docs/reference/combinations.md");

const SIZE: (u32, u32) = (64, 64);

const COLORS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

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

/// A frame that is asked for.
struct Case {
    scene: Scene,
    camera: Camera,
    wanted: Wanted,
    run: RunOptions,
    limit: u64,
    has: BTreeSet<Feature>,
}

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

/// The rows of an image see the scene one after the other, from half a frame before the frame's time to half a frame after it.
fn row_by_row() -> Readout {
    Readout::Lines(Lines { first: -0.5, line_time: 1.0 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 })
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
    fn plain(features: &[Feature]) -> Case {
        let count = if features.contains(&Feature::Chunks) { 3000 } else { 60 };
        let mut scene = if features.contains(&Feature::Caustics) {
            load(CAUSTICS).unwrap()
        } else {
            common::scene(soup(&mut Rng(5), count, 0.3))
        };
        // one camera of composites shows the second object, the other one all the rest
        let first = scene.mesh.triangle_count() / 2;
        let second = scene.mesh.triangle_count() - first;
        scene.objects = [("first", first), ("second", second)]
            .map(|(name, triangles)| Object { name: name.into(), triangles })
            .into();
        let (kind, range) = (scene.camera.kind.clone(), scene.camera.t_range);
        Case {
            camera: camera(kind, SIZE, range),
            scene,
            wanted: Wanted::of(COLORS.to_vec()),
            run: RunOptions::default(),
            limit: 1 << 27,
            has: BTreeSet::from([Feature::OneSample]),
        }
    }

    /// With these features and those that come with them; `None`: they need different cameras or counts of samples.
    fn of(features: &[Feature]) -> Option<Case> {
        use Feature::{Analytic, OneSample};
        let mut case = Case::plain(features);
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
                mask(&mut self.scene);
                let materials = &mut Arc::make_mut(&mut self.scene.mesh).materials;
                materials.iter_mut().for_each(|m: &mut Material| m.blend = Some(0.75));
                self.has.insert(Feature::AlphaMasks);
            }
            Feature::Shadows => self.scene.ambient_occlusion = Some(AmbientOcclusion { rays: 4, reach: 1.0 }),
            Feature::Pictures => self.scene.projector_lights = vec![picture()],
            Feature::Layers => self.camera = layered::chain(8, 2, (3, 2), Default::default(), SIZE),
            Feature::Curves => self.camera = layered::wavy(2, 0.5, false, SIZE),
            Feature::Optics => self.camera = camera_of("", SIZE, MIRROR).unwrap(),
            Feature::Atlas => {
                self.camera = camera_of("", SIZE, &format!("{MIRROR}\nfacets = \"normals\"\natlas = 4")).unwrap();
                self.has.insert(Feature::Optics);
            }
            Feature::Incoherent => self.camera = camera_of("", SIZE, DISPLAY).unwrap(),
            Feature::Bands => self.limit = self.limit.min(1 << 15),
            Feature::Chunks => {
                self.limit = self.limit.min(1 << 15);
                self.has.insert(Feature::Bands);
            }
            Feature::Timed => {
                let at = |x: f64| TimeStep {
                    positions: self.scene.mesh.positions.iter().map(|p| *p + DVec3::X * x).collect(),
                    normals: self.scene.mesh.normals.clone(),
                };
                self.scene.steps = TimeSteps::new(vec![-0.5, 0.5], vec![at(-0.5), at(0.5)]).map(Arc::new);
                self.scene.exposure.readout = row_by_row();
            }
            Feature::Spheres => {
                // in the place of a triangle
                let mesh = Arc::make_mut(&mut self.scene.mesh);
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
                let ends = ends.map(|keys: String| camera_of("", SIZE, &keys).unwrap());
                self.scene.exposure.readout = row_by_row();
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
                let composed = camera_of("", SIZE, COMPOSED).unwrap();
                let moved = camera_of("", SIZE, &COMPOSED.replace("eye = [0,", "eye = [0.3,")).unwrap();
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

    /// What is planned of it, or why not. No device is touched.
    fn plan(&self) -> Result<()> {
        let has = AdapterFeatures {
            f64: true,
            atomics64: true,
            lanes: true,
            wide: false,
            by_pair: false,
            timestamps: false,
            clip_distances: false,
            draw_counts: false,
            software: true,
            f64_is_wrong: false,
        };
        let planner = Planner { name: "test".into(), has, limit: self.limit, table_limit: self.limit };
        let asked = Asked::of(&self.scene, &self.camera, &self.wanted, &self.run);
        asked.check()?;
        // of images that take several frames, the first frame
        let first = Sample { number: 0, count: self.wanted.samples };
        let (mut camera, mut wanted) = (Arc::new(self.camera.clone()), self.wanted.clone());
        if asked.is_separate() {
            camera = Arc::new(camera.of_sample((0.0, 0.0), first)?);
            wanted.samples = 1;
        }
        if let Some(composition) = camera.layered() {
            camera = composition.members[0].camera.clone();
        }
        planner.plan(&self.scene, camera, &wanted, &self.run, None).map(|_| ())
    }

    /// The row that is to refuse it.
    fn expected(&self) -> Option<&'static Refusal> {
        REFUSALS.iter().find(|row| row.features.iter().all(|f| self.has.contains(f)))
    }
}

/// An error is the line of a row.
fn assert_refused(what: &str, row: &Refusal, error: &Error) {
    let text = error.to_string();
    assert!(error.exit_code() == 2 && !text.contains('\n') && !text.contains('{'), "{what}: {text}");
    // between what stands for the frame's own
    let whole = format!("{}; {}", row.reason, row.remedy);
    let mut rest = text.as_str();
    for part in whole.split('{').map(|p| p.split_once('}').map_or(p, |(_, after)| after)) {
        let at = rest.find(part).unwrap_or_else(|| panic!("{what}: {text:?} is not {whole:?}"));
        rest = &rest[at + part.len()..];
    }
    assert!(rest.is_empty(), "{what}: {text:?} is not {whole:?}");
}

#[test]
fn each_row_refuses_its_pair_and_no_other_pair_is_refused() {
    let pairs = Feature::ALL
        .into_iter()
        .flat_map(|a| Feature::ALL.into_iter().filter(move |b| a <= *b).map(move |b| vec![a, b]));
    let more = REFUSALS.iter().filter(|row| row.features.len() > 2).map(|row| row.features.to_vec());
    let mut reached = BTreeSet::new();
    let (mut refused, mut taken) = (0, 0);
    for pair in pairs.chain(more) {
        let Some(case) = Case::of(&pair) else { continue };
        match (case.plan(), case.expected()) {
            (Err(error), Some(row)) => {
                assert_refused(&format!("{pair:?}"), row, &error);
                reached.insert(row.features);
                refused += 1;
            }
            (Ok(()), None) => taken += 1,
            (got, expected) => panic!("{pair:?}: {:?}, expected {expected:?}", got.map_err(|e| e.to_string())),
        }
    }
    println!("{refused} pairs refused, {taken} taken");
    let missed: Vec<_> = REFUSALS.iter().filter(|row| !reached.contains(row.features)).collect();
    assert!(missed.is_empty(), "rows that refuse nothing: {missed:?}");
}

/// Engines by the size of their bindings.
#[derive(Default)]
struct Engines(Vec<(u64, Engine)>);

impl Engines {
    fn of(&mut self, limit: u64) -> Option<&mut Engine> {
        if !self.0.iter().any(|(own, _)| *own == limit) {
            let engine = engine_on(|gpu| {
                if limit < Case::plain(&[]).limit {
                    limit_bindings(gpu, limit);
                }
            })?;
            self.0.push((limit, engine));
        }
        self.0.iter_mut().find(|(own, _)| *own == limit).map(|(_, engine)| engine)
    }
}

/// The reference's verdict on a frame.
struct Verdict {
    /// Safe pixels with another triangle than the reference's, other pixels with none of the triangles near by, and proven pixels with another
    /// triangle than the reference's.
    wrong: u64,
    safe: Vec<bool>,
}

fn verdict(scene: &Scene, camera: &Camera, frame: &Frame) -> Verdict {
    let judged = judge(scene, camera, frame);
    let seen = compare(frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)).unwrap();
    let proven = frame.u32(Channel::Certified).unwrap_or_default();
    let differ = |k: usize| ids(frame)[k] != ids(&judged.truth)[k];
    let wrongly_proven = (0..proven.len()).filter(|k| proven[*k] > 0 && differ(*k)).count() as u64;
    Verdict { wrong: seen.wrong_safe.unwrap() + judged.not_near + wrongly_proven, safe: judged.safe }
}

/// A frame of these triangles.
fn frame_of_ids(camera: &Camera, ids: Vec<u32>) -> Frame {
    Frame { width: camera.width, height: camera.height, planes: vec![(Channel::TriangleId, Plane::U32(ids))] }
}

/// The largest difference of two colors that round to the same 8 bits or to neighboring ones.
const COLOR_ERROR: f32 = 1.0 / 255.0;

/// Renders a case and compares it with the reference: triangles of all samples, proofs, and colors of pixels that are safe.
fn assert_as_the_reference(what: &str, case: &Case, engine: &mut Engine) {
    let Case { scene, camera, run, .. } = case;
    let run = &RunOptions { repeat: u32::from(run.moving), ..run.clone() };
    let channels = case.wanted.channels.iter().copied().chain([Channel::TriangleId, Channel::T]);
    let wanted = Wanted { channels: Channel::in_order(channels), sample_ids: true, ..case.wanted.clone() };
    let rendered = engine.render(scene, camera.clone(), &wanted, run).unwrap_or_else(|e| panic!("{what}: {e}"));
    let frame = &rendered.frame;
    if let Some(rows) = wanted.rows {
        // other cases compare the whole image
        let whole = engine.render(scene, camera.clone(), &Wanted { rows: None, ..wanted }, run).unwrap().frame;
        let width = camera.width as usize;
        let own = rows.first as usize * width..(rows.first + rows.count) as usize * width;
        for ((channel, plane), (_, of_whole)) in frame.planes.iter().zip(&whole.planes) {
            let expected = match of_whole {
                Plane::F32(values) => Plane::F32(values[own.clone()].to_vec()),
                Plane::U32(values) => Plane::U32(values[own.clone()].to_vec()),
            };
            assert!(*plane == expected, "{what}: {channel:?}");
        }
        return;
    }
    if camera.optics.as_ref().is_some_and(|optics| optics.atlas.is_some()) {
        // pixels show the nearest texel; tests of mirrors compare that with mirrors without an atlas
        assert!(ids(frame).iter().any(|id| *id != NO_ID), "{what}");
        return;
    }
    let Verdict { wrong, mut safe } = verdict(scene, camera, frame);
    assert_eq!(wrong, 0, "{what}");
    // an error in one pixel is found
    let mut planted = ids(frame).to_vec();
    let mut hits = (0..planted.len()).filter(|k| planted[*k] != NO_ID);
    // along curves no pixel that shows an alpha mask is safe
    let hit = hits.clone().find(|k| safe[*k]).or_else(|| hits.next());
    planted[hit.unwrap_or_else(|| panic!("{what}: no pixel hits anything"))] ^= 1;
    assert!(verdict(scene, camera, &frame_of_ids(camera, planted)).wrong > 0, "{what}: an error is not found");
    if wanted.samples > 1 {
        let offsets = sample_offsets(wanted.samples);
        assert_eq!(rendered.sample_ids.len(), offsets.len(), "{what}");
        // of many samples, a few
        let every = offsets.len().div_ceil(8);
        for ((number, offset), ids) in (0..).zip(offsets).zip(&rendered.sample_ids).step_by(every) {
            let sample = Sample { number, count: wanted.samples };
            let camera = camera.of_sample(offset.into(), sample).unwrap();
            let of_sample = verdict(scene, &camera, &frame_of_ids(&camera, ids.clone()));
            assert_eq!(of_sample.wrong, 0, "{what}, sample {number}");
            safe.iter_mut().zip(of_sample.safe).for_each(|(all, own)| *all &= own);
        }
    }
    // the reference draws no lines and measures no areas; and where only edge pixels are sampled, a triangle has one shadow in a pixel
    let has_one_shadow = case.has.contains(&Feature::Shadows) && !case.has.contains(&Feature::Separate);
    if scene.style != Style::default() || wanted.analytic || wanted.samples > 1 && has_one_shadow {
        return;
    }
    let colors = Wanted { samples: wanted.samples, ..Wanted::of(COLORS.to_vec()) };
    let (camera, plain) = (Arc::new(camera.clone()), RunOptions::default());
    let truth = Backend::Reference.render(scene, &camera, &colors, &plain, &mut |_| {}).unwrap().frame;
    let differs = |k: &usize| {
        let value = |frame: &Frame, channel| frame.f32(channel).unwrap()[*k].clamp(0.0, 1.0);
        COLORS.into_iter().any(|channel| (value(frame, channel) - value(&truth, channel)).abs() > COLOR_ERROR)
    };
    let (safe_count, off) =
        (0..safe.len()).filter(|k| safe[*k]).fold((0, 0), |(n, off), k| (n + 1, off + u32::from(differs(&k))));
    println!("{what}: {safe_count} pixels are safe, {off} have another color");
    // a shadow ray that passes an edge within rounding is no matter of safe pixels
    let most = if case.has.contains(&Feature::Shadows) { safe_count / 1000 } else { 0 };
    assert!(safe_count > 0 && off <= most, "{what}: {safe_count} pixels are safe, {off} have another color");
}

#[test]
#[ignore = "slow: make test-all"]
fn every_pair_that_is_not_refused_is_as_the_reference_says() {
    let (mut count, mut wrong) = (0, Vec::new());
    for a in Feature::ALL {
        // an engine keeps all kernels, and few are those of other features
        let mut engines = Engines::default();
        for pair in Feature::ALL.into_iter().filter(|b| a <= *b).map(|b| [a, b]) {
            let Some(case) = Case::of(&pair).filter(|case| case.expected().is_none()) else { continue };
            let Some(engine) = engines.of(case.limit) else { return };
            let compared = AssertUnwindSafe(|| assert_as_the_reference(&format!("{pair:?}"), &case, engine));
            wrong.extend(catch_unwind(compared).is_err().then_some(pair));
            count += 1;
        }
    }
    println!("{count} pairs");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn frames_of_other_cameras_and_lights_are_prepared_again() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let prepare = |engine: &mut Engine, case: &Case| {
        engine.prepare(&case.scene, case.camera.clone(), &case.wanted, &case.run).unwrap()
    };
    let [lit, mirror, composed, plain, atlas] =
        [Feature::Caustics, Feature::Optics, Feature::Composed, Feature::OneSample, Feature::Atlas]
            .map(|feature| Case::of(&[feature]).unwrap());
    let says = |error: Error, what: &str| {
        assert!(error.to_string().contains(what) && error.exit_code() == 2, "{error}");
        assert!(error.to_string().ends_with("; call Engine::prepare again"), "{error}");
    };
    says(prepare(&mut engine, &lit).light(&lit.scene).unwrap_err(), "the light cannot change with caustics");
    says(prepare(&mut engine, &mirror).aim(&mirror.camera).unwrap_err(), "cannot be taken by this reflection");
    says(prepare(&mut engine, &plain).aim(&composed.camera).unwrap_err(), "cannot be taken by this composite");
    let error =
        engine.prepare(&composed.scene, composed.camera.clone(), &composed.wanted, &composed.run).err().unwrap();
    assert!(error.to_string().contains("call Engine::render"), "{error}");
    let none = Wanted { samples: 0, ..plain.wanted.clone() };
    let error = engine.render(&plain.scene, plain.camera.clone(), &none, &plain.run).unwrap_err();
    assert!(error.to_string().contains("use at least 1"), "{error}");
    for (case, is_taken) in [(&lit, false), (&atlas, false), (&composed, false), (&mirror, true), (&plain, true)] {
        assert_eq!(Sequence::takes(&case.scene, &case.camera, &case.wanted), is_taken, "{:?}", case.has);
    }
}

#[test]
fn rivals_refuse_what_they_do_not_render() {
    let rival = |culls: bool| {
        let technique = TECHNIQUES.iter().find(|technique| technique.culls == culls).unwrap();
        Choice { technique, parameter: technique.parameter.as_ref().map_or(0, |parameter| parameter.default) }
    };
    let refused = |features: &[Feature], run: RunOptions, what: &str| {
        let case = Case { run, ..Case::of(features).unwrap() };
        let name = case.run.rival.unwrap().technique.name;
        let text = case.plan().unwrap_err().to_string();
        assert!(text.starts_with(&format!("{name} {what}; ")), "{text}");
    };
    let run = RunOptions { rival: Some(rival(true)), ..RunOptions::default() };
    for (feature, what) in [
        (Feature::Gradients, "has no gradients"),
        (Feature::Timed, "sees the whole scene at one time"),
        (Feature::Spheres, "draws triangles alone"),
        (Feature::Certified, "cannot certify pixels"),
        (Feature::AlphaMasks, "ignores alpha masks"),
        (Feature::Optics, "does not follow reflected or refracted rays"),
    ] {
        refused(&[feature], run.clone(), what);
    }
    let four = TECHNIQUES.iter().find(|technique| technique.samples == MULTISAMPLES).unwrap();
    let of_four = RunOptions { rival: Some(Choice { technique: four, parameter: 0 }), ..RunOptions::default() };
    refused(&[Feature::Analytic], of_four, "counts samples, and measures no areas");
    let without_culling = RunOptions { rival: Some(rival(false)), no_cull: true, ..RunOptions::default() };
    refused(&[], without_culling, "culls nothing");
    Case { run, ..Case::of(&[]).unwrap() }.plan().unwrap();
}

#[test]
fn the_page_of_rivals_has_their_table() {
    let line = |(feature, what, remedy): (Feature, &str, &str)| format!("| {} | {what} | {remedy} |", feature.name());
    let expected = NOT_RENDERED.map(line).join("\n");
    assert!(include_str!("../../docs/reference/rivals.md").contains(&expected), "rivals.md must have:\n{expected}");
}

/// A row of the page's table.
fn line(row: &Refusal) -> String {
    let names: Vec<&str> = row.features.iter().map(|f| f.name()).collect();
    let plain = |text: &str| {
        let words = [("{camera}", "the camera"), ("{rows}", "some"), ("{chunks}", "several")];
        words.iter().fold(text.to_string(), |text, (from, to)| text.replace(from, to))
    };
    format!("| {} | {} | {} |", names.join(" + "), plain(row.reason), plain(row.remedy))
}

#[test]
fn the_page_is_the_table() {
    let lines: Vec<&str> = PAGE.lines().filter(|l| l.starts_with("| ")).skip(1).collect();
    let expected: Vec<String> = REFUSALS.iter().map(line).collect();
    assert_eq!(lines, expected, "docs/reference/combinations.md must have these rows:\n{}", expected.join("\n"));
    assert!(expected.iter().all(|l| l.matches('|').count() == 4 && !l.contains('{')));
}

/// Features that go with all others.
const NEVER_REFUSED: [Feature; 5] =
    [Feature::Samples, Feature::Moving, Feature::Blended, Feature::Shadows, Feature::Bands];

#[test]
fn every_feature_is_in_a_row_and_named_once() {
    let names: BTreeSet<&str> = Feature::ALL.into_iter().map(Feature::name).collect();
    assert_eq!(names.len(), Feature::ALL.len());
    let in_rows: BTreeSet<Feature> = REFUSALS.iter().flat_map(|r| r.features).copied().collect();
    let refused = BTreeSet::from(Feature::ALL).difference(&BTreeSet::from(NEVER_REFUSED)).copied().collect();
    assert_eq!(in_rows, refused);
}
