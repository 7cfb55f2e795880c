//! The implementations and constants that a variant chooses for its kernels.

use super::{
    Arithmetic, LightsKind, MaterialsKind, PrimitivesKind, RaysKind, SampleMeasure, SurfaceKind, Variant, VerticesKind,
    VolumeKind,
};
use crate::gpu::kernels::OpticsKind;
use crate::image::frame::Channel;

impl Variant {
    /// The implementations of an interface, the preferred one first: folders or files of `wgsl/INTERFACE`, or of `wgsl`
    /// where they begin with `/`, or paths of files.
    pub fn implementations(self, interface: &str) -> &'static [&'static str] {
        let is_incoherent = self.rays.kind == RaysKind::Field { incoherent: true };
        let has_optics = self.rays.optics.is_some();
        let measure = self.extras.samples.map(|samples| samples.measure);
        match interface {
            "arithmetic" if self.f64() => &["f64"],
            "arithmetic" => &["f32"],
            "bin/items" if self.draws_small() => &["/software/large_items"],
            "bin/items" => &["groups"],
            "caustics" if has_optics => &["bounced"],
            "caustics" => &["plain"],
            "depth" if self.bounds_t_in_raster() => &["bounded"],
            "depth" => &["exact"],
            "depth/columns" => match (self.rays.kind.is_field(), self.bounds_t_in_raster()) {
                (true, false) => &["field_exact"],
                (true, true) => &["field_bounded"],
                (false, false) => &["pieces_exact"],
                (false, true) => &["pieces_bounded"],
            },
            "keys" if self.path.atomics64 => &["u64"],
            "keys" => &["u32"],
            "lanes" if self.tiles().is_some_and(|tiles| tiles.wide) => &["part"],
            "lanes" => &["whole"],
            "lanes/loads" if self.loads_by_lanes() => &["/software/loads"],
            "lanes/loads" => &["threads"],
            "masks" if self.is_masked() => &["masked"],
            "masks" => &["opaque"],
            "nodes/item_rays" => match (is_incoherent && self.extras.culling, self.loads_by_lanes()) {
                (true, true) => &["/software/incoherent_item_rays"],
                (true, false) => &["incoherent"],
                (false, _) => &["coherent"],
            },
            "nodes/tile_rays" if is_incoherent => &["incoherent"],
            "nodes/tile_rays" => &["coherent"],
            "optics" => match self.optics() {
                Some(OpticsKind::Quadrics) => &["quadrics", "smooth"],
                Some(OpticsKind::Torus) => &["torus", "smooth"],
                Some(OpticsKind::Wave) => &["wave", "smooth"],
                Some(OpticsKind::Facets | OpticsKind::Atlas) | None => &["facets"],
            },
            // only straight rays meet a smooth surface
            "optics/arrival" if self.rays.kind.is_curved() && !self.meets() => &["curved"],
            "optics/arrival" => &["straight"],
            "optics/seen" if has_optics => &["bounced"],
            "optics/seen" => &["own"],
            "optics/start" if self.is_bounced() => &["bounced"],
            "optics/start" => &["anywhere"],
            "pairs" if self.by_tile() => &["by_tile"],
            "pairs" => &["by_pair"],
            "pixels" if self.is_bounced() => &["live"],
            "pixels" => &["every"],
            "pixels/tiles" if self.is_bounced() => &["/pixels/live"],
            "pixels/tiles" => &["every"],
            "primitives" if self.has_round() => &["round"],
            "primitives" => &["triangles"],
            "rays" => match self.rays.kind {
                RaysKind::Pieces => &["pieces", "straight"],
                RaysKind::Field { .. } => &["field", "straight"],
                RaysKind::Curves { .. } => &["curves"],
            },
            "samples/measure" if measure == Some(SampleMeasure::Area) => &["areas"],
            "samples/measure" => &["counted"],
            "samples/shaded_part" if measure == Some(SampleMeasure::AtCentre) => &["centre"],
            "samples/shaded_part" => &["seen"],
            "shading/casters" if self.is_timed() => &["timed"],
            "shading/casters" => &["still"],
            "shading/colors" if self.surfaces() == SurfaceKind::Colored => &["colored"],
            "shading/colors" => &["uncolored"],
            "shading/lights" => match self.appearance.lights {
                LightsKind::Plain => &["plain"],
                LightsKind::Positional { .. } => &["positional"],
                LightsKind::Shadowed { .. } => &["shadowed", "positional"],
            },
            "shading/materials" if self.appearance.materials == MaterialsKind::Matte => &["matte"],
            "shading/materials" => &["glossy"],
            "shading/pictures" if self.appearance.lights.has_pictures() => &["thrown"],
            "shading/pictures" => &["none"],
            "shading/sky" if self.appearance.materials == MaterialsKind::UnderSky => &["image"],
            "shading/sky" => &["constant"],
            "shading/styles" if self.appearance.styled => &["drawn"],
            "shading/styles" => &["plain"],
            "shading/textures" if self.appearance.textures.is_some() => &["mapped"],
            "shading/textures" => &["plain"],
            "shading/written" if self.extras.writes => &["now"],
            "shading/written" => &["later"],
            "vertices" => match self.extras.vertices {
                VerticesKind::Still => &["still"],
                VerticesKind::Timed => &["timed", "still"],
                VerticesKind::Placed => &["placed", "still"],
            },
            "volume/light" if self.extras.volume == Some(VolumeKind::Lit) => &["lit"],
            "volume/light" => &["unlit"],
            "volume/passed" if self.extras.volume == Some(VolumeKind::Maximum) => &["maximum"],
            "volume/passed" => &["composite"],
            _ => &[],
        }
    }

    /// The value of an `override` constant of kernels whose frames have these planes, unless it is the default one.
    pub fn constant(self, name: &str, planes: &[Channel]) -> Option<f64> {
        let flag = |value: bool| Some(f64::from(u8::from(value)));
        match name {
            "ALL_UNCERTAIN" => flag(self.path.arithmetic == Arithmetic::Double && self.rechecks()),
            "CAPSULES" => flag(self.extras.primitives == PrimitivesKind::Capsules),
            "COUNTING" => flag(self.extras.counting),
            "CULLING" => flag(self.extras.culling),
            "DEGREE" => {
                if let RaysKind::Curves { degree } = self.rays.kind {
                    Some(f64::from(degree))
                } else {
                    None
                }
            }
            "FOLLOWS_RAYS" => {
                let is_of_keys = |channel: &Channel| matches!(channel, Channel::T | Channel::A | Channel::TriangleId);
                flag(self.extras.writes || !planes.iter().all(is_of_keys))
            }
            "NORMALS" => flag(self.appearance.normals),
            "SAMPLES" => Some(f64::from(self.samples())),
            "SAMPLE_REACH" => Some(self.sample_reach()),
            "SLABBED" => flag(self.rays.slabbed),
            "SMOOTH" => flag(self.meets()),
            // of four samples of a pixel
            "STRIPS" => Some(f64::from(self.samples().div_ceil(4))),
            _ => {
                let channel = name.strip_prefix("PLANE_")?;
                planes.iter().position(|plane| plane_name(*plane) == channel).map(|plane| plane as f64)
            }
        }
    }
}

/// A channel in the names of constants: `BARY_U` for `bary.u`.
fn plane_name(channel: Channel) -> String {
    channel.name().to_uppercase().replace('.', "_")
}
