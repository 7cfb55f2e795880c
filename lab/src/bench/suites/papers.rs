//! What the papers measured, on stand-ins of the same counts: none of their scenes is public.

use super::{cylinder_scene, scene};
use crate::bench::case::{Arm, Case, Samples, arms};
use crate::bench::row::{Moving, Paper};
use anamorph::internals::engine::Method;
use anamorph::internals::engine::rival::MULTISAMPLES;

/// Machines of the papers.
const GTX_8800: &str = "Core 2 Duo 2.13 GHz, GeForce 8800 GTX";
const GT_7800: &str = "GeForce 7800 GT";
const K5000: &str = "Xeon E5-1660, Quadro K5000";
const GTS_8800: &str = "Athlon 64 X2 4200+, GeForce 8800 GTS";

fn paper(paper: &str, figure: &str, fps: impl Into<Option<f64>>, hardware: &str, stand_in: &str) -> Paper {
    Paper {
        paper: paper.into(),
        figure: figure.into(),
        fps: fps.into(),
        fps_no_cull: None,
        hardware: hardware.into(),
        stand_in: stand_in.into(),
    }
}

/// The mirror or lens itself; facets by the key `count`; and these in an atlas of `texels` x `texels` / 2 each, by this engine and by
/// rivals, whose facets are one GLC each.
fn atlas_arms((key, count): (&str, u32), texels: u32, rivals: &[&str]) -> Vec<Arm> {
    let set = [format!("camera.{key}={count}"), format!("camera.atlas={texels}")];
    let exact = Arm::ours().set(&["camera.facets=\"exact\""]);
    let direct = Arm::ours().set(&[&set[0]]).label("facets");
    let painted = |arm: Arm| arm.set(&[&set[0], &set[1]]).parameter("texels of an atlas", f64::from(texels));
    let by_raster = painted(Arm::ours().by(Method::Raster));
    let rivals = rivals.iter().map(|name| painted(Arm::rival(name).set(&["camera.facets=\"flat\""])));
    [exact, direct, painted(Arm::ours().label("facets")), by_raster].into_iter().chain(rivals).collect()
}

/// Raster alone as well, behind this engine's own choice.
fn with_raster(mut arms: Vec<Arm>) -> Vec<Arm> {
    arms.insert(1, arms[0].clone().by(Method::Raster));
    arms
}

