//! This engine against each rival over all cases of an adapter: how many times as long the rival takes as this engine in its plain form, at an
//! error that is not larger.

use super::Run;
use super::page::{escaped, table};
use super::plot::rms;
use super::row::Row;
use super::times::median;
use crate::rivals::TECHNIQUES;

/// Suites whose rows are compared: the others have no rivals, or scenes that are made to be hard.
const COMPARED: [&str; 5] = ["papers", "pareto", "glc", "samples", "dynamic"];

/// Labels of rows that a suite's arms have.
const BARE: &str = "t and ids alone";
const NO_CULLING: &str = "no culling";

/// A ratio nearer to 1 is a draw.
const DRAW: f64 = 0.05;

/// Against one rival.
#[derive(Debug)]
struct Against {
    rival: String,
    /// Each row's time over this engine's, and its case, the worst for this engine first.
    ratios: Vec<(f64, String)>,
    /// Rows whose error is smaller than any of this engine's.
    nearer: usize,
    /// Rows without a time.
    without_time: usize,
    /// Shares of wrong pixels.
    wrong: Vec<f64>,
    /// Rows with a wrong safe pixel.
    unsafe_rows: usize,
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
    let ours = || case.iter().copied().filter(|row| row.is_ours());
    let with =
        |label: &dyn Fn(Option<&str>) -> bool| ours().filter(|row| label(row.label.as_deref())).collect::<Vec<_>>();
    let is_beside = TECHNIQUES.iter().all(|technique| technique.name != rival.technique);
    let own = rival.label.as_deref();
    let found = [
        with(&|label| is_beside && label == Some(BARE)),
        with(&|label| label.is_none() || label == own),
        with(&|_| true),
    ];
    found.into_iter().find(|rows| !rows.is_empty()).unwrap_or_default()
}

/// The row of a rival that is told to leave nothing out, where it has a row in which it leaves out what it may: no way that one would take.
fn is_held_back(case: &[&Row], rival: &Row) -> bool {
    let plain = |row: &&&Row| row.technique == rival.technique && row.label.is_none() && row.times.is_some();
    rival.label.as_deref() == Some(NO_CULLING) && case.iter().find(plain).is_some()
}

/// Rivals in the order of their first row.
fn against_each<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Against> {
    let rows: Vec<&Row> = rows.filter(|r| COMPARED.contains(&r.suite.as_str())).collect();
    let mut all: Vec<Against> = Vec::new();
    for case in rows.chunk_by(|a, b| (&a.suite, &a.case) == (&b.suite, &b.case)) {
        for &row in case.iter().filter(|r| !r.is_ours() && !is_held_back(case, r)) {
            let at = all.iter().position(|a| a.rival == row.technique).unwrap_or_else(|| {
                let new = Against {
                    rival: row.technique.clone(),
                    ratios: Vec::new(),
                    nearer: 0,
                    without_time: 0,
                    wrong: Vec::new(),
                    unsafe_rows: 0,
                };
                all.push(new);
                all.len() - 1
            });
            let (Some(theirs), Some(wrong)) = (time(row), error(row)) else {
                all[at].without_time += 1;
                continue;
            };
            let ours = comparable(case, row);
            let no_worse = ours.into_iter().filter(|ours| error(ours).is_some_and(|e| e <= wrong));
            match no_worse.filter_map(time).min_by(f64::total_cmp) {
                Some(ours) => all[at].ratios.push((theirs / ours, row.case.clone())),
                None => all[at].nearer += 1,
            }
            if let Some(error) = row.error.as_ref().filter(|e| !e.is_of_colours()) {
                all[at].wrong.push(error.wrong_share);
                all[at].unsafe_rows += usize::from(error.wrong_safe > 0);
            }
        }
    }
    for against in &mut all {
        against.ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        against.wrong.sort_by(f64::total_cmp);
    }
    all
}

const HEADS: [&str; 9] = [
    "rival",
    "comparisons",
    "its time over ours: median [least, most]",
    "ours faster in",
    "even in",
    "ours slower in",
    "its wrong pixels, median %",
    "no safe pixel wrong in",
    "no comparison: nearer to the truth than ours, or without a time",
];

impl Against {
    fn median(&self) -> Option<f64> {
        let ratios: Vec<f64> = self.ratios.iter().map(|r| r.0).collect();
        Some(median(&ratios)).filter(|_| !ratios.is_empty())
    }

    fn slower(&self) -> usize {
        self.ratios.iter().filter(|r| r.0 < 1.0 - DRAW).count()
    }

