//! Regions with viewpoints of their own.

use super::*;

const ROOT: &str = "eye = [0, 6, 20]\ntarget = [0, 1, 0]\nvfov = 40";
const REGIONS: &str = "regions = [{ rect = [0.1, 0.2, 0.35, 0.7], eye = [-6, 12, 4], target = [-6, 1, -4] }, \
                       { polygon = [[0.6, 0.3], [0.85, 0.25], [0.8, 0.7], [0.7, 0.5]], eye = [8, 10, 6], vfov = 30 }]\nband = 0.1";

fn of(keys: &str) -> Camera {
    camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{REGIONS}\n{keys}")).unwrap()
}

fn root() -> Camera {
    camera_of(BOXES, SIZE, &format!("kind = \"pinhole\"\n{ROOT}")).unwrap()
}

/// Pixels surely inside the first region, and outside all regions and bands.
fn inside((i, j): (u32, u32)) -> bool {
    (8..28).contains(&i) && (12..42).contains(&j)
}

fn outside((i, j): (u32, u32)) -> bool {
    let near = |x0: u32, x1: u32, y0: u32, y1: u32| (x0..x1).contains(&i) && (y0..y1).contains(&j);
    !near(1, 35, 5, 49) && !near(38, 79, 2, 60)
}

#[test]
fn a_region_is_the_plain_pinhole_of_its_eye_moved_by_whole_pixels() {
    for keys in ["", "foreground = true", "foreground = true\njoin = \"bezier\""] {
        let camera = of(keys);
        let leaf = camera.layers.len() - 1;
        let own =
            camera_of(BOXES, SIZE, "kind = \"pinhole\"\neye = [-6, 12, 4]\ntarget = [-6, 1, -4]\nvfov = 40").unwrap();
        // the region's middle is at (18, 27), the view's at (40, 30)
        for (i, j) in pixels(&camera).filter(|p| inside(*p)) {
            assert_same(&camera, leaf, (i, j), &own.ray(i + 22, j + 3).unwrap());
        }
    }
}

#[test]
fn around_the_regions_it_is_the_plain_root_view() {
    for keys in ["", "foreground = true", "foreground = true\nlongitudinal = 3", "foreground = true\njoin = \"bezier\""]
    {
        let camera = of(keys);
        let root = root();
        let around: Vec<_> = pixels(&camera).filter(|p| outside(*p)).collect();
        assert!(around.len() > 600);
        for p in around {
            assert_straight(&camera, p, &root.ray(p.0, p.1).unwrap());
        }
    }
}

#[test]
fn a_region_without_a_target_looks_at_what_the_root_sees_in_its_middle() {
    let rect = "regions = [{ rect = [0.4, 0.4, 0.6, 0.6], eye = [3, 8, 9] }]";
    let camera = camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{rect}")).unwrap();
    // the root looks down onto the middle box's front, x = 0, z = 0.5; its middle ray meets that at y = 1.125
    let ray = camera.with_sample_offset(-0.5, -0.5).ray(40, 30).unwrap();
    let to = DVec3::new(0.0, 1.125, 0.5) - ray.origin;
    assert!((to.normalize() - ray.direction.normalize()).length() < 1e-9, "{to} {}", ray.direction);
}

#[test]
fn the_picture_has_no_seam() {
    for (keys, layers) in [
        ("", 1),
        ("foreground = true", 3),
        ("foreground = true\nlongitudinal = 2", 4),
        ("foreground = true\njoin = \"bezier\"", 3),
    ] {
        let camera = of(keys);
        assert_eq!(camera.layers.len(), layers, "{keys}");
        assert_eq!(assert_joined(&camera, 1), 3 * (layers - 1) * 80 * 60);
        // 8 corners in regions, 8 around them, 4 around the image; all sides but those 4 are shared
        assert!(assert_seamless(&camera, 2) >= 40);
        assert_curves_seamless(&camera);
        assert!(pixels(&camera).all(|(i, j)| (0..layers).all(|layer| camera.curve(layer, i, j).is_some())));
    }
    assert_smooth(&of("foreground = true\njoin = \"bezier\""));
}