/// Yu, Yu and McMillan 2009.
fn yu() -> Vec<Case> {
    let of = |figure: &str, fps: Option<f64>, stand_in: &str| paper("Yu et al. 2009", figure, fps, GTX_8800, stand_in);
    let glc = || with_raster(arms(&["raster-splat:10", "raster-warp:0", "raster-warp:2", "raytrace"]));
    let ball = ["raster-splat:6", "raster-splat-passes:6", "raytrace"];
    let ring = ["raster-splat:10", "raster-splat-passes:10", "raster-bound", "raytrace"];
    let pieces = |n: u32, names: &[&str]| -> Vec<Arm> {
        let set = format!("camera.pieces={n}");
        with_raster(vec![Arm::ours()])
            .into_iter()
            .chain(arms(names).into_iter().map(|a| a.set(&[&set]).parameter("pieces", f64::from(n))))
            .collect()
    };
    let mut cases = vec![
        Case::of("Yu 1", "city-cross-slit", glc()).paper(of("1", Some(70.0), "a generated city of 15,000 triangles")),
        Case::new(
            "Yu 5",
            scene!("primitives"),
            with_raster(arms(&["raster-splat:5", "raster-splat:10", "raster-splat:20", "raytrace"])),
        )
        .paper(of("5 (b) to (d)", None, "a ball, a cylinder and a box of 370 triangles in all")),
        Case::of("Yu 6", "cow-panorama", pieces(32, &ring)).paper(of("6", Some(47.0), "a generated cow")),
        Case::of("Yu 7", "teapot-panorama", pieces(32, &ring)).paper(of(
            "7",
            Some(32.0),
            "the teapot; the number of GLCs is not given",
        )),
        Case::of("Yu 8", "mirror-ball", atlas_arms(("mirror.count", 960), 256, &ball))
            .truth(&["camera.facets=\"exact\""])
            .paper(of("8", Some(10.0), "1,100 triangles, an atlas of 31 million texels")),
        Case::of("Yu 9", "hinge", glc()).paper(of("9", None, "a generated cow")),
    ];
    let in_facets = |name: String, count, texels, fps| {
        Case::of(name, "mirror-ball", atlas_arms(("mirror.count", count), texels, &ball))
            .truth(&["camera.facets=\"exact\""])
            .paper(of("10 (a)", Some(fps), "1,100 triangles"))
    };
    let a =
        [(126, 128, 87.1), (126, 512, 43.1), (360, 128, 27.8), (360, 512, 16.7), (640, 128, 16.6), (640, 512, 10.4)];
    cases.extend(
        a.map(|(n, texels, fps)| in_facets(format!("Yu 10 (a): {n} GLCs of {texels} texels a side"), n, texels, fps)),
    );
    let b = [(550, 6, 28.4), (550, 10, 14.4), (1100, 6, 22.4), (1100, 10, 10.8), (2200, 6, 9.5), (2200, 10, 6.9)];
    cases.extend(b.map(|(n, k, fps)| {
        let by = [&*format!("raster-splat:{k}"), &*format!("raster-splat-passes:{k}")].map(str::to_owned);
        let arms = atlas_arms(("mirror.count", 480), 256, &[&by[0], &by[1], "raytrace"]);
        let stand_in = "a generated town; 256 texels a side, as in its figure 8: the paper does not say";
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
    let ring = |cameras: &str, count: u32, texels: u32, fps: f64| {
        Case::of(
            format!("Hou table 1: reflection, {cameras} cameras"),
            "mirror-ring",
            atlas_arms(("mirror.count", count), texels, &bound),
        )
        .set(&["camera.depth=1"])
        .truth(&["camera.facets=\"exact\""])
        .paper(of("table 1, figures 1 and 6", Some(fps), "a torus in a scene of 108 triangles"))
    };
    let flat = ["camera.facets=\"flat\""];
    let ring_atlas = |arm: Arm| arm.set(&["camera.atlas=64"]).parameter("texels of an atlas", 64.0);
    let water = atlas_arms(("lens.count", 12), 128, &bound);
    let mut cases = vec![
        // no grid around a torus has 26 triangles
        ring("24 for 26", 24, 128, 51.0),
        ring("104", 104, 64, 63.0),
        ring("416", 416, 32, 5.0),
        Case::of("Hou table 1: refraction", "water", water).truth(&["camera.facets=\"exact\""]).paper(of(
            "table 1, figure 9",
            Some(46.0),
            "252 triangles and 12 cameras",
        )),
        Case::of("Hou table 1: caustics, the frame", "caustic", arms(&[])).paper(of(
            "table 1, figure 11",
            Some(35.0),
            FRAME,
        )),
        Case::of(
            "Hou table 1: caustics, what the light sees",
            "caustic",
            vec![
                Arm::ours(),
                ring_atlas(Arm::ours().label("facets")),
                ring_atlas(Arm::rival("raster-bound").set(&flat)),
                ring_atlas(Arm::rival("raster-bound-passes").set(&flat)),
                ring_atlas(Arm::rival("raytrace").set(&flat)),
            ],
        )
        .set(&[
            "image.width=512",
            "image.height=512",
            "camera.eye={ kind = \"pinhole\", eye = [-2.0, 2.2, 1.0], target = [0, 0.2, 0], vfov = 40 }",
            "camera.depth=1",
        ])
        .paper(of("table 1, figure 11", Some(35.0), LIGHT)),
        Case::of("Hou table 1: visualization", "surround", with_raster(arms(&bound))).paper(of(
            "table 1, figure 12",
            Some(46.0),
            "a generated walker of 7,040 triangles (the paper's has 6,841), 400 cameras",
        )),
    ];
    // triangles, those of the flock, cameras, frames a second with culling and without
    let rows = [
        (800, 700, 100, 20.1, 4.5),
        (1200, 1100, 100, 14.6, 3.6),
        (1600, 1500, 100, 9.2, 2.1),
        (400, 300, 256, 6.0, 1.5),
        (800, 700, 256, 2.1, 0.5),
        (1200, 1100, 256, 1.8, 0.35),
        (400, 300, 512, 2.5, 0.8),
        (800, 700, 512, 1.0, 0.3),
    ];
    cases.extend(rows.map(|(triangles, flock, cameras, fps, fps_no_cull)| {
        let mut arms = atlas_arms(("mirror.cameras", cameras), 64, &bound);
        // the teapot has no formula: as many cameras as the eye sees facets are as near as it gets
        let most = "camera.mirror.cameras=6320";
        arms[0] = Arm::ours().set(&[most]).label("a camera a facet");
        // moving triangles are rasterized anyway
        arms.retain(|arm| arm.method.is_none());
        let culling: Vec<Arm> = arms[2..4].to_vec();
        arms.extend(culling.into_iter().map(Arm::no_cull));
        let paper = of("7", Some(fps), "the built-in teapot as the mirror, butterflies and balls that move");
        Case::of(format!("Hou 7: {triangles} moving triangles, {cameras} cameras"), "mirror-teapot", arms)
            .moving(Moving::Triangles)
            .set(&[&format!("mesh.0.file=flock-{flock}.obj")])
            .truth(&[most])
            .paper(Paper { fps_no_cull: Some(fps_no_cull), ..paper })
    }));
    cases
}

const FRAME: &str = "a ring of 400 triangles; its light is deposited once, before the frames: the stage deposit, with the way to \
                     the host and back, is not in their time. The mirror is seen as it is, which rivals cannot: they are timed in the next case";
const LIGHT: &str = "the same ring from the light, one bounce: what the paper renders in each frame for its photons, without their deposit";

/// Popescu et al.
fn popescu() -> Vec<Case> {
    let of = |figure: &str, fps: f64, stand_in: &str| paper("Popescu et al.", figure, fps, K5000, stand_in);
    // built once, as the rival's, a hierarchy is not in the time of a frame
    let traced = || Arm::ours().by(Method::Trace);
    let by = || {
        vec![Arm::ours(), Arm::ours().by(Method::Raster), traced(), Arm::rival("raster-warp:0"), Arm::rival("raytrace")]
    };
    let (terrain, city) =
        ("a generated terrain of 2,121,800 triangles", "a generated city and balls, 3,692,000 triangles");
    let terrain_size = ["mesh.0.size=1030"];
    let towns = ["mesh.0.triangles=3689440"];
    let one = ["camera.targets=[{ at = [-6.25, 0.5, 0], radius = 0.45 }]"];
    let town = ["mesh.0.triangles=3752000"];
    vec![
        Case::of("Popescu 1", "terrain-top-down", by()).set(&terrain_size).paper(of("1, table 1", 28.0, terrain)),
        Case::of("Popescu 2", "terrain-bottom-up", by()).set(&terrain_size).paper(of("2, table 1", 24.0, terrain)),
        Case::of("Popescu 3", "tracked", by()).set(&towns).paper(of("3, table 1", 19.0, city)),
        Case::of("Popescu 3: 17 segments a layer", "tracked", by()).set(&["camera.segments=17"]).paper(paper(
            "Popescu et al.",
            "3",
            None,
            K5000,
            "a generated city of 9,000 triangles and balls: few enough for the paper's technique",
        )),
        Case::of("Popescu 10", "tracked", by()).set(&towns).set(&one).paper(of("10, table 1", 39.0, city)),
        Case::of("Popescu 9", "opposite", by()).set(&town).paper(of("9, table 1", 13.0, "a generated city of as many")),
        Case::of(
            "Popescu 9, the graph camera",
            "graph-camera",
            vec![Arm::ours(), traced(), Arm::rival("raster-pieces"), Arm::rival("raytrace")],
        )
        .set(&town)
        .paper(paper(
            "Popescu et al.",
            "9",
            None,
            K5000,
            "the same city by the camera that the paper compares with",
        )),
    ]
}

/// Samples of a pixel of the truth of what is filtered.
const TRUTH: u32 = 64;

/// Lorenz and Doellner 2009.
fn lorenz() -> Vec<Case> {
    let of =
        |figure: &str, fps: f64, stand_in: &str| paper("Lorenz and Doellner 2009", figure, fps, GTS_8800, stand_in);
    let strips = |arm: Arm, n: u32| arm.set(&[&format!("camera.strips={n}")]).parameter("strips", f64::from(n));
    let city = "a generated city of 35,000 triangles";
    let quality = "the same city under a pattern that is filtered, 16 samples a pixel as in the paper, by a frame each where a row says so. \
                   Like the paper's, the rasterizer's own multisampling shades once a pixel and triangle; every adapter has it with 4 samples, \
                   so rows of 4 compare with each other";
    let size = ["image.width=1600", "image.height=1200"];
    let pattern = ["mesh.0.pattern.kind=\"checker\"", "mesh.0.pattern.size=0.7"];
    // this engine's both ways
    let fine = |arms: Vec<Arm>| -> Vec<Arm> {
        let (separate, at_once) = (Samples::Separate(16), Samples::AtOnce);
        let ways = |arm: &Arm| match arm.rival.as_deref() {
            None => [at_once(16), separate, at_once(MULTISAMPLES)].map(|samples| arm.clone().samples(samples)).to_vec(),
            Some("raster-pieces") => {
                vec![arm.clone().samples(separate), arm.clone().samples(at_once(MULTISAMPLES)).label("multisampling")]
            }
            Some(_) => vec![arm.clone().samples(separate)],
        };
        arms.iter().flat_map(ways).collect()
    };
    let cube = || Arm::rival("raster-cubemap:2048");
    let ppp = |n: u32| vec![strips(Arm::ours(), n), strips(Arm::rival("raster-pieces"), n)];
    let exact = vec![Arm::ours(), Arm::ours().by(Method::Trace), Arm::rival("raytrace")];
    let cylinder =
        |name: &str, arms: Vec<Arm>, size: [&str; 2]| Case::new(name, cylinder_scene(), arms).set(&size).counted();
    let mut cases = vec![
        cylinder("Lorenz table 1: PPP", [exact, ppp(160)].concat(), size).paper(of("table 1, figure 1", 84.7, city)),
        cylinder("Lorenz table 1: IB", vec![Arm::ours(), cube(), Arm::rival("raytrace")], size)
            .paper(of("table 1", 41.7, city)),
        cylinder("Lorenz table 1: PPP HQ", fine(ppp(160)), size).set(&pattern).filtered(TRUTH).paper(of(
            "table 1, figure 1",
            54.8,
            quality,
        )),
        cylinder("Lorenz table 1: IB HQ", fine(vec![Arm::ours(), cube()]), size)
            .set(&pattern)
            .filtered(TRUTH)
            .paper(of("table 1", 33.8, quality)),
        cylinder("Lorenz 4", ppp(40), size).paper(paper("Lorenz and Doellner 2009", "4", None, GTS_8800, city)),
    ];
    // texture, technique, with high quality, figure, frames a second
    let by = |name: &str| vec![Arm::ours(), Arm::rival(name)];
    let traced = |name: &str| [by(name), vec![Arm::rival("raytrace")]].concat();
    let textures = [
        ("128x128", "raster-pieces", false, "table 2, PPP", 8.4),
        ("128x128", "raster-image:2048", false, "table 2, IB", 206.2),
        ("128x128", "raster-pieces", true, "table 2, PPP HQ", 8.2),
        ("128x128", "raster-image:2048", true, "table 2, IB HQ", 95.8),
        ("80x60", "raster-pieces", false, "section 4", 22.1),
        ("80x60", "raster-pieces", true, "section 4, HQ", 20.9),
    ];
    cases.extend(textures.map(|(texture, technique, is_fine, figure, fps)| {
        let (arms, more) = if is_fine { (fine(by(technique)), &pattern[..]) } else { (traced(technique), &[][..]) };
        let case = Case::of(format!("Lorenz {figure}: camera texture of {texture}"), "deformation", arms)
            .set(&[&format!("camera.file=deformation-{texture}.npy")])
            .set(&size)
            .set(more)
            .counted()
            .paper(of(figure, fps, if is_fine { quality } else { city }));
        if is_fine { case.filtered(TRUTH) } else { case }
    }));
    // its figure 6: up to a million triangles
    cases.extend([20_000, 100_000, 1_000_000].map(|n| {
        let stand_in = "a generated city; the paper draws curves without numbers";
        Case::of(format!("Lorenz 6: {n} triangles"), "deformation", traced("raster-pieces"))
            .set(&["camera.file=deformation-128x128.npy", &format!("mesh.0.triangles={n}")])
            .set(&size)
            .counted()
            .paper(paper("Lorenz and Doellner 2009", "6", None, GTS_8800, stand_in))
    }));
    cases
}

pub fn cases() -> Vec<Case> {
    [yu(), hou(), popescu(), lorenz()].concat()
}

pub fn quick() -> Vec<Case> {
    let few = ["Yu 1", "Yu 5", "Hou table 1: refraction", "Lorenz table 1: PPP"];
    cases().into_iter().filter(|c| few.contains(&c.name.as_str())).collect()
}
