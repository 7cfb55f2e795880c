//! A rendered frame: planes of values, one a channel, row 0 on top.

/// Id of a triangle, piece, object or material where nothing is hit.
pub const NO_ID: u32 = u32::MAX;

/// A channel of an image, one value a pixel: `docs/reference/definitions.md`, Channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Red, linear.
    R,
    /// Green, linear.
    G,
    /// Blue, linear.
    B,
    /// Coverage: 1 where something is hit, 0 elsewhere; between with several samples.
    A,
    /// Distance from the ray's origin P to the hit, world units; +inf where nothing is hit.
    Z,
    /// Ray parameter of the hit, X = P + t D; +inf where nothing is hit.
    T,
    /// The triangle that is hit, numbered through all meshes; [`NO_ID`] where nothing is.
    TriangleId,
    /// The camera's piece that the pixel belongs to; [`NO_ID`] where no ray is.
    PieceId,
    /// Weight of the triangle's second corner at the hit.
    BaryU,
    /// Weight of its third corner.
    BaryV,
    /// The facet of a mirror or lens that the pixel sees first; [`NO_ID`] where it sees none.
    MirrorId,
    /// 2 where bounds in f32 prove that the pixel's triangle, or the miss, is that of exact arithmetic; 1 where bounds on the
    /// recheck do; 0 where nothing does.
    Certified,
    /// x of the unit normal of the surface as it is shaded, world axes, turned to the viewer; 0 where nothing is hit, or a surface
    /// without triangles.
    NormalX,
    /// y of the normal.
    NormalY,
    /// z of the normal.
    NormalZ,
    /// x of the hit, world units; 0 where nothing is hit.
    PositionX,
    /// y of the hit.
    PositionY,
    /// z of the hit.
    PositionZ,
    /// Red of the material's diffuse colour, times its texture's, linear, before it is lit; 0 where nothing is hit.
    AlbedoR,
    /// Green of the diffuse colour.
    AlbedoG,
    /// Blue of the diffuse colour.
    AlbedoB,
    /// u of the texture coordinates of the hit; 0 where nothing is hit, or what has none.
    TextureU,
    /// v of the texture coordinates.
    TextureV,
    /// The number of the triangle's object.
    ObjectId,
    /// The number of the triangle's material.
    MaterialId,
}

impl Channel {
    /// Those that say what is seen.
    pub const ALL: [Channel; 11] = [
        Channel::R,
        Channel::G,
        Channel::B,
        Channel::A,
        Channel::Z,
        Channel::T,
        Channel::TriangleId,
        Channel::PieceId,
        Channel::BaryU,
        Channel::BaryV,
        Channel::MirrorId,
    ];

    /// And what is computed where it is asked for by name.
    pub const MORE: [Channel; 14] = [
        Channel::Certified,
        Channel::NormalX,
        Channel::NormalY,
        Channel::NormalZ,
        Channel::PositionX,
        Channel::PositionY,
        Channel::PositionZ,
        Channel::AlbedoR,
        Channel::AlbedoG,
        Channel::AlbedoB,
        Channel::TextureU,
        Channel::TextureV,
        Channel::ObjectId,
        Channel::MaterialId,
    ];

    /// Both.
    pub fn every() -> impl Iterator<Item = Channel> {
        Channel::ALL.into_iter().chain(Channel::MORE)
    }

    /// The name in an EXR file and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Channel::R => "R",
            Channel::G => "G",
            Channel::B => "B",
            Channel::A => "A",
            Channel::Z => "Z",
            Channel::T => "t",
            Channel::TriangleId => "triangle.id",
            Channel::PieceId => "piece.id",
            Channel::BaryU => "bary.u",
            Channel::BaryV => "bary.v",
            Channel::MirrorId => "mirror.id",
            Channel::Certified => "certified",
            Channel::NormalX => "N.X",
            Channel::NormalY => "N.Y",
            Channel::NormalZ => "N.Z",
            Channel::PositionX => "P.X",
            Channel::PositionY => "P.Y",
            Channel::PositionZ => "P.Z",
            Channel::AlbedoR => "albedo.R",
            Channel::AlbedoG => "albedo.G",
            Channel::AlbedoB => "albedo.B",
            Channel::TextureU => "uv.U",
            Channel::TextureV => "uv.V",
            Channel::ObjectId => "object.id",
            Channel::MaterialId => "material.id",
        }
    }

    /// Its values are whole numbers.
    pub fn is_id(self) -> bool {
        matches!(self, Channel::TriangleId | Channel::PieceId | Channel::MirrorId | Channel::Certified)
            || self.is_label()
    }

    /// It is a function of the triangle id: see [`crate::scene::labels`].
    pub fn is_label(self) -> bool {
        matches!(self, Channel::ObjectId | Channel::MaterialId)
    }

    /// The channel of this name, or all those of a vector or colour: `N`, `P`, `albedo` and `uv`.
    pub fn named(name: &str) -> Vec<Channel> {
        match name {
            "N" => vec![Channel::NormalX, Channel::NormalY, Channel::NormalZ],
            "P" => vec![Channel::PositionX, Channel::PositionY, Channel::PositionZ],
            "albedo" => vec![Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB],
            "uv" => vec![Channel::TextureU, Channel::TextureV],
            _ => Channel::every().filter(|c| c.name() == name).collect(),
        }
    }
}

/// One channel's values, `width * height`, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum Plane {
    /// Of colours, depths, weights and vectors.
    F32(Vec<f32>),
    /// Of ids.
    U32(Vec<u32>),
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
    /// The values of a channel of numbers; `None` where the frame does not have it.
    pub fn f32(&self, channel: Channel) -> Option<&[f32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::F32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }

    /// The values of a channel of ids; `None` where the frame does not have it.
    pub fn u32(&self, channel: Channel) -> Option<&[u32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::U32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }
}
