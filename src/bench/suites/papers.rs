//! What the papers measured, on stand-ins of the same counts: none of their scenes is public.

use super::{cylinder_scene, scene};
use crate::bench::case::{Arm, Case, arms};
use crate::bench::row::Paper;

/// Machines of the papers.
const GTX_8800: &str = "Core 2 Duo 2.13 GHz, GeForce 8800 GTX";
const GT_7800: &str = "GeForce 7800 GT";
const K5000: &str = "Xeon E5-1660, Quadro K5000";
const GTS_8800: &str = "Athlon 64 X2 4200+, GeForce 8800 GTS";

/// Texels of an atlas at most: some 20 bytes each on the device, and seconds a frame on a CPU.
const TEXELS_MAX: u32 = 1 << 22;

fn paper(paper: &str, figure: &str, fps: impl Into<Option<f64>>, hardware: &str, stand_in: &str) -> Paper {
    Paper {
        paper: paper.into(),
        figure: figure.into(),
        fps: fps.into(),
        hardware: hardware.into(),
        stand_in: stand_in.into(),
    }
}

/// Facets by the key `count`, in an atlas of `texels` x `texels` / 2 each, by this engine and by rivals, whose facets are one GLC
/// each; and without an atlas.
fn atlas_arms((key, count): (&str, u32), texels: u32, rivals: &[&str]) -> Vec<Arm> {
    let set = [format!("camera.{key}={count}"), format!("camera.atlas={texels}")];
    let direct = Arm::ours().set(&[&set[0]]);
    let painted = |arm: Arm| arm.set(&[&set[0], &set[1]]).knob("texels of an atlas", f64::from(texels));
    if count * texels * texels / 2 > TEXELS_MAX {
        return vec![direct];
    }
    let rivals = rivals.iter().map(|name| Arm::rival(name).set(&["camera.facets=\"flat\""]));
    [direct].into_iter().chain([Arm::ours()].into_iter().chain(rivals).map(painted)).collect()
}

/// Yu, Yu and McMillan 2009.
fn yu() -> Vec<Case> {
    let of = |figure: &str, fps: Option<f64>, stand_in: &str| paper("Yu et al. 2009", figure, fps, GTX_8800, stand_in);
    let glc = ["raster-splat:10", "raster-bound", "raster-warp:0", "raster-warp:2", "raytrace"];
    let ring = ["raster-splat:10", "raster-splat-passes:10", "raster-bound", "raytrace"];
    let pieces = |n: u32, names: &[&str]| -> Vec<Arm> {
        let set = format!("camera.pieces={n}");
        [Arm::ours()]
            .into_iter()
            .chain(arms(names).into_iter().map(|a| a.set(&[&set]).knob("pieces", f64::from(n))))
            .collect()
    };
    let mut cases = vec![
        Case::of("Yu 1", "city-cross-slit", arms(&glc)).paper(of(
            "1",
            Some(70.0),
            "a generated city of 15,000 triangles",
        )),
        Case::new(
            "Yu 5",
            scene!("primitives"),
            arms(&["raster-splat:5", "raster-splat:10", "raster-splat:20", "raytrace"]),
        )
        .paper(of("5 (b) to (d)", None, "a ball of 320 triangles, a cylinder of 40, a box of 12")),
        Case::of("Yu 6", "cow-panorama", pieces(32, &ring)).paper(of("6", Some(47.0), "a generated cow")),
        Case::of("Yu 7", "teapot-panorama", pieces(32, &ring)).paper(of(
            "7",
            Some(32.0),
            "the teapot; the number of GLCs is not given",
        )),
        Case::of("Yu 8", "mirror-ball", atlas_arms(("mirror.count", 960), 256, &[]))
            .truth(&["camera.facets=\"exact\""])
            .paper(of("8", Some(10.0), "1,100 triangles; 31 million texels are too many here, so without an atlas")),
        Case::of("Yu 9", "hinge", arms(&glc)).paper(of("9", None, "a generated cow")),
    ];
    let ball = |name: String, count, texels, fps| {
        Case::of(
            name,
            "mirror-ball",
            atlas_arms(("mirror.count", count), texels, &["raster-splat:6", "raster-splat-passes:6"]),
        )
        .truth(&["camera.facets=\"exact\""])
        .paper(of("10 (a)", Some(fps), "1,100 triangles"))
    };
    let a =
        [(126, 128, 87.1), (126, 512, 43.1), (360, 128, 27.8), (360, 512, 16.7), (640, 128, 16.6), (640, 512, 10.4)];
    cases.extend(
        a.map(|(n, texels, fps)| ball(format!("Yu 10 (a): {n} GLCs of {texels} texels a side"), n, texels, fps)),
    );
    let b = [(550, 6, 28.4), (550, 10, 14.4), (1100, 6, 22.4), (1100, 10, 10.8), (2200, 6, 9.5), (2200, 10, 6.9)];
    cases.extend(b.map(|(n, k, fps)| {
        let by = [&*format!("raster-splat:{k}"), &*format!("raster-splat-passes:{k}")].map(str::to_owned);
        let arms = atlas_arms(("mirror.count", 480), 128, &[&by[0], &by[1]]);
        let stand_in = "a generated town; GLCs of 128 texels a side for 256";
        Case::new(format!("Yu 10 (b): {n} triangles, S of {k} x {k}"), scene!("mirror"), arms)
            .set(&[&format!("mesh.0.triangles={n}")])
            .truth(&["camera.facets=\"exact\""])
            .paper(of("10 (b)", Some(fps), stand_in))
    }));
    cases
}

