//! Points as a PLY file: <http://paulbourke.net/dataformats/ply/>.

use std::io::{BufWriter, Write};
use std::path::Path;

use glam::DVec3;

use crate::image::file::whole::write_whole;
use crate::input::Result;

/// Writes points in binary, little-endian: `x y z` as doubles, and the triangle each lies on as `triangle_id`.
///
/// # Errors
/// [`crate::input::Error::Work`] naming `path`.
pub fn write_ply(path: &Path, points: &[(DVec3, u32)]) -> Result<()> {
    write_whole(path, |file| {
        let mut writer = BufWriter::new(file);
        writeln!(writer, "ply\nformat binary_little_endian 1.0\nelement vertex {}", points.len())?;
        writer.write_all(b"property double x\nproperty double y\nproperty double z\n")?;
        writer.write_all(b"property uint triangle_id\nend_header\n")?;
        for (point, id) in points {
            point.to_array().iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
            writer.write_all(&id.to_le_bytes())?;
        }
        writer.flush()
    })
}
