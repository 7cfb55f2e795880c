//! What kernels are compiled for: the set of kernels that a scene, a camera and an adapter need.

use super::optics::OpticsKind;
use crate::image::frame::Channel;

/// How the kernels hold a camera's rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RaysKind {
    /// Affine pieces.
    Pieces,
    /// A ray a pixel.
    Field,
    /// A Bezier curve a pixel and layer, all of this degree.
    Curves { degree: u32 },
}

/// How the triangle of each pixel is found. All see the same ones, but where two are level to within the rounding of f64.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// The one that costs less.
    #[default]
    Auto,
    /// Triangles are projected: the stages from cull to raster.
    Raster,
    /// Rays are traced through a bounding volume hierarchy: the stage trace.
    Trace,
}

/// What the kernels know of lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightsKind {
    /// Directional white lights only.
    Plain,
    /// Coloured and positional lights too.
    Positional,
    /// And shadows.
    Shadowed,
}

/// What the table of surfaces holds of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceKind {
    /// Normals and material.
    Plain,
    /// And texture coordinates.
    Mapped,
    /// And the colours of its corners.
    Colored,
}

/// What is seen of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeKind {
    /// The light that it sends out and absorbs.
    Plain,
    /// The same in the scene's light.
    Lit,
    /// The largest value along a ray.
    Maximum,
}

/// Which variants of the kernels a scene and an adapter need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// Rechecks, depths and shading in f64; else all in f32.
    pub f64: bool,
    /// One 64-bit atomic a fragment; without it two dispatches of 32-bit ones.
    pub atomics64: bool,
    /// Raster by tile finds each t in f64; else it bounds t in f32, as trace does, and recheck finds it once a pixel.
    pub f64_depths: bool,
    /// `raster` goes tile by tile, not pair by pair.
    pub by_tile: bool,
    /// Subgroups have more threads than a tile has columns: those of a tile are a part of one.
    pub wide: bool,
    /// Which of trace and the stages from cull to raster there are; [`Method::Auto`]: both.
    pub method: Method,
    /// `small` draws the triangles of few pixels, and bin pairs the others with tiles.
    pub small: bool,
    pub rays: RaysKind,
    /// The rays are incoherent even after sorting: they are tested one by one against boxes.
    pub incoherent: bool,
    /// The tiles of several layers, or of several spans of t, are stacked below each other.
    pub slabbed: bool,
    /// Count tested and kept fragments.
    pub counting: bool,
    /// `cull` leaves out what a node's rays do not meet.
    pub culling: bool,
    /// Bounds in f32 prove nothing: all is left to `recheck`.
    pub all_uncertain: bool,
    /// The scene has normals of its own.
    pub normals: bool,
    /// Images lie on triangles, their texture coordinates are asked for, or vertices have colours.
    pub textured: bool,
    /// Vertices have colours.
    pub colored: bool,
    /// Some of these images are alpha masks.
    pub masked: bool,
    /// Some material is not matte.
    pub glossy: bool,
    /// Light comes from all around by an image of it.
    pub sky: bool,
    pub lights: LightsKind,
    /// Pictures are thrown onto surfaces.
    pub pictures: bool,
    /// Patterns, lines or strokes are drawn on surfaces.
    pub styled: bool,
    /// Lines are drawn between pixels.
    pub outlined: bool,
    /// A mirror reflects rays, or a lens refracts them.
    pub optics: Option<OpticsKind>,
    /// The rays have bounced there, and start on it.
    pub bounced: bool,
    /// Samples of an edge pixel, 32 at most; 1: its centre alone, and no pixel is looked at for edges.
    pub samples: u32,
    /// A triangle's share of an edge pixel is its visible area, not the number of samples that see it.
    pub analytic: bool,
    /// The rasterizer takes such a pixel's samples, and shades at its centre.
    pub centred: bool,
    /// Vertices move while the frame is taken, and each pixel sees them at a moment of its own.
    pub timed: bool,
    /// There are spheres beside triangles.
    pub spheres: bool,
    /// Meshes stand in several places, and the tables hold each once.
    pub instanced: bool,
    /// Rays pass through a volume.
    pub volume: Option<VolumeKind>,
    /// `shade` writes 8-bit sRGB itself: it is wanted, and no later stage changes colours.
    pub writes: bool,
}

