//! A rendered frame: one plane of values per channel, row 0 on top.

use crate::input::tree::nearest;
use glam::DVec3;

/// Id of a triangle, piece, object or material where nothing is hit.
pub const NO_ID: u32 = u32::MAX;

/// What the channels of a pixel follow from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PixelValues {
    /// Linear.
    pub colour: [f64; 3],
    pub coverage: f64,
    /// Distance along the ray, world units; +inf where nothing is hit.
    pub z: f64,
    /// Ray parameter of the hit; +inf where nothing is hit.
    pub t: f64,
    /// Weights of the triangle's second and third corner.
    pub bary: [f64; 2],
    pub triangle: u32,
    pub piece: u32,
    /// The first surface of the mirror or lens.
    pub mirror: u32,
    pub object: u32,
    pub material: u32,
    pub certified: u32,
    /// World axes; 0 where nothing is hit, or a surface without triangles.
    pub normal: DVec3,
    /// World units; 0 where nothing is hit.
    pub position: DVec3,
    /// Linear; 0 where nothing is hit.
    pub albedo: [f32; 3],
    pub uv: [f64; 2],
    /// Unit, from the hit towards the viewer, world axes; 0 where nothing is hit.
    pub view: DVec3,
    /// Z between the scene's near and far: linear, and as a depth buffer of a perspective camera has it; 1 where nothing is hit.
    pub depth: [f64; 2],
}

/// A channel's value.
#[derive(Clone, Copy)]
enum Value {
    Number(fn(&PixelValues) -> f64),
    Id(fn(&PixelValues) -> u32),
    /// An id that follows from the triangle's.
    Label(fn(&PixelValues) -> u32),
    /// A number that follows from Z.
    OfZ(fn(&PixelValues) -> f64),
}