#[test]
fn any_number_of_regions_and_of_none() {
    let many: Vec<String> = (0..12)
        .map(|k| {
            let (a, b) = (0.05 + 0.25 * (k % 4) as f64, 0.1 + 0.3 * (k / 4) as f64);
            format!("{{ rect = [{a}, {b}, {}, {}], eye = [{k}, 9, 9] }}", a + 0.15, b + 0.15)
        })
        .collect();
    let camera =
        camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\nband = 0.03\nregions = [{}]", many.join(", ")))
            .unwrap();
    assert!(assert_seamless(&camera, 3) > 12 * 9);
    let none = camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\nregions = []")).unwrap();
    let root = root();
    pixels(&none).for_each(|p| assert_straight(&none, p, &root.ray(p.0, p.1).unwrap()));
}

#[test]
fn morphed_to_0_it_is_the_root_view() {
    for keys in ["morph = 0", "morph = 0.0\nforeground = true\njoin = \"bezier\""] {
        let (camera, root) = (of(keys), root());
        pixels(&camera).for_each(|p| assert_straight(&camera, p, &root.ray(p.0, p.1).unwrap()));
    }
    assert_seamless(&of("morph = 0.3"), 5);
}

#[test]
fn a_cube_of_views_closes_around_the_eye() {
    for (layout, cells) in [
        ("cross", [(0, 1), (1, 1), (2, 1), (3, 1), (1, 0), (1, 2)]),
        ("strip", [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)]),
    ] {
        let keys = format!(
            "kind = \"top_down\"\nlayout = \"{layout}\"\neye = [1, 4, 7]\ntarget = [1, 4, 0]\nregions = []\nforeground = true"
        );
        let size = if layout == "cross" { (80, 60) } else { (120, 20) };
        let camera = camera_of(BOXES, size, &keys).unwrap();
        let looks = [(-1, 0, 0), (0, 0, -1), (1, 0, 0), (0, 0, 1), (0, 1, 0), (0, -1, 0)];
        let ups = [(0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)];
        for k in 0..6 {
            let ((x, y, z), (ux, uy, uz)) = (looks[k], ups[k]);
            let face = format!(
                "kind = \"pinhole\"\neye = [1, 4, 7]\ntarget = [{}, {}, {}]\nup = [{ux}, {uy}, {uz}]\nvfov = 90",
                1 + x,
                4 + y,
                7 + z
            );
            let face = camera_of(BOXES, (20, 20), &face).unwrap();
            for (i, j) in pixels(&face) {
                let (column, row) = cells[k];
                assert_straight(&camera, (20 * column + i, 20 * row + j), &face.ray(i, j).unwrap());
            }
        }
        let blank = pixels(&camera).filter(|(i, j)| camera.ray(*i, *j).is_none()).count();
        assert_eq!(blank as u32, size.0 * size.1 - 6 * 400);
    }
}

#[test]
fn faces_of_a_cube_have_regions_of_their_own() {
    let keys = "kind = \"top_down\"\nlayout = \"cross\"\neye = [0, 4, 8]\ntarget = [0, 4, 0]\nband = 0.1\nregions = [\
                { rect = [0.3, 0.4, 0.45, 0.6], eye = [0, 9, 9], target = [0, 1, 0] }]";
    let camera = camera_of(BOXES, SIZE, keys).unwrap();
    assert!(assert_seamless(&camera, 6) > 10);
    let own = camera_of(BOXES, (20, 20), "kind = \"pinhole\"\neye = [0, 9, 9]\ntarget = [0, 1, 0]\nvfov = 90").unwrap();
    for (i, j) in (24..36).flat_map(|i| (24..36).map(move |j| (i, j))) {
        assert_same(&camera, 0, (i, j), &own.ray(i - 20, j - 20).unwrap());
    }
}