impl Variant {
    /// A scene without normals, images, lines or samples, through pieces, on an adapter without f64 and 64-bit atomics.
    #[cfg(feature = "internals")]
    pub const PLAIN: Variant = Variant {
        f64: false,
        atomics64: false,
        f64_depths: false,
        by_tile: false,
        wide: false,
        method: Method::Raster,
        small: false,
        rays: RaysKind::Pieces,
        incoherent: false,
        slabbed: false,
        counting: false,
        culling: true,
        all_uncertain: false,
        normals: false,
        textured: false,
        colored: false,
        masked: false,
        glossy: false,
        sky: false,
        lights: LightsKind::Plain,
        pictures: false,
        styled: false,
        outlined: false,
        optics: None,
        bounced: false,
        samples: 1,
        analytic: false,
        centred: false,
        timed: false,
        spheres: false,
        instanced: false,
        volume: None,
        writes: false,
    };

    pub fn surfaces(self) -> SurfaceKind {
        match (self.textured, self.colored) {
            (_, true) => SurfaceKind::Colored,
            (true, false) => SurfaceKind::Mapped,
            (false, false) => SurfaceKind::Plain,
        }
    }

    /// Every variant that some camera needs on an adapter with these abilities.
    #[cfg(feature = "internals")]
    pub fn every(f64: bool, atomics64: bool) -> Vec<Variant> {
        let plain = Variant { f64, atomics64, f64_depths: f64 && atomics64, ..Variant::PLAIN };
        let mut list = Vec::new();
        for more in [false, true] {
            let [counting, normals, textured, colored, glossy, sky] = [more; 6];
            let [styled, outlined] = [more; 2];
            let lights = if more { LightsKind::Shadowed } else { LightsKind::Plain };
            let of_camera =
                Variant { counting, normals, textured, colored, glossy, sky, lights, styled, outlined, ..plain };
            let variant = |rays, slabbed, optics| {
                let incoherent = more && rays == RaysKind::Field;
                Variant { rays, incoherent, slabbed, optics, ..of_camera }
            };
            let curves = [1, 2, 3].map(|degree| RaysKind::Curves { degree });
            for rays in [RaysKind::Pieces, RaysKind::Field].into_iter().chain(curves) {
                list.extend([false, true].map(|slabbed| variant(rays, slabbed, None)));
            }
            for (rays, slabbed) in [(RaysKind::Pieces, false), (RaysKind::Pieces, true), (RaysKind::Field, false)] {
                list.push(Variant { samples: 4, analytic: more, ..variant(rays, slabbed, None) });
            }
            list.push(Variant { samples: 4, centred: true, ..variant(RaysKind::Pieces, false, None) });
            if textured {
                let kinds = [RaysKind::Pieces, RaysKind::Field, RaysKind::Curves { degree: 3 }];
                list.extend(kinds.map(|rays| Variant { masked: true, colored: false, ..variant(rays, false, None) }));
                let slabbed = Variant { masked: true, ..variant(RaysKind::Pieces, true, None) };
                let seen = Variant { masked: true, ..variant(RaysKind::Pieces, false, Some(OpticsKind::Facets)) };
                list.extend([slabbed, seen, seen.after_bounce()]);
                let sampled = [RaysKind::Pieces, RaysKind::Field].map(|rays| variant(rays, false, None));
                list.extend(sampled.map(|of| Variant { samples: 4, masked: true, lights, ..of }));
                let traced = |variant| Variant { method: Method::Trace, masked: true, ..variant };
                let moving = Variant { timed: true, spheres: true, ..variant(RaysKind::Field, false, None) };
                let curved = variant(RaysKind::Curves { degree: 2 }, true, Some(OpticsKind::Facets));
                list.extend([variant(RaysKind::Pieces, false, None), moving, curved].map(traced));
            }
            let methods = [Method::Auto, Method::Trace];
            list.extend(methods.map(|method| Variant { method, ..variant(RaysKind::Pieces, more, None) }));
            list.push(Variant { method: Method::Trace, ..variant(RaysKind::Field, false, None) });
            list.extend(curves.map(|rays| Variant { method: Method::Trace, ..variant(rays, true, None) }));
            let timed = |rays, optics| Variant { method: Method::Trace, timed: true, ..variant(rays, false, optics) };
            list.extend([RaysKind::Pieces, RaysKind::Field, curves[2]].map(|rays| timed(rays, None)));
            let seen = timed(RaysKind::Pieces, Some(OpticsKind::Facets));
            list.extend([seen, seen.after_bounce()]);
            let spheres = |variant| Variant { method: Method::Trace, spheres: true, ..variant };
            let of_rays = [RaysKind::Pieces, RaysKind::Field].map(|rays| spheres(variant(rays, false, None)));
            list.extend(of_rays);
            list.extend([spheres(variant(RaysKind::Pieces, true, None)), spheres(timed(RaysKind::Pieces, None))]);
            let seen = spheres(variant(RaysKind::Pieces, false, Some(OpticsKind::Quadrics)));
            list.extend([seen, seen.after_bounce()]);
            list.extend(curves.map(|rays| spheres(variant(rays, true, None))));
            let lights = if more { LightsKind::Positional } else { LightsKind::Plain };
            let instanced = |variant| Variant { method: Method::Trace, instanced: true, lights, ..variant };
            list.extend([RaysKind::Pieces, RaysKind::Field].map(|rays| instanced(variant(rays, false, None))));
            list.push(instanced(variant(RaysKind::Pieces, true, None)));
            list.push(Variant { writes: true, ..variant(RaysKind::Field, false, None) });
            list.push(Variant { lights: LightsKind::Positional, ..variant(RaysKind::Pieces, false, None) });
            let thrown = |of: Variant| {
                let lights = if more { LightsKind::Shadowed } else { LightsKind::Positional };
                Variant { pictures: true, textured: true, lights, ..of }
            };
            let kinds = [RaysKind::Pieces, RaysKind::Field, curves[2]];
            list.extend(kinds.map(|rays| thrown(variant(rays, false, None))));
            let seen = variant(RaysKind::Pieces, false, Some(OpticsKind::Facets)).after_bounce();
            let samples = Variant { samples: 4, ..variant(RaysKind::Pieces, false, None) };
            list.extend([timed(RaysKind::Pieces, None), seen, samples].map(thrown));
            let kinds = [VolumeKind::Plain, VolumeKind::Lit, VolumeKind::Maximum];
            for (rays, slabbed) in [(RaysKind::Pieces, false), (RaysKind::Field, false), (curves[2], true)] {
                list.extend(kinds.map(|kind| Variant { volume: Some(kind), ..variant(rays, slabbed, None) }));
            }
            for optics in OpticsKind::ALL {
                let seen = [RaysKind::Pieces, RaysKind::Field].map(|rays| variant(rays, false, Some(optics)));
                list.extend(seen);
                list.extend(seen[0].bounces_rays().then(|| seen[0].after_bounce()));
                let traced = Variant { method: Method::Trace, ..seen[0] };
                list.extend(traced.bounces_rays().then(|| traced.after_bounce()));
                let layers = [RaysKind::Pieces, curves[0]].map(|rays| Variant { rays, slabbed: true, ..traced });
                list.extend(layers.into_iter().filter(|v| v.bounces_rays()));
            }
            let curved = |rays| Variant { method: Method::Trace, ..variant(rays, true, Some(OpticsKind::Facets)) };
            list.extend(curves[1..].iter().map(|rays| curved(*rays)));
        }
        // each part of the appearance by itself
        list.extend([
            Variant { normals: true, ..plain },
            Variant { textured: true, ..plain },
            Variant { textured: true, colored: true, ..plain },
            Variant { textured: true, masked: true, ..plain },
            Variant { glossy: true, ..plain },
            Variant { glossy: true, sky: true, textured: true, ..plain },
            Variant { lights: LightsKind::Positional, ..plain },
            Variant { lights: LightsKind::Shadowed, ..plain },
            Variant { pictures: true, textured: true, lights: LightsKind::Positional, ..plain },
            Variant { styled: true, ..plain },
            Variant { outlined: true, ..plain },
        ]);
        list
    }

