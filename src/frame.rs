//! A rendered frame: planes of values, one a channel, row 0 on top.

use crate::camera::Camera;

/// Triangle or piece id where nothing is hit.
pub const NO_ID: u32 = u32::MAX;

/// A channel of the contract's section 4, the facet of a mirror or lens that a pixel sees first, and what is proven.
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

    /// And how well that is known.
    pub const EVERY: [Channel; 12] = {
        let mut every = [Channel::Certified; 12];
        let mut k = 0;
        while k < Channel::ALL.len() {
            every[k] = Channel::ALL[k];
            k += 1;
        }
        every
    };

    /// The channels that say something about pictures of this camera.
    pub fn of(camera: &Camera) -> Vec<Channel> {
        Channel::ALL.into_iter().filter(|c| *c != Channel::MirrorId || camera.optics.is_some()).collect()
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
        }
    }

    /// Its values are whole numbers.
    pub fn is_id(self) -> bool {
        matches!(self, Channel::TriangleId | Channel::PieceId | Channel::MirrorId | Channel::Certified)
    }

    pub fn from_name(name: &str) -> Option<Channel> {
        Channel::EVERY.into_iter().find(|c| c.name() == name)
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
