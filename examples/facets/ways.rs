//! Ways of showing a mirror ball, against the ball itself.

use super::measure::{Bench, Difference, Look, Shown};
use anamorph::error::Result;
use std::fmt::Write;

pub const FILE: &str = "mirror_facets.csv";

/// Facets: those of Yu et al., figure 10, then four times as many each.
const COUNTS: [u32; 8] = [126, 360, 640, 960, 3840, 15_360, 61_440, 100_000];
/// Texels a side: those of Hou et al., table 1, and of Yu et al., figure 10.
const TEXELS: [u32; 4] = [32, 64, 128, 256];

/// For every way the pixels that show another triangle than the ball itself, of those that see it, the signal-to-noise ratio of
/// the colours, and the median frame.
pub fn table(bench: &mut Bench) -> Result<String> {
    let path = bench.example("mirror-ball")?;
    let truth = bench.shown(&path, &["camera.facets=\"exact\"".into()], Look::All)?;
    let mut csv = String::from("way,facets,texels,wrong,mirror_pixels,psnr_db,frame_ms\n");
    let mut add = |name: &str, facets: u32, texels: u32, shown: &Shown| {
        let Difference { wrong, pixels, psnr } = Difference::of(&shown.frame, &truth.frame);
        let ms = shown.ms;
        // writing to a String cannot fail
        let _ = writeln!(csv, "{name},{facets},{texels},{wrong},{pixels},{psnr:.2},{ms:.1}");
        println!(
            "{name:<12} {facets:>7} facets {texels:>4} texels: {wrong:>6} of {pixels} wrong, {psnr:6.2} dB, {ms:8.1} ms"
        );
    };
    add("exact", 0, 0, &truth);
    let set = |keys: &[(&str, String)]| keys.iter().map(|(k, v)| format!("camera.{k}={v}")).collect::<Vec<_>>();
    for law in ["normals", "flat"] {
        for count in COUNTS {
            let keys = [("facets", format!("{law:?}")), ("mirror.count", count.to_string())];
            add(law, count, 0, &bench.shown(&path, &set(&keys), Look::All)?);
        }
    }
    for texels in TEXELS {
        for count in [126, 480, 960] {
            if !bench.fits(count, texels, Look::All) {
                println!("flat atlas {count} facets {texels} texels: more than the adapter binds");
                continue;
            }
            let keys = [("mirror.count", count.to_string()), ("atlas", texels.to_string())];
            add("flat atlas", count, texels, &bench.shown(&path, &set(&keys), Look::All)?);
        }
    }
    let keys = [("facets", "\"exact\"".to_owned()), ("environment", "[0, 0, 0]".to_owned())];
    add("environment", 0, 0, &bench.shown(&path, &set(&keys), Look::All)?);
    Ok(csv)
}
