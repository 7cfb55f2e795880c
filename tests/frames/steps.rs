//! Frames as data: what the steps of a frame bind is in the table of buffers, is written before it is read, and is read and written as
//! the kernels say.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::bounces::bounces;
use anamorph::internals::engine::buffer_table::table;
use anamorph::internals::engine::changes::Dirty;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Plan, PlanTarget, SceneContents, SceneExtent, Wanted};
use anamorph::internals::engine::stage::{Dispatch, KernelId, Number, Threads};
use anamorph::internals::engine::steps::{FrameInputs, Step, StepScope, passes, steps};
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::kernels::{Access, Kernel, Variant, VolumeKind};
use anamorph::internals::image::frame::Channel;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::{FORWARD, camera, layered};
use glam::DVec3;
use naga::valid::{Capabilities, GlobalUse, ValidationFlags, Validator};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

const SIZE: (u32, u32) = (61, 45);

const MIRROR: &str = r#"kind = "reflection"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
mirror = { shape = "torus", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.4, count = 300 }
facets = "normals"
depth = 3"#;
const TORUS: &str = "shape = \"torus\", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.4, count = 300";
const WAVE: &str = "shape = \"wave\", center = [0, 0, 0], size = 4, amplitude = 0.1, wavelength = 1";
const ATLAS: &str = r#"kind = "reflection"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
mirror = { shape = "torus", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.4, count = 300 }
facets = "flat"
atlas = 8"#;
const LENS: &str = r#"kind = "refraction"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
lens = { shape = "lens", center = [0, 0, 1.5], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, curvatures = [0.5, -0.6] }
ior = 1.5
fresnel = true
depth = 2"#;

const HAS: AdapterFeatures = AdapterFeatures {
    f64: true,
    software: true,
    f64_is_wrong: false,
    atomics64: true,
    lanes: true,
    wide: false,
    by_pair: false,
    timestamps: true,
    clip_distances: true,
    draw_counts: false,
};

/// What frames are made of: a camera, an adapter, contents, and what is wanted of them.
struct Case {
    name: String,
    camera: Camera,
    has: AdapterFeatures,
    contents: SceneContents,
    wanted: Wanted,
}

