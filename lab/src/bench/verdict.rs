//! This engine against each rival over all cases of an adapter: how many times as long the rival takes as this engine in its plain form, at an
//! error that is not larger.

use super::page::{escaped, table};
use super::plot::rms;
use super::row::Row;
use super::times::median;
use super::{Run, marks};
use crate::rivals::TECHNIQUES;

/// Suites whose rows are compared: the others have no rivals, or scenes that are made to be hard.
const COMPARED: [&str; 5] = ["papers", "pareto", "glc", "samples", "dynamic"];

/// Labels of rows that a suite's arms have.
const BARE: &str = "t and ids alone";
const NO_CULLING: &str = "no culling";
const RASTER: &str = "raster";

/// Parameters of rows whose camera stands for a mirror, a lens or a curve in parts.
const PARTS: [&str; 3] = ["texels of an atlas", "strips", "pieces"];

/// A ratio nearer to 1 is a draw.
const DRAW: f64 = 0.05;

/// Against one rival.
#[derive(Debug)]
struct Against {
    rival: String,
    /// Each row's time over this engine's, and its case, the worst for this engine first.
    ratios: Vec<(f64, String)>,
    /// The same over this engine's frames that raster alone found, smallest first.
    over_raster: Vec<f64>,
    /// Rows whose error is smaller than any of this engine's.
    nearer: usize,
    /// Rows without a time.
    without_time: usize,
    /// Shares of wrong pixels.
    wrong: Vec<f64>,
    /// Rows with a wrong safe pixel.
    unsafe_rows: usize,
    /// Compared rows in which an empty kernel takes over a tenth of this engine's time.
    near_the_floor: usize,
}

/// Smaller is better; of two rows of one case.
fn error(row: &Row) -> Option<f64> {
    let error = row.error.as_ref()?;
    // without an rms the colours are the same
    Some(if error.is_of_colours() { rms(row).unwrap_or(0.0) } else { error.wrong_share })
}

fn time(row: &Row) -> Option<f64> {
    row.times.as_ref().map(|t| t.median)
}