/// Regions that overlap: two whose bands meet, two that cross, one in another, three at once, and a polygon over a side.
const OVERLAPPING: [&[&str]; 5] = [
    &["rect = [0.1, 0.2, 0.4, 0.6]", "rect = [0.5, 0.3, 0.7, 0.7]"],
    &["rect = [0.2, 0.2, 0.5, 0.6]", "rect = [0.35, 0.4, 0.7, 0.75]"],
    &["rect = [0.4, 0.4, 0.5, 0.5]", "rect = [0.2, 0.2, 0.7, 0.7]"],
    &["rect = [0.2, 0.2, 0.5, 0.6]", "rect = [0.35, 0.4, 0.7, 0.75]", "rect = [0.4, 0.2, 0.7, 0.5]"],
    &["rect = [0.2, 0.2, 0.5, 0.6]", "polygon = [[0.45, 0.3], [0.8, 0.25], [0.75, 0.7], [0.6, 0.5]]"],
];
const EYES: [&str; 3] = ["eye = [-6, 12, 4]", "eye = [8, 10, 6]", "eye = [1, 14, 9]"];

/// The camera of some of the regions.
fn overlapping(outlines: &[(usize, &str)], keys: &str) -> Camera {
    let regions: Vec<String> =
        outlines.iter().map(|(k, o)| format!("{{ {o}, {}, target = [0, 1, -2] }}", EYES[*k])).collect();
    let keys = format!("kind = \"top_down\"\n{ROOT}\nband = 0.1\nregions = [{}]\n{keys}", regions.join(", "));
    camera_of(BOXES, SIZE, &keys).unwrap()
}

fn is_same(a: &Camera, b: &Camera, (i, j): (u32, u32)) -> bool {
    let [a, b] = [a, b].map(|c| c.ray(i, j).unwrap());
    let size = 1.0 + a.origin.length() + a.direction.length();
    (a.origin - b.origin).length() <= POINT_ROUNDING * size
        && (a.direction - b.direction).length() <= POINT_ROUNDING * size
}

#[test]
fn regions_that_overlap_join_without_a_seam() {
    for outlines in OVERLAPPING {
        let all: Vec<(usize, &str)> = outlines.iter().copied().enumerate().collect();
        for keys in ["", "foreground = true", "foreground = true\njoin = \"bezier\""] {
            let camera = overlapping(&all, keys);
            assert_joined(&camera, 7);
            assert!(assert_seamless(&camera, 8) > 40);
            let layers = camera.layers.len();
            assert!(pixels(&camera).all(|(i, j)| (0..layers).all(|layer| camera.curve(layer, i, j).is_some())));
        }
        // in every pair of neighbouring pixels rays differ by no more than a band's slope: the camera without overlaps
        let camera = overlapping(&all, "");
        let jump = |c: &Camera, a: (u32, u32), b: (u32, u32)| {
            let [a, b] = [a, b].map(|p| c.ray(p.0, p.1).unwrap());
            (a.origin - b.origin).length().max((a.origin + a.direction - b.origin - b.direction).length())
        };
        let steepest = |c: &Camera| {
            let pairs = pixels(c).filter(|(i, j)| i + 1 < SIZE.0 && j + 1 < SIZE.1);
            pairs.map(|(i, j)| jump(c, (i, j), (i + 1, j)).max(jump(c, (i, j), (i, j + 1)))).fold(0.0, f64::max)
        };
        let alone: f64 = all.iter().map(|one| steepest(&overlapping(&[*one], ""))).sum();
        // the difference of two views is at most the sum of both from the root's
        assert!(steepest(&camera) <= 2.0 * alone, "{} over {alone}", steepest(&camera));
    }
}

#[test]
fn a_region_is_as_if_alone_where_no_other_reaches() {
    for outlines in OVERLAPPING {
        let all: Vec<(usize, &str)> = outlines.iter().copied().enumerate().collect();
        let camera = overlapping(&all, "");
        let alone: Vec<Camera> = all.iter().map(|one| overlapping(&[*one], "")).collect();
        let root = overlapping(&[], "");
        let mut single = vec![0; all.len()];
        for p in pixels(&camera) {
            let present: Vec<usize> = (0..all.len()).filter(|&k| !is_same(&alone[k], &root, p)).collect();
            match present[..] {
                [] => assert!(is_same(&camera, &root, p), "{p:?}"),
                [k] => {
                    single[k] += 1;
                    assert!(is_same(&camera, &alone[k], p), "{p:?} of region {k}");
                }
                _ => {}
            }
        }
        assert!(single.iter().filter(|n| **n > 50).count() + 1 >= all.len(), "{single:?}");
    }
}

