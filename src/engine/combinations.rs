//! What does not go together in a frame: one table. Errors are made from it, and `docs/reference/combinations.md` shows it.

use crate::camera::Camera;
use crate::camera::ray_order::is_incoherent;
use crate::engine::plan::slabs::kind;
use crate::engine::plan::{Plan, Wanted};
use crate::engine::rival::Choice;
use crate::gpu::kernels::RaysKind;
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::scene::{SPHERES_AND_CAUSTICS, Scene, VOLUME_AND_OPTICS};

/// Generates the features and their names from one table.
macro_rules! features {
    ($($feature:ident, $name:literal;)*) => {
        /// What a frame has, or what is asked of it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        // tests alone name the features that go with all others
        #[cfg_attr(not(feature = "internals"), allow(dead_code))]
        pub enum Feature {
            $($feature,)*
        }

        impl Feature {
            #[cfg(feature = "internals")]
            pub const ALL: [Feature; [$($name),*].len()] = [$(Feature::$feature),*];

            /// As the page calls it.
            #[cfg(feature = "internals")]
            pub fn name(self) -> &'static str {
                match self {
                    $(Feature::$feature => $name,)*
                }
            }
        }
    };
}

features! {
    NoSamples, "no samples";
    OneSample, "one sample per pixel";
    Samples, "several samples per pixel in one frame";
    ManySamples, "more than 32 samples per pixel in one frame";
    Analytic, "analytic coverage";
    Certified, "the channel `certified`";
    Outlines, "outlines or borders";
    Rows, "some rows of the image (strips)";
    Rival, "a rival";
    RivalOfOtherSamples, "a rival, and several samples per pixel in one frame that are not its own";
    RivalWithoutCulling, "a rival that culls nothing";
    NoCull, "`--no-cull`";
    Moving, "`--moving`";
    Caustics, "caustics";
    AlphaMasks, "alpha masks";
    Blended, "blended surfaces";
    Shadows, "shadows or ambient occlusion";
    Pictures, "pictures thrown onto surfaces";
    Curves, "curved rays, or layers of rays";
    Layers, "several layers of pieces";
    Optics, "a mirror or lens";
    Bounces, "a mirror or lens without an atlas";
    Atlas, "a mirror or lens with an atlas";
    LayeredOptics, "a mirror or lens seen along curves, or along layers of rays";
    Incoherent, "unrelated rays in neighbouring pixels";
    Bands, "an image larger than the adapter's bindings";
    Chunks, "a scene larger than the adapter's tables";
    Timed, "things that move while the frame is taken";
    Spheres, "spheres";
    Volume, "a volume";
    MovingCamera, "a camera that moves while the shutter is open";
    Raster, "`--method raster`";
    Aimed, "`Frames::aim`";
    Relit, "`Frames::light`";
    InSequence, "one of a sequence of frames";
    Gradients, "gradients";
    CoverageGradients, "gradients of coverage";
    CameraInMotion, "a camera that moves while the frame is taken";
    Composed, "a composite with `master` or `feather`";
}

/// Features of which a frame cannot have all.
#[derive(Debug)]
pub struct Refusal {
    pub features: &'static [Feature],
    /// Why, in a line; `{rival}`, `{own}` (samples of the rival), `{camera}`, `{samples}`, `{rows}` and `{chunks}` stand for the frame's own.
    pub reason: &'static str,
    /// What to do instead.
    pub remedy: &'static str,
}

/// What was asked for.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub wanted: &'a Wanted,
    pub rival: Option<Choice>,
    pub no_cull: bool,
    pub moving: bool,
    /// Rasterization is asked for.
    pub raster: bool,
    /// [`Feature::Aimed`], [`Feature::Relit`] or [`Feature::InSequence`], where a frame follows another one.
    pub change: Option<Feature>,
    /// Once it is planned, with the number of its chunks of triangles.
    pub planned: Option<(&'a Plan, usize)>,
}