/// The rows of this engine that a rival's is compared with: its plain form, or one that takes as many frames as the rival's; for a program
/// beside, which finds t and ids alone, one that finds no more. Where there is no plain form, all.
fn comparable<'a>(case: &'a [&'a Row], rival: &Row) -> Vec<&'a Row> {
    let is_beside = TECHNIQUES.iter().all(|technique| technique.name != rival.technique);
    let label = |row: &Row, label: &str| row.label.as_deref() == Some(label);
    let is_plain =
        |row: &Row| row.label.is_none() || row.label == rival.label || label(row, RASTER) && !is_in_parts(row);
    let tests: [&dyn Fn(&Row) -> bool; 3] = [&|row| is_beside && label(row, BARE), &is_plain, &|_| true];
    let with =
        |test: &dyn Fn(&Row) -> bool| case.iter().copied().filter(|row| row.is_ours() && test(row)).collect::<Vec<_>>();
    tests.into_iter().map(with).find(|rows| !rows.is_empty()).unwrap_or_default()
}

/// The row of a rival that is told to leave nothing out, where it has a row in which it leaves out what it may: no way that one would take.
fn is_held_back(case: &[&Row], rival: &Row) -> bool {
    let plain = |row: &&&Row| row.technique == rival.technique && row.label.is_none() && row.times.is_some();
    rival.label.as_deref() == Some(NO_CULLING) && case.iter().find(plain).is_some()
}

/// Its camera stands for a mirror, a lens or a curve in parts. In the suite `glc` it is its own truth.
pub fn is_in_parts(row: &Row) -> bool {
    row.parameter.as_ref().is_some_and(|p| PARTS.contains(&p.0.as_str())) && row.suite != "glc"
}

/// What rows of a rival are counted under: a tracer of parts of a mirror or a curve apart from one of the camera's own rays.
fn counted_under(row: &Row) -> String {
    let traces = row.technique.starts_with("raytrace");
    if is_in_parts(row) && traces { format!("{}, of facets or pieces", row.technique) } else { row.technique.clone() }
}

/// The time of a rival's row over that of one of this engine's: over common rounds, where they are known.
fn ratio(case: &[&Row], rival: &Row, ours: &Row) -> Option<f64> {
    let is_beside = TECHNIQUES.iter().all(|technique| technique.name != rival.technique);
    let mut own = case.iter().filter(|row| row.is_ours());
    let base = if is_beside { own.find(|row| row.label.as_deref() == Some(BARE)) } else { own.next() };
    match rival.to_ours {
        Some(known) if base.is_some_and(|base| std::ptr::eq(*base, ours)) => Some(known.median),
        _ => Some(time(rival)? / time(ours)?),
    }
}

/// Rivals in the order of the legend.
fn against_each<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Against> {
    let rows: Vec<&Row> = rows.filter(|r| COMPARED.contains(&r.suite.as_str())).collect();
    let mut all: Vec<Against> = Vec::new();
    for case in rows.chunk_by(|a, b| (&a.suite, &a.case) == (&b.suite, &b.case)) {
        for &row in case.iter().filter(|r| !r.is_ours() && !is_held_back(case, r)) {
            let name = counted_under(row);
            let at = all.iter().position(|a| a.rival == name).unwrap_or_else(|| {
                all.push(Against::new(name));
                all.len() - 1
            });
            all[at].add(case, row);
        }
    }
    all.sort_by_key(|against| marks::place(against.rival.split(',').next().unwrap_or_default()));
    for against in &mut all {
        against.ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        against.over_raster.sort_by(f64::total_cmp);
        against.wrong.sort_by(f64::total_cmp);
    }
    all
}

const HEADS: [&str; 9] = [
    "rival",
    "comparisons",
    "its time over ours: median [least, most]",
    "the same where ours was timed by raster alone too, over that",
    "ours is faster, even, slower in",
    "its wrong pixels, median %",
    "rows of it without a wrong safe pixel",
    "not compared: nearer to the truth than ours",
    "not compared: no time",
];

impl Against {
    fn new(rival: String) -> Against {
        Against {
            rival,
            ratios: Vec::new(),
            over_raster: Vec::new(),
            nearer: 0,
            without_time: 0,
            wrong: Vec::new(),
            unsafe_rows: 0,
            near_the_floor: 0,
        }
    }

    /// One more row of the rival, and the case that it is of.
    fn add(&mut self, case: &[&Row], row: &Row) {
        let (Some(_), Some(wrong)) = (time(row), error(row)) else {
            self.without_time += 1;
            return;
        };
        let mut ours = comparable(case, row);
        ours.retain(|ours| error(ours).is_some_and(|e| e <= wrong) && ours.times.is_some());
        ours.sort_by(|a, b| time(a).unwrap_or(f64::NAN).total_cmp(&time(b).unwrap_or(f64::NAN)));
        match ours.first().and_then(|fastest| Some((ratio(case, row, fastest)?, time(fastest)?))) {
            Some((of_fastest, ms)) => {
                self.ratios.push((of_fastest, row.case.clone()));
                self.near_the_floor += usize::from(row.control_ms > ms / 10.0);
            }
            None => self.nearer += 1,
        }
        let by_raster = ours.iter().find(|ours| ours.found_by() == RASTER);
        self.over_raster.extend(by_raster.and_then(|ours| ratio(case, row, ours)));
        if let Some(error) = row.error.as_ref().filter(|e| !e.is_of_colours()) {
            self.wrong.push(error.wrong_share);
            self.unsafe_rows += usize::from(error.wrong_safe > 0);
        }
    }

    fn slower(&self) -> usize {
        self.ratios.iter().filter(|r| r.0 < 1.0 - DRAW).count()
    }

    fn cells(&self) -> [String; 9] {
        let between = |sorted: &[f64]| {
            let ends = sorted.first().zip(sorted.last());
            ends.map(|(lo, hi)| format!("{} [{}, {}]", digits(median(sorted)), digits(*lo), digits(*hi)))
        };
        let ratios: Vec<f64> = self.ratios.iter().map(|r| r.0).collect();
        let of_raster = between(&self.over_raster).map(|text| format!("{text} over {}", self.over_raster.len()));
        let faster = ratios.iter().filter(|r| **r > 1.0 + DRAW).count();
        let wrong = Some(median(&self.wrong)).filter(|_| !self.wrong.is_empty()).map(|w| digits(100.0 * w));
        let safe = Some(self.wrong.len()).filter(|rows| *rows > 0);
        [
            self.rival.clone(),
            ratios.len().to_string(),
            between(&ratios).unwrap_or_default(),
            of_raster.unwrap_or_default(),
            format!("{faster}, {}, {}", ratios.len() - faster - self.slower(), self.slower()),
            wrong.unwrap_or_default(),
            safe.map(|rows| format!("{} of {rows}", rows - self.unsafe_rows)).unwrap_or_default(),
            self.nearer.to_string(),
            self.without_time.to_string(),
        ]
    }
}

/// Kinds of rivals, in the words of the first sentence.
const KINDS: [&str; 3] =
    ["techniques that draw", "tracing rays on the same adapter", "a ray tracer for CPUs beside it"];

fn kind(rival: &str) -> &'static str {
    match rival {
        _ if rival.starts_with("raster") => KINDS[0],
        _ if rival.starts_with("ray") => KINDS[1],
        _ => KINDS[2],
    }
}

