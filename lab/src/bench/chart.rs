//! A chart with two logarithmic axes, as SVG that takes its colours from the page around it.

use super::marks::{class, mark};
use super::page::escaped;
use std::fmt::Write;

/// Points of one technique, joined where they are steps of one number.
pub struct Series {
    pub technique: String,
    /// What the tables call it.
    pub name: String,
    /// Not the plain form of its technique.
    pub is_variation: bool,
    pub points: Vec<Point>,
}

pub struct Point {
    pub x: f64,
    pub y: f64,
    /// 95 % of the time's median.
    pub interval: Option<[f64; 2]>,
    /// Of what is stepped.
    pub number: Option<f64>,
}

pub struct Chart<'a> {
    pub series: &'a [Series],
    /// Name of each axis.
    pub axes: [&'a str; 2],
    /// The time is along y, not x.
    pub is_time_up: bool,
    /// The height at which a value of 0 is drawn.
    pub none: Option<f64>,
    /// Width and height, px.
    pub size: [f64; 2],
}

/// Large, and in an overview.
pub const LARGE: [f64; 2] = [720.0, 400.0];
pub const SMALL: [f64; 2] = [300.0, 200.0];

/// Room beside the axes, px: left, top, right, bottom.
const ROOM: [f64; 4] = [58.0, 8.0, 24.0, 40.0];

/// From a number to a place on an axis.
struct Scale {
    log: [f64; 2],
    px: [f64; 2],
}

impl Scale {
    /// Of all numbers with some room beside them.
    fn of(numbers: impl Iterator<Item = f64>, px: [f64; 2]) -> Scale {
        let (lo, hi) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), n| (lo.min(n), hi.max(n)));
        let [lo, hi] = [lo.log10(), hi.log10()];
        let room = f64::max(0.15, 0.06 * (hi - lo));
        Scale { log: [lo - room, hi + room], px }
    }

    fn place(&self, number: f64) -> f64 {
        let [from, to] = self.log;
        self.px[0] + (number.log10() - from) / (to - from) * (self.px[1] - self.px[0])
    }

    /// Powers of ten, thinned to six at most; with others between where they are few.
    fn ticks(&self) -> Vec<f64> {
        let [from, to] = self.log;
        let powers = (from.floor() as i32)..=(to.ceil() as i32);
        let steps: &[f64] = match to - from {
            decades if decades < 0.8 => &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            decades if decades < 2.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let all = powers.flat_map(|p| steps.iter().map(move |s| s * 10f64.powi(p)));
        let within: Vec<f64> = all.filter(|n| (from..=to).contains(&n.log10())).collect();
        within.iter().copied().step_by(within.len().div_ceil(6).max(1)).collect()
    }
}

