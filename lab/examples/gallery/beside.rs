//! Pictures beside those of the examples: the same scene by an ordinary camera, by one of the views that were joined, with one number
//! changed, as the paper's own technique draws it, or from close by.

pub struct Beside {
    /// The example's name.
    pub of: &'static str,
    /// The picture's file is OF-NAME.jpg.
    pub name: &'static str,
    pub shows: &'static str,
    /// How the scene changes, as after --set.
    pub change: &'static str,
    /// Of the video that the scene shows.
    pub frame: f64,
    /// The technique that draws it in place of ours, as after --engine.
    pub rival: Option<&'static str>,
    /// A close-up: left, top, width and height as shares of the picture's. All of it without.
    pub close: Option<[f64; 4]>,
}

const fn view(of: &'static str, name: &'static str, shows: &'static str, change: &'static str) -> Beside {
    Beside { of, name, shows, change, frame: 0.0, rival: None, close: None }
}

const fn close(
    of: &'static str,
    name: &'static str,
    shows: &'static str,
    change: &'static str,
    part: [f64; 4],
) -> Beside {
    Beside { of, name, shows, change, frame: 0.0, rival: None, close: Some(part) }
}

const fn splats(name: &'static str, shows: &'static str, rival: &'static str) -> Beside {
    Beside { of: "primitives", name, shows, change: "", frame: 0.0, rival: Some(rival), close: None }
}

const fn later(of: &'static str, name: &'static str, shows: &'static str, frame: f64) -> Beside {
    Beside { of, name, shows, change: "", frame, rival: None, close: None }
}

/// Those beside an example, in the order of the page.
pub fn beside(of: &str) -> impl Iterator<Item = &'static Beside> {
    BESIDE.iter().filter(move |b| b.of == of)
}

/// Where the aeroplane lies across two segments, and the inner side of the ring.
const AT_THE_JOINT: [f64; 4] = [0.28, 0.36, 0.4, 0.3];
const RIM: [f64; 4] = [0.33, 0.2, 0.34, 0.34];

#[rustfmt::skip] // a table
const BESIDE: [Beside; 42] = [
    view("city-cross-slit", "pinhole", "the same by a pinhole",
        "camera={kind='pinhole',eye=[-36,20,50],target=[-10,9.5,15],vfov=34}"),
    splats("splats-5", "as the paper draws it: splats, 5 texels a side for each triangle", "raster-splat:5"),
    splats("splats-10", "10 texels a side", "raster-splat:10"),
    splats("splats-20", "20 texels a side", "raster-splat:20"),
    view("cow-panorama", "pinhole", "the same by a pinhole",
        "camera={kind='pinhole',eye=[4,1.6,4],target=[0,0.95,0],vfov=36}"),
    view("teapot-panorama", "pinhole", "the same by a pinhole",
        "camera={kind='pinhole',eye=[0,4.5,9],target=[0,1,0],vfov=28}"),
    view("hinge", "straight", "angle = 0: the cow as it stands", "camera.angle=0"),
    view("hinge", "away", "angle = -12: its head is stretched away", "camera.angle=-12"),
    view("car", "pinhole", "the same car by a pinhole",
        "camera={kind='pinhole',eye=[5.5,2.2,5],target=[0,0.7,0],vfov=25}"),
    view("columns", "perspective", "convergence = 1: perspective", "camera.convergence=1"),
    view("twist", "straight", "angle = 0: perspective", "camera.angle=0"),
    view("curved", "straight", "bend = [0, 0]: perspective", "camera.bend=[0,0]"),
    view("occlusion", "straight", "distortion = [0, 0]: perspective", "camera.distortion=[0,0]"),
    view("ortho-to-perspective", "pinhole", "the same by a pinhole",
        "camera={kind='pinhole',eye=[0,34,62],target=[0,2,14],vfov=40}"),
    view("stairs", "pinhole", "the same by a pinhole", "camera={kind='pinhole',eye=[0,0,8],target=[0,0,0],vfov=62}"),
    view("terrain-top-down", "pinhole", "morph = 0: the plain view", "camera.morph=0"),
    view("terrain-bottom-up", "left", "the left view",
        "camera={kind='pinhole',eye=[-22,32,72],target=[-33,15,10],vfov=38}"),
    view("terrain-bottom-up", "right", "the right view",
        "camera={kind='pinhole',eye=[12,54,66],target=[22,13,-8],vfov=40}"),
    view("tracked", "pinhole", "morph = 0: the plain view, where houses hide both balls", "camera.morph=0"),
    view("tree", "root", "morph = 0: the root's plain view", "camera.morph=0"),
    view("opposite", "left", "the left view",
        "camera={kind='pinhole',eye=[-0.8,2.6,0.5],target=[-20,4.6,-3.5],vfov=60}"),
    view("opposite", "right", "the right view",
        "camera={kind='pinhole',eye=[0.8,2.6,0.5],target=[20,4.6,-3.5],vfov=60}"),
    view("aeroplane", "root", "morph = 0: the root's plain view", "camera.morph=0"),
    close("aeroplane", "smooth", "from close by: 40 strips bend it little by little", "", AT_THE_JOINT),
    close("aeroplane", "bent", "few and straight segments: it is bent at the joint", "camera.join='straight' camera.lateral=2", AT_THE_JOINT),
    view("city-cylinder", "pinhole", "the same by a pinhole", "camera={kind='pinhole',eye=[0,31,0],target=[-10,23,-3],vfov=90}"),
    view("deformation", "pinhole", "the same by a pinhole", "camera={kind='pinhole',eye=[34,40,62],target=[0,3,0],vfov=42}"),
    close("mirror-ring", "twice", "from close by: the ring sees itself", "", RIM),
    close("mirror-ring", "once", "depth = 1: it does not", "camera.depth=1", RIM),
    view("mirror-teapot", "more", "512 cameras and 1,600 triangles", "camera.mirror.cameras=512 mesh.0.file=flock-1500.obj"),
    view("surround", "pinhole", "the same by a pinhole", "camera={kind='pinhole',eye=[0,1.6,5],target=[0,1,0],vfov=45}"),
    view("rolling-shutter", "at-once", "line_time = 0: all rows at once", "camera.line_time=0"),
    view("rolling-shutter", "blurred", "all rows at once, with an open shutter", "camera.line_time=0 image.shutter=0.04"),
    view("composite", "pinhole", "the same city by a pinhole", "camera={kind='pinhole',eye=[0,9,34],target=[0,3,0],vfov=45}"),
    view("table", "one", "by its first camera alone", "camera={kind='pinhole',eye=[0,5.2,3.6],target=[0,0.1,0],vfov=38}"),
    view("hidden-mirror", "straight", "distortion = [0, 0]: straight rays", "camera.eye.distortion=[0,0]"),
    view("helix", "pinhole", "the same by a pinhole", "camera={kind='pinhole',eye=[0,1.5,13],target=[0,0,0],vfov=40}"),
    view("smoke", "straight", "bend = [0, 0]: perspective", "camera.bend=[0,0]"),
    view("smoke", "maximum", "mode = 'maximum': each pixel shows the largest number on its curve", "volume.mode='maximum' volume.lit=false"),
    view("video-on-city", "bare", "without the pictures", "projector_light=[]"),
    later("video-on-city", "later", "three frames later", 3.0),
    view("tracked", "smooth", "17 segments a layer: 196 pieces", "camera.segments=17"),
];
