//! What the project's own tests, benches and laboratory use of the product's inside. Nothing here is stable.
//!
//! An item that is needed from outside gets a name in this list; everything else stays private, so that the compiler finds dead code.

pub mod camera {
    pub use crate::camera::{
        Bundle, Camera, Curve, CurveMap, Curves, Field, Piece, Pieces, Ray, RayMap, Rays, TILE, glc, kinds, mesh,
    };
    pub mod bundle {
        pub use crate::camera::bundle::{Bundle, Ray};
    }
    pub mod change {
        pub use crate::camera::change::{PixelRay, Rate, rate};
    }
    pub use crate::camera::composition;
    pub mod curve {
        pub use crate::camera::curve::{Curve, CurveMap, Curves};
    }
    pub mod exposure {
        pub use crate::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
    }
    pub mod moving {
        pub use crate::camera::moving::Moving;
    }
    pub mod optics {
        pub use crate::camera::optics::{Bounce, FLAT_LEAST, Facets, Law, Optics, Quadric, Smooth, Surface};
    }
    pub mod perturb {
        pub use crate::camera::perturb::{EDGE_ON, END_REACH, PERTURB, PERTURB_PX, scene_size};
    }
    pub mod pieces {
        pub use crate::camera::pieces::{Piece, Pieces};
    }
    pub mod project {
        pub use crate::camera::project::{Degenerate, Image, Images, Projector};
        pub mod tree {
            pub use crate::camera::project::tree::{INNER, Tree, WHOLE, place_key};
        }
    }
    pub mod recipe {
        pub use crate::camera::recipe::{Built, Setting, Surroundings};
    }
    pub mod spec {
        pub use crate::camera::spec::{CameraKind, CameraSpec};
    }
    pub mod tessellate {
        pub use crate::camera::tessellate::Tessellation;
    }
}
pub mod engine {
    pub use crate::engine::{
        Arithmetic, Capacities, Counts, Engine, Frames, Method, Rendered, RunOptions, rival, stage, tables,
    };
    pub mod bounces {
        pub use crate::engine::bounces::bounces;
    }
    pub mod buffer_table {
        pub use crate::engine::buffer_table::table;
    }
    pub mod changes {
        pub use crate::engine::changes::Dirty;
    }
    pub mod clusters {
        pub use crate::engine::clusters::{CORNER_ORDERS, Chunk, Clustered, cluster, surfaces::mapped_surfaces};
    }
    pub mod combinations {
        pub use crate::engine::combinations::{Asked, Feature, REFUSALS, Refusal, at_once};
    }
    pub mod in_view {
        pub use crate::engine::in_view::rays::ImageRays;
    }
    pub mod left_out {
        pub use crate::engine::left_out::LeftOut;
    }
    pub mod pages {
        pub use crate::engine::pages::PageStore;
    }
    pub mod plan {
        pub use crate::engine::plan::{
            Band, Plan, PlanTarget, Rows, SceneContents, SceneExtent, SceneShape, Wanted, slabs,
        };
        pub mod beams {
            pub use crate::engine::plan::beams::Beams;
        }
        pub mod curves {
            pub use crate::engine::plan::curves::RayTable;
        }
        pub mod fit {
            pub use crate::engine::plan::fit::{Fit, LOOSE, LOOSE_SIZE};
        }
        pub mod hierarchy {
            pub use crate::engine::plan::hierarchy::{Hierarchy, leaf_triangle};
        }
        pub mod nodes {
            pub use crate::engine::plan::nodes::{DISCONTINUOUS_WIDTH, Level, Nodes, WidthMeasure};
        }
        pub mod pages {
            pub use crate::engine::plan::pages::Pages;
        }
        pub mod samples {
            pub use crate::engine::plan::samples::sample_offsets;
        }
        pub mod solve {
            pub use crate::engine::plan::solve::SolveTable;
            pub mod cells {
                pub use crate::engine::plan::solve::cells::CellTable;
            }
        }
        pub mod tiles {
            pub use crate::engine::plan::tiles::{TileFits, TileRay, TileRays, packed_piece};
        }
        pub mod turned {
            pub use crate::engine::plan::turned::Turned;
        }
        pub mod variant {
            pub use crate::engine::plan::variant::variant;
        }
    }
    pub mod planned {
        pub use crate::engine::planned::{Planned, Planner};
    }
    pub mod report {
        pub use crate::engine::report::FrameMs;
    }
    pub mod sequence {
        pub use crate::engine::sequence::Sequence;
    }
    pub mod steps {
        pub use crate::engine::steps::{FrameInputs, Step, StepScope, passes, steps};
    }
    pub mod surface {
        pub use crate::engine::surface::OpticsSurface;
    }
}
pub mod geometry {
    pub use crate::geometry::{dae, generate, gltf, heights, obj, off, place, ply, stl};
    pub mod bernstein {
        pub use crate::geometry::bernstein::Bernstein;
    }
    pub mod cast {
        pub use crate::geometry::cast::{Caster, ExactCaster, Hit, Ray};
    }
    pub mod load {
        pub use crate::geometry::load::Object;
    }
    pub mod instances {
        pub use crate::geometry::instances::{Instance, Instances, at_places};
    }
    pub mod mesh {
        pub use crate::geometry::mesh::{DIELECTRIC, Material, Mesh, NO_COLOR, NO_UV};
    }
    pub mod pattern {
        pub use crate::geometry::pattern::{Pattern, PatternKind};
    }
    pub mod scene_mesh {
        pub use crate::geometry::scene_mesh::SceneMesh;
    }
    pub mod spheres {
        pub use crate::geometry::spheres::{Join, round_of, spheres_of};
    }
    pub mod texture {
        pub use crate::geometry::texture::{Images, Texels, Texture, Wrap};
    }
    pub mod time_steps {
        pub use crate::geometry::time_steps::{TimeStep, TimeSteps};
    }
}
pub mod gpu {
    pub use crate::gpu::{Gpu, GpuOptions, exact, layout};
    pub mod buffers {
        pub use crate::gpu::buffers::{Binder, Buffers, Pipeline, wait};
    }
    pub mod compile {
        pub use crate::gpu::compile::{Module, lowered};
    }
    pub mod device {
        pub use crate::gpu::device::{AdapterFeatures, GpuOptions, NO_ADAPTER, adapters, label};
    }
    pub mod draw_counts {
        pub use crate::gpu::draw_counts::DrawCounts;
    }
    pub mod kernels {
        pub use crate::gpu::kernels::{
            Access, AdapterPath, Appearance, Binding, EdgeSamples, Extras, File, Files, Kernel, LightsKind,
            MaterialsKind, Method, OpticsKind, OpticsModel, PrimitivesKind, RayModel, RaysKind, SampleMeasure,
            SurfaceKind, Textures, TileDepths, TilePath, Variant, VerticesKind, Visibility, VolumeKind, reached,
            storage_buffers,
        };
    }
    pub mod needs {
        pub use crate::gpu::needs::{NEEDS, STORAGE_BUFFERS, STORAGE_BUFFERS_BY_TILE, lacks};
    }
    pub mod readback {
        pub use crate::gpu::readback::{PendingRead, read_words, readback};
    }
    pub mod recorder {
        pub use crate::gpu::recorder::Recorder;
        pub mod drawing {
            pub use crate::gpu::recorder::drawing::DrawPass;
        }
    }
    pub mod single {
        pub use crate::gpu::single::{run, words};
    }
}
pub mod image {
    pub use crate::image::{
        png_bytes, read_exr, read_exr_texts, read_npy_rows, read_pairs, read_points, read_text_points, read_vectors,
        rgb8, srgb8, toned8, write_exr, write_npy as write_npy_f64, write_png, write_text,
    };
    pub mod compare {
        pub use crate::image::compare::{Comparison, Quantiles, compare};
    }
    pub mod frame {
        pub use crate::image::frame::{Channel, Frame, NO_ID, PixelValues, Plane, plane_of_words};
    }
    pub mod tone {
        pub use crate::image::tone::{Curve, Tone};
    }
}
pub mod input {
    pub use crate::input::{Error, Limits, Loading, Result};
    pub mod files {
        pub use crate::input::files::Inputs;
    }
}
pub mod jobs {
    pub use crate::jobs::{Backend, counted, outputs};
    pub mod project {
        pub use crate::jobs::project::project_many;
    }
    pub mod splat {
        pub use crate::jobs::splat::splat;
    }
}
pub mod reference {
    pub use crate::reference::{Outcome, Path, Reference, Segment, image};
    pub mod caustics {
        pub use crate::reference::caustics::{caustics, photons};
    }
    pub mod gradient {
        pub use crate::reference::gradient::{Direction, Edge, PixelChange, changes};
    }
}
pub mod scene {
    pub use crate::scene::{Scene, file};
    pub mod caustics {
        pub use crate::scene::caustics::{CausticMaps, Map};
        pub mod beams {
            pub use crate::scene::caustics::beams::{CHANNELS, Fate};
        }
        pub mod receiver_triangles {
            pub use crate::scene::caustics::receiver_triangles::ReceiverTriangles;
        }
        pub mod shares {
            pub use crate::scene::caustics::shares::{LINE_WIDTH, shares};
        }
    }
    pub mod gradients {
        pub use crate::scene::gradients::{Changes, HIT_NUMBERS, NONE, Seen, VERTEX_DIRECTIONS};
    }
    pub mod light {
        pub use crate::scene::light::{AmbientOcclusion, Light, Source};
    }
    pub mod motion {
        pub use crate::scene::motion::{NEEDED, motion};
    }
    pub mod projector_light {
        pub use crate::scene::projector_light::{Mode, ProjectorLight, Throw};
    }
    pub mod sky {
        pub use crate::scene::sky::Sky;
    }
    pub mod style {
        pub use crate::scene::style::{Hatching, Line, Outline, Style};
    }
    pub mod volume {
        pub use crate::scene::volume::{ControlPoint, Grid, Mode, Volume, placed};
        pub mod load {
            pub use crate::scene::volume::load::load_grid;
        }
        pub mod spec {
            pub use crate::scene::volume::spec::{GridSource, GridSpec, Placement};
        }
    }
}
pub mod tools {
    pub use crate::tools::{cli, self_test};
    pub mod example {
        pub use crate::tools::example::{EXAMPLES, Example};
    }
}
