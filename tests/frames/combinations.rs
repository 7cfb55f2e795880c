//! What goes together in a frame: every refused pair is tried and gives its own line, every other pair is planned, and the page says
//! what the table says.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::moving::Moving;
use anamorph::internals::engine::combinations::{Feature, REFUSALS, Refusal};
use anamorph::internals::engine::plan::{Rows, Wanted};
use anamorph::internals::engine::planned::Planner;
use anamorph::internals::engine::rival::Choice;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, Method, RunOptions};
use anamorph::internals::geometry::mesh::Material;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::AmbientOcclusion;
use anamorph::internals::scene::projector_light::{ProjectorLight, Throw};
use anamorph::internals::scene::style::{Line, Style};
use anamorph::internals::scene::volume::Mode;
use anamorph_lab::rivals::TECHNIQUES;
use common::file::{camera_of, load};
use common::gpu::engine_on;
use common::rng::Rng;
use common::volumes::{bumps, grid, volume};
use common::{camera, layered, soup};
use glam::{DQuat, DVec3, Vec2};
use half::f16;
use std::collections::BTreeSet;
use std::sync::Arc;

const PAGE: &str = include_str!("../../docs/reference/combinations.md");

const SIZE: (u32, u32) = (64, 64);

const MIRROR: &str = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }\n\
    mirror = { shape = \"sphere\", center = [0, 0, 0], radius = 1, count = 60 }";
const PINHOLE: &str = "kind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40";
const DISPLAY: &str = "kind = \"lightfield\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\nup = [0, 1, 0]\nwidth = 2\nheight = 2\n\
    views = [8, 8]\nfov = 40";
const COMPOSED: &str = "kind = \"composite\"\nmaster = 0\ncameras = [
    { camera = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 } },
    { camera = { kind = \"pinhole\", eye = [1, 0, 5], target = [0, 0, 0], vfov = 40 } }]";
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

fn rival(culls: bool) -> Option<Choice> {
    let technique = TECHNIQUES.iter().find(|t| t.culls == culls).unwrap();
    Some(Choice { technique, parameter: technique.parameter.as_ref().map_or(0, |parameter| parameter.default) })
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
        scene.objects.clear();
        let (kind, range) = (scene.camera.kind.clone(), scene.camera.t_range);
        Case {
            camera: camera(kind, SIZE, range),
            scene,
            wanted: Wanted::of(vec![Channel::R, Channel::G, Channel::B]),
            run: RunOptions::default(),
            limit: 1 << 27,
            has: BTreeSet::from([Feature::OneSample]),
        }
    }

    /// With these features and those that come with them; `None`: they need different cameras or counts of samples.
    fn of(features: &[Feature]) -> Option<Case> {
        use Feature::{Analytic, NoSamples, OneSample};
        let mut case = Case::plain(features);
        let many = features
            .iter()
            .any(|f| matches!(f, Feature::Samples | Feature::ManySamples | Feature::RivalOfOtherSamples));
        let few = features.iter().any(|f| matches!(f, NoSamples | OneSample));
        let counts = [many, features.contains(&NoSamples), features.contains(&OneSample)];
        let kinds = [
            Feature::Layers,
            Feature::Curves,
            Feature::Incoherent,
            Feature::Atlas,
            Feature::LayeredOptics,
            Feature::MovingCamera,
            Feature::CameraInMotion,
            Feature::Composed,
        ];
        let cameras = features.iter().filter(|f| kinds.contains(f)).count()
            + usize::from(features.iter().any(|f| matches!(f, Feature::Optics | Feature::Bounces)));
        // what an image larger than the bindings needs of a scene is caustics' own affair
        let is_large = features.iter().any(|f| matches!(f, Feature::Bands | Feature::Chunks));
        let is_lit_anew = features.contains(&Feature::Caustics) && is_large;
        // a composite that moves
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
        let own = case.run.rival.map(|choice| choice.samples(&case.camera));
        if case.wanted.samples > 1 && own.is_some_and(|own| own != case.wanted.samples) {
            case.has.insert(Feature::RivalOfOtherSamples);
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
            Feature::NoSamples => samples(0, &[]),
            Feature::OneSample => {}
            Feature::Samples => samples(several, &[]),
            Feature::ManySamples => samples(40, &[Feature::Samples]),
            Feature::Analytic => wanted.analytic = true,
            Feature::Certified => wanted.channels.push(Channel::Certified),
            Feature::Outlines => {
                let borders = Some(Line { colour: [0.0; 3], width: 2.0, depth: f64::INFINITY });
                self.scene.style = Style { borders, ..Style::default() };
            }
            Feature::Rows => wanted.rows = Some(Rows { first: 8, count: 16 }),
            Feature::Rival => run.rival = run.rival.or_else(|| rival(true)),
            Feature::RivalOfOtherSamples => {
                run.rival = run.rival.or_else(|| rival(true));
                samples(2, &[Feature::Samples]);
                self.has.insert(Feature::Rival);
            }
            Feature::RivalWithoutCulling => {
                run.rival = rival(false);
                self.has.insert(Feature::Rival);
            }
            Feature::NoCull => run.no_cull = true,
            Feature::Moving => run.moving = true,
            // its scene is there from the start
            Feature::Caustics => {}
            Feature::AlphaMasks => mask(&mut self.scene),
            Feature::Blended => {
                mask(&mut self.scene);
                let materials = &mut Arc::make_mut(&mut self.scene.mesh).materials;
                materials.iter_mut().for_each(|m: &mut Material| m.blend = Some(0.5));
                self.has.insert(Feature::AlphaMasks);
            }
            Feature::Shadows => self.scene.ambient_occlusion = Some(AmbientOcclusion { rays: 4, reach: 1.0 }),
            Feature::Pictures => self.scene.projector_lights = vec![picture()],
            Feature::Layers => self.camera = layered::chain(8, 2, (3, 2), Default::default(), SIZE),
            Feature::Curves => self.camera = layered::wavy(2, 0.5, false, SIZE),
            Feature::Optics | Feature::Bounces => {
                self.camera = camera_of("", SIZE, MIRROR).unwrap();
                self.has.extend([Feature::Optics, Feature::Bounces]);
            }
            Feature::Atlas => {
                self.camera = camera_of("", SIZE, &format!("{MIRROR}\nfacets = \"normals\"\natlas = 8")).unwrap();
                self.has.insert(Feature::Optics);
            }
            Feature::LayeredOptics => {
                let optics = camera_of("", SIZE, &format!("{MIRROR}\nfacets = \"normals\"")).unwrap().optics;
                self.camera = Camera { optics, ..layered::wavy(2, 0.5, false, SIZE) };
                self.has.extend([Feature::Optics, Feature::Bounces, Feature::Curves]);
            }
            Feature::Incoherent => self.camera = camera_of("", SIZE, DISPLAY).unwrap(),
            Feature::Bands => self.limit = self.limit.min(1 << 14),
            Feature::Chunks => {
                self.limit = self.limit.min(1 << 15);
                self.has.insert(Feature::Bands);
            }
            Feature::Timed => {
                let at = |x: f64| TimeStep {
                    positions: self.scene.mesh.positions.iter().map(|p| *p + DVec3::X * x).collect(),
                    normals: self.scene.mesh.normals.clone(),
                };
                self.scene.steps = TimeSteps::new(vec![0.0, 1.0], vec![at(0.0), at(1.0)]).map(Arc::new);
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
            Feature::MovingCamera | Feature::CameraInMotion => {
                let ends = [camera_of("", SIZE, PINHOLE).unwrap(), camera_of("", SIZE, PINHOLE).unwrap()];
                self.has.insert(Feature::CameraInMotion);
                self.scene.exposure.shutter = if feature == Feature::MovingCamera { 1.0 } else { 0.0 };
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
                self.camera = match self.has.contains(&Feature::CameraInMotion) {
                    true => {
                        let ends = vec![composed.clone(), composed];
                        Moving::new(self.scene.exposure.clone(), vec![-0.5, 0.5], ends).unwrap().camera(None).unwrap()
                    }
                    false => composed,
                };
            }
            Feature::Raster => run.method = Method::Raster,
            Feature::Aimed | Feature::Relit | Feature::InSequence => unreachable!("of frames that follow others"),
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
        planner.plan(&self.scene, self.camera.clone(), &self.wanted, &self.run, None).map(|_| ())
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

/// Features that frames are planned with.
fn planned() -> impl Iterator<Item = Feature> + Clone {
    Feature::ALL.into_iter().filter(|f| !matches!(f, Feature::Aimed | Feature::Relit | Feature::InSequence))
}

#[test]
fn each_row_refuses_its_pair_and_no_other_pair_is_refused() {
    let pairs = planned().flat_map(|a| planned().filter(move |b| a <= *b).map(move |b| vec![a, b]));
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
    let rows = REFUSALS.iter().filter(|row| row.features.iter().all(|f| planned().any(|p| p == *f)));
    let missed: Vec<_> = rows.filter(|row| !reached.contains(row.features)).collect();
    assert!(missed.is_empty(), "rows that refuse nothing: {missed:?}");
}

#[test]
fn frames_that_follow_others_refuse_their_rows() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let row = |features: &[Feature]| REFUSALS.iter().find(|row| row.features == features).unwrap();
    let prepare = |engine: &mut Engine, case: &Case| {
        engine.prepare(&case.scene, case.camera.clone(), &case.wanted, &case.run).unwrap()
    };
    let lit = Case::of(&[Feature::Caustics]).unwrap();
    let error = prepare(&mut engine, &lit).light(&lit.scene).unwrap_err();
    assert_refused("light", row(&[Feature::Relit, Feature::Caustics]), &error);
    let mirror = Case::of(&[Feature::Optics]).unwrap();
    let error = prepare(&mut engine, &mirror).aim(&mirror.camera).unwrap_err();
    assert_refused("aim", row(&[Feature::Aimed, Feature::Optics]), &error);
    let moving = Case::of(&[Feature::Timed]).unwrap();
    let error = prepare(&mut engine, &moving).aim(&moving.camera).unwrap_err();
    assert_refused("aim", row(&[Feature::Timed, Feature::Aimed]), &error);
    let composed = Case::of(&[Feature::Composed]).unwrap();
    let plain = Case::of(&[]).unwrap();
    let error = prepare(&mut engine, &plain).aim(&composed.camera).unwrap_err();
    assert_refused("aim", row(&[Feature::Composed, Feature::Aimed]), &error);
    let error =
        engine.prepare(&composed.scene, composed.camera.clone(), &composed.wanted, &composed.run).err().unwrap();
    assert!(error.to_string().contains("call Engine::render"), "{error}");
    let atlas = Case::of(&[Feature::Atlas]).unwrap();
    for (case, is_taken) in [(&lit, false), (&atlas, false), (&composed, false), (&mirror, true), (&plain, true)] {
        assert_eq!(Sequence::takes(&case.scene, &case.camera, &case.wanted), is_taken, "{:?}", case.has);
    }
    let of_changes = REFUSALS.iter().filter(|r| r.features.iter().any(|f| planned().all(|p| p != *f)));
    assert_eq!(of_changes.count(), 7, "rows of frames that follow others");
}

/// A row of the page's table.
fn line(row: &Refusal) -> String {
    let names: Vec<&str> = row.features.iter().map(|f| f.name()).collect();
    let plain = |text: &str| {
        let words = [("{rival}", "the rival"), ("{camera}", "the camera"), ("{samples}", "N"), ("{rows}", "some")];
        let more = [("{chunks}", "several"), ("{own}", "1 sample (`raster-pieces`: 1 or 4)")];
        words.iter().chain(&more).fold(text.to_string(), |text, (from, to)| text.replace(from, to))
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
const NEVER_REFUSED: [Feature; 1] = [Feature::Shadows];

#[test]
fn every_feature_is_in_a_row_and_named_once() {
    let names: BTreeSet<&str> = Feature::ALL.into_iter().map(Feature::name).collect();
    assert_eq!(names.len(), Feature::ALL.len());
    let in_rows: BTreeSet<Feature> = REFUSALS.iter().flat_map(|r| r.features).copied().collect();
    let refused = BTreeSet::from(Feature::ALL).difference(&BTreeSet::from(NEVER_REFUSED)).copied().collect();
    assert_eq!(in_rows, refused);
}