/// Generates the enum of channels, its lists, names and values from one table.
macro_rules! channels {
    ($($(#[$about:meta])* $list:ident: { $($(#[$doc:meta])* $channel:ident, $name:literal, $kind:ident, $value:expr;)* })*) => {
        /// A channel of an image, one value per pixel: `docs/reference/definitions.md`, Channels.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Channel {
            $($($(#[$doc])* $channel,)*)*
        }

        impl Channel {
            $($(#[$about])* pub const $list: [Channel; [$($name),*].len()] = [$(Channel::$channel),*];)*

            /// Its name in EXR files and on the command line.
            pub fn name(self) -> &'static str {
                match self {
                    $($(Channel::$channel => $name,)*)*
                }
            }

            fn value(self) -> Value {
                match self {
                    $($(Channel::$channel => Value::$kind($value),)*)*
                }
            }
        }
    };
}

channels! {
    /// The default channels.
    ALL: {
        /// Red, linear.
        R, "R", Number, |p| p.colour[0];
        /// Green, linear.
        G, "G", Number, |p| p.colour[1];
        /// Blue, linear.
        B, "B", Number, |p| p.colour[2];
        /// Coverage: 1 where something is hit, 0 elsewhere; between with several samples.
        A, "A", Number, |p| p.coverage;
        /// Distance from the ray's origin P to the hit, world units; +inf where nothing is hit.
        Z, "Z", Number, |p| p.z;
        /// Ray parameter of the hit, X = P + t D; +inf where nothing is hit.
        T, "t", Number, |p| p.t;
        /// The triangle that is hit, numbered through all meshes; [`NO_ID`] where nothing is.
        TriangleId, "triangle.id", Id, |p| p.triangle;
        /// The camera's piece that owns the pixel; [`NO_ID`] where there is no ray.
        PieceId, "piece.id", Id, |p| p.piece;
        /// Weight of the triangle's second corner at the hit.
        BaryU, "bary.u", Number, |p| p.bary[0];
        /// Weight of its third corner.
        BaryV, "bary.v", Number, |p| p.bary[1];
        /// The first facet or smooth part of the mirror or lens on the pixel's path; [`NO_ID`] without one.
        MirrorId, "mirror.id", Id, |p| p.mirror;
    }
    /// The channels computed only on request by name.
    MORE: {
        /// 2 where bounds in f32 prove that the pixel's triangle, or its miss, is that of exact arithmetic; 1 where bounds on the
        /// recheck prove it; else 0.
        Certified, "certified", Id, |p| p.certified;
        /// x of the unit normal of the surface as shaded, world axes, on the viewer's side; 0 where nothing is hit, or a surface
        /// without triangles.
        NormalX, "N.X", Number, |p| p.normal.x;
        /// y of the normal.
        NormalY, "N.Y", Number, |p| p.normal.y;
        /// z of the normal.
        NormalZ, "N.Z", Number, |p| p.normal.z;
        /// x of the hit, world units; 0 where nothing is hit.
        PositionX, "P.X", Number, |p| p.position.x;
        /// y of the hit.
        PositionY, "P.Y", Number, |p| p.position.y;
        /// z of the hit.
        PositionZ, "P.Z", Number, |p| p.position.z;
        /// Red of the material's diffuse colour, times its texture's, linear, before it is lit; 0 where nothing is hit.
        AlbedoR, "albedo.R", Number, |p| p.albedo[0].into();
        /// Green of the diffuse colour.
        AlbedoG, "albedo.G", Number, |p| p.albedo[1].into();
        /// Blue of the diffuse colour.
        AlbedoB, "albedo.B", Number, |p| p.albedo[2].into();
        /// u of the texture coordinates of the hit; 0 where nothing is hit, or the hit has none.
        TextureU, "uv.U", Number, |p| p.uv[0];
        /// v of the texture coordinates.
        TextureV, "uv.V", Number, |p| p.uv[1];
        /// x of the unit vector from the hit towards the viewer, along the ray, world axes; 0 where nothing is hit.
        ViewX, "view.X", Number, |p| p.view.x;
        /// y of that vector.
        ViewY, "view.Y", Number, |p| p.view.y;
        /// z of that vector.
        ViewZ, "view.Z", Number, |p| p.view.z;
        /// (Z - near) / (far - near), with the scene's near and far; 1 where nothing is hit.
        DepthLinear, "depth.linear", OfZ, |p| p.depth[0];
        /// The same as a depth buffer of a perspective camera has it.
        DepthPerspective, "depth.perspective", OfZ, |p| p.depth[1];
        /// The number of the triangle's object.
        ObjectId, "object.id", Label, |p| p.object;
        /// The number of the triangle's material.
        MaterialId, "material.id", Label, |p| p.material;
    }
}

impl Channel {
    /// In their own order, each once.
    pub fn in_order(channels: impl IntoIterator<Item = Channel>) -> Vec<Channel> {
        let mut all: Vec<Channel> = channels.into_iter().collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// All channels.
    pub fn every() -> impl Iterator<Item = Channel> {
        Channel::ALL.into_iter().chain(Channel::MORE)
    }

    /// Whether its values are ids (u32).
    pub fn is_id(self) -> bool {
        matches!(self.value(), Value::Id(_) | Value::Label(_))
    }

    /// Whether it is a function of the triangle id.
    pub fn is_label(self) -> bool {
        matches!(self.value(), Value::Label(_))
    }

    /// Whether it is a function of Z.
    pub fn is_of_z(self) -> bool {
        matches!(self.value(), Value::OfZ(_))
    }

    /// Whether kernels write it; the host makes the others of those.
    pub fn is_rendered(self) -> bool {
        !self.is_label() && !self.is_of_z()
    }

    /// The channel of this name, or all those of a vector or colour, one of [`VECTORS`].
    pub fn named(name: &str) -> Vec<Channel> {
        let vector = VECTORS.into_iter().find(|vector| *vector == name);
        let is_of = |c: &Channel| c.name().split_once('.').is_some_and(|(of, _)| Some(of) == vector);
        Channel::every().filter(|c| c.name() == name || is_of(c)).collect()
    }

    /// The name that may be meant by one that no channel has, as `Z` by `depth`; `None` if no name is near.
    pub fn similar(name: &str) -> Option<&'static str> {
        let word = name.to_lowercase();
        if let Some((_, own)) = OTHER_NAMES.iter().find(|(others, _)| others.contains(&word.as_str())) {
            return Some(own);
        }
        let known: Vec<&'static str> = Channel::every().map(Channel::name).chain(VECTORS).collect();
        let near = nearest(name, &known)?;
        let longer = name.chars().count().max(near.len());
        // a name twice as long has no letter in three right; a letter alone is like every other
        (longer <= 2 * near.len() && 3 * strsim::levenshtein(name, near) <= longer).then_some(near)
    }
}

/// Names that stand for several channels.
const VECTORS: [&str; 5] = ["N", "P", "albedo", "uv", "view"];

/// Names in lower case that other programs have for what channels hold, and the channels' own.
const OTHER_NAMES: [(&[&str], &str); 9] = [
    (&["depth", "distance", "range", "z"], "Z"),
    (&["normal", "normals"], "N"),
    (&["position", "positions", "point", "points", "xyz"], "P"),
    (&["rgb", "rgba", "color", "colour", "beauty", "combined"], "R, G, B"),
    (&["alpha", "mask", "coverage"], "A"),
    (&["id", "ids", "face", "faces", "primitive", "triangle"], "triangle.id"),
    (&["instance", "instances", "object", "mesh", "segmentation"], "object.id"),
    (&["material"], "material.id"),
    (&["barycentric", "barycentrics", "bary"], "bary.u, bary.v"),
];

/// Z between near and far: (Z - near) / (far - near), and far (Z - near) / (Z (far - near)), which is 0 at near and 1 at far too.
pub fn normalised_depth(z: f64, [near, far]: [f64; 2]) -> [f64; 2] {
    if z == f64::INFINITY {
        return [1.0; 2];
    }
    let linear = (z - near) / (far - near);
    [linear, far / z * linear]
}

impl PixelValues {
    /// Those of a ray that hits nothing, before nothing.
    pub const MISS: PixelValues = PixelValues {
        colour: [0.0; 3],
        coverage: 0.0,
        z: f64::INFINITY,
        t: f64::INFINITY,
        bary: [0.0; 2],
        triangle: NO_ID,
        piece: NO_ID,
        mirror: NO_ID,
        object: NO_ID,
        material: NO_ID,
        certified: 0,
        normal: DVec3::ZERO,
        position: DVec3::ZERO,
        albedo: [0.0; 3],
        uv: [0.0; 2],
        view: DVec3::ZERO,
        depth: [1.0; 2],
    };

    /// A channel's word in its plane: the bits of an f32, or an id.
    pub fn word(&self, channel: Channel) -> u32 {
        match channel.value() {
            Value::Number(of) | Value::OfZ(of) => (of(self) as f32).to_bits(),
            Value::Id(of) | Value::Label(of) => of(self),
        }
    }

    /// The number in a channel that is not one of ids.
    #[cfg(feature = "internals")]
    pub fn number(&self, channel: Channel) -> Option<f64> {
        match channel.value() {
            Value::Number(of) | Value::OfZ(of) => Some(of(self)),
            Value::Id(_) | Value::Label(_) => None,
        }
    }
}

/// One channel's values, `width * height`, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum Plane {
    /// Colours, depths, weights and vectors.
    F32(Vec<f32>),
    /// Ids.
    U32(Vec<u32>),
}

impl Plane {
    /// How many values it has.
    pub(crate) fn count(&self) -> usize {
        match self {
            Plane::F32(values) => values.len(),
            Plane::U32(values) => values.len(),
        }
    }
}

/// A channel's plane from its words: the bits of f32 values, or ids.
pub fn plane_of_words(channel: Channel, words: Vec<u32>) -> Plane {
    if channel.is_id() {
        return Plane::U32(words);
    }
    Plane::F32(words.into_iter().map(f32::from_bits).collect())
}

/// The channels of one image; each channel at most once, in the order of [`Channel::ALL`].
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The channels and their values.
    pub planes: Vec<(Channel, Plane)>,
}

impl Frame {
    /// The values of a channel of numbers; `None` if the frame does not have it.
    pub fn f32(&self, channel: Channel) -> Option<&[f32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::F32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }

    /// The values of a channel of ids; `None` if the frame does not have it.
    pub fn u32(&self, channel: Channel) -> Option<&[u32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::U32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_name_tells_the_channel_that_may_be_meant() {
        for (wrong, own) in [
            ("depth", Some("Z")),
            ("Depth", Some("Z")),
            ("z", Some("Z")),
            ("normals", Some("N")),
            ("trinagle.id", Some("triangle.id")),
            ("albedo.r", Some("albedo.R")),
            ("albdo", Some("albedo")),
            ("Q", None),
            ("", None),
            ("temperature", None),
        ] {
            assert_eq!(Channel::similar(wrong), own, "{wrong}");
        }
        assert_eq!(Channel::similar(&"Z".repeat(1 << 20)), None);
        // what is suggested is there
        let is_known = |name: &str| name.split(", ").all(|name| !Channel::named(name).is_empty());
        assert!(OTHER_NAMES.iter().all(|(_, own)| is_known(own)) && VECTORS.iter().all(|name| is_known(name)));
    }
}
