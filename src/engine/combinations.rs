//! What does not go together in a frame: one table. Errors are made from it, and `docs/reference/combinations.md` shows it.

use crate::camera::Camera;
use crate::camera::ray_order::is_incoherent;
use crate::engine::RunOptions;
use crate::engine::plan::slabs::kind;
use crate::engine::plan::{Plan, Wanted};
use crate::engine::rival::Choice;
use crate::gpu::kernels::RaysKind;
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::scene::{Scene, VOLUME_AND_OPTICS};

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
    OneSample, "one sample per pixel";
    Samples, "several samples per pixel";
    Separate, "several samples per pixel, each in a frame of its own";
    Analytic, "analytic coverage";
    Certified, "the channel `certified`";
    Outlines, "outlines or borders";
    Rows, "some rows of the image (strips)";
    Moving, "`--moving`";
    Caustics, "caustics";
    AlphaMasks, "alpha masks";
    Blended, "blended surfaces";
    Shadows, "shadows or ambient occlusion";
    Pictures, "pictures thrown onto surfaces";
    Curves, "curved rays, or layers of rays";
    Layers, "several layers of pieces";
    Optics, "a mirror or lens";
    Atlas, "a mirror or lens with an atlas";
    Incoherent, "unrelated rays in neighbouring pixels";
    Bands, "an image larger than the adapter's bindings";
    Chunks, "a scene larger than the adapter's tables";
    Timed, "things that move while the frame is taken";
    Spheres, "spheres";
    Volume, "a volume";
    Gradients, "gradients";
    CoverageGradients, "gradients of coverage";
    CameraInMotion, "a camera that moves while the frame is taken";
    Composed, "a composite with `master` or `feather`";
}

/// Features of which a frame cannot have all.
#[derive(Debug)]
pub struct Refusal {
    pub features: &'static [Feature],
    /// Why, in a line; `{camera}` and `{chunks}` stand for the frame's own.
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
    const MOVES: &str = "make shutter and line_time 0";
    const WITHOUT_GRADIENTS: &str = "leave the gradients out";
    &[
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
        refusal(
            &[CoverageGradients, AlphaMasks],
            "gradients of coverage are of edges of triangles, not of alpha masks",
            "leave coverage out of the gradients",
        ),
        refusal(&[Timed, Certified], "pixels cannot be certified while things move", WITHOUT_CERTIFIED),
        refusal(&[Timed, Caustics], "caustics are of one time", MOVES),
        refusal(&[Timed, Atlas], "an atlas is of one time", "remove atlas"),
        refusal(
            &[Spheres, Certified, Curves],
            "{camera} has curved or layered rays, along which no pixel with spheres is certified",
            WITHOUT_CERTIFIED,
        ),
        refusal(&[Volume, Optics], VOLUME_AND_OPTICS[0], VOLUME_AND_OPTICS[1]),
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
        refusal(&[Analytic, OneSample], "analytic coverage needs several samples per pixel", "use at least 2"),
        refusal(
            &[Analytic, Separate],
            "areas are found in one frame, and here each sample takes a frame",
            "leave out analytic coverage",
        ),
        refusal(
            &[Analytic, AlphaMasks],
            "areas are of triangles, not of what alpha masks leave of them",
            "leave out analytic coverage",
        ),
        refusal(
            &[Pictures, Caustics],
            "caustics are added to the colours of materials, not to pictures thrown onto them",
            "remove caustics or projector_light",
        ),
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
        refusal(
            &[Rows, Incoherent],
            "{camera} cannot be rendered in strips: rays of neighbouring pixels are unrelated",
            "render the whole image",
        ),
        refusal(
            &[Analytic, Chunks],
            "analytic coverage needs all triangles in one table; this scene needs {chunks}",
            "leave out analytic coverage",
        ),
        refusal(&[Composed, Gradients], "gradients are of one frame, not of several", WITHOUT_GRADIENTS),
        refusal(
            &[Composed, Outlines],
            "outlines and borders are drawn in one frame, not across several",
            WITHOUT_LINES,
        ),
    ]
};

