//! Every variant that tests compile.

use super::*;
use crate::gpu::kernels::OpticsKind;

/// A scene with everything that pieces, fields and curves share.
fn with_all(plain: Variant) -> Variant {
    let appearance = Appearance {
        textures: Some(Textures { colored: true, masked: false }),
        normals: true,
        materials: MaterialsKind::UnderSky,
        lights: LightsKind::Shadowed { pictures: false },
        styled: true,
    };
    Variant { appearance, extras: Extras { outlined: true, counting: true, ..plain.extras }, ..plain }
}

impl TilePath {
    pub const BOUNDED: TilePath = TilePath { wide: false, depths: TileDepths::Bounded };
    pub const EXACT: TilePath = TilePath { wide: false, depths: TileDepths::Exact { small: false } };
}

impl Variant {
    /// A plain scene through pieces, pair by pair, on an adapter with these abilities.
    pub fn plain(f64: bool, atomics64: bool) -> Variant {
        let arithmetic = if f64 { Arithmetic::Rechecked } else { Arithmetic::Single };
        let path = AdapterPath { arithmetic, atomics64, ..AdapterPath::default() };
        Variant { path, ..Variant::default() }
    }

    fn through(self, kind: RaysKind, slabbed: bool, optics: Option<OpticsKind>) -> Variant {
        let optics = optics.map(|kind| OpticsModel { kind, bounced: false });
        Variant { rays: RayModel { kind, slabbed, optics }, ..self }
    }

    fn found_by(self, method: Method) -> Variant {
        self.with(|v| v.path.visibility = Visibility::by_pair(method))
    }

    fn traced(self) -> Variant {
        self.found_by(Method::Trace)
    }

    fn timed(self) -> Variant {
        self.traced().with(|v| v.extras.vertices = VerticesKind::Timed)
    }

    fn with_spheres(self) -> Variant {
        self.traced().with(|v| {
            v.extras.primitives = if v.extras.counting { PrimitivesKind::Capsules } else { PrimitivesKind::Spheres };
        })
    }

    fn with_masks(self, colored: bool) -> Variant {
        self.with(|v| v.appearance.textures = Some(Textures { colored, masked: true }))
    }

    fn sampled(self, measure: SampleMeasure) -> Variant {
        self.with(|v| v.extras.samples = Some(EdgeSamples { count: 4, measure }))
    }

    fn lit(self, lights: LightsKind) -> Variant {
        self.with(|v| v.appearance.lights = lights)
    }

    /// Every variant that some camera needs on an adapter with these abilities.
    pub fn every(f64: bool, atomics64: bool) -> Vec<Variant> {
        let plain = Variant::plain(f64, atomics64);
        let bases = [(plain, false), (with_all(plain), true)];
        let [some, all] = bases.map(|(base, has_all)| with_each_ray_model(base, has_all));
        [some, all, with_each_part_of_the_appearance(plain)].concat()
    }

    /// The variant with each path of raster by tile, if raster can go tile by tile.
    pub fn by_each_tile_path(self) -> Vec<Variant> {
        let exact = self.path.atomics64.then_some(TilePath::EXACT);
        let paths = [TilePath::BOUNDED].into_iter().chain(exact);
        let paths = paths.flat_map(|path| [false, true].map(|wide| TilePath { wide, ..path }));
        let all = paths.map(|path| self.with_tiles(path)).filter(|v| v.by_tile());
        all.flat_map(|v| [Some(v), Some(v.with_small()).filter(|small| *small != v)]).flatten().collect()
    }
}

