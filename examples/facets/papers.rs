//! The papers' tables of mirrors and lenses: their figures, as printed, and the scenes that stand in for theirs.

/// A table of a paper.
pub struct Table {
    pub file: &'static str,
    pub paper: &'static str,
    /// What the paper's frames were timed on.
    pub hardware: &'static str,
    pub rows: &'static [Row],
}

/// A row: the paper's frames a second, and our scene.
pub struct Row {
    pub figure: &'static str,
    /// What else the paper varies, which has no counterpart here, and the frames a second of each.
    pub timed: &'static [(&'static str, f64)],
    pub triangles: u32,
    pub cameras: u32,
    /// A side of a camera's triangle in the atlas; `None` where the paper does not say, or it has none.
    pub texels: Option<u32>,
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
    optics: Some(Surface { key: "mirror", seen: Some(6320), finest: None }),
    moving: true,
    keys: &["camera.facets=\"normals\""],
};

const NONE: Row = Row { figure: "", timed: &[], triangles: 0, cameras: 0, texels: None, scene: None, keys: &[] };

type Timed = &'static [(&'static str, f64)];
type Keys = &'static [&'static str];

/// Scene triangles are drawn with tiles of texels about them in the paper, so large.
const fn yu(figure: &'static str, of: [u32; 3], timed: Timed, keys: Keys) -> Row {
    let [triangles, cameras, texels] = of;
    Row { figure, timed, triangles, cameras, texels: Some(texels), scene: Some(&BALL), keys }
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

const fn hou_1(of: [u32; 3], timed: Timed, scene: &'static Stand) -> Row {
    let [triangles, cameras, texels] = of;
    Row { figure: "table 1", timed, triangles, cameras, texels: Some(texels), scene: Some(scene), ..NONE }
}

const fn hou_7([triangles, cameras]: [u32; 2], timed: Timed, keys: Keys) -> Row {
    Row { figure: "7", timed, triangles, cameras, scene: Some(&TEAPOT), keys, ..NONE }
}

/// There is no switch here that leaves culling out.
const fn unculled([triangles, cameras]: [u32; 2], timed: Timed) -> Row {
    Row { figure: "7", timed, triangles, cameras, ..NONE }
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
            yu("10a", [1100, 126, 128], &[("tiles 6x6", 87.1)], &[]),
            yu("10a", [1100, 126, 512], &[("tiles 6x6", 43.1)], &[]),
            yu("10a", [1100, 360, 128], &[("tiles 6x6", 27.8)], &[]),
            yu("10a", [1100, 360, 512], &[("tiles 6x6", 16.7)], &[]),
            yu("10a", [1100, 640, 128], &[("tiles 6x6", 16.6)], &[]),
            yu("10a", [1100, 640, 512], &[("tiles 6x6", 10.4)], &[]),
            yu("10b", [550, 480, 256], &[("tiles 6x6", 28.4), ("tiles 10x10", 14.4)], FEWER),
            yu("10b", [1100, 480, 256], &[("tiles 6x6", 22.4), ("tiles 10x10", 10.8)], &[]),
            yu("10b", [2200, 480, 256], &[("tiles 6x6", 9.5), ("tiles 10x10", 6.9)], MORE),
        ],
    },
    Table {
        file: "hou_table_1.csv",
        paper: "Hou et al. 2006",
        hardware: "GeForce 7800 GT",
        rows: &[
            hou_1([108, 26, 128], &[("reflection", 51.0)], &RING),
            hou_1([108, 104, 64], &[("reflection", 63.0)], &RING),
            hou_1([108, 416, 32], &[("reflection", 5.0)], &RING),
            hou_1([252, 12, 128], &[("refraction", 46.0)], &WATER),
            hou_1([2, 400, 64], &[("caustics", 35.0)], &CAUSTIC),
            hou_1([6841, 400, 64], &[("visualization", 46.0)], &WALKER),
        ],
    },
    Table {
        file: "hou_figure_7.csv",
        paper: "Hou et al. 2006",
        hardware: "GeForce 7800 GT",
        rows: &[
            hou_7([800, 100], &[("moving; culled", 20.1)], TRIANGLES_800),
            hou_7([1200, 100], &[("moving; culled", 14.6)], TRIANGLES_1200),
            hou_7([1600, 100], &[("moving; culled", 9.2)], TRIANGLES_1600),
            hou_7([400, 256], &[("moving; culled", 6.0)], TRIANGLES_400),
            hou_7([800, 256], &[("moving; culled", 2.1)], TRIANGLES_800),
            hou_7([1200, 256], &[("moving; culled", 1.8)], TRIANGLES_1200),
            hou_7([400, 512], &[("moving; culled", 2.5)], TRIANGLES_400),
            hou_7([800, 512], &[("moving; culled", 1.0)], TRIANGLES_800),
            unculled([800, 100], &[("moving; not culled", 4.5)]),
            unculled([1200, 100], &[("moving; not culled", 3.6)]),
            unculled([1600, 100], &[("moving; not culled", 2.1)]),
            unculled([400, 256], &[("moving; not culled", 1.5)]),
            unculled([800, 256], &[("moving; not culled", 0.5)]),
            unculled([1200, 256], &[("moving; not culled", 0.35)]),
            unculled([400, 512], &[("moving; not culled", 0.8)]),
            unculled([800, 512], &[("moving; not culled", 0.3)]),
        ],
    },
];
