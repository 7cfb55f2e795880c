//! The program beside, in cases of whole calls: it traces the rays of the same GLCs over the city as it first stands.

use super::{City, Lens, Motion, Plan, city};
use crate::bench::case::{Arm, Case};
use crate::bench::row::{Calls, Error, Moving, Row};
use crate::bench::times::Times;
use crate::bench::yardstick::Yardstick;
use anamorph::Result;
use std::path::Path;

/// Poses that it is timed at: it reads and builds everything anew for each.
const POSES: u32 = 5;

/// A row, and the time of its call at each pose, ms.
pub type Beside = (Row, Vec<(u32, f64)>);

/// Times the outside program: returns its row, and the time of its call at each pose, ms. A call includes building the hierarchy if something
/// moves; otherwise the build is listed separately. Returns `None` if the program cannot show the camera.
///
/// # Errors
/// [`anamorph::Error`] if the program fails.
pub fn row(
    program: &Path,
    suite: &str,
    case: &Case,
    plan: &Plan,
    city: &City,
    folder: &Path,
) -> Result<Option<Beside>> {
    if !matches!(plan.lens, Lens::Pinhole | Lens::CrossSlit | Lens::Pieces) {
        return Ok(None);
    }
    let moves = plan.motion != Motion::Still;
    let moving = if moves { Moving::Triangles } else { Moving::Nothing };
    let scene = city::load(&plan.text(), folder)?;
    let (mut rounds, mut traces, mut builds, mut errors) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for pose in (0..POSES).map(|k| k * plan.poses / POSES) {
        let size = format!("image = {{ width = {}, height = {} }}\n", plan.size.0, plan.size.1);
        let camera = city::load(&format!("{size}[camera]\n{}", plan.camera_keys(pose)), folder)?.camera()?;
        let Some(yardstick) = Yardstick::new(program, &scene, &camera, moving)? else { return Ok(None) };
        let (trace_ms, build_ms) = yardstick.trace_and_build()?;
        rounds.push((pose, trace_ms + if moves { build_ms } else { 0.0 }));
        traces.push(trace_ms);
        builds.push(build_ms);
        let seen = plan.camera(pose, city, folder)?;
        errors.push(Error::of(&anamorph::check(&city.scene, &seen, &yardstick.finish()?)?));
    }
    let mut row = Row::of_yardstick(suite, case, Some(&Arm::ours()), program);
    let parts = vec![
        ("trace".to_owned(), Times::of(&traces).median),
        (if moves { "build" } else { "build (once)" }.to_owned(), Times::of(&builds).median),
    ];
    let all: Vec<f64> = rounds.iter().map(|round| round.1).collect();
    (row.triangles, row.pieces) = (city.scene.triangle_count(), plan.camera(0, city, folder)?.piece_count());
    (row.width, row.height) = plan.size;
    row.times = Some(Times::of(&traces));
    row.calls = Some(Calls { parts, ..Calls::of(&all, &traces) });
    row.error = Error::over(&errors);
    Ok(Some((row, rounds)))
}
