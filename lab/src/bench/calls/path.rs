//! The path that cases of whole calls follow, and the cameras that follow it.

use std::fmt::Write;

/// Position and target of a camera at one pose of the path.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    eye: [f64; 3],
    target: [f64; 3],
}

impl Pose {
    /// Pose `k` of `count`: the first half goes along a street of the city, the second half around it.
    pub fn of(k: u32, count: u32) -> Pose {
        let half = count.div_ceil(2);
        let share = f64::from(k % half) / f64::from(half);
        let (sin, cos) = (std::f64::consts::TAU * share).sin_cos();
        match k < half {
            true => Pose { eye: [50.0 * share - 25.0, 3.0, 1.0], target: [40.0 * share - 10.0, 2.0, -20.0] },
            false => Pose { eye: [60.0 * cos, 30.0, 60.0 * sin], target: [0.0; 3] },
        }
    }

    fn keys(&self) -> String {
        let Pose { eye: [x, y, z], target: [u, v, w] } = self;
        format!("eye = [{x}, {y}, {z}]\ntarget = [{u}, {v}, {w}]\n")
    }

    /// The place of the camera as the value of a keyframe.
    pub fn eye_at(&self, frame: u32) -> String {
        let [x, y, z] = self.eye;
        format!("{{ frame = {frame}, value = [{x}, {y}, {z}] }}")
    }
}

/// A camera without its pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lens {
    Pinhole,
    CrossSlit,
    /// A fisheye in 1,000 GLCs.
    Pieces,
    Fisheye,
    /// OpenCV's model with five coefficients.
    Brown,
    Cylinder,
    /// 128 beams of 2,048 shots.
    Lidar,
    /// A mirror ball in the city, as a pinhole camera sees it.
    Mirror,
}

/// The file of the calibration.
pub const CALIBRATION_FILE: &str = "brown.yml";

/// A calibration of OpenCV's tutorial.
pub const CALIBRATION: &str = "%YAML:1.0
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 535.9, 0., 342.3, 0., 535.9, 235.6, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2664, -0.0386, 0.0018, -0.0003, 0.2384 ]
";

const BEAMS: u32 = 128;
const SHOTS: u32 = 2048;

impl Lens {
    pub const ALL: [Lens; 8] = [
        Lens::Pinhole,
        Lens::CrossSlit,
        Lens::Pieces,
        Lens::Fisheye,
        Lens::Brown,
        Lens::Cylinder,
        Lens::Lidar,
        Lens::Mirror,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Lens::Pinhole => "pinhole",
            Lens::CrossSlit => "GLC",
            Lens::Pieces => "1,000 GLCs",
            Lens::Fisheye => "fisheye",
            Lens::Brown => "Brown",
            Lens::Cylinder => "cylinder",
            Lens::Lidar => "lidar",
            Lens::Mirror => "mirror",
        }
    }

    /// The size of its image, where it has one of its own.
    pub fn own_size(self) -> Option<(u32, u32)> {
        (self == Lens::Lidar).then_some((SHOTS, BEAMS))
    }

    /// The keys of the camera at a pose, as TOML.
    pub fn keys(self, pose: &Pose) -> String {
        let at = pose.keys();
        match self {
            Lens::Pinhole => format!("kind = 'pinhole'\n{at}vfov = 60\n"),
            Lens::CrossSlit => {
                let slits = "[{ distance = 40, angle = 0 }, { distance = 60, angle = 90 }]";
                format!("kind = 'cross_slit'\n{at}height = 60\nslits = {slits}\n")
            }
            Lens::Pieces => format!("kind = 'fisheye'\n{at}fov = 170\nframe = 'full'\npieces = 1000\n"),
            Lens::Fisheye => format!("kind = 'fisheye'\n{at}fov = 180\n"),
            Lens::Brown => format!("kind = 'opencv'\n{at}file = '{CALIBRATION_FILE}'\n"),
            Lens::Cylinder => format!("kind = 'cylinder'\n{at}vfov = 60\n"),
            Lens::Lidar => {
                let mut beams = String::new();
                for k in 0..BEAMS {
                    // writing to a String cannot fail
                    let _ = write!(beams, "{}, ", 15.0 - 40.0 * f64::from(k) / f64::from(BEAMS - 1));
                }
                format!("kind = 'lidar'\n{at}columns = {SHOTS}\nbeams = [{beams}]\n")
            }
            Lens::Mirror => {
                let eye = at.trim_end().replace('\n', ", ");
                let ball = "{ shape = 'sphere', center = [0, 8, -15], radius = 6 }";
                format!("kind = 'reflection'\nmirror = {ball}\neye = {{ kind = 'pinhole', {eye}, vfov = 60 }}\n")
            }
        }
    }
}
