//! What pages and the server say to each other: JSON texts; pictures are binary, with a JSON header.

use super::display::{Legend, Shown};
use super::document::Edit;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// What a page asks for.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// Change values. Edits with the number of a gesture, such as a drag, are undone together, and pictures are smaller until it rests.
    Edit {
        edits: Vec<Edit>,
        gesture: Option<u64>,
        seq: u64,
    },
    /// Replace the scene's text.
    Text {
        text: String,
        seq: u64,
    },
    Undo {
        seq: u64,
    },
    Redo {
        seq: u64,
    },
    /// Write the scene to its file.
    Save {},
    /// Show another frame of a keyframed scene.
    Frame {
        frame: f64,
        playing: bool,
        seq: u64,
    },
    /// Show the scene in another way, to this page alone.
    Look {
        look: Look,
        seq: u64,
    },
    /// A gesture has ended.
    Rest {
        seq: u64,
    },
    /// The page has drawn a picture and can take another one.
    Drawn {
        id: u64,
    },
    /// Explain a pixel; `tag` comes back with the answer.
    Pixel {
        x: u32,
        y: u32,
        tag: u64,
    },
    /// The command line that renders what the page shows.
    Command {},
    /// Write the offsets of a `camera_texture`, which are in a file, into the scene.
    Offsets {
        seq: u64,
    },
}

/// What a page shows of the scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Look {
    pub shown: Shown,
    /// Rays per pixel of the picture at rest.
    pub samples: u32,
    /// The engine of a second picture beside: `reference` or a rival.
    pub beside: Option<String>,
    /// Whether the camera's volume is drawn.
    pub volume: bool,
}

impl Default for Look {
    fn default() -> Look {
        Look { shown: Shown::Color, samples: 1, beside: None, volume: true }
    }
}

/// How good a picture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// Small enough to follow a gesture.
    Moving,
    /// Full size, one ray per pixel.
    Whole,
    /// Full size, with the samples asked for: the picture at rest.
    Rest,
}

/// The header of a picture.
#[derive(Debug, Clone, Serialize)]
pub struct Header {
    /// To be named by [`Request::Drawn`].
    pub id: u64,
    /// The second picture, for a comparison.
    pub beside: bool,
    /// Of the scene that it shows.
    pub revision: u64,
    /// The page's last input before it.
    pub seq: u64,
    pub quality: Quality,
    pub width: u32,
    pub height: u32,
    /// The size of the picture at rest.
    pub whole: [u32; 2],
    pub mime: &'static str,
    pub legend: Option<Legend>,
    pub times: Times,
    /// What is left out, or otherwise to know.
    pub notes: Vec<String>,
}

impl Times {
    pub fn all(&self) -> Duration {
        Duration::from_secs_f64((self.read + self.render + self.encode).max(0.0) / 1e3)
    }
}

/// Where the time of a picture went, ms.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Times {
    /// From text to scene and camera.
    pub read: f64,
    /// From there to pixels.
    pub render: f64,
    /// The parts of `render`, without the choice of colors.
    pub parts: Vec<(&'static str, f64)>,
    /// To PNG or JPEG.
    pub encode: f64,
    /// Of the stages on the device; empty without timestamps.
    pub stages: Vec<(String, f64)>,
}