    fn cells(&self) -> [String; 9] {
        let ends = self.ratios.first().zip(self.ratios.last());
        let ratio =
            self.median().zip(ends).map(|(m, (lo, hi))| format!("{} [{}, {}]", digits(m), digits(lo.0), digits(hi.0)));
        let faster = self.ratios.iter().filter(|r| r.0 > 1.0 + DRAW).count();
        let wrong = Some(median(&self.wrong)).filter(|_| !self.wrong.is_empty()).map(|w| digits(100.0 * w));
        let safe = Some(self.wrong.len()).filter(|rows| *rows > 0);
        [
            self.rival.clone(),
            self.ratios.len().to_string(),
            ratio.unwrap_or_default(),
            faster.to_string(),
            (self.ratios.len() - faster - self.slower()).to_string(),
            self.slower().to_string(),
            wrong.unwrap_or_default(),
            safe.map(|rows| format!("{} of {rows}", rows - self.unsafe_rows)).unwrap_or_default(),
            format!("{}, {}", self.nearer, self.without_time),
        ]
    }
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

/// How the papers' printed times compare with those of their own techniques here: in how many cases they are shorter, of how many, and by what
/// at most.
fn printed<'a>(rows: impl Iterator<Item = &'a Row>) -> Option<(usize, usize, f64)> {
    let rows: Vec<&Row> = rows.collect();
    let ratio = |case: &[&Row]| {
        let printed = 1000.0 / case.iter().find_map(|row| row.paper.as_ref()?.fps)?;
        let own = case.iter().filter(|row| row.technique.starts_with("raster-") && row.label.is_none());
        Some(own.filter_map(|row| time(row)).min_by(f64::total_cmp)? / printed)
    };
    let all: Vec<f64> = rows.chunk_by(|a, b| a.case == b.case).filter_map(ratio).collect();
    let longer = all.iter().filter(|r| **r > 1.0).count();
    (!all.is_empty()).then(|| (longer, all.len(), all.iter().copied().fold(0.0, f64::max)))
}

/// The runs of the newest commit, of those of one day the one with most rows; without one, why there is none.
fn of_one_commit<'a>(runs: &[&'a Run]) -> Result<(&'a str, Vec<&'a Run>), String> {
    let commit = |run: &'a Run| {
        let own = run.provenance.commit.as_deref().unwrap_or("unknown");
        let is_one = run.rows.iter().all(|row| row.commit.as_deref().is_none_or(|c| c == own));
        Some(own).filter(|own| is_one && *own != "unknown" && !own.ends_with("-dirty"))
    };
    let of = |one: &str| runs.iter().copied().filter(|run| commit(run) == Some(one)).collect::<Vec<_>>();
    let key = |one: &str| {
        let rows: usize = of(one).iter().map(|run| run.rows.len()).sum();
        (of(one).iter().map(|run| run.provenance.date.clone()).max(), rows)
    };
    let newest = runs.iter().filter_map(|run| commit(run)).max_by_key(|one| key(one));
    newest.map(|one| (one, of(one))).ok_or_else(|| "none is of one commit".to_owned())
}

/// What runs of one adapter came to, as a part of a page.
pub fn verdict(adapter: &str, runs: &[&Run]) -> String {
    let mut text = format!("<h3>{}</h3>\n", escaped(adapter));
    if let Some(first) = runs.first() {
        text += &format!("<p class=\"note\">{}</p>\n", first.provenance.fairness());
    }
    let (commit, runs) = match of_one_commit(runs) {
        Ok(found) => found,
        Err(why) => {
            return text + &format!("<p>No verdict over these runs: {why}. Each row stands for itself.</p>\n");
        }
    };
    let suites: Vec<&str> = runs.iter().map(|run| run.suite.as_str()).collect();
    let cases: usize = runs.iter().map(|run| run.rows.chunk_by(|a, b| a.case == b.case).count()).sum();
    text += &format!("<p>Over {cases} cases of {}, all at commit {}.</p>\n", suites.join(", "), escaped(commit));
    let rows = || runs.iter().flat_map(|r| &r.rows);
    let plain = || rows().filter(|r| r.is_ours() && r.label.is_none() && r.parameter.is_none());
    let judged: Vec<&Row> = plain().filter(|r| r.error.as_ref().is_some_and(|e| !e.is_of_colours())).collect();
    let pixels = |row: &Row| {
        let step = row.error.as_ref().map_or(1, |e| e.row_step);
        u64::from(row.width) * u64::from(row.height.div_ceil(step))
    };
    let safe: u64 = judged.iter().filter_map(|r| r.error.as_ref()).map(|e| e.wrong_safe).sum();
    let wrong = |row: &&Row| row.error.as_ref().map_or(0.0, |e| e.wrong_share) * pixels(row) as f64;
    let wrong: f64 = judged.iter().map(wrong).sum();
    let pixels: u64 = judged.iter().map(|row| pixels(row)).sum();
    text += &format!(
        "<p>{} frames of this engine's plain form, {pixels} pixels, compared with an f64 reference: {wrong:.0} pixels have another triangle, {safe} of \
         them safe (a safe pixel has one answer everywhere within 1/16 px of its centre). Frames of several samples are compared by colour.</p>\n",
        judged.len()
    );
    if let Some((longer, all, most)) = printed(rows()) {
        text += &format!(
            "<p>In {longer} of {all} cases the paper's own technique, built anew here, takes longer than the paper prints, for its own scenes and hardware of \
             2004 to 2013: {} times as long at most.</p>\n",
            digits(most)
        );
    }
    let all = against_each(rows());
    text += &table(&HEADS, all.iter().map(Against::cells));
    let worst = |a: &Against| {
        a.ratios
            .first()
            .filter(|r| r.0 < 1.0 - DRAW)
            .map(|r| format!("{} in {} of our time ({})", a.rival, digits(r.0), r.1.trim()))
    };
    let lost: Vec<String> = all.iter().filter_map(worst).collect();
    let lost = if lost.is_empty() { "nowhere".to_owned() } else { lost.join("; ") };
    text + &format!("<p>Where it loses most: {}.</p>\n", escaped(&lost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::bench::case::{Arm, Case, arms};
    use crate::tools::bench::row::Error;
    use crate::tools::bench::times::Times;

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