/// Each kind of rays, with samples, motion, spheres, instances, pictures, volumes and optics.
fn with_each_ray_model(base: Variant, has_all: bool) -> Vec<Variant> {
    let (pieces, field) = (RaysKind::Pieces, RaysKind::Field { incoherent: has_all });
    let curves = [1, 2, 3].map(|degree| RaysKind::Curves { degree });
    let facets = Some(OpticsKind::Facets);
    let variant = |kind, slabbed, optics| base.through(kind, slabbed, optics);
    let of = |kinds: &[RaysKind]| kinds.iter().map(|kind| variant(*kind, false, None)).collect::<Vec<_>>();

    let mut list = Vec::new();
    for kind in [pieces, field].into_iter().chain(curves) {
        list.extend([false, true].map(|slabbed| variant(kind, slabbed, None)));
    }
    let measure = if has_all { SampleMeasure::Area } else { SampleMeasure::Counted };
    let sampled = [(pieces, false), (pieces, true), (field, false)];
    list.extend(sampled.map(|(kind, slabbed)| variant(kind, slabbed, None).sampled(measure)));
    list.push(variant(pieces, false, None).sampled(SampleMeasure::AtCentre));
    if has_all {
        list.extend(of(&[pieces, field, curves[2]]).into_iter().map(|v| v.with_masks(false)));
        let mirror = variant(pieces, false, facets).with_masks(true);
        list.extend([variant(pieces, true, None).with_masks(true), mirror, mirror.after_bounce()]);
        list.extend(of(&[pieces, field]).into_iter().map(|v| v.sampled(SampleMeasure::Counted).with_masks(true)));
        let moving = variant(field, false, None).timed().with_spheres();
        let curved = variant(curves[1], true, facets);
        list.extend([variant(pieces, false, None), moving, curved].map(|v| v.traced().with_masks(true)));
    }
    list.extend([Method::Auto, Method::Trace].map(|method| variant(pieces, has_all, None).found_by(method)));
    list.push(variant(field, false, None).traced());
    list.extend(curves.map(|kind| variant(kind, true, None).traced()));
    list.extend(of(&[pieces, field, curves[2]]).into_iter().map(Variant::timed));
    let mirror = variant(pieces, false, facets).timed();
    list.extend([mirror, mirror.after_bounce()]);
    list.extend(of(&[pieces, field]).into_iter().map(Variant::with_spheres));
    list.extend([variant(pieces, true, None), variant(pieces, false, None).timed()].map(Variant::with_spheres));
    let mirror = variant(pieces, false, Some(OpticsKind::Quadrics)).with_spheres();
    list.extend([mirror, mirror.after_bounce()]);
    list.extend(curves.map(|kind| variant(kind, true, None).with_spheres()));
    let lights = if has_all { LightsKind::Positional { pictures: false } } else { LightsKind::Plain };
    let placed = |v: Variant| v.traced().lit(lights).with(|v| v.extras.vertices = VerticesKind::Placed);
    list.extend(of(&[pieces, field]).into_iter().chain([variant(pieces, true, None)]).map(placed));
    list.push(variant(field, false, None).with(|v| v.extras.writes = true));
    list.push(variant(pieces, false, None).lit(LightsKind::Positional { pictures: false }));
    let throws = |v: Variant| {
        let pictures = true;
        let lights = if has_all { LightsKind::Shadowed { pictures } } else { LightsKind::Positional { pictures } };
        v.lit(lights).with(|v| v.appearance.textures = Some(v.appearance.textures.unwrap_or_default()))
    };
    list.extend(of(&[pieces, field, curves[2]]).into_iter().map(throws));
    let mirror = variant(pieces, false, facets).after_bounce();
    let samples = variant(pieces, false, None).sampled(SampleMeasure::Counted);
    list.extend([variant(pieces, false, None).timed(), mirror, samples].map(throws));
    for (kind, slabbed) in [(pieces, false), (field, false), (curves[2], true)] {
        let kinds = [VolumeKind::Plain, VolumeKind::Lit, VolumeKind::Maximum];
        list.extend(kinds.map(|volume| variant(kind, slabbed, None).with(|v| v.extras.volume = Some(volume))));
    }
    for kind in OpticsKind::ALL {
        let first = variant(pieces, false, Some(kind));
        list.extend([first, variant(field, false, Some(kind))]);
        if first.bounces_rays() {
            list.extend([first.after_bounce(), first.traced().after_bounce()]);
            list.extend([pieces, curves[0]].map(|rays| variant(rays, true, Some(kind)).traced()));
        }
    }
    list.extend(curves[1..].iter().map(|kind| variant(*kind, true, facets).traced()));
    list
}

/// Each part of the appearance by itself.
fn with_each_part_of_the_appearance(plain: Variant) -> Vec<Variant> {
    let with = |change: fn(&mut Variant)| plain.with(change);
    let textures = |colored, masked| Some(Textures { colored, masked });
    let textured = [(false, false), (true, false), (false, true)];
    let textured = textured.map(|(colored, masked)| plain.with(|v| v.appearance.textures = textures(colored, masked)));
    let others = [
        with(|v| v.appearance.normals = true),
        with(|v| v.appearance.materials = MaterialsKind::Glossy),
        with(|v| v.appearance.styled = true),
        with(|v| v.extras.outlined = true),
        plain.lit(LightsKind::Positional { pictures: false }),
        plain.lit(LightsKind::Shadowed { pictures: false }),
        plain.lit(LightsKind::Positional { pictures: true }).with(|v| v.appearance.textures = textures(false, false)),
        with(|v| v.appearance.materials = MaterialsKind::UnderSky)
            .with(|v| v.appearance.textures = textures(false, false)),
    ];
    [&textured[..], &others].concat()
}