/// Hou, Wei, Shum and Guo 2006.
fn hou() -> Vec<Case> {
    let of = |figure: &str, fps: Option<f64>, stand_in: &str| paper("Hou et al. 2006", figure, fps, GT_7800, stand_in);
    let bound = ["raster-bound", "raster-bound-passes", "raytrace"];
    let ring = |count: u32, texels: u32, fps: f64| {
        Case::of(
            format!("Hou table 1: reflection, {count} cameras"),
            "mirror-ring",
            atlas_arms(("mirror.count", count), texels, &bound),
        )
        .set(&["camera.depth=1"])
        .truth(&["camera.facets=\"exact\""])
        .paper(of("table 1, figures 1 and 6", Some(fps), "a torus in a scene of 108 triangles"))
    };
    let water = atlas_arms(("lens.count", 12), 128, &bound);
    let mut cases = vec![
        ring(26, 128, 51.0),
        ring(104, 64, 63.0),
        ring(416, 32, 5.0),
        Case::of("Hou table 1: refraction", "water", water).truth(&["camera.facets=\"exact\""]).paper(of(
            "table 1, figure 9",
            Some(46.0),
            "252 triangles and 12 cameras",
        )),
        Case::of("Hou table 1: caustics", "caustic", arms(&[])).paper(of(
            "table 1, figure 11",
            Some(35.0),
            "a ring of 400 triangles; its light is deposited once, before the frames, and not in their time",
        )),
        Case::of("Hou table 1: visualization", "surround", arms(&bound)).paper(of(
            "table 1, figure 12",
            Some(46.0),
            "a generated walker of 6,841 triangles, 400 cameras",
        )),
    ];
    let rows = [
        (800, 700, 100, 20.1),
        (1200, 1100, 100, 14.6),
        (1600, 1500, 100, 9.2),
        (400, 300, 256, 6.0),
        (800, 700, 256, 2.1),
        (1200, 1100, 256, 1.8),
        (400, 300, 512, 2.5),
        (800, 700, 512, 1.0),
    ];
    cases.extend(rows.map(|(triangles, flock, cameras, fps)| {
        let arms = atlas_arms(("mirror.cameras", cameras), 64, &["raster-bound", "raster-bound-passes"]);
        let case = Case::of(format!("Hou 7: {triangles} moving triangles, {cameras} cameras"), "mirror-teapot", arms);
        Case { moving: true, ..case }
            .set(&[&format!("mesh.0.file=flock-{flock}.obj")])
            // as many as the eye sees
            .truth(&["camera.mirror.cameras=6320"])
            .paper(of("7", Some(fps), "the built-in teapot as the mirror, butterflies and balls that move"))
    }));
    cases
}

/// Popescu et al.
fn popescu() -> Vec<Case> {
    let of = |figure: &str, fps: f64, stand_in: &str| paper("Popescu et al.", figure, fps, K5000, stand_in);
    let by = || arms(&["raster-warp:0", "raytrace"]);
    let smaller = "a generated terrain; 2,120,000 triangles in the paper";
    let city = "a generated city; 3,692,000 triangles in the paper";
    vec![
        Case::of("Popescu 1", "terrain-top-down", by()).paper(of("1, table 1", 28.0, smaller)),
        Case::of("Popescu 2", "terrain-bottom-up", by()).paper(of("2, table 1", 24.0, smaller)),
        Case::of("Popescu 3", "tracked", by()).paper(of("3, table 1", 19.0, city)),
        Case::of("Popescu 9", "opposite", by()).paper(of(
            "9, table 1",
            13.0,
            "generated; 3,752,000 triangles in the paper",
        )),
        Case::of("Popescu 9, the graph camera", "graph-camera", by()).paper(of("9", 13.0, "its rival in the paper")),
    ]
}

/// Lorenz and Doellner 2009.
fn lorenz() -> Vec<Case> {
    let of =
        |figure: &str, fps: f64, stand_in: &str| paper("Lorenz and Doellner 2009", figure, fps, GTS_8800, stand_in);
    let strips = |arm: Arm| arm.set(&["camera.strips=160"]).knob("strips", 160.0);
    let city = "a generated city of 35,000 triangles";
    let size = ["image.width=1600", "image.height=1200"];
    let exact = || vec![Arm::ours(), strips(Arm::ours())];
    let ppp = [exact(), vec![strips(Arm::rival("raster-pieces")), Arm::rival("raytrace")]].concat();
    let ib = [exact(), vec![Arm::rival("raster-cubemap:2048")]].concat();
    let warped = arms(&["raster-pieces", "raytrace"]);
    vec![
        Case::new("Lorenz table 1: PPP", cylinder_scene(), ppp).set(&size).paper(of("table 1, figure 1", 84.7, city)),
        Case::new("Lorenz table 1: IB", cylinder_scene(), ib).set(&size).paper(of("table 1", 41.7, city)),
        Case::of("Lorenz table 2", "deformation", warped).set(&size).paper(of(
            "table 2",
            8.4,
            "the same city; 16 x 16 cells for 128 x 128",
        )),
    ]
}

pub fn cases() -> Vec<Case> {
    [yu(), hou(), popescu(), lorenz()].concat()
}

pub fn quick() -> Vec<Case> {
    let few = ["Yu 1", "Yu 5", "Hou table 1: refraction", "Lorenz table 1: PPP"];
    cases().into_iter().filter(|c| few.contains(&c.name.as_str())).collect()
}
