//! The image with its pieces, one picture a layer.

use super::svg::{Frame, Svg};
use crate::arrays::MapEach;
use crate::camera::volume::{runs, spread};
use crate::camera::{Camera, Pieces, Rays};
use glam::DVec2;

/// Pieces of a layer that are drawn at most.
const PIECES_MAX: usize = 5000;
/// Up to so many pieces of a layer, each has its number.
const NUMBERED_MAX: usize = 64;
/// Cells of the grid that stands for a layer without pieces, across and down.
const CELLS: (u32, u32) = (24, 18);
/// Space for a picture's label above it, px.
const LABEL_PX: f64 = 20.0;

pub fn draw(svg: &mut Svg, frame: Frame, camera: &Camera) {
    let count = camera.layers.len();
    let columns = (1..=count).find(|c| c * c >= count).unwrap_or(1);
    let cell = frame.size / DVec2::new(columns as f64, count.div_ceil(columns) as f64);
    for (k, layer) in camera.layers.iter().enumerate() {
        let lo = frame.lo + cell * DVec2::new((k % columns) as f64, (k / columns) as f64);
        let area = Frame { lo: lo + DVec2::Y * LABEL_PX, size: cell - DVec2::new(12.0, LABEL_PX + 4.0) };
        let picture = area.fitted(DVec2::new(camera.width.into(), camera.height.into()));
        let label = match layer {
            Rays::Pieces(pieces) => draw_pieces(svg, picture, camera, k, pieces),
            Rays::Field(_) | Rays::Curves(_) => draw_grid(svg, picture, camera, k),
        };
        svg.polygon("frame", &picture.corners());
        let name = if count == 1 { "image".into() } else { format!("layer {k}") };
        svg.text("label", picture.lo - DVec2::Y * 6.0, &format!("{name}: {label}"));
    }
}

/// Draws the pieces of a layer, and says how many.
fn draw_pieces(svg: &mut Svg, picture: Frame, camera: &Camera, layer: usize, pieces: &Pieces) -> String {
    let size = DVec2::new(camera.width.into(), camera.height.into());
    let on_page = |q: DVec2| picture.lo + q / size * picture.size;
    let count = pieces.pieces.len();
    let step = count.div_ceil(PIECES_MAX);
    svg.layer(layer, &picture, |svg| {
        for (k, piece) in pieces.pieces.iter().enumerate().step_by(step) {
            let corners = match &piece.corners_px {
                Some(corners) => corners.map_each(on_page).to_vec(),
                None => picture.corners().to_vec(),
            };
            svg.polygon("piece", &corners);
            if count <= NUMBERED_MAX {
                let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
                let number = camera.first_piece(layer) as usize + k;
                svg.text("number", middle + DVec2::Y * 3.5, &number.to_string());
            }
        }
    });
    match (step, count) {
        (1, 1) => "1 piece".into(),
        (1, _) => format!("{count} pieces"),
        _ => format!("{count} pieces, one in {step} is drawn"),
    }
}

/// Draws a grid where a layer has rays, and says which.
fn draw_grid(svg: &mut Svg, picture: Frame, camera: &Camera, layer: usize) -> String {
    let (n, m) = (CELLS.0.min(camera.width - 1), CELLS.1.min(camera.height - 1));
    let size = DVec2::new(camera.width.into(), camera.height.into());
    let pixel = |x: u32, y: u32| (spread(x, n, camera.width), spread(y, m, camera.height));
    let place = |x: u32, y: u32| {
        let (i, j) = pixel(x, y);
        camera.curve(layer, i, j)?;
        Some(picture.lo + (DVec2::new(i.into(), j.into()) + 0.5) / size * picture.size)
    };
    let (rows, columns): (Vec<_>, Vec<_>) = (
        (0..=m).map(|y| (0..=n).map(|x| place(x, y)).collect::<Vec<_>>()).collect(),
        (0..=n).map(|x| (0..=m).map(|y| place(x, y)).collect::<Vec<_>>()).collect(),
    );
    svg.layer(layer, &picture, |svg| {
        rows.iter().chain(&columns).flat_map(|line| runs(line)).for_each(|run| svg.polyline("grid", &run));
    });
    match &camera.layers[layer] {
        Rays::Curves(c) => format!("a curve of degree {} for each pixel", c.map.degree()),
        _ => "a ray for each pixel".into(),
    }
}