fn cases() -> Vec<Case> {
    let pinhole = camera(glc_of_each_class().swap_remove(3).1, SIZE, FORWARD);
    let pieces = camera(mesh_camera(1, 4, 3, MeshShape::default()), SIZE, FORWARD);
    let optics = |keys: &str| camera_of("", SIZE, keys).unwrap();
    let cameras = [
        ("one piece", pinhole),
        ("pieces", pieces),
        ("chain", layered::chain(3, 2, (4, 3), MeshShape::default(), SIZE)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("fisheye", optics("kind = \"fisheye\"\nfov = 150\neye = [0, 0, 3]\ntarget = [0, 0, 0]")),
        ("curves", layered::wavy(2, 0.5, false, SIZE)),
        ("mirror", optics(MIRROR)),
        ("atlas", optics(ATLAS)),
        ("lens", optics(LENS)),
        ("torus", optics(&MIRROR.replace("facets = \"normals\"\n", ""))),
        ("wave", optics(&MIRROR.replace("facets = \"normals\"\n", "").replace(TORUS, WAVE))),
    ];
    let adapters = [
        ("all", HAS),
        ("no lanes", AdapterFeatures { lanes: false, ..HAS }),
        ("no 64 bits", AdapterFeatures { lanes: false, f64: false, atomics64: false, ..HAS }),
    ];
    let plain = SceneContents { triangles: 100, ..SceneContents::default() };
    let rich = SceneContents {
        has_normals: true,
        has_uvs: true,
        has_colors: true,
        has_images: true,
        has_gloss: true,
        has_sky: true,
        has_positional_lights: true,
        has_shadows: true,
        has_pictures: true,
        has_style: true,
        line_reach: 2,
        ..plain
    };
    let all = Wanted { srgb8: true, counting: true, ..Wanted::of(Channel::every().collect()) };
    let mut list = Vec::new();
    for ((name, camera), (adapter, has)) in cameras.iter().flat_map(|c| adapters.iter().map(move |a| (c, a))) {
        let mut add = |what: &str, contents, wanted| {
            let name = format!("{name}, {adapter}, {what}");
            list.push(Case { name, camera: camera.clone(), has: *has, contents, wanted });
        };
        let shown: Vec<Channel> = Channel::every().filter(|c| *c != Channel::Certified).collect();
        add("plain", plain, Wanted::of(vec![Channel::TriangleId]));
        add("rich", rich, Wanted { channels: shown.clone(), ..all.clone() });
        add("alpha masks", SceneContents { has_alpha_masks: true, ..rich }, Wanted { channels: shown, ..all.clone() });
        if name != &"atlas" {
            let shown = Channel::every().filter(|c| *c != Channel::Certified).collect();
            add("moving", SceneContents { steps: 3, ..rich }, Wanted { channels: shown, ..all.clone() });
        }
        if camera.optics.is_none() {
            add("certified", plain, all.clone());
            for kind in [VolumeKind::Plain, VolumeKind::Lit, VolumeKind::Maximum] {
                let shown = Channel::every().filter(|c| *c != Channel::Certified).collect();
                let contents = SceneContents { volume: Some(kind), ..rich };
                add(&format!("volume, {kind:?}"), contents, Wanted { channels: shown, ..all.clone() });
            }
        }
        if camera.optics.is_none() && !camera.is_curved() {
            add("samples", plain, Wanted { samples: 4, ..all.clone() });
            add("samples, rich", rich, Wanted { samples: 4, ..all.clone() });
            add("certified spheres", SceneContents { has_spheres: true, ..plain }, all.clone());
        }
    }
    list
}

/// Runs a check on the frames of every case: lists split into several bands and chunks, with and without caustics.
fn each_input(mut check: impl FnMut(&str, &FrameInputs)) {
    for Case { name, camera, has, contents, wanted } in cases() {
        let methods = [Method::Raster, Method::Auto, Method::Trace];
        // what is shaded makes no difference to how triangles are found
        for method in methods.into_iter().take(if name.ends_with("plain") { 3 } else { 1 }) {
            let run = RunOptions { method, ..RunOptions::default() };
            let variant = variant(&camera, contents, &wanted, has, &run);
            let extent = SceneExtent::point(DVec3::ZERO);
            let target = PlanTarget { has, binding_limit: 1 << 16, aims: true, last: None };
            let plan = Plan::on(target, variant, &camera, contents, extent, &wanted);
            let bounces = bounces(camera.optics.as_deref());
            // one list; batches of one chunk of triangles; chunks, of which one is empty
            for (jobs, batches) in [(vec![5], 1), (vec![5, 4], 2), (vec![5, 3, 0], 1)] {
                for (samples_by_tile, prefers_trace) in [(false, false), (variant.samples_by_tile(), true)] {
                    let inputs = FrameInputs {
                        plan: &plan,
                        bounces: &bounces,
                        jobs: jobs.clone(),
                        batches,
                        raster_rounds: 2,
                        samples_by_tile,
                        prefers_trace,
                        aims: true,
                        by_rival: false,
                        gathers: wanted.srgb8,
                        keeps: true,
                        reads: true,
                    };
                    check(&format!("{name}, {method:?}, jobs {jobs:?}"), &inputs);
                }
            }
        }
    }
}

/// What a kernel does to a buffer.
#[derive(Debug, Clone, Copy)]
struct Use {
    reads: bool,
    writes: bool,
}

/// By the names that the kernel knows buffers by.
type Uses = BTreeMap<String, Use>;

/// What a kernel does by its code, of which the bindings say no less.
fn uses(kernel: &Kernel) -> Uses {
    let module = naga::front::wgsl::parse_str(&kernel.source()).unwrap();
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
    let point = info.get_entry_point(0);
    let mut uses = Uses::new();
    let bindings = kernel.bindings();
    let is_used = |handle: naga::Handle<naga::GlobalVariable>| !point[handle].is_empty();
    for (handle, global) in module.global_variables.iter().filter(|(h, global)| global.binding.is_some() && is_used(*h))
    {
        let name = global.name.clone().unwrap();
        let binding = bindings.iter().find(|b| b.name == name).expect("a binding of that name");
        let found = point[handle];
        let does = Use { reads: found.contains(GlobalUse::READ), writes: found.contains(GlobalUse::WRITE) };
        if let naga::AddressSpace::Storage { access } = global.space {
            let may_store = access.contains(naga::StorageAccess::STORE);
            assert_eq!(may_store, binding.access == Access::Write, "{}: {name}", kernel.name);
            assert!(!does.writes || may_store, "{}: {name}", kernel.name);
        }
        uses.insert(name, does);
    }
    uses
}

/// The uses of kernels of one variant.
type OfKernels = HashMap<KernelId, Rc<Uses>>;

/// The uses of kernels that were asked for.
#[derive(Default)]
struct Known {
    by_source: HashMap<String, Rc<Uses>>,
    /// Of frames so far: to put a kernel's source together takes longer than to find it here.
    by_variant: Vec<(Variant, Vec<Channel>, OfKernels)>,
}

impl Known {
    fn uses(&mut self, id: KernelId, variant: Variant, planes: &[Channel]) -> Rc<Uses> {
        // frames of one variant come one after the other
        let at = self.by_variant.iter().rposition(|v| (v.0, &v.1[..]) == (variant, planes)).unwrap_or_else(|| {
            self.by_variant.push((variant, planes.to_vec(), HashMap::new()));
            self.by_variant.len() - 1
        });
        let of_variant = self.by_variant[at].2.entry(id);
        let found = of_variant.or_insert_with(|| {
            let kernel = id.kernel(variant, planes).unwrap_or_else(|| panic!("{id:?} is none of {variant:?}"));
            self.by_source.entry(kernel.source()).or_insert_with(|| uses(&kernel).into()).clone()
        });
        found.clone()
    }

    /// What a dispatch does to each buffer, with what lays it out before.
    fn of_dispatch(&mut self, d: &Dispatch, variant: Variant, planes: &[Channel]) -> Vec<(KernelId, String, Use)> {
        let mut all = Vec::new();
        if let Threads::Counted(number) = d.threads {
            let own = self.uses(KernelId::Args, variant, planes);
            let bound = |name: &str| if name == "counters" { number.counted_in().into() } else { name.into() };
            all.extend(own.iter().map(|(name, does)| (KernelId::Args, bound(name), *does)));
            if variant.method() == Method::Auto && number.is_of_raster() {
                let own = self.uses(KernelId::Choose, variant, planes);
                all.extend(own.iter().map(|(name, does)| (KernelId::Choose, name.clone(), *does)));
            }
            all.push((d.kernel, "indirect".into(), Use { reads: true, writes: false }));
        }
        for (name, does) in self.uses(d.kernel, variant, planes).iter() {
            let buffer = d.renamed.iter().find(|r| r.0 == name).map_or_else(|| name.clone(), |r| r.1.into());
            all.push((d.kernel, buffer, *does));
        }
        // the buffers of step are the kernels' own
        all.retain(|(_, name, _)| name != "step");
        all
    }
}

/// Under which names the rays after a bounce are read that `bounce` has written.
const BOUNCED: [(&str, &str); 4] =
    [("bounced_hi", "rays_hi"), ("bounced_lo", "rays_lo"), ("bounced_paths", "paths"), ("bounced_live", "live")];

/// Buffers of which each bounce has its own.
const OF_BOUNCES: [&str; 6] = ["rays_hi", "rays_lo", "paths", "live", "nodes", "cells"];

/// How long a buffer keeps what was written to it in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lasts {
    /// Until another scene, camera or appearance is uploaded.
    Upload,
    /// While one band is rendered.
    Band,
    /// While the rays of one bounce are followed.
    Bounce,
    /// While one batch of triangles is rendered.
    Job,
}

