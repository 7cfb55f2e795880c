//! Files that are recognized and cannot be read as a calibration: what each is, and what to do.

use super::document::Document;

struct Known {
    recognizes: fn(&Document) -> bool,
    /// Names the kind of file, and the remedy.
    says: &'static str,
}

fn has(document: &Document, keys: &[&str]) -> bool {
    document.tree().has(keys)
}

fn root_is(document: &Document, name: &str) -> bool {
    matches!(document, Document::Xml(xml) if xml.root_element().has_tag_name(name))
}

const KNOWN: &[Known] = &[
    Known {
        recognizes: |d| ["P0", "P1", "P2", "P3"].iter().any(|key| has(d, &[key])),
        says: "KITTI's P0 to P3 without a size of the image; write fx, fy, cx, cy of P2 as a file of OpenCV",
    },
    Known {
        recognizes: |d| has(d, &["CalibrationInformation"]),
        says: "Azure Kinect's raw calibration, whose numbers depend on the camera's mode; save its camera_info",
    },
    Known {
        recognizes: |d| has(d, &["M1", "D1"]) || has(d, &["M1", "M2"]),
        says: "a stereo calibration of OpenCV without a size of the image; save image_width, image_height, camera_matrix and distortion_coefficients of each camera",
    },
    Known {
        recognizes: |d| root_is(d, "xmpmeta"),
        says: "an XMP of RealityCapture, which has no size of the image; export the project as COLMAP",
    },
    Known {
        recognizes: |d| d.text().is_some_and(|text| text.starts_with("#name,") || text.starts_with("#cameras")),
        says: "a list of RealityCapture's cameras, which has no size of the images; export the project as COLMAP",
    },
    Known {
        recognizes: |d| has(d, &["openMVG_version"]) || has(d, &["sfm_data_version"]),
        says: "a project of OpenMVG; export it as COLMAP",
    },
    Known {
        recognizes: |d| has(d, &["camera"]) && has(d, &["image"]) || has(d, &["mesh"]),
        says: "a scene file; give the calibration that its camera names",
    },
    Known {
        recognizes: |d| root_is(d, "lensdatabase"),
        says: "a database of lensfun; calibrate the lens, or write its numbers as a file of OpenCV",
    },
    Known {
        recognizes: is_poses,
        says: "a list of poses; give it as poses = \"FILE\", and the file of the lens as file",
    },
];

/// Lines of as many numbers as a pose has.
fn is_poses(document: &Document) -> bool {
    let lines = document.text().into_iter().flat_map(str::lines).map(str::trim);
    let first = lines.filter(|line| !line.is_empty() && !line.starts_with('#')).take(1).next().unwrap_or_default();
    let words: Vec<&str> = first.split([' ', '\t', ',']).filter(|word| !word.is_empty()).collect();
    words.iter().all(|word| word.parse::<f64>().is_ok()) && matches!(words.len(), 3 | 4 | 8 | 12 | 13 | 16 | 17)
}

/// What the file is, if it is known.
pub fn why(document: &Document) -> Option<String> {
    let known = KNOWN.iter().find(|known| (known.recognizes)(document))?;
    Some(format!("not a calibration but {}", known.says))
}