#[test]
fn where_regions_overlap_each_takes_its_share_of_what_those_before_it_leave() {
    let outlines = OVERLAPPING[1];
    let all: Vec<(usize, &str)> = outlines.iter().copied().enumerate().collect();
    let (camera, reversed) = (overlapping(&all, ""), overlapping(&[all[1], all[0]], ""));
    let [first, second] = [0, 1].map(|k| overlapping(&[all[k]], ""));
    // the first region inside the second, and its own inside elsewhere
    let both = |(i, j): (u32, u32)| (28..40).contains(&i) && (24..36).contains(&j);
    assert_eq!(pixels(&camera).filter(|p| both(*p)).count(), 144);
    for p in pixels(&camera).filter(|p| both(*p)) {
        assert!(is_same(&camera, &first, p) && is_same(&reversed, &second, p), "{p:?}");
    }
    // the left band of the first, which lies in the second: its own offset from the root, and 1 - a of the second's
    let inside = overlapping(&[(0, "rect = [0.4, 0.4, 0.5, 0.5]"), (1, "rect = [0.2, 0.2, 0.7, 0.7]")], "");
    let small = overlapping(&[(0, "rect = [0.4, 0.4, 0.5, 0.5]")], "");
    let large = overlapping(&[(1, "rect = [0.2, 0.2, 0.7, 0.7]")], "");
    let (i, j, a) = (29, 27, (29.5 - 26.0) / 6.0);
    let [mixed, small, large, root] = [&inside, &small, &large, &root()].map(|c| c.ray(i, j).unwrap().origin);
    assert!((mixed - small - (1.0 - a) * (large - root)).length() < 1e-9, "{mixed} {small} {large}");
    assert!((mixed - small).length() > 1.0);
}

#[test]
fn regions_that_do_not_fit_are_errors() {
    let says = |keys: &str| refusal(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{keys}"));
    let two = |a: &str, b: &str| says(&format!("regions = [{{ eye = [0, 9, 9], {a} }}, {{ eye = [0, 9, 9], {b} }}]"));
    let fine = "rect = [0.1, 0.1, 0.3, 0.3]";
    assert!(two(fine, "rect = [0.6, 0.1, 0.5, 0.3]").contains("camera.regions.1.rect: the first corner"));
    assert!(
        two(fine, "polygon = [[0.5, 0.5], [0.9, 0.9], [0.9, 0.5], [0.5, 0.9]]").contains("no side crossing another")
    );
    assert!(two(fine, "polygon = [[0.5, 0.5], [0.9, 0.5], [0.5, 0.505]]").contains("too sharp or narrow"));
    assert!(two(fine, "polygon = [[0.5, 0.5], [0.9, 0.5], [0.5, 0.8]], rect = [0, 0, 1, 1]").contains("either rect"));
    assert!(two(fine, "rect = [0.6, 0.6, 0.8, 0.8], vfov = 0").contains("camera.regions.1.vfov = 0"));
    assert!(two(fine, "rect = [0.6, 0.6, 0.8, 0.8], target = [0, 9, 9]").contains("camera.regions.1: eye and target"));
    assert!(says("regions = []\nlayout = \"cross\"").contains("leave vfov out"));
    let cube = |rect: &str| {
        let root = "kind = \"top_down\"\nlayout = \"cross\"\neye = [0, 4, 8]\ntarget = [0, 4, 0]";
        refusal(BOXES, SIZE, &format!("{root}\nregions = [{{ rect = {rect}, eye = [0, 9, 9] }}]"))
    };
    assert!(cube("[0.0, 0.0, 0.1, 0.1]").contains("lies in no face"));
    assert!(cube("[0.25, 0.4, 0.45, 0.6]").contains("leaves its face"));
}