/// The buffers that kernels write. The host uploads all others.
const WRITTEN: [(&str, Lasts); 25] = [
    ("counters", Lasts::Bounce),
    ("indirect", Lasts::Job),
    ("queue_even", Lasts::Job),
    ("queue_odd", Lasts::Job),
    ("work", Lasts::Job),
    ("tasks", Lasts::Job),
    ("large", Lasts::Job),
    ("unsorted", Lasts::Job),
    ("ranks", Lasts::Job),
    ("starts", Lasts::Job),
    ("ends", Lasts::Job),
    ("busy", Lasts::Job),
    ("pairs", Lasts::Job),
    ("recheck_items", Lasts::Job),
    ("samples", Lasts::Bounce),
    ("edge_of", Lasts::Bounce),
    ("blocks", Lasts::Job),
    ("touches", Lasts::Job),
    ("visibility", Lasts::Bounce),
    ("proofs", Lasts::Bounce),
    ("planes", Lasts::Band),
    ("srgb8", Lasts::Band),
    ("bounced_hi", Lasts::Bounce),
    ("bounced_lo", Lasts::Bounce),
    ("bounced_paths", Lasts::Bounce),
];

/// How long the contents of a buffer last.
fn lasts(name: &str) -> Lasts {
    WRITTEN.iter().find(|row| row.0 == name).map_or(Lasts::Upload, |row| row.1)
}

/// What a frame has written so far.
struct Written<'a> {
    inputs: &'a FrameInputs<'a>,
    /// Where each buffer was written last.
    at: HashMap<String, StepScope>,
    /// Of each number of bounces what was written for its rays.
    bounced: BTreeSet<(u32, String)>,
}