    /// Bounds in f32 prove most of what straight rays meet; where a curve meets a triangle is found in recheck arithmetic.
    pub fn rechecks(self) -> bool {
        !matches!(self.rays, RaysKind::Curves { .. })
    }

    /// Raster bounds t in f32, and merges no key itself.
    pub fn bounds_t_in_raster(self) -> bool {
        self.by_tile && !self.f64_depths
    }

    /// Triangles of a pixel that are left to recheck, proven to be nearest: by trace one, and by raster where it bounds t one a layer.
    pub fn proven_a_pixel(self, layers: usize) -> u64 {
        match self {
            _ if self.bounds_t_in_raster() => layers as u64,
            _ => u64::from(self.rechecks() && self.traces()),
        }
    }

    /// Neither raster nor trace merges a key.
    pub fn leaves_all_to_recheck(self) -> bool {
        self.rechecks() && (self.method == Method::Trace || self.bounds_t_in_raster())
    }

    /// The same, with `raster` tile by tile where there is that.
    pub fn with_tiles(self) -> Variant {
        let by_tile =
            self.method != Method::Trace && self.f64 && !self.all_uncertain && self.rechecks() && !self.masked;
        Variant { by_tile, ..self }
    }

    /// The same with the stage `small`, where it applies. Stages that find samples or proofs need all pairs, so it does not go with them.
    pub fn with_small(self) -> Variant {
        let small = self.by_tile
            && self.f64_depths
            && self.culling
            && self.rays == RaysKind::Pieces
            && !self.slabbed
            && self.samples == 1;
        Variant { small, ..self }
    }