/// How often this engine is faster than each kind of rivals, and by how much.
fn in_short(against: &[Against]) -> String {
    let of_kind = |asked: &str| {
        let own = against.iter().filter(|a| kind(&a.rival) == asked);
        let mut ratios: Vec<f64> = own.flat_map(|a| a.ratios.iter().map(|r| r.0)).collect();
        ratios.sort_by(f64::total_cmp);
        let faster = ratios.iter().filter(|r| **r > 1.0 + DRAW).count();
        (!ratios.is_empty()).then(|| {
            format!(
                "against {asked} this engine is faster in {faster} of {} comparisons ({} times as fast in the median)",
                ratios.len(),
                digits(median(&ratios))
            )
        })
    };
    let all: Vec<String> = KINDS.into_iter().filter_map(of_kind).collect();
    format!("<p><strong>In short:</strong> {}.</p>\n", escaped(&all.join("; ")))
}

/// Pixels of a row that were compared with the reference.
fn compared_pixels(row: &Row) -> f64 {
    let step = row.error.as_ref().map_or(1, |e| e.row_step);
    f64::from(row.width) * f64::from(row.height.div_ceil(step))
}

/// How many pixels of this engine's frames are wrong: of its plain form, of cameras in parts, and of scenes that are made to be hard.
fn wrong_pixels<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let is_judged = |row: &&Row| row.error.as_ref().is_some_and(|e| !e.is_of_colours());
    let rows: Vec<&Row> = rows.filter(|r| r.is_ours() && r.label.is_none()).filter(is_judged).collect();
    let safe = |rows: &[&Row]| rows.iter().filter_map(|r| r.error.as_ref()).map(|e| e.wrong_safe).sum::<u64>();
    let share = |row: &Row| row.error.as_ref().map_or(0.0, |e| e.wrong_share);
    let shares = |rows: &[&Row]| {
        let mut all: Vec<f64> = rows.iter().map(|row| share(row)).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let (hard, rest): (Vec<&Row>, Vec<&Row>) = rows.into_iter().partition(|row| row.stiffness.is_some());
    let (parts, plain): (Vec<&Row>, Vec<&Row>) = rest.into_iter().partition(|row| is_in_parts(row));
    let pixels: f64 = plain.iter().map(|row| compared_pixels(row)).sum();
    let wrong: f64 = plain.iter().map(|row| share(row) * compared_pixels(row)).sum();
    let in_rows = if plain.iter().any(|row| row.error.as_ref().is_some_and(|e| e.row_step > 1)) {
        " (of large frames, rows spread over them)"
    } else {
        ""
    };
    let mut text = format!(
        "<p>{} frames of this engine's plain form, {:.1} million pixels{in_rows}, compared with an f64 reference: {wrong:.0} pixels have another triangle, \
         {} of them safe. Frames of several samples are compared by colour.",
        plain.len(),
        pixels / 1e6,
        safe(&plain)
    );
    let parts_shares = shares(&parts);
    if let Some(most) = parts_shares.last() {
        text += &format!(
            " Not among them: {} frames whose camera stands for a mirror, a lens or a curve in parts, as the rivals' do (hollow marks below). Against the whole \
             camera {} % of their pixels are wrong in the median, {} % at most.",
            parts.len(),
            digits(100.0 * median(&parts_shares)),
            digits(100.0 * most)
        );
    }
    let hard_shares = shares(&hard);
    if let Some(most) = hard_shares.last() {
        text += &format!(
            " Nor {} frames of scenes that are made to be hard (the suite stiff): {} of their safe pixels are wrong; in {} of these frames \
             others are, {} % of a frame at most.",
            hard.len(),
            safe(&hard),
            hard_shares.iter().filter(|share| **share > 0.0).count(),
            digits(100.0 * most)
        );
    }
    text + "</p>\n"
}

