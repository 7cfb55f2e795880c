//! Operations of a frame's kernels, as a table: counted from their code.

use super::case::Case;
use super::race::seen;
use crate::operations::{ByLoopDepth, Operations, of_kernel};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::SceneContents;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::stage::KernelId;
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use serde::{Deserialize, Serialize};

/// What one invocation of a kernel does.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KernelOperations {
    pub kernel: String,
    pub by_loop_depth: ByLoopDepth,
}

/// Those that a frame may spend its time in.
const KERNELS: [KernelId; 10] = [
    KernelId::Cull,
    KernelId::Split,
    KernelId::Small,
    KernelId::Bin,
    KernelId::Sort,
    KernelId::Raster,
    KernelId::Trace,
    KernelId::Recheck,
    KernelId::Shade,
    KernelId::Write,
];

/// Of the kernels that an adapter takes for a case, where raster and trace may both be taken.
pub fn of_case(case: &Case, has: AdapterFeatures) -> Result<Vec<KernelOperations>> {
    let folder = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
    let scene = Scene::load(&case.write(folder.path())?, &case.set, 0.0, &Loading::default())?;
    let (camera, wanted) = (scene.camera()?, seen(false, false));
    let variant = variant(&camera, SceneContents::of(&scene), &wanted, has, &RunOptions::default());
    let planes: Vec<Channel> = wanted.channels.into_iter().filter(|channel| channel.is_rendered()).collect();
    let kernels = KERNELS.into_iter().filter_map(|id| id.kernel(variant, &planes));
    let counted = kernels.map(|kernel| {
        let by_loop_depth = of_kernel(&kernel).map_err(Error::work)?;
        Ok(KernelOperations { kernel: kernel.name.to_owned(), by_loop_depth })
    });
    counted.collect()
}

pub const HEADS: [&str; 6] = ["kernel", "words loaded", "words stored", "atomics", "f64", "f64 divisions"];

pub const ABOUT: &str = "What one invocation does, counted from the code of the first case's kernels: outside of loops + in a round \
                         of a loop + in a round of a loop in a loop. Both sides of branches count.";

/// The words of a row.
pub fn cells(of: &KernelOperations) -> [String; 6] {
    let cell = |number: fn(&Operations) -> u64| match of.by_loop_depth.each_ref().map(number) {
        [0, 0, 0] => "0".to_owned(),
        [outside, 0, 0] => outside.to_string(),
        [outside, in_a_loop, 0] => format!("{outside} + {in_a_loop}"),
        [outside, in_a_loop, deeper] => format!("{outside} + {in_a_loop} + {deeper}"),
    };
    [
        of.kernel.clone(),
        cell(|o| o.loads),
        cell(|o| o.stores),
        cell(|o| o.atomics),
        cell(|o| o.f64),
        cell(|o| o.f64_divisions),
    ]
}

/// The table for a terminal.
pub fn lines(all: &[KernelOperations]) -> String {
    let line = |[kernel, cells @ ..]: [String; 6]| {
        let cells: String = cells.iter().map(|cell| format!(" {cell:>16}")).collect();
        format!("  {kernel:<10}{cells}\n")
    };
    let rows: String = all.iter().map(cells).map(line).collect();
    format!("  {ABOUT}\n{}{rows}", line(HEADS.map(str::to_owned)))
}
