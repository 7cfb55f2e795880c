//! Wall times of a call by its parts.

use serde::Serialize;
use std::ops::AddAssign;
use std::time::Instant;

/// Wall times of a call, ms: from the change of a camera, object or vertex to the results in the caller's memory or files. Parts that a call
/// does not have are 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CallMs {
    /// The whole call. It may be longer than the sum of its parts, and shorter where parts overlap.
    pub total: f64,
    /// Reads the scene and its files, and compiles its camera.
    pub read: f64,
    /// Compiles a camera from changed keys.
    pub camera: f64,
    /// Orders triangles, or moves them to another anchor.
    pub place: f64,
    /// Computes the camera's tables.
    pub plan: f64,
    /// Sends triangles, the camera's tables and appearance to the device.
    pub upload: f64,
    /// Compiles kernels that no earlier frame needed.
    pub compile: f64,
    /// Records the frame and waits for the device.
    pub wait: f64,
    /// Copies channels into the caller's memory, in the order of the image's pixels.
    pub read_back: f64,
    /// Encodes and writes files.
    pub encode: f64,
}

impl CallMs {
    /// Each part by its name, in order.
    pub fn parts(&self) -> [(&'static str, f64); 9] {
        let CallMs { read, camera, place, plan, upload, compile, wait, read_back, encode, total: _ } = *self;
        [
            ("read", read),
            ("camera", camera),
            ("place", place),
            ("plan", plan),
            ("upload", upload),
            ("compile", compile),
            ("wait", wait),
            ("read_back", read_back),
            ("encode", encode),
        ]
    }
}

impl AddAssign for CallMs {
    fn add_assign(&mut self, other: CallMs) {
        self.total += other.total;
        self.read += other.read;
        self.camera += other.camera;
        self.place += other.place;
        self.plan += other.plan;
        self.upload += other.upload;
        self.compile += other.compile;
        self.wait += other.wait;
        self.read_back += other.read_back;
        self.encode += other.encode;
    }
}

/// Milliseconds since a moment.
pub fn ms_since(moment: Instant) -> f64 {
    moment.elapsed().as_secs_f64() * 1e3
}
