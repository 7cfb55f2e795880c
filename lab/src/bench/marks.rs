//! How each technique is drawn, in every plot alike: a colour by its family, and a mark of its own.

use std::fmt::Write;

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Circle,
    Square,
    Diamond,
    Up,
    Down,
}

struct Technique {
    name: &'static str,
    /// On a light page, and on a dark one: after Okabe and Ito's palette for all kinds of colour vision.
    colours: [&'static str; 2],
    mark: Mark,
    what: &'static str,
}

const TRACE: [&str; 2] = ["#c45a00", "#ff9a3d"];
const WARP: [&str; 2] = ["#00785a", "#2fc79b"];
const SPLAT: [&str; 2] = ["#b3245e", "#ff6fa5"];
const BOUND: [&str; 2] = ["#7a3fa8", "#c48cf0"];
const PIECES: [&str; 2] = ["#8a6d00", "#e3c130"];
const CUBE: [&str; 2] = ["#555555", "#aaaaaa"];

/// What is none of these: a program that runs beside.
const OTHER: Technique = Technique {
    name: "",
    colours: ["#111111", "#eeeeee"],
    mark: Mark::Diamond,
    what: "a program beside, here Embree: it finds t and ids alone",
};

const TECHNIQUES: [Technique; 13] = [
    Technique { name: "anamorph", colours: ["#0062b8", "#5fb0ff"], mark: Mark::Circle, what: "this engine" },
    Technique { name: "raytrace", colours: TRACE, mark: Mark::Square, what: "rays through a hierarchy" },
    Technique { name: "raytrace-refit", colours: TRACE, mark: Mark::Diamond, what: "its hierarchy refitted" },
    Technique { name: "raytrace-brute", colours: TRACE, mark: Mark::Up, what: "every triangle" },
    Technique { name: "raymarch-segments", colours: TRACE, mark: Mark::Down, what: "curves as segments" },
    Technique { name: "raster-warp", colours: WARP, mark: Mark::Up, what: "vertices moved, edges straight" },
    Technique { name: "raster-splat", colours: SPLAT, mark: Mark::Square, what: "texels moved (Yu et al.)" },
    Technique { name: "raster-splat-passes", colours: SPLAT, mark: Mark::Down, what: "the same, a GLC a pass" },
    Technique { name: "raster-bound", colours: BOUND, mark: Mark::Diamond, what: "bounding triangles (Hou et al.)" },
    Technique { name: "raster-bound-passes", colours: BOUND, mark: Mark::Down, what: "the same, a camera a pass" },
    Technique { name: "raster-pieces", colours: PIECES, mark: Mark::Square, what: "replicas (Lorenz and Doellner)" },
    Technique { name: "raster-cubemap", colours: CUBE, mark: Mark::Square, what: "looked up in a cube map" },
    Technique { name: "raster-image", colours: CUBE, mark: Mark::Down, what: "looked up in one picture" },
];

/// Where a technique stands in lists: those that are none of these stand last.
pub fn place(name: &str) -> usize {
    TECHNIQUES.iter().position(|t| t.name == name).unwrap_or(TECHNIQUES.len())
}

fn technique(name: &str) -> &'static Technique {
    TECHNIQUES.iter().find(|t| t.name == name).unwrap_or(&OTHER)
}

/// The class of a technique's marks and lines.
pub fn class(name: &str) -> String {
    match TECHNIQUES.iter().position(|t| t.name == name) {
        Some(k) => format!("t{k}"),
        None => "tx".to_owned(),
    }
}

/// The colours of all classes, as a style sheet.
pub fn style() -> String {
    let line = |dark: usize| -> String {
        let all = TECHNIQUES.iter().chain([&OTHER]);
        all.map(|t| format!(".{}{{color:{}}}", class(t.name), t.colours[dark])).collect()
    };
    format!("{}\n@media (prefers-color-scheme: dark) {{ {} }}\n", line(0), line(1))
}

/// A technique's mark at a place, hollow for what is not its plain form.
pub fn mark(name: &str, (x, y): (f64, f64), is_hollow: bool) -> String {
    const R: f64 = 4.0;
    let fill = if is_hollow { " class=\"h\"" } else { "" };
    let polygon = |corners: &[(f64, f64)]| {
        let places: Vec<String> =
            corners.iter().map(|(dx, dy)| format!("{:.1},{:.1}", x + R * dx, y + R * dy)).collect();
        format!("<polygon{fill} points=\"{}\"/>", places.join(" "))
    };
    match technique(name).mark {
        Mark::Circle => format!("<circle{fill} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{R}\"/>"),
        Mark::Square => polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
        Mark::Diamond => polygon(&[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)]),
        Mark::Up => polygon(&[(0.0, -1.15), (1.15, 0.85), (-1.15, 0.85)]),
        Mark::Down => polygon(&[(0.0, 1.15), (1.15, -0.85), (-1.15, -0.85)]),
    }
}

/// The one legend: of the techniques that rows have.
pub fn legend<'a>(techniques: impl Iterator<Item = &'a str>) -> String {
    let techniques: Vec<&str> = techniques.collect();
    let has_rows = |name: &str| techniques.contains(&name);
    let has_other = techniques.iter().any(|name| TECHNIQUES.iter().all(|t| t.name != *name));
    let mut text = "<p class=\"legend\" id=\"legend\">".to_owned();
    let other = Some(&OTHER).filter(|_| has_other);
    for t in TECHNIQUES.iter().filter(|t| has_rows(t.name)).chain(other) {
        let key = format!(
            "<svg width=\"14\" height=\"14\" class=\"{}\">{}</svg>",
            class(t.name),
            mark(t.name, (7.0, 7.0), false)
        );
        // writing to a String cannot fail
        let _ = write!(text, "<span>{key} {} <small>{}</small></span> ", t.name, t.what);
    }
    text + "<span><small>A hollow mark is a variation, or a camera in parts: point at it for its name. In the large charts a number beside a mark is the value of the swept parameter.</small></span></p>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rivals;

    #[test]
    fn every_rival_has_a_mark_of_its_own() {
        for rival in rivals::TECHNIQUES {
            assert_ne!(class(rival.name), "tx", "{}", rival.name);
        }
        let mut looks: Vec<String> = TECHNIQUES.iter().map(|t| format!("{:?} {:?}", t.colours, t.mark)).collect();
        looks.sort();
        looks.dedup();
        assert_eq!(looks.len(), TECHNIQUES.len());
    }
}