/// Two digits, of numbers below 10; whole ones above.
fn digits(v: f64) -> String {
    match v {
        v if v >= 10.0 => format!("{v:.0}"),
        v if v >= 1.0 || v == 0.0 => format!("{v:.1}"),
        v => {
            let decimals = (1.0 - v.log10().floor()) as usize;
            format!("{v:.decimals$}")
        }
    }
}

/// Whether a technique is a paper's own.
fn is_own(paper: &str, technique: &str) -> bool {
    let own: &[&str] = match paper.split_whitespace().next() {
        Some("Yu") => &["raster-splat", "raster-splat-passes"],
        Some("Hou") => &["raster-bound", "raster-bound-passes"],
        Some("Popescu") => &["raster-warp", "raster-pieces"],
        _ => &["raster-pieces", "raster-cubemap", "raster-image"],
    };
    own.contains(&technique)
}

/// What this engine and the papers' own techniques, built anew, take against the papers' printed times.
fn printed<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let rows: Vec<&Row> = rows.collect();
    let [mut own, mut ours, mut fair] = [const { Vec::new() }; 3];
    for case in rows.chunk_by(|a, b| a.case == b.case) {
        let Some((paper, fps)) = case[0].paper.as_ref().and_then(|p| Some((&p.paper, p.fps?))) else { continue };
        let plain = || case.iter().filter(|row| row.label.is_none());
        let fastest = |rows: &mut dyn Iterator<Item = &&Row>| rows.filter_map(|row| time(row)).min_by(f64::total_cmp);
        let of_paper = fastest(&mut plain().filter(|row| is_own(paper, &row.technique)));
        let of_ours = fastest(
            &mut plain().filter(|row| row.is_ours() && row.parameter.as_ref().is_none_or(|p| p.0 == "samples")),
        );
        own.extend(of_paper.map(|ms| ms * fps / 1000.0));
        ours.extend(of_ours.map(|ms| ms * fps / 1000.0));
        let both = of_paper.zip(of_ours).filter(|(ms, _)| ms * fps <= 1000.0);
        fair.extend(both.map(|(theirs, ours)| theirs / ours));
    }
    own.sort_by(f64::total_cmp);
    fair.sort_by(f64::total_cmp);
    let longer = |all: &[f64]| all.iter().filter(|r| **r > 1.0).count();
    if own.is_empty() || ours.is_empty() {
        return String::new();
    }
    let over_fair = match fair.len() {
        0 => String::new(),
        n => {
            format!(" Over the other {n}, this engine is {} times as fast as it in the median.", digits(median(&fair)))
        }
    };
    format!(
        "<p>The papers print times of their own scenes on hardware of their day. In {} of {} cases the paper's own technique, built anew here, takes longer \
         than that, {} times as long at most: it is not tuned as theirs was.{over_fair} This engine takes longer than the papers print in {} of {}.</p>\n",
        longer(&own),
        own.len(),
        digits(own.last().copied().unwrap_or(0.0)),
        longer(&ours),
        ours.len()
    )
}

/// Whether all rows are of one commit that is known.
fn is_of_one_commit(run: &Run) -> bool {
    let own = run.provenance.commit.as_deref().unwrap_or("unknown");
    run.rows.iter().all(|row| row.commit.as_deref().is_none_or(|c| c == own))
        && own != "unknown"
        && !own.ends_with("-dirty")
}

