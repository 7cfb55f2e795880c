//! The rays of one layer as they are drawn in space.

use super::svg::Svg;
use super::view::View;
use crate::arrays::MapEach;
use crate::camera::volume::LayerVolume;
use glam::{DVec2, DVec3};

pub fn draw(svg: &mut Svg, layer: &LayerVolume, view: &View) {
    let places = |points: &[DVec3]| points.iter().map(|p| view.place(*p)).collect::<Vec<DVec2>>();
    layer.far().iter().for_each(|line| svg.polyline("far", &places(line)));
    layer.rays().for_each(|curve| svg.bezier("ray", &places(curve.points())));
    layer.outlines.iter().for_each(|outline| svg.polygon("near", &outline.map_each(|p| view.place(p))));
    layer.near().iter().for_each(|line| svg.polyline("near", &places(line)));
    for [a, b] in layer.slits.iter().map(|ends| ends.map_each(|p| view.place(p))) {
        if a == b { svg.dot("eye", a, 3.5) } else { svg.polyline("slit", &[a, b]) }
    }
}