impl Written<'_> {
    fn holds(&self, name: &str, at: StepScope) -> bool {
        let count = self.inputs.bounces[at.bounce].count;
        // where fit does not write them, cells are as the host did
        if count > 0 && name == "cells" && !self.inputs.variant(at.bounce).rasters() {
            return true;
        }
        if count > 0 && OF_BOUNCES.contains(&name) {
            return self.bounced.contains(&(count, name.into()));
        }
        // where rays are split each count has its own
        if self.inputs.bounces.len() > 1 && name == "visibility" {
            return self.bounced.contains(&(count, name.into()));
        }
        let Some(then) = self.at.get(name) else { return lasts(name) == Lasts::Upload };
        match lasts(name) {
            Lasts::Upload => true,
            Lasts::Band => then.band == at.band,
            Lasts::Bounce => (then.band, then.bounce) == (at.band, at.bounce),
            Lasts::Job => (then.band, then.bounce, then.job) == (at.band, at.bounce, at.job),
        }
    }

    fn write(&mut self, name: &str, at: StepScope) {
        let bounce = at.into.unwrap_or(at.bounce);
        let read_as = BOUNCED.iter().find(|b| b.0 == name).map_or(name, |b| b.1);
        self.bounced.insert((self.inputs.bounces[bounce].count, read_as.into()));
        self.at.insert(name.into(), at);
    }
}

/// What a kernel reads, and not in this step of its own: cull takes clusters in its first and fit rays, edges goes over pixels in its
/// first and third, and certify in its third.
const IDLE: [(KernelId, u32, &str); 6] = [
    (KernelId::Cull, 0, "queue_even"),
    (KernelId::Fit, 0, "nodes"),
    (KernelId::Edges, 0, "pairs"),
    (KernelId::Edges, 0, "edge_of"),
    (KernelId::Edges, 2, "pairs"),
    (KernelId::Certify, 2, "pairs"),
];

/// The faults of a frame's steps: buffers that are read before anything is there. Adds what each kernel does.
fn faults(inputs: &FrameInputs, steps: &[Step], known: &mut Known, done: &mut BTreeSet<Done>) -> Vec<String> {
    let mut written = Written { inputs, at: HashMap::new(), bounced: BTreeSet::new() };
    let mut faults = Vec::new();
    for step in steps {
        match step {
            Step::Clear { buffer, at, .. } => written.write(buffer, *at),
            Step::Pass { at, dispatches, .. } => {
                for dispatch in dispatches {
                    let uses = known.of_dispatch(dispatch, inputs.variant(at.bounce), &inputs.plan.planes);
                    for (kernel, buffer, does) in &uses {
                        let is_idle = IDLE
                            .iter()
                            .any(|i| (i.0, Number::Index(i.1), i.2) == (*kernel, dispatch.step, buffer.as_str()));
                        if does.reads && !is_idle && *buffer != "indirect" && !written.holds(buffer, *at) {
                            faults.push(format!("{kernel:?} reads {buffer} before it is written, {at:?}"));
                        }
                        done.extend(does.reads.then(|| (buffer.clone(), *kernel, false)));
                        done.extend(does.writes.then(|| (buffer.clone(), *kernel, true)));
                    }
                    // what forget writes is that there are no rays
                    for (_, buffer, _) in uses.iter().filter(|u| u.2.writes && u.0 != KernelId::Forget) {
                        written.write(buffer, *at);
                    }
                }
            }
            Step::Keep { band } | Step::Read { band } => {
                let at = StepScope { band: *band, bounce: 0, job: 0, into: None };
                let srgb8 = inputs.plan.srgb8.then_some("srgb8");
                for buffer in ["planes"].into_iter().chain(srgb8).filter(|b| !written.holds(b, at)) {
                    faults.push(format!("the host reads {buffer} before it is written, {at:?}"));
                }
            }
            Step::Count { .. } | Step::Rival { .. } => {}
        }
    }
    faults
}

/// That a kernel reads a buffer, or that it writes it.
type Done = (String, KernelId, bool);

