//! A rendered frame: one plane of values per channel, row 0 on top.

/// Id of a triangle, piece, object or material where nothing is hit.
pub const NO_ID: u32 = u32::MAX;

/// The type of a channel's values.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Values {
    Number,
    Id,
    /// An id that follows from the triangle's: see [`crate::scene::labels`].
    Label,
}

/// Generates the enum of channels, its lists, names and value types from one table.
macro_rules! channels {
    ($($(#[$about:meta])* $list:ident: { $($(#[$doc:meta])* $channel:ident, $name:literal, $values:ident;)* })*) => {
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

            fn values(self) -> Values {
                match self {
                    $($(Channel::$channel => Values::$values,)*)*
                }
            }
        }
    };
}

channels! {
    /// The default channels.
    ALL: {
        /// Red, linear.
        R, "R", Number;
        /// Green, linear.
        G, "G", Number;
        /// Blue, linear.
        B, "B", Number;
        /// Coverage: 1 where something is hit, 0 elsewhere; between with several samples.
        A, "A", Number;
        /// Distance from the ray's origin P to the hit, world units; +inf where nothing is hit.
        Z, "Z", Number;
        /// Ray parameter of the hit, X = P + t D; +inf where nothing is hit.
        T, "t", Number;
        /// The triangle that is hit, numbered through all meshes; [`NO_ID`] where nothing is.
        TriangleId, "triangle.id", Id;
        /// The camera's piece that owns the pixel; [`NO_ID`] where there is no ray.
        PieceId, "piece.id", Id;
        /// Weight of the triangle's second corner at the hit.
        BaryU, "bary.u", Number;
        /// Weight of its third corner.
        BaryV, "bary.v", Number;
        /// The first facet or smooth part of the mirror or lens on the pixel's path; [`NO_ID`] without one.
        MirrorId, "mirror.id", Id;
    }
    /// The channels computed only on request by name.
    MORE: {
        /// 2 where bounds in f32 prove that the pixel's triangle, or its miss, is that of exact arithmetic; 1 where bounds on the
        /// recheck prove it; else 0.
        Certified, "certified", Id;
        /// x of the unit normal of the surface as shaded, world axes, on the viewer's side; 0 where nothing is hit, or a surface
        /// without triangles.
        NormalX, "N.X", Number;
        /// y of the normal.
        NormalY, "N.Y", Number;
        /// z of the normal.
        NormalZ, "N.Z", Number;
        /// x of the hit, world units; 0 where nothing is hit.
        PositionX, "P.X", Number;
        /// y of the hit.
        PositionY, "P.Y", Number;
        /// z of the hit.
        PositionZ, "P.Z", Number;
        /// Red of the material's diffuse colour, times its texture's, linear, before it is lit; 0 where nothing is hit.
        AlbedoR, "albedo.R", Number;
        /// Green of the diffuse colour.
        AlbedoG, "albedo.G", Number;
        /// Blue of the diffuse colour.
        AlbedoB, "albedo.B", Number;
        /// u of the texture coordinates of the hit; 0 where nothing is hit, or the hit has none.
        TextureU, "uv.U", Number;
        /// v of the texture coordinates.
        TextureV, "uv.V", Number;
        /// The number of the triangle's object.
        ObjectId, "object.id", Label;
        /// The number of the triangle's material.
        MaterialId, "material.id", Label;
    }
}

impl Channel {
    /// All channels.
    pub fn every() -> impl Iterator<Item = Channel> {
        Channel::ALL.into_iter().chain(Channel::MORE)
    }

    /// Whether its values are ids (u32).
    pub fn is_id(self) -> bool {
        self.values() != Values::Number
    }

    /// Whether it is a function of the triangle id.
    pub fn is_label(self) -> bool {
        self.values() == Values::Label
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
    /// Colours, depths, weights and vectors.
    F32(Vec<f32>),
    /// Ids.
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
