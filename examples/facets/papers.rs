//! The papers' tables of mirrors and lenses: their figures, as printed, and the scenes that stand in for theirs.

/// A table of a paper.
pub struct Table {
    pub file: &'static str,
    pub paper: &'static str,
    /// What the paper's frames were timed on.
    pub hardware: &'static str,
    pub rows: &'static [Row],
}

/// A row: the paper's setting and frames a second, and our scene.
pub struct Row {
    pub figure: &'static str,
    /// What else the paper varies.
    pub setting: &'static str,
    pub triangles: u32,
    pub cameras: u32,
    /// A side of a camera's triangle in the atlas; `None` where the paper does not say, or it has none.
    pub texels: Option<u32>,
    pub fps: f64,
    pub scene: Option<&'static Stand>,
    /// More keys of the scene: for the paper's number of triangles.
    pub keys: &'static [&'static str],
}

/// An example that stands in for the paper's scene, which none of them gives away.
pub struct Stand {
    pub example: &'static str,
    pub optics: Option<Surface>,
    /// Every vertex is new in each frame.
    pub moving: bool,
    pub keys: &'static [&'static str],
}

/// Of what the eye sees the cameras are a copy.
pub struct Surface {
    /// The camera's key of it.
    pub key: &'static str,
    /// Facets that the eye sees; `None`: the cameras themselves.
    pub seen: Option<u32>,
    /// Facets that stand for the surface itself, where it is not met exactly; `None`: as many as it has.
    pub finest: Option<u32>,
}

/// Texels a side where the paper does not say: those of most of its rows.
pub const TEXELS: u32 = 64;

/// A mirror ball among a cow, two balls, a box and a floor; each camera one GLC, which the eye sees.
static BALL: Stand = Stand {
    example: "mirror-ball",
    optics: Some(Surface { key: "mirror", seen: None, finest: None }),
    moving: false,
    keys: &["camera.facets=\"flat\""],
};
/// A ring of mixed curvature.
static RING: Stand = Stand {
    example: "mirror-ring",
    optics: Some(Surface { key: "mirror", seen: Some(6400), finest: Some(200_000) }),
    moving: false,
    // the paper's rays are reflected once
    keys: &["camera.facets=\"normals\"", "camera.depth=1"],
};
static WATER: Stand = Stand {
    example: "water",
    optics: Some(Surface { key: "lens", seen: Some(6400), finest: None }),
    moving: false,
    keys: &["camera.facets=\"normals\""],
};
static CAUSTIC: Stand =
    Stand { example: "caustic", optics: None, moving: false, keys: &["camera.depth=1", "caustics.light.depth=1"] };
static WALKER: Stand = Stand { example: "surround", optics: None, moving: false, keys: &[] };
static TEAPOT: Stand = Stand {
    example: "mirror-teapot",
    optics: Some(Surface { key: "mirror", seen: Some(6400), finest: None }),
    moving: true,
    keys: &["camera.facets=\"normals\""],
};

const NONE: Row =
    Row { figure: "", setting: "", triangles: 0, cameras: 0, texels: None, fps: 0.0, scene: None, keys: &[] };

const fn yu_a(cameras: u32, texels: u32, fps: f64) -> Row {
    let texels = Some(texels);
    Row { figure: "10a", setting: "tiles 6x6", triangles: 1100, cameras, texels, fps, scene: Some(&BALL), ..NONE }
}