/// What runs of one adapter came to, as a part of a page: of each suite the newest run that is of one commit.
pub fn verdict(adapter: &str, all: &[&Run]) -> String {
    let mut text = format!("<h3>{}</h3>\n", escaped(adapter));
    let Some(first) = all.first() else { return text };
    text += &format!("<p class=\"note\">{}</p>\n", first.provenance.fairness());
    let mut runs: Vec<&Run> = Vec::new();
    for &run in all.iter().filter(|run| is_of_one_commit(run)) {
        match runs.iter_mut().find(|other| other.suite == run.suite) {
            Some(other) if other.provenance.date < run.provenance.date => *other = run,
            Some(_) => (),
            None => runs.push(run),
        }
    }
    let mut left_out: Vec<&str> =
        all.iter().map(|run| &*run.suite).filter(|suite| runs.iter().all(|run| run.suite != *suite)).collect();
    left_out.dedup();
    if runs.is_empty() {
        return text + "<p>No verdict over these runs: none is of one commit. Each row stands for itself.</p>\n";
    }
    let cases: usize = runs.iter().map(|run| run.rows.chunk_by(|a, b| a.case == b.case).count()).sum();
    let commit = |run: &&Run| format!("{} ({})", run.suite, run.provenance.commit.as_deref().unwrap_or(""));
    text += &format!(
        "<p>Over {cases} cases, suites at commits: {}.",
        escaped(&runs.iter().map(commit).collect::<Vec<_>>().join(", "))
    );
    if !left_out.is_empty() {
        text += &format!(" Left out, as their runs are not of one commit: {}.", escaped(&left_out.join(", ")));
    }
    text += "</p>\n";
    let rows = || runs.iter().flat_map(|r| &r.rows);
    let against = against_each(rows());
    text += &in_short(&against);
    text += &wrong_pixels(rows());
    if !first.provenance.is_software {
        text += &printed(rows());
    }
    text += &table(&HEADS, against.iter().map(Against::cells));
    let (near, compared) = against.iter().fold((0, 0), |sum, a| (sum.0 + a.near_the_floor, sum.1 + a.ratios.len()));
    text += &format!(
        "<p class=\"note\">In {near} of these {compared} comparisons an empty kernel takes more than a tenth of our time: the ratio would be farther from 1 \
         without that.</p>\n"
    );
    let worst = |a: &Against| {
        a.ratios
            .first()
            .filter(|r| r.0 < 1.0 - DRAW)
            .map(|r| format!("{} in {} of our time ({})", a.rival, digits(r.0), r.1.trim()))
    };
    let lost: Vec<String> = against.iter().filter_map(worst).collect();
    let lost = if lost.is_empty() { "nowhere".to_owned() } else { lost.join("; ") };
    text + &format!("<p>Where this engine loses most: {}.</p>\n", escaped(&lost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::case::{Arm, Case, arms};
    use crate::bench::row::{Error, Stiffness};
    use crate::bench::times::Times;

    fn row(technique: Option<&str>, ms: f64, wrong_share: f64) -> Row {
        let case = Case::of("a case", "demo", arms(&[]));
        let arm = technique.map_or_else(Arm::ours, Arm::rival);
        let error = Error { wrong_share, t_median: Some(0.0), ..Error::none() };
        Row { times: Some(Times::of(&[ms])), error: Some(error), ..Row::new("papers", &case, &arm) }
    }

    fn labelled(row: Row, label: &str) -> Row {
        Row { label: Some(label.to_owned()), ..row }
    }

    #[test]
    fn a_rival_is_compared_with_the_fastest_plain_row_that_is_no_worse() {
        let rows = [
            row(None, 8.0, 0.0),
            row(None, 2.0, 0.1),
            labelled(row(None, 1.0, 0.0), "f32 alone"),
            row(Some("raytrace"), 4.0, 0.05),
            row(Some("raster-warp"), 4.0, 0.2),
        ];
        let all = against_each(rows.iter());
        let ratio = |k: usize| all[k].ratios[0].0;
        assert_eq!((ratio(0), ratio(1)), (0.5, 2.0));
        assert_eq!((all[0].slower(), all[1].slower()), (1, 0));
    }

    #[test]
    fn like_is_compared_with_like() {
        let beside = Row { technique: "a program".to_owned(), ..row(Some("raytrace"), 4.0, 0.0) };
        let rows = [
            row(None, 8.0, 0.0),
            labelled(row(None, 2.0, 0.0), BARE),
            labelled(row(None, 5.0, 0.0), "a frame a sample"),
            beside,
            labelled(row(Some("raster-pieces"), 10.0, 0.0), "a frame a sample"),
            row(Some("raster-bound"), 16.0, 0.0),
            labelled(row(Some("raster-bound"), 800.0, 0.0), NO_CULLING),
        ];
        let all = against_each(rows.iter());
        let ratios: Vec<Vec<f64>> = all.iter().map(|a| a.ratios.iter().map(|r| r.0).collect()).collect();
        assert_eq!(ratios, [[2.0], [2.0], [2.0]]);
    }

    #[test]
    fn frames_that_raster_found_are_compared_on_their_own() {
        let found_by = |row: Row, name: &str| Row { stages: vec![(name.to_owned(), 1.0)], ..row };
        let rows = [
            found_by(row(None, 2.0, 0.0), "trace"),
            found_by(labelled(row(None, 4.0, 0.0), RASTER), "raster"),
            row(Some("raytrace"), 1.0, 0.0),
            Row { parameter: Some((PARTS[0].to_owned(), 64.0)), ..row(Some("raytrace"), 8.0, 0.1) },
        ];
        let all = against_each(rows.iter());
        let of = |k: usize| (all[k].rival.as_str(), all[k].ratios[0].0, all[k].over_raster.clone());
        assert_eq!(of(0), ("raytrace", 0.5, vec![0.25]));
        assert_eq!(of(1), ("raytrace, of facets or pieces", 4.0, vec![2.0]));
    }

    #[test]
    fn the_first_sentence_counts_each_kind_of_rivals() {
        let rows = [
            row(None, 2.0, 0.0),
            row(Some("raytrace"), 1.0, 0.0),
            row(Some("raster-warp"), 8.0, 0.1),
            row(Some("raster-splat"), 4.0, 0.1),
        ];
        let text = in_short(&against_each(rows.iter()));
        assert!(text.contains("techniques that draw this engine is faster in 2 of 2 comparisons (3.0 times"), "{text}");
        assert!(text.contains("on the same adapter this engine is faster in 0 of 1 comparisons (0.50 times"), "{text}");
        assert!(!text.contains("CPUs"), "{text}");
    }

    #[test]
    fn frames_in_parts_and_hard_scenes_are_counted_apart() {
        let sized = |row: Row| Row { width: 100, height: 10, ..row };
        let hard = Some(Stiffness { family: "a family".into(), parameter: "a number".into(), value: 1.0 });
        let rows = [
            sized(row(None, 1.0, 0.002)),
            sized(Row { parameter: Some((PARTS[0].to_owned(), 64.0)), ..row(None, 1.0, 0.25) }),
            sized(Row { stiffness: hard, ..row(None, 1.0, 0.5) }),
            sized(row(Some("raytrace"), 1.0, 0.1)),
            sized(labelled(row(None, 1.0, 0.1), "f32 alone")),
        ];
        let text = wrong_pixels(rows.iter());
        assert!(text.starts_with("<p>1 frames of this engine's plain form, 0.0 million pixels, "), "{text}");
        assert!(text.contains(" 2 pixels have another triangle, 0 of them safe."), "{text}");
        assert!(text.contains("Not among them: 1 frames") && text.contains("25 % of their pixels"), "{text}");
        assert!(text.contains("Nor 1 frames") && text.contains("50 % of a frame at most"), "{text}");
    }

    #[test]
    fn numbers_have_two_digits() {
        assert_eq!([157.18, 2.714, 0.5912, 0.03, 0.0, 10.0].map(digits), ["157", "2.7", "0.59", "0.030", "0.0", "10"]);
    }

    #[test]
    fn what_is_nearer_to_the_truth_is_counted_and_not_timed() {
        let rows = [row(None, 8.0, 0.1), row(Some("raytrace"), 80.0, 0.05)];
        let all = against_each(rows.iter());
        assert_eq!((all[0].nearer, all[0].ratios.len()), (1, 0));
    }
}
