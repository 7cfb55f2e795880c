//! The papers' rows, measured: one loop for all of them.

use super::measure::{Bench, Difference, Look, Shown};
use super::papers::{Row, Stand, Surface, TEXELS, Table};
use anamorph::error::Result;
use anamorph::frame::Frame;
use std::fmt::Write;
use std::path::Path;

const COLUMNS: &str = "paper,figure,setting,triangles,cameras,texels,paper_fps,paper_hardware,\
our_scene,our_triangles,our_cameras,our_texels,direct_fps,atlas_fps,direct_wrong_share,atlas_wrong_share,truth,our_adapter";

/// An atlas of fewer texels a side has no picture left.
const TEXELS_LEAST: u32 = 8;

/// A row of ours.
#[derive(Default)]
struct Ours {
    scene: &'static str,
    direct: Option<Shown>,
    /// The same cameras in an atlas first, with so many texels a side: the paper's, or fewer where the adapter binds no more.
    atlas: Option<(u32, Shown)>,
    /// The surface itself, and what that is.
    truth: Option<(Frame, String)>,
}

/// The table with our figures beside the paper's; what we do not have is left empty.
pub fn table(bench: &mut Bench, table: &Table) -> Result<String> {
    println!("{}, {}", table.paper, table.file);
    let mut csv = format!("{COLUMNS}\n");
    for row in table.rows {
        let ours = match row.scene {
            Some(stand) => measured(bench, stand, row)?,
            None => Ours::default(),
        };
        let columns = ours.columns(&bench.adapter().replace(',', ";"));
        for (setting, fps) in row.timed {
            // writing to a String cannot fail
            let _ = writeln!(csv, "{},{columns}", theirs(table, row, setting, *fps));
            println!(
                "{:>5} triangles {:>4} cameras, {setting}: {fps} fps there; {}",
                row.triangles,
                row.cameras,
                ours.said()
            );
        }
    }
    Ok(csv)
}

fn theirs(table: &Table, row: &Row, setting: &str, fps: f64) -> String {
    let texels = row.texels.map(|t| t.to_string()).unwrap_or_default();
    let Row { figure, triangles, cameras, .. } = row;
    format!("{},{figure},{setting},{triangles},{cameras},{texels},{fps},{}", table.paper, table.hardware)
}

fn measured(bench: &mut Bench, stand: &'static Stand, row: &Row) -> Result<Ours> {
    let path = bench.example(stand.example)?;
    let look = Look::Colours { moving: stand.moving };
    let base: Vec<String> = stand.keys.iter().chain(row.keys).map(|k| k.to_string()).collect();
    let Some(surface) = &stand.optics else {
        return Ok(Ours { scene: stand.example, direct: Some(bench.shown(&path, &base, look)?), ..Ours::default() });
    };
    let direct = [base.clone(), surface.cut(row.cameras)].concat();
    // halved until the adapter binds the atlas
    let mut sides =
        std::iter::successors(row.texels.or(Some(TEXELS)), |t| Some(t / 2)).take_while(|t| *t >= TEXELS_LEAST);
    let atlas = match sides.find(|t| bench.fits(row.cameras, *t, look)) {
        Some(texels) => {
            let keys = [direct.clone(), vec![format!("camera.atlas={texels}")]].concat();
            Some((texels, bench.shown(&path, &keys, look)?))
        }
        None => None,
    };
    Ok(Ours {
        scene: stand.example,
        direct: Some(bench.shown(&path, &direct, look)?),
        atlas,
        truth: Some(truth(bench, &path, &base, surface)?),
    })
}

/// The surface met exactly; or as many facets as stand for it.
fn truth(bench: &mut Bench, path: &Path, base: &[String], surface: &Surface) -> Result<(Frame, String)> {
    let exact = [base, &["camera.facets=\"exact\"".into()]].concat();
    if let Ok(frame) = bench.frame(path, &exact) {
        return Ok((frame, "exact".into()));
    }
    let key = surface.key;
    let (facets, cut) = match surface.finest {
        Some(n) => (n, format!("camera.{key}.count={n}")),
        // a copy as fine as itself is itself
        None => surface.seen.map(|n| (n, format!("camera.{key}.cameras={n}"))).unwrap_or_default(),
    };
    let normals = [base, &["camera.facets=\"normals\"".into(), cut]].concat();
    Ok((bench.frame(path, &normals)?, format!("{facets} facets")))
}

impl Surface {
    /// Keys for so many cameras: the facets that are seen, or a copy of those.
    fn cut(&self, cameras: u32) -> Vec<String> {
        let key = self.key;
        match self.seen {
            None => vec![format!("camera.{key}.count={cameras}")],
            Some(seen) => vec![format!("camera.{key}.count={seen}"), format!("camera.{key}.cameras={cameras}")],
        }
    }
}

impl Ours {
    fn share(&self, shown: &Shown) -> Option<f64> {
        self.truth.as_ref().map(|(truth, _)| Difference::of(&shown.frame, truth).share())
    }

    fn columns(&self, adapter: &str) -> String {
        let Some(direct) = &self.direct else { return ",,,,,,,,,".into() };
        let fps = |shown: &Shown| format!("{:.3}", 1e3 / shown.ms);
        let share = |shown: &Shown| self.share(shown).map(|s| format!("{s:.4}")).unwrap_or_default();
        let (texels, atlas_fps, atlas_share) = match &self.atlas {
            Some((texels, shown)) => (texels.to_string(), fps(shown), share(shown)),
            None => Default::default(),
        };
        let truth = self.truth.as_ref().map_or("", |t| &t.1);
        let Shown { triangles, cameras, .. } = direct;
        format!(
            "{},{triangles},{cameras},{texels},{},{atlas_fps},{},{atlas_share},{truth},{adapter}",
            self.scene,
            fps(direct),
            share(direct)
        )
    }

    fn said(&self) -> String {
        let way = |shown: &Shown| {
            let wrong = self.share(shown).map(|s| format!(", {:.1} % wrong", 100.0 * s)).unwrap_or_default();
            format!("{:.2} fps{wrong}", 1e3 / shown.ms)
        };
        match (&self.direct, &self.atlas) {
            (None, _) => "no switch for it here".into(),
            (Some(direct), None) => format!("here {}", way(direct)),
            (Some(direct), Some((texels, atlas))) => {
                format!("here {}; by an atlas of {texels} texels {}", way(direct), way(atlas))
            }
        }
    }
}