    /// Triangles may be rasterized.
    pub fn rasters(self) -> bool {
        self.method != Method::Trace
    }

    /// Rays may be traced.
    pub fn traces(self) -> bool {
        self.method != Method::Raster
    }

    /// Whether the lanes of a tile load together what all of them need. So on software adapters, whose subgroups have no more threads
    /// than these: each thread that loads a number takes time of its own there.
    pub fn loads_by_lanes(self) -> bool {
        self.by_tile && !self.wide
    }

    /// Edge pixels have several samples.
    pub fn samples_edges(self) -> bool {
        self.samples > 1
    }

    /// The edges of pixels are found tile by tile where there is one tile to each.
    pub fn samples_by_tile(self) -> bool {
        self.by_tile && self.f64_depths && self.samples_edges() && !self.slabbed
    }

    /// Largest distance of a sample from its pixel's centre, px.
    pub fn sample_reach(self) -> f64 {
        // rounded up
        f64::from(self.samples - 1) / f64::from(2 * self.samples) * (1.0 + f64::from(f32::EPSILON))
    }

    /// The implementations of an interface, the preferred one first: folders or files of `wgsl/INTERFACE`, or paths of files.
    pub fn implementations(self, interface: &str) -> &'static [&'static str] {
        let is_curved = matches!(self.rays, RaysKind::Curves { .. });
        match interface {
            "arithmetic" if self.f64 => &["f64"],
            "arithmetic" => &["f32"],
            "bin/items" if self.small => &["large"],
            "bin/items" => &["groups"],
            "caustics" if self.optics.is_some() => &["bounced"],
            "caustics" => &["plain"],
            "depth" if self.f64_depths => &["exact"],
            "depth" => &["bounded"],
            "depth/columns" => match (self.rays == RaysKind::Field, self.f64_depths) {
                (true, true) => &["field_exact"],
                (true, false) => &["field_bounded"],
                (false, true) => &["pieces_exact"],
                (false, false) => &["pieces_bounded"],
            },
            "keys" if self.atomics64 => &["u64"],
            "keys" => &["u32"],
            "lanes" if self.wide => &["part"],
            "lanes" => &["whole"],
            "lanes/loads" if self.loads_by_lanes() => &["lanes"],
            "lanes/loads" => &["threads"],
            "masks" if self.masked => &["masked"],
            "masks" => &["opaque"],
            "nodes/item_rays" => match (self.incoherent && self.culling, self.loads_by_lanes()) {
                (true, true) => &["incoherent_by_lanes"],
                (true, false) => &["incoherent"],
                (false, _) => &["coherent"],
            },
            "nodes/tile_rays" if self.incoherent => &["incoherent"],
            "nodes/tile_rays" => &["coherent"],
            "optics" => match self.optics {
                Some(OpticsKind::Quadrics) => &["quadrics", "smooth"],
                Some(OpticsKind::Torus) => &["torus", "smooth"],
                Some(OpticsKind::Wave) => &["wave", "smooth"],
                Some(OpticsKind::Facets | OpticsKind::Atlas) | None => &["facets"],
            },
            // only straight rays meet a smooth surface
            "optics/arrival" if is_curved && !self.meets() => &["curved"],
            "optics/arrival" => &["straight"],
            "optics/seen" if self.optics.is_some() => &["bounced"],
            "optics/seen" => &["own"],
            "optics/start" if self.bounced => &["bounced"],
            "optics/start" => &["anywhere"],
            "pairs" if self.by_tile => &["by_tile"],
            "pairs" => &["by_pair"],
            "pixels" if self.bounced => &["live"],
            "pixels" => &["every"],
            "pixels/tiles" if self.bounced => &["pixels/live.wgsl"],
            "pixels/tiles" => &["every"],
            "primitives" if self.spheres => &["spheres"],
            "primitives" => &["triangles"],
            "rays" => match self.rays {
                RaysKind::Pieces => &["pieces", "straight"],
                RaysKind::Field => &["field", "straight"],
                RaysKind::Curves { .. } => &["curves"],
            },
            "samples/measure" if self.analytic => &["areas"],
            "samples/measure" => &["counted"],
            "samples/shaded_part" if self.centred => &["centre"],
            "samples/shaded_part" => &["seen"],
            "shading/casters" if self.timed => &["timed"],
            "shading/casters" => &["still"],
            "shading/colors" if self.colored => &["colored"],
            "shading/colors" => &["uncolored"],
            "shading/lights" => match self.lights {
                LightsKind::Plain => &["plain"],
                LightsKind::Positional => &["positional"],
                LightsKind::Shadowed => &["shadowed", "positional"],
            },
            "shading/materials" if self.glossy || self.sky => &["glossy"],
            "shading/materials" => &["matte"],
            "shading/pictures" if self.pictures => &["thrown"],
            "shading/pictures" => &["none"],
            "shading/sky" if self.sky => &["image"],
            "shading/sky" => &["constant"],
            "shading/styles" if self.styled => &["drawn"],
            "shading/styles" => &["plain"],
            "shading/textures" if self.textured => &["mapped"],
            "shading/textures" => &["plain"],
            "shading/written" if self.writes => &["now"],
            "shading/written" => &["later"],
            "vertices" => match (self.timed, self.instanced) {
                (true, _) => &["timed", "still"],
                (false, true) => &["placed", "still"],
                (false, false) => &["still"],
            },
            "volume/light" if self.volume == Some(VolumeKind::Lit) => &["lit"],
            "volume/light" => &["unlit"],
            "volume/passed" if self.volume == Some(VolumeKind::Maximum) => &["maximum"],
            "volume/passed" => &["composite"],
            _ => &[],
        }
    }

    /// The value of an `override` constant of kernels whose frames have these planes, unless it is the default one.
    pub fn constant(self, name: &str, planes: &[Channel]) -> Option<f64> {
        let flag = |value: bool| Some(f64::from(u8::from(value)));
        match name {
            "ALL_UNCERTAIN" => flag(self.all_uncertain && self.rechecks()),
            "COUNTING" => flag(self.counting),
            "CULLING" => flag(self.culling),
            "DEGREE" => {
                if let RaysKind::Curves { degree } = self.rays {
                    Some(f64::from(degree))
                } else {
                    None
                }
            }
            "FOLLOWS_RAYS" => {
                let is_of_keys = |channel: &Channel| matches!(channel, Channel::T | Channel::A | Channel::TriangleId);
                flag(self.writes || !planes.iter().all(is_of_keys))
            }
            "NORMALS" => flag(self.normals),
            "SAMPLES" => Some(f64::from(self.samples)),
            "SAMPLE_REACH" => Some(self.sample_reach()),
            "SLABBED" => flag(self.slabbed),
            "SMOOTH" => flag(self.meets()),
            // of four samples of a pixel
            "STRIPS" => Some(f64::from(self.samples.div_ceil(4))),
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
