//! `anamorph camera --diagram`: what the drawing holds, read as XML.

use super::program::Place;

const SCENE: &str = "[image]\nwidth = 49\nheight = 33\n[[mesh]]\nbuiltin = \"box\"\nscale = [2, 4, 6]\n[camera]\n";

fn drawn(place: &Place, camera: &str) -> String {
    place.write("d.toml", format!("{SCENE}{camera}\n"));
    place.works(&["camera", "d.toml", "--diagram", "d.svg"]);
    std::fs::read_to_string(place.path().join("d.svg")).unwrap()
}

/// The places in every shape of a class, px.
fn shapes(svg: &str, class: &str) -> Vec<Vec<[f64; 2]>> {
    let tree = roxmltree::Document::parse(svg).expect("XML");
    let of_class = tree.descendants().filter(|n| n.attribute("class") == Some(class));
    let text =
        |n: roxmltree::Node| n.attribute("points").or(n.attribute("d")).unwrap().replace(['M', 'L', 'Q', 'C'], " ");
    let number = |t: &str| t.parse::<f64>().unwrap();
    let places = |t: String| {
        t.split_whitespace().map(|xy| xy.split_once(',').map(|(x, y)| [number(x), number(y)]).unwrap()).collect()
    };
    of_class.map(|n| places(text(n))).collect()
}

/// Sheet places of world points, from the edges of the box about the scene: corner 0 is its least one, and edges go from
/// corner k along x, y, z in turn.
fn projection(svg: &str) -> impl Fn([f64; 3]) -> [f64; 2] {
    let edges = shapes(svg, "box");
    assert_eq!(edges.len(), 12);
    let (lo, size) = ([-1.0, -2.0, -3.0], [2.0, 4.0, 6.0]);
    move |p| {
        let coordinate = |c: usize| {
            let along = |axis: usize| (edges[axis][1][c] - edges[axis][0][c]) * (p[axis] - lo[axis]) / size[axis];
            edges[0][0][c] + (0..3).map(along).sum::<f64>()
        };
        [coordinate(0), coordinate(1)]
    }
}

/// Corners and places are rounded to 0.01 px, off by 0.005 each; a point up to 6 box sides away multiplies the two
/// corners' error by 6 for each of three axes.
const PLACE_PX: f64 = 0.005 * (1.0 + 1.0 + 3.0 * 2.0 * 6.0);

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() <= PLACE_PX && (a[1] - b[1]).abs() <= PLACE_PX
}

#[test]
fn rays_are_drawn_where_they_are() {
    let place = Place::new();
    let svg =
        drawn(&place, "kind = \"orthographic\"\neye = [0, 0, 8]\ntarget = [0, 0, 0]\nheight = 6.6\nt_range = [1, 9]");
    let at = projection(&svg);
    let rays = shapes(&svg, "ray");
    // every 2nd of 49 and of 33 pixels makes the grid, every 4th of those a ray; pixels are 0.2 wide
    assert_eq!(rays.len(), 7 * 5);
    for (k, ray) in rays.iter().enumerate() {
        let (x, y) = (1.6 * (k % 7) as f64 - 4.8, 3.2 - 1.6 * (k / 7) as f64);
        assert!(near(ray[0], at([x, y, 7.0])) && near(ray[1], at([x, y, -1.0])), "ray {k}: {ray:?}");
    }
    // near and far surfaces: 5 rows and 7 columns; four borders
    let (lines, borders) = (shapes(&svg, "near"), shapes(&svg, "far"));
    assert_eq!((lines.len(), borders.len()), (12, 4));
    assert!(near(lines[0][24], at([4.8, 3.2, 7.0])) && near(borders[1][0], at([-4.8, -3.2, -1.0])));
    assert_eq!(shapes(&svg, "piece").len(), 1);
    assert_eq!(
        svg,
        drawn(&place, "kind = \"orthographic\"\neye = [0, 0, 8]\ntarget = [0, 0, 0]\nheight = 6.6\nt_range = [1, 9]")
    );
}

#[test]
fn slits_are_drawn_where_they_are() {
    let place = Place::new();
    // slits at z = 8, along y, and at z = 4, along x: D goes from z = 8 to z = 4 at t = 1
    let glc = "kind = \"glc\"\nnear = [[0, 2, 8], [0, 2, 8], [0, -2, 8]]\nfar = [[-3, 0, 4], [3, 0, 4], [-3, 0, 4]]";
    let svg = drawn(&place, glc);
    let (at, slits) = (projection(&svg), shapes(&svg, "slit"));
    let expected = [[[0.0, 2.0, 8.0], [0.0, -2.0, 8.0]], [[-3.0, 0.0, 4.0], [3.0, 0.0, 4.0]]];
    for (slit, ends) in slits.iter().zip(expected) {
        let [a, b] = ends.map(&at);
        assert!((near(slit[0], a) && near(slit[1], b)) || (near(slit[0], b) && near(slit[1], a)), "{slit:?}");
    }
    assert_eq!(slits.len(), 2);
}

#[test]
fn projectors_are_beziers() {
    let place = Place::new();
    let plane =
        |x: f64, z: f64| format!("{{ kind = \"plane\", origin = [{x}, 2, {z}], u = [4, 0, 0], v = [0, -4, 0] }}");
    for degree in 1..=3 {
        let control: Vec<[f64; 2]> = (0..=degree).map(|k| [f64::from(k * k) - 2.0, 6.0 - 3.0 * f64::from(k)]).collect();
        let surfaces: Vec<String> = control.iter().map(|[x, z]| plane(*x, *z)).collect();
        let svg = drawn(&place, &format!("kind = \"projector\"\nsurfaces = [{}]", surfaces.join(", ")));
        let (at, rays) = (projection(&svg), shapes(&svg, "ray"));
        // the first pixel's centre, and all its control points
        let (u, v) = (0.5 / 49.0, 0.5 / 33.0);
        let expected: Vec<[f64; 2]> = control.iter().map(|[x, z]| at([x + 4.0 * u, 2.0 - 4.0 * v, *z])).collect();
        assert_eq!(rays[0].len(), degree as usize + 1);
        assert!(rays[0].iter().zip(&expected).all(|(a, b)| near(*a, *b)), "{:?} is not {expected:?}", rays[0]);
    }
}

#[test]
fn every_piece_is_a_polygon_until_there_are_too_many() {
    let place = Place::new();
    let panorama = |n: u32| format!("kind = \"panorama\"\nradius = 9\nheight = 5\npieces = {n}");
    let few = drawn(&place, &panorama(12));
    assert_eq!(shapes(&few, "piece").len(), 24);
    assert!(few.contains("image: 24 pieces<") && few.matches("class=\"number\"").count() == 24 + 3);
    let sphere = "kind = \"sphere\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nstrips = ";
    let many = drawn(&place, &format!("{sphere}100"));
    let count: usize = many.split("image: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let step: usize = many.split("one in ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(count > 5000 && step > 1);
    assert_eq!(shapes(&many, "piece").len(), count.div_ceil(step));
    // a ray field: a grid instead; circular fisheyes have no rays in the corners
    let fisheye = drawn(&place, "kind = \"fisheye\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 120");
    assert!(shapes(&fisheye, "piece").is_empty() && shapes(&fisheye, "grid").iter().all(|l| l.len() < 25));
    // a chain: a picture for each layer
    let chain = drawn(&place, "kind = \"occlusion\"\neye = [0, 0, 9]");
    assert_eq!(shapes(&chain, "frame").len(), 3);
    assert_eq!(shapes(&chain, "ray").len(), 3 * 35);
}
