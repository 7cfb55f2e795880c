//! How each technique is drawn, in every plot alike: a colour by its family, and a mark of its own.

use crate::rivals::{ENTRIES, Family, Mark};
use std::fmt::Write;
use std::sync::LazyLock;

struct Technique {
    name: &'static str,
    /// On a light page, and on a dark one: after Okabe and Ito's palette for all kinds of colour vision.
    colours: [&'static str; 2],
    mark: Mark,
    what: &'static str,
}

fn colours(family: Family) -> [&'static str; 2] {
    match family {
        Family::Trace => ["#c45a00", "#ff9a3d"],
        Family::Warp => ["#00785a", "#2fc79b"],
        Family::Splat => ["#b3245e", "#ff6fa5"],
        Family::Bound => ["#7a3fa8", "#c48cf0"],
        Family::Pieces => ["#8a6d00", "#e3c130"],
        Family::Cube => ["#555555", "#aaaaaa"],
    }
}

/// What is none of these: a program that runs beside.
const OTHER: Technique = Technique {
    name: "",
    colours: ["#111111", "#eeeeee"],
    mark: Mark::Diamond,
    what: "a program beside, here Embree: it finds t and ids alone",
};

const OWN: Technique =
    Technique { name: "anamorph", colours: ["#0062b8", "#5fb0ff"], mark: Mark::Circle, what: "this engine" };

/// The engine, and the rivals by family.
static TECHNIQUES: LazyLock<Vec<Technique>> = LazyLock::new(|| {
    let mut entries: Vec<_> = ENTRIES.iter().collect();
    // stable: those of a family stay in their order
    entries.sort_by_key(|entry| entry.family);
    let rivals = entries.into_iter().map(|entry| Technique {
        name: entry.technique.name,
        colours: colours(entry.family),
        mark: entry.mark,
        what: entry.what,
    });
    std::iter::once(OWN).chain(rivals).collect()
});

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

    #[test]
    fn every_rival_has_a_mark_of_its_own() {
        let mut looks: Vec<String> = TECHNIQUES.iter().map(|t| format!("{:?} {:?}", t.colours, t.mark)).collect();
        looks.sort();
        looks.dedup();
        assert_eq!(looks.len(), TECHNIQUES.len());
    }
}
