//! Volumes from arrays.

use super::Scene;
use crate::arrays::MapEach;
use crate::input::{Error, Loading, Result};
use crate::scene::file;
use crate::scene::volume::Volume;
use crate::scene::volume::load::load_grid;
use std::path::Path;
use std::sync::Arc;

impl Scene {
    /// Gives the scene a volume of these numbers, in place of one that it has: `shape` is how many there are along z, y and x, 2 to 4096 each,
    /// and x runs fastest. `table` has the keys of a scene file's `[volume]` that say where it is and what it looks like, such as `min`, `max`
    /// and `transfer`: a table in TOML, or in JSON where it begins with a brace. `docs/guide/volumes.md` shows how.
    ///
    /// # Errors
    /// [`Error::Input`] for a wrong key or value, numbers that do not fill the shape, or one that is not finite; the scene is then unchanged.
    pub fn set_volume(
        &mut self,
        shape: [usize; 3],
        values: Vec<f32>,
        table: &str,
        folder: impl AsRef<Path>,
    ) -> Result<()> {
        let loading = Loading::new(self.scene.limits);
        let spec = file::volume_look_of(table, folder.as_ref(), &loading)?;
        let [z, y, x] = shape;
        if z.checked_mul(y).and_then(|n| n.checked_mul(x)) != Some(values.len()) {
            let count = values.len();
            return Err(Error::input(format!("volume: {count} numbers do not fill the shape {z} x {y} x {x}")));
        }
        let grid = load_grid(&spec.grid, Some((shape.map_each(|n| n as u64), values)), &loading)?;
        let (transfer, mode, is_lit) = (spec.transfer, spec.mode, spec.is_lit);
        self.scene.volume = Some(Volume { grid: Arc::new(grid), transfer, mode, is_lit });
        Ok(())
    }

    /// Takes the scene's volume away, if it has one.
    pub fn remove_volume(&mut self) {
        self.scene.volume = None;
    }
}