impl Feature {
    /// The frame has it.
    pub fn is_in(self, asked: &Asked) -> bool {
        let Asked { scene, camera, wanted, moving, planned, .. } = asked;
        match self {
            Feature::OneSample => wanted.samples == 1,
            Feature::Samples => wanted.samples > 1,
            Feature::Separate => asked.is_separate(),
            Feature::Analytic => wanted.analytic,
            Feature::Certified => wanted.channels.contains(&Channel::Certified),
            Feature::Outlines => scene.style.line_reach() > 0 && wanted.has_colour(),
            Feature::Rows => wanted.rows.is_some(),
            Feature::Moving => *moving,
            Feature::Timed => scene.steps.is_some(),
            Feature::Spheres => scene.mesh.base().has_spheres(),
            Feature::Volume => scene.volume.is_some(),
            Feature::Caustics => scene.caustics.is_some(),
            Feature::AlphaMasks => scene.mesh.base().has_alpha_masks(),
            Feature::Blended => scene.mesh.base().is_blended(),
            Feature::Shadows => {
                scene.has_shadows() && wanted.has_colour() || scene.hides_pictures() && wanted.needs_appearance()
            }
            Feature::Pictures => !scene.projector_lights.is_empty(),
            Feature::Curves => kind(camera).is_curved(),
            Feature::Layers => camera.layers.len() > 1 && kind(camera) == RaysKind::Pieces,
            Feature::Optics => camera.optics.is_some(),
            Feature::Atlas => camera.optics.as_ref().is_some_and(|o| o.atlas.is_some()),
            Feature::Incoherent => is_incoherent(camera),
            Feature::Bands => planned.is_some_and(|(plan, _)| plan.bands.len() > 1),
            Feature::Chunks => planned.is_some_and(|(_, chunks)| chunks > 1),
            Feature::Gradients => wanted.gradients,
            Feature::CoverageGradients => wanted.coverage_gradients,
            Feature::CameraInMotion => camera.moving.is_some(),
            Feature::Composed => camera.layered().is_some(),
        }
    }
}

impl Refusal {
    /// The error, in a line.
    pub fn text(&self, asked: &Asked) -> String {
        let chunks = asked.planned.map_or(0, |(_, chunks)| chunks);
        format!("{}; {}", self.reason, self.remedy)
            .replace("{camera}", asked.camera.kind)
            .replace("{chunks}", &chunks.to_string())
    }
}

impl<'a> Asked<'a> {
    /// Before it is planned.
    pub fn new(scene: &'a Scene, camera: &'a Camera, wanted: &'a Wanted) -> Asked<'a> {
        Asked { scene, camera, wanted, rival: None, no_cull: false, moving: false, planned: None }
    }

    /// The frame that is rendered with these options.
    pub fn of(scene: &'a Scene, camera: &'a Camera, wanted: &'a Wanted, run: &RunOptions) -> Asked<'a> {
        let RunOptions { rival, no_cull, moving, .. } = *run;
        Asked { rival, no_cull, moving, ..Asked::new(scene, camera, wanted) }
    }

    /// Several samples per pixel are wanted, each of which takes a frame.
    pub fn is_separate(&self) -> bool {
        let Asked { scene, camera, wanted: Wanted { samples, .. }, rival, .. } = *self;
        let is_blurred = camera.moving.is_some() && scene.exposure.shutter > 0.0;
        let has_others = rival.is_some_and(|choice| choice.samples(camera) != *samples);
        let is_alone = *samples > AT_ONCE_MAX || is_blurred || has_others;
        *samples > 1 && (is_alone || A_FRAME_PER_SAMPLE.into_iter().any(|feature| feature.is_in(self)))
    }

    /// The first row that refuses it.
    pub fn refusal(&self) -> Option<&'static Refusal> {
        REFUSALS.iter().find(|row| row.features.iter().all(|feature| feature.is_in(self)))
    }

    /// # Errors
    /// [`Error::Input`] of the first row that refuses it, or of what the rival does not render.
    pub fn check(&self) -> Result<()> {
        if self.wanted.samples == 0 {
            return Err(Error::input("0 samples per pixel; use at least 1"));
        }
        self.refusal().map_or(Ok(()), |row| Err(Error::input(row.text(self))))?;
        self.rival.map_or(Ok(()), |choice| choice.check(self))
    }
}

/// The largest number of samples per pixel in one frame.
pub const AT_ONCE_MAX: u32 = 32;

/// Features with which each sample of a pixel takes a frame of its own.
const A_FRAME_PER_SAMPLE: [Feature; 9] = [
    Feature::Timed,
    Feature::Spheres,
    Feature::Volume,
    Feature::Caustics,
    Feature::Blended,
    Feature::Curves,
    Feature::Optics,
    Feature::Incoherent,
    Feature::Composed,
];

/// Whether one frame renders all samples. Its kernels then compute the samples of edge pixels only.
#[cfg(feature = "internals")]
pub fn at_once(scene: &Scene, camera: &Camera, count: u32) -> bool {
    let wanted = Wanted { samples: count.max(2), ..Wanted::of(Vec::new()) };
    !Asked::new(scene, camera, &wanted).is_separate()
}