#[test]
fn every_list_is_in_the_table_and_written_before_it_is_read() {
    let (mut known, mut done) = (Known::default(), BTreeSet::new());
    let mut all = Vec::new();
    each_input(|name, inputs| {
        let found = faults(inputs, &steps(inputs, Dirty::All), &mut known, &mut done);
        all.extend(found.into_iter().map(|fault| format!("{name}: {fault}")));
    });
    assert!(all.is_empty(), "{all:#?}");
    let kernels: BTreeSet<KernelId> = done.iter().map(|d| d.1).collect();
    assert!(kernels == BTreeSet::from(KernelId::ALL), "of all kernels frames here take {kernels:?}");
    // the host writes these first; fit writes them again for rays after a bounce, and reach and bounce list tiles; rays are the host's where no
    // lens is turned
    let uploaded = ["nodes", "cells", "live", "bounced_live", "rays_hi", "rays_lo"];
    let written: BTreeSet<&str> = done.iter().filter(|d| d.2).map(|d| d.0.as_str()).collect();
    let written: BTreeSet<&str> = written.into_iter().filter(|name| !uploaded.contains(name)).collect();
    assert_eq!(written, WRITTEN.iter().map(|row| row.0).collect(), "by the kernels' code, and by the table above");
    let lists: BTreeSet<&str> = table().iter().map(|spec| spec.name).collect();
    let bounced: BTreeSet<&str> = BOUNCED.iter().map(|row| row.0).collect();
    assert_eq!(written.difference(&bounced).copied().collect::<BTreeSet<_>>(), lists);
}

/// Removes some steps.
type Less = (&'static str, fn(&Step) -> bool);

fn clears(step: &Step, name: &str) -> bool {
    matches!(step, Step::Clear { buffer, .. } if *buffer == name)
}

fn is_pass(step: &Step, pass: &str) -> bool {
    matches!(step, Step::Pass { name, .. } if *name == pass)
}

#[test]
#[ignore = "slow: make test-all"]
fn a_step_that_is_missing_is_seen() {
    let less: [Less; 13] = [
        ("cull", |s| is_pass(s, "cull")),
        ("split", |s| is_pass(s, "split")),
        ("bin", |s| is_pass(s, "bin")),
        ("sort", |s| is_pass(s, "sort")),
        ("fit", |s| is_pass(s, "fit")),
        ("bounce", |s| is_pass(s, "bounce")),
        ("all that writes planes", |s| {
            let names = ["shade", "resolve", "gather", "outline", "paste", "certify"];
            names.iter().any(|name| is_pass(s, name)) || clears(s, "planes")
        }),
        ("write", |s| is_pass(s, "write")),
        ("edges", |s| is_pass(s, "edges")),
        ("the clearing of visibility", |s| clears(s, "visibility")),
        ("the clearing of counters", |s| clears(s, "counters")),
        ("the clearing of the ends of tiles", |s| clears(s, "ends")),
        ("the clearing of proofs", |s| clears(s, "proofs")),
    ];
    let mut known = Known::default();
    let mut tried = [0; 13];
    each_input(|name, inputs| {
        let all = steps(inputs, Dirty::All);
        for ((what, is_removed), tried) in less.iter().zip(&mut tried) {
            let rest: Vec<Step> = all.iter().filter(|s| !is_removed(s)).cloned().collect();
            if rest.len() < all.len() {
                let faults = faults(inputs, &rest, &mut known, &mut BTreeSet::new());
                assert!(!faults.is_empty(), "{name}: nothing misses {what}");
                *tried += 1;
            }
        }
    });
    assert!(tried.iter().all(|n| *n > 0), "{tried:?}");
}

#[test]
fn what_follows_from_light_alone_leaves_out_what_finds_triangles() {
    each_input(|name, inputs| {
        let [all, lit] = [Dirty::All, Dirty::Appearance].map(|dirty| steps(inputs, dirty));
        let names = |steps: &[Step]| -> BTreeSet<&str> {
            steps.iter().filter_map(|s| if let Step::Pass { name, .. } = s { Some(*name) } else { None }).collect()
        };
        let found =
            ["cull", "split", "bin", "sort", "raster", "trace", "recheck", "meet", "edges", "sample", "certify"];
        let by_raster = found[..3].iter().all(|n| names(&all).contains(n));
        assert!(by_raster || names(&all).contains("trace"), "{name}");
        assert!(found.iter().all(|n| !names(&lit).contains(n)) && names(&lit).contains("shade"), "{name}");
        assert!(passes(&lit) < passes(&all));
        assert_eq!(passes(&all) as usize, all.iter().filter(|s| matches!(s, Step::Pass { .. })).count());
    });
}

#[test]
fn numbers_of_dispatches_have_a_buffer_each() {
    let names: BTreeSet<&str> = Number::every().map(Number::name).collect();
    assert_eq!(names.len(), Number::every().count());
    each_input(|name, inputs| {
        for step in steps(inputs, Dirty::All) {
            let Step::Pass { dispatches, .. } = step else { continue };
            let numbers = dispatches.iter().flat_map(|d| {
                let counted = if let Threads::Counted(number) = d.threads { Some(number) } else { None };
                [Some(d.step), counted].into_iter().flatten()
            });
            assert!(numbers.into_iter().all(|n| Number::every().any(|known| known == n)), "{name}");
        }
    });
}