impl Chart<'_> {
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let [left, top, right, bottom] = ROOM;
        let points = || self.series.iter().flat_map(|s| &s.points);
        let ends = |p: &Point| p.interval.unwrap_or([p.x, p.x]);
        let along_x = |p: &Point| if self.is_time_up { [p.x, p.x] } else { ends(p) };
        let along_y = |p: &Point| if self.is_time_up { p.interval.unwrap_or([p.y, p.y]) } else { [p.y, p.y] };
        let x = Scale::of(points().flat_map(along_x), [left, width - right]);
        let y = Scale::of(points().flat_map(along_y), [height - bottom, top]);
        let mut svg = format!("<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\">");
        self.axes(&mut svg, &x, &y);
        for s in self.series {
            let _ = write!(svg, "<g class=\"{}\">", class(&s.technique));
            let places: Vec<(f64, f64)> = s.points.iter().map(|p| (x.place(p.x), y.place(p.y))).collect();
            if places.len() > 1 {
                let line: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
                let _ = write!(svg, "<polyline points=\"{}\"/>", line.join(" "));
            }
            for (p, &at) in s.points.iter().zip(&places) {
                if let Some([lo, hi]) = p.interval {
                    let [from, to] = match self.is_time_up {
                        true => [(at.0, y.place(lo)), (at.0, y.place(hi))],
                        false => [(x.place(lo), at.1), (x.place(hi), at.1)],
                    };
                    let _ = write!(svg, "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>", from.0, from.1, to.0, to.1);
                }
                let title = self.title(s, p);
                let _ =
                    write!(svg, "<g><title>{}</title>{}</g>", escaped(&title), mark(&s.technique, at, s.is_variation));
                if let (Some(number), true) = (p.number, self.size == LARGE && s.points.len() > 1) {
                    let _ =
                        write!(svg, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", at.0 + 7.0, at.1 - 6.0, short(number));
                }
            }
            svg += "</g>";
        }
        svg + "</svg>\n"
    }

    /// What a reader sees who rests on a point.
    fn title(&self, s: &Series, p: &Point) -> String {
        let number = p.number.map(|n| format!(" at {}", short(n))).unwrap_or_default();
        let is_none = self.none == Some(p.y);
        let y = if is_none { "none".to_owned() } else { short(p.y) };
        format!("{}{number}: {} {}, {} {y}", s.name, short(p.x), self.axes[0], self.axes[1])
    }

    fn axes(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let [width, height] = self.size;
        let [left, top, right, bottom] = ROOM;
        let (floor, end) = (height - bottom, width - right);
        let _ = write!(svg, "<g class=\"axes\"><path d=\"M{left} {top}V{floor}H{end}\"/>");
        for tick in x.ticks() {
            let at = x.place(tick);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {top}V{floor}\"/><text class=\"m\" x=\"{at:.1}\" y=\"{}\">{}</text>",
                floor + 14.0,
                short(tick)
            );
        }
        let none = self.none.filter(|n| self.series.iter().flat_map(|s| &s.points).any(|p| p.y == *n));
        // its name stands where that of a tick would
        let is_free = |at: f64| none.is_none_or(|n| (y.place(n) - at).abs() > 12.0);
        for (at, tick) in y.ticks().into_iter().map(|tick| (y.place(tick), tick)).filter(|t| is_free(t.0)) {
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{left} {at:.1}H{end}\"/><text class=\"e\" x=\"{}\" y=\"{:.1}\">{}</text>",
                left - 5.0,
                at + 4.0,
                short(tick)
            );
        }
        if let Some(none) = none {
            let at = y.place(none);
            let _ = write!(
                svg,
                "<path class=\"none\" d=\"M{left} {at:.1}H{end}\"/><text class=\"e\" x=\"{}\" y=\"{:.1}\">none</text>",
                left - 5.0,
                at + 4.0
            );
        }
        let (middle, centre) = ((left + end) / 2.0, (top + floor) / 2.0);
        let _ = write!(
            svg,
            "<text class=\"m\" x=\"{middle:.0}\" y=\"{:.0}\">{} (log)</text>\
             <text class=\"m\" transform=\"translate(11 {centre:.0}) rotate(-90)\">{} (log)</text></g>",
            height - 6.0,
            escaped(self.axes[0]),
            escaped(self.axes[1])
        );
    }
}

/// Whole numbers as they are, others to three digits.
fn short(v: f64) -> String {
    let rounded: f64 = if v.fract() == 0.0 { v } else { format!("{v:.2e}").parse().unwrap_or(v) };
    if rounded == 0.0 || (0.01..100_000.0).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [0.099_999_999_999_999_98, 1e-12, 0.3, 1024.0, 1e6, 12.345, 0.0].map(short);
        assert_eq!(shown, ["0.1", "1e-12", "0.3", "1024", "1e6", "12.3", "0"]);
    }

    #[test]
    fn ticks_are_round_few_and_in_the_axis() {
        for (lo, hi) in [(3.0, 17.0), (0.001, 2e5), (1e-7, 1.0), (42.0, 42.0), (30.0, 31.0)] {
            let scale = Scale::of([lo, hi].into_iter(), [0.0, 100.0]);
            let ticks = scale.ticks();
            assert!((1..=6).contains(&ticks.len()), "{lo} to {hi}: {ticks:?}");
            assert!(ticks.iter().all(|t| (0.0..=100.0).contains(&scale.place(*t))), "{lo} to {hi}: {ticks:?}");
        }
    }

    #[test]
    fn a_point_stands_where_its_number_is() {
        let scale = Scale { log: [0.0, 2.0], px: [10.0, 210.0] };
        assert_eq!([1.0, 10.0, 100.0].map(|n| scale.place(n)), [10.0, 110.0, 210.0]);
    }
}