const fn yu_b(triangles: u32, setting: &'static str, fps: f64, keys: &'static [&'static str]) -> Row {
    Row { figure: "10b", setting, triangles, cameras: 480, texels: Some(256), fps, scene: Some(&BALL), keys }
}

/// 550 triangles: two balls, a column for the cow, a plainer floor.
const FEWER: &[&str] = &[
    "mesh.0.divisions=3",
    "mesh.1={ builtin = \"cylinder\", sides = 31, scale = [0.5, 1.6, 0.5], translate = [2.6, -1.2, 0.9] }",
];
/// 2,200: a rounder ball, a column for the box.
const MORE: &[&str] = &[
    "mesh.2.level=3",
    "mesh.4={ builtin = \"cylinder\", sides = 39, scale = [0.35, 0.7, 0.35], translate = [1.0, -1.2, 2.2] }",
];

const fn hou_1(
    setting: &'static str,
    triangles: u32,
    cameras: u32,
    texels: u32,
    fps: f64,
    scene: &'static Stand,
) -> Row {
    Row { figure: "table 1", setting, triangles, cameras, texels: Some(texels), fps, scene: Some(scene), ..NONE }
}

const fn hou_7(triangles: u32, cameras: u32, fps: f64, keys: &'static [&'static str]) -> Row {
    Row { figure: "7", setting: "culled, moving", triangles, cameras, fps, scene: Some(&TEAPOT), keys, ..NONE }
}

/// There is no switch here that leaves culling out.
const fn hou_7_unculled(triangles: u32, cameras: u32, fps: f64) -> Row {
    Row { figure: "7", setting: "not culled, moving", triangles, cameras, fps, ..NONE }
}

const TRIANGLES_400: &[&str] = &[];
const TRIANGLES_800: &[&str] = &["mesh.0.file=flock-700.obj"];
const TRIANGLES_1200: &[&str] = &["mesh.0.file=flock-1100.obj"];
const TRIANGLES_1600: &[&str] = &["mesh.0.file=flock-1500.obj"];

pub static TABLES: [Table; 3] = [
    Table {
        file: "yu_figure_10.csv",
        paper: "Yu et al. 2009",
        hardware: "Core2 Duo 2.13 GHz; GeForce 8800 GTX",
        rows: &[
            yu_a(126, 128, 87.1),
            yu_a(126, 512, 43.1),
            yu_a(360, 128, 27.8),
            yu_a(360, 512, 16.7),
            yu_a(640, 128, 16.6),
            yu_a(640, 512, 10.4),
            yu_b(550, "tiles 6x6", 28.4, FEWER),
            yu_b(550, "tiles 10x10", 14.4, FEWER),
            yu_b(1100, "tiles 6x6", 22.4, &[]),
            yu_b(1100, "tiles 10x10", 10.8, &[]),
            yu_b(2200, "tiles 6x6", 9.5, MORE),
            yu_b(2200, "tiles 10x10", 6.9, MORE),
        ],
    },
    Table {
        file: "hou_table_1.csv",
        paper: "Hou et al. 2006",
        hardware: "GeForce 7800 GT",
        rows: &[
            hou_1("reflection", 108, 26, 128, 51.0, &RING),
            hou_1("reflection", 108, 104, 64, 63.0, &RING),
            hou_1("reflection", 108, 416, 32, 5.0, &RING),
            hou_1("refraction", 252, 12, 128, 46.0, &WATER),
            hou_1("caustics", 2, 400, 64, 35.0, &CAUSTIC),
            hou_1("visualization", 6841, 400, 64, 46.0, &WALKER),
        ],
    },
    Table {
        file: "hou_figure_7.csv",
        paper: "Hou et al. 2006",
        hardware: "GeForce 7800 GT",
        rows: &[
            hou_7(800, 100, 20.1, TRIANGLES_800),
            hou_7(1200, 100, 14.6, TRIANGLES_1200),
            hou_7(1600, 100, 9.2, TRIANGLES_1600),
            hou_7(400, 256, 6.0, TRIANGLES_400),
            hou_7(800, 256, 2.1, TRIANGLES_800),
            hou_7(1200, 256, 1.8, TRIANGLES_1200),
            hou_7(400, 512, 2.5, TRIANGLES_400),
            hou_7(800, 512, 1.0, TRIANGLES_800),
            hou_7_unculled(800, 100, 4.5),
            hou_7_unculled(1200, 100, 3.6),
            hou_7_unculled(1600, 100, 2.1),
            hou_7_unculled(400, 256, 1.5),
            hou_7_unculled(800, 256, 0.5),
            hou_7_unculled(1200, 256, 0.35),
            hou_7_unculled(400, 512, 0.8),
            hou_7_unculled(800, 512, 0.3),
        ],
    },
];
