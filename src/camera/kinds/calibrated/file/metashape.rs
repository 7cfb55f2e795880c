//! Agisoft Metashape's `cameras.xml`, and its calibrations alone. The principal point is an offset from the middle of the image, half its
//! size from the corner of the first pixel. Poses are from the camera to its chunk.

use super::document::{Document, Result, whole};
use super::{Calibration, Contents, Image, Placed, intrinsics};
use crate::camera::calibration::{Coefficients, Intrinsics, Model, Projection};
use glam::{DMat2, DVec2};
use roxmltree::Node;

pub fn is_file(document: &Document) -> bool {
    document.root("calibration").is_some_and(|root| child(root, "f").is_some()) || sensors(document).next().is_some()
}

fn sensors<'a>(document: &'a Document) -> impl Iterator<Item = Node<'a, 'a>> {
    let root = document.root("document");
    root.into_iter().flat_map(|root| root.descendants().filter(|node| node.has_tag_name("sensor")))
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn id(node: Node, key: &str) -> Option<u64> {
    node.attribute(key)?.trim().parse().ok()
}

/// The cameras by the ids of their sensors.
pub fn contents(document: &Document) -> Result<Contents> {
    if let Some(root) = document.root("calibration") {
        let kind = child(root, "projection").and_then(|node| node.text()).unwrap_or("frame");
        return Contents::of_one(camera(root, kind, None));
    }
    let mut all = Contents::default();
    for sensor in sensors(document) {
        let Some(id) = id(sensor, "id") else { continue };
        if all.cameras.iter().any(|(other, _)| *other == id) {
            return Err(format!("has two sensors of id {id}; export one chunk"));
        }
        // the adjusted calibration comes last
        let found = sensor.children().rfind(|node| node.has_tag_name("calibration"));
        let kind = sensor.attribute("type").unwrap_or("frame");
        let read = |node| camera(node, kind, child(sensor, "resolution"));
        all.cameras.push((id, found.map_or(Err("the sensor has no calibration".into()), read)));
    }
    let cameras = document.root("document").into_iter().flat_map(|root| root.descendants());
    for node in cameras.filter(|node| node.has_tag_name("camera")) {
        // a camera without a transform is not aligned
        if let (Some(camera), Some(name), Some(transform)) =
            (id(node, "sensor_id"), node.attribute("label"), child(node, "transform"))
        {
            all.images.push(Image { name: name.into(), camera, placed: placed(transform) });
        }
    }
    Ok(all)
}

fn placed(transform: Node) -> Result<Placed> {
    let words = transform.text().unwrap_or_default().split_ascii_whitespace();
    let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
    let [a, b, c, d, e, f, g, h, i, j, k, l, ..] = numbers[..] else {
        return Err("transform must be 16 numbers".into());
    };
    Placed::of_rows(&[[a, b, c, d], [e, f, g, h], [i, j, k, l]])
}

fn camera(node: Node, kind: &str, resolution: Option<Node>) -> Result<Calibration> {
    let number = |name: &str| match child(node, name) {
        None => Ok(0.0),
        Some(child) => {
            let number = child.text().and_then(|text| text.trim().parse().ok()).filter(|x: &f64| x.is_finite());
            number.ok_or(format!("<{name}> must be a finite number"))
        }
    };
    let size = match child(node, "resolution").or(resolution) {
        Some(size) => {
            let side = |key: &str| size.attribute(key).and_then(|text| text.trim().parse().ok());
            [side("width"), side("height")].map(|side| side.unwrap_or(f64::NAN))
        }
        None => [number("width")?, number("height")?],
    };
    let size = whole(size)?;
    let pixels = DVec2::new(size[0] as f64, size[1] as f64);
    let projection = match kind {
        "frame" => Projection::Perspective,
        "fisheye" | "equidistant_fisheye" => Projection::Equidistant,
        other => return Err(format!("type: {other:?} is not known; use frame or fisheye")),
    };
    let f = number("f")?;
    let centre = 0.5 * pixels + DVec2::new(number("cx")?, number("cy")?) - 0.5;
    // u = x f + x b1 + y b2, v = y f
    let scale = DMat2::from_cols(DVec2::new(f + number("b1")?, 0.0), DVec2::new(number("b2")?, f));
    let checked = intrinsics(size, DVec2::new(scale.x_axis.x, f), centre)?;
    let radial = Coefficients::radial(&[number("k1")?, number("k2")?, number("k3")?, number("k4")?]);
    // its p1 goes with r^2 + 2 x^2
    let bent = Coefficients { tangential: [number("p2")?, number("p1")?], ..radial };
    Ok(Calibration::new(Intrinsics { scale, ..checked }, Model { projection, distortions: vec![bent] }))
}