/// All refusals, in the order in which they are looked for.
pub const REFUSALS: &[Refusal] = {
    use Feature::*;
    const fn refusal(features: &'static [Feature], reason: &'static str, remedy: &'static str) -> Refusal {
        Refusal { features, reason, remedy }
    }
    const WITHOUT_CERTIFIED: &str = "leave certified out";
    const WITHOUT_LINES: &str = "remove outline and borders from [style]";
    const ONE: &str = "render one frame per sample";
    const ANEW: &str = "call Engine::prepare again";
    const MOVES: &str = "make shutter and line_time 0";
    const WITHOUT_GRADIENTS: &str = "leave the gradients out";
    const SINGLE: &str = "use one sample per pixel";
    const ALONE: &str = "render this frame with Engine::render";
    &[
        refusal(
            &[Gradients, Samples],
            "gradients are those of the rays of pixel centres, not of {samples} samples",
            SINGLE,
        ),
        refusal(
            &[Gradients, Curves],
            "{camera} has curved or layered rays, which have no gradients",
            WITHOUT_GRADIENTS,
        ),
        refusal(
            &[Gradients, Layers],
            "{camera} has several layers of rays, which have no gradients",
            WITHOUT_GRADIENTS,
        ),
        refusal(&[Gradients, Spheres], "gradients are of triangles alone", WITHOUT_GRADIENTS),
        refusal(&[Gradients, Optics], "{camera} reflects or refracts rays, which have no gradients", WITHOUT_GRADIENTS),
        refusal(&[Gradients, Timed], "gradients are of one time", MOVES),
        refusal(&[Gradients, CameraInMotion], "gradients are of a camera that stands still", MOVES),
        refusal(&[Gradients, Rival], "{rival} has no gradients", "use --engine compute"),
        refusal(
            &[CoverageGradients, AlphaMasks],
            "gradients of coverage are of edges of triangles, not of alpha masks",
            "leave coverage out of the gradients",
        ),
        refusal(&[Timed, Rival], "{rival} sees the whole scene at one time", MOVES),
        refusal(&[Timed, Raster], "what moves while the frame is taken is traced", "leave out --method raster"),
        refusal(&[Timed, Certified], "pixels cannot be certified while things move", WITHOUT_CERTIFIED),
        refusal(&[Timed, Caustics], "caustics are of one time", MOVES),
        refusal(&[Timed, Atlas], "an atlas is of one time", "remove atlas"),
        refusal(&[Timed, Moving], "--moving is for scenes that stand still while a frame is taken", MOVES),
        refusal(&[Timed, Aimed], "Frames::aim does not support things that move while the frame is taken", ANEW),
        refusal(&[Timed, Samples], "while things move a frame takes 1 sample per pixel, not {samples}", ONE),
        refusal(
            &[MovingCamera, Samples],
            "while the camera moves a frame takes 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(&[Spheres, Rival], "{rival} draws triangles alone", "use --engine compute"),
        refusal(&[Spheres, Raster], "spheres are traced", "leave out --method raster"),
        refusal(
            &[Spheres, Certified, Curves],
            "{camera} has curved or layered rays, along which no pixel with spheres is certified",
            WITHOUT_CERTIFIED,
        ),
        refusal(&[Spheres, Caustics], SPHERES_AND_CAUSTICS[0], SPHERES_AND_CAUSTICS[1]),
        refusal(&[Spheres, Atlas], "an atlas is of triangles alone", "remove atlas"),
        refusal(&[Spheres, Samples], "with spheres a frame takes 1 sample per pixel, not {samples}", ONE),
        refusal(&[Volume, Samples], "with a volume a frame takes 1 sample per pixel, not {samples}", ONE),
        refusal(&[Volume, Optics], VOLUME_AND_OPTICS[0], VOLUME_AND_OPTICS[1]),
        refusal(&[Relit, Caustics], "the light cannot change with caustics", ANEW),
        refusal(&[Certified, Rival], "{rival} cannot certify pixels", "use --engine compute, or leave certified out"),
        refusal(
            &[Certified, Optics],
            "{camera} reflects or refracts rays, without bounds on where they go",
            WITHOUT_CERTIFIED,
        ),
        refusal(
            &[Certified, AlphaMasks, Curves],
            "{camera} has curved or layered rays, along which no pixel with alpha masks is certified",
            WITHOUT_CERTIFIED,
        ),
        refusal(&[NoSamples], "0 samples per pixel", "use at least 1"),
        refusal(&[Analytic, OneSample], "analytic coverage needs several samples per pixel", "use at least 2"),
        refusal(
            &[Analytic, AlphaMasks],
            "areas are of triangles, not of what alpha masks leave of them",
            "leave out analytic coverage",
        ),
        refusal(&[Analytic, Rival], "{rival} counts samples, and measures no areas", "leave out analytic coverage"),
        refusal(&[RivalOfOtherSamples], "{rival} renders {own} per pixel in a frame, not {samples}", ONE),
        refusal(&[Samples, Caustics], "with caustics a frame takes 1 sample per pixel, not {samples}", ONE),
        refusal(
            &[Samples, Blended],
            "each sample of a blended surface is another picture: a frame takes 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(
            &[Samples, Curves],
            "{camera} has curved or layered rays: a frame takes 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(
            &[Samples, Optics],
            "{camera} reflects or refracts rays: a frame takes 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(
            &[Samples, Incoherent],
            "rays of neighbouring pixels of {camera} are unrelated: a frame takes 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(
            &[ManySamples],
            "a frame takes at most 32 samples per pixel, not {samples}",
            "use at most 32, or one frame per sample",
        ),
        refusal(&[Rival, AlphaMasks], "{rival} ignores alpha masks", "use --engine compute"),
        refusal(
            &[Pictures, Caustics],
            "caustics are added to the colours of materials, not to pictures thrown onto them",
            "remove caustics or projector_light",
        ),
        refusal(
            &[Rival, Bounces],
            "{rival} does not follow reflected or refracted rays",
            "give the camera an atlas, or use --engine compute",
        ),
        refusal(&[RivalWithoutCulling, NoCull], "{rival} culls nothing", "leave out --no-cull"),
        refusal(
            &[Outlines, Atlas],
            "outlines and borders are not drawn with an atlas",
            "remove atlas, or outline and borders",
        ),
        refusal(
            &[Outlines, Incoherent],
            "outlines and borders compare neighbouring pixels, whose rays are unrelated in {camera}",
            WITHOUT_LINES,
        ),
        refusal(&[Rows, Outlines], "strips cannot draw outlines or borders", WITHOUT_LINES),
        refusal(
            &[Rows, Incoherent],
            "{camera} cannot be rendered in strips: rays of neighbouring pixels are unrelated",
            "render the whole image",
        ),
        refusal(
            &[Outlines, Bands],
            "outlines and borders need the whole image in one band; this adapter allows {rows} rows",
            "use a smaller --size",
        ),
        refusal(
            &[Analytic, Chunks],
            "analytic coverage needs all triangles in one table; this scene needs {chunks}",
            "leave --analytic out",
        ),
        refusal(&[Moving, Caustics], "caustics are computed once for all frames", "leave out --moving"),
        refusal(&[Aimed, Optics], "Frames::aim does not support {camera}: it reflects or refracts rays", ANEW),
        refusal(&[InSequence, Caustics], "a sequence does not support caustics", ALONE),
        refusal(
            &[LayeredOptics, Raster],
            "{camera} sees a mirror or lens along curved or layered rays, which are traced",
            "leave out --method raster",
        ),
        refusal(&[InSequence, Atlas], "a sequence does not support {camera} with an atlas", ALONE),
        refusal(
            &[Composed, Samples],
            "a frame of {camera} is composed of several of 1 sample per pixel, not {samples}",
            ONE,
        ),
        refusal(&[Composed, Rows], "strips cannot be composed of several frames", "render the whole image"),
        refusal(&[Composed, InSequence], "a sequence does not support frames that are composed of several", ALONE),
        refusal(&[Composed, Aimed], "Frames::aim does not support frames that are composed of several", ANEW),
        refusal(&[Composed, Moving], "--moving renders one frame again, not several", "leave out --moving"),
        refusal(&[Composed, Gradients], "gradients are of one frame, not of several", WITHOUT_GRADIENTS),
        refusal(
            &[Composed, Certified],
            "no pixel of a frame that is composed of several is certified",
            WITHOUT_CERTIFIED,
        ),
        refusal(
            &[Composed, Outlines],
            "outlines and borders are drawn in one frame, not across several",
            WITHOUT_LINES,
        ),
        refusal(
            &[Composed, CameraInMotion],
            "the cameras of a frame that is composed of several stand still while it is taken",
            MOVES,
        ),
        refusal(
            &[Composed, Volume],
            "a volume has no surface whose depth decides what is seen",
            "remove [volume] or use another camera",
        ),
        refusal(
            &[Composed, Caustics],
            "caustics are added to one frame, not to several",
            "remove [caustics] or use another camera",
        ),
    ]
};

impl Feature {
    /// The frame has it.
    pub fn is_in(self, asked: &Asked) -> bool {
        let Asked { scene, camera, wanted, rival, no_cull, moving, raster, change, planned } = asked;
        match self {
            Feature::NoSamples => wanted.samples == 0,
            Feature::OneSample => wanted.samples == 1,
            Feature::Samples => wanted.samples > 1,
            Feature::ManySamples => wanted.samples > AT_ONCE_MAX,
            Feature::Analytic => wanted.analytic,
            Feature::Certified => wanted.channels.contains(&Channel::Certified),
            Feature::Outlines => scene.style.is_between_pixels() && wanted.has_colour(),
            Feature::Rows => wanted.rows.is_some(),
            Feature::Rival => rival.is_some(),
            Feature::RivalOfOtherSamples => {
                wanted.samples > 1 && rival.is_some_and(|choice| choice.samples(camera) != wanted.samples)
            }
            Feature::RivalWithoutCulling => rival.is_some_and(|choice| !choice.technique.culls),
            Feature::NoCull => *no_cull,
            Feature::Moving => *moving,
            Feature::Timed => scene.steps.is_some(),
            Feature::Spheres => scene.mesh.base().has_spheres(),
            Feature::Volume => scene.volume.is_some(),
            Feature::MovingCamera => camera.moving.is_some() && scene.exposure.shutter > 0.0,
            Feature::Raster => *raster,
            Feature::Caustics => scene.caustics.is_some(),
            Feature::AlphaMasks => scene.mesh.base().has_alpha_masks(),
            Feature::Blended => scene.mesh.base().is_blended(),
            Feature::Shadows => {
                scene.has_shadows() && wanted.has_colour() || scene.hides_pictures() && wanted.needs_appearance()
            }
            Feature::Pictures => !scene.projector_lights.is_empty(),
            Feature::Curves => matches!(kind(camera), RaysKind::Curves { .. }),
            Feature::Layers => camera.layers.len() > 1 && kind(camera) == RaysKind::Pieces,
            Feature::Optics => camera.optics.is_some(),
            Feature::Bounces => camera.optics.as_ref().is_some_and(|o| o.atlas.is_none()),
            Feature::Atlas => camera.optics.as_ref().is_some_and(|o| o.atlas.is_some()),
            Feature::LayeredOptics => camera.optics.is_some() && camera.is_curved_or_layered(),
            Feature::Incoherent => is_incoherent(camera),
            Feature::Bands => planned.is_some_and(|(plan, _)| plan.bands.len() > 1),
            Feature::Chunks => planned.is_some_and(|(_, chunks)| chunks > 1),
            Feature::Gradients => wanted.gradients,
            Feature::CoverageGradients => wanted.coverage_gradients,
            Feature::CameraInMotion => camera.moving.is_some(),
            Feature::Composed => camera.layered().is_some(),
            Feature::Aimed | Feature::Relit | Feature::InSequence => *change == Some(self),
        }
    }
}

impl Refusal {
    /// The error, in a line.
    pub fn text(&self, asked: &Asked) -> String {
        let rival = asked.rival.map_or("", |choice| choice.technique.name);
        let own = match asked.rival.map_or(1, |choice| choice.samples(asked.camera)) {
            1 => "1 sample".to_owned(),
            several => format!("1 or {several} samples"),
        };
        let (rows, chunks) = asked.planned.map_or((0, 0), |(plan, chunks)| (plan.rows_max(), chunks));
        format!("{}; {}", self.reason, self.remedy)
            .replace("{rival}", rival)
            .replace("{own}", &own)
            .replace("{camera}", asked.camera.kind)
            .replace("{samples}", &asked.wanted.samples.to_string())
            .replace("{rows}", &rows.to_string())
            .replace("{chunks}", &chunks.to_string())
    }
}

impl<'a> Asked<'a> {
    /// Before it is planned.
    pub fn new(scene: &'a Scene, camera: &'a Camera, wanted: &'a Wanted) -> Asked<'a> {
        let (no_cull, moving, raster) = (false, false, false);
        Asked { scene, camera, wanted, rival: None, no_cull, moving, raster, change: None, planned: None }
    }

    /// The first row that refuses it.
    pub fn refusal(&self) -> Option<&'static Refusal> {
        REFUSALS.iter().find(|row| row.features.iter().all(|feature| feature.is_in(self)))
    }

    /// # Errors
    /// [`Error::Input`] of the first row that refuses it.
    pub fn check(&self) -> Result<()> {
        self.refusal().map_or(Ok(()), |row| Err(Error::input(row.text(self))))
    }
}

/// As many samples a pixel has at most in one frame.
pub const AT_ONCE_MAX: u32 = 32;

/// Whether one frame can take all samples: the kernels then sample edge pixels only. Otherwise each sample takes a frame.
pub fn at_once(scene: &Scene, camera: &Camera, count: u32) -> bool {
    let wanted = Wanted { samples: count.max(2), ..Wanted::of(Vec::new()) };
    Asked::new(scene, camera, &wanted).refusal().is_none()
}
