//! Pictures at every width of subgroups that Mesa's software driver can have.

use super::program::Place;
use crate::needs::skip;

/// One of each kind of camera, surface and sample.
const EXAMPLES: [&str; 10] =
    ["demo", "bilinear", "mesh", "panorama", "occlusion", "curved", "mirror-ball", "lens", "pen-and-ink", "glass-ball"];

/// Bits of a vector, and whether raster goes tile by tile there, with lanes that are a part of a subgroup.
const WIDTHS: [(&str, bool, bool); 3] = [("256", true, false), ("512", true, true), ("128", false, false)];

/// Runs with vectors of that width, and gives what the program prints.
fn at_width(place: &Place, bits: &str, args: &[&str]) -> String {
    let out = place.command(args).env("LP_NATIVE_VECTOR_WIDTH", bits).output().unwrap();
    assert!(out.status.success(), "{bits} {args:?}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

#[test]
#[ignore = "slow: make test-all"]
fn pictures_are_the_same_at_every_width_of_subgroups() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    for (bits, lanes, wide) in WIDTHS {
        let info: serde_json::Value = serde_json::from_str(&at_width(&place, bits, &["info", "--json"])).unwrap();
        let adapter = &info["adapters"][0];
        if !adapter["name"].as_str().unwrap().contains("llvmpipe") {
            return skip("not Mesa's software driver");
        }
        assert_eq!((&adapter["abilities"]["lanes"], &adapter["abilities"]["wide"]), (&lanes.into(), &wide.into()));
    }
    for example in EXAMPLES {
        place.works(&["example", example, "--out", example]);
        let scene = format!("{example}/{example}.toml");
        let [first, others @ ..] = WIDTHS.map(|(bits, ..)| {
            let file = format!("{example}/{bits}.exr");
            at_width(&place, bits, &["render", &scene, "--size", "64x48", "--exr", &file]);
            std::fs::read(place.path().join(file)).unwrap()
        });
        for (other, (bits, ..)) in others.iter().zip(&WIDTHS[1..]) {
            assert!(*other == first, "{example}: not the same with vectors of {bits} bits as with 256");
        }
    }
}
