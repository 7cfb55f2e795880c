//! A rendered frame: planes of values, one a channel, row 0 on top.

/// Id of a triangle, piece, object or material where nothing is hit.
pub const NO_ID: u32 = u32::MAX;

/// A channel of the contract's section 4, the facet of a mirror or lens that a pixel sees first, what is proven, and what the
/// surface is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    R,
    G,
    B,
    A,
    Z,
    T,
    TriangleId,
    PieceId,
    BaryU,
    BaryV,
    MirrorId,
    /// 2 where bounds in f32 prove that the pixel's triangle, or the miss, is that of exact arithmetic; 1 where bounds on the
    /// recheck do; 0 where nothing does.
    Certified,
    /// The unit normal of the surface as it is shaded, world axes, turned to the viewer; 0 where nothing is hit, or a surface
    /// without triangles.
    NormalX,
    NormalY,
    NormalZ,
    /// The hit, world units; 0 where nothing is hit.
    PositionX,
    PositionY,
    PositionZ,
    /// The material's diffuse colour, times its texture's, linear, before it is lit; 0 where nothing is hit.
    AlbedoR,
    AlbedoG,
    AlbedoB,
    /// Texture coordinates of the hit; 0 where nothing is hit, or what has none.
    TextureU,
    TextureV,
    /// The number of the triangle's object or material: see [`crate::scene::labels::Labels`].
    ObjectId,
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
    F32(Vec<f32>),
    U32(Vec<u32>),
}

/// The channels of one image; each channel at most once, in the order of [`Channel::ALL`].
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub width: u32,
    pub height: u32,
    pub planes: Vec<(Channel, Plane)>,
}

impl Frame {
    pub fn f32(&self, channel: Channel) -> Option<&[f32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::F32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }

    pub fn u32(&self, channel: Channel) -> Option<&[u32]> {
        self.planes.iter().find_map(|(c, p)| match p {
            Plane::U32(v) if *c == channel => Some(v.as_slice()),
            _ => None,
        })
    }
}
