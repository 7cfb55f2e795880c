//! This engine against each rival over all cases of an adapter: how many times as long the rival takes at the least of this engine's times
//! whose error is not larger.

use super::Run;
use super::page::{escaped, table};
use super::plot::rms;
use super::row::Row;
use super::times::median;

/// Suites whose rows are compared: the others have no rivals, or scenes that are made to be hard.
const COMPARED: [&str; 5] = ["papers", "pareto", "glc", "samples", "dynamic"];

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

/// Rivals in the order of their first row.
fn against_each<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Against> {
    let rows: Vec<&Row> = rows.filter(|r| COMPARED.contains(&r.suite.as_str())).collect();
    let mut all: Vec<Against> = Vec::new();
    for case in rows.chunk_by(|a, b| (&a.suite, &a.case) == (&b.suite, &b.case)) {
        for row in case.iter().filter(|r| !r.is_ours()) {
            let at = all.iter().position(|a| a.rival == row.technique).unwrap_or_else(|| {
                let new = Against {
                    rival: row.technique.clone(),
                    ratios: Vec::new(),
                    nearer: 0,
                    without_time: 0,
                    wrong: Vec::new(),
                };
                all.push(new);
                all.len() - 1
            });
            let (Some(theirs), Some(wrong)) = (time(row), error(row)) else {
                all[at].without_time += 1;
                continue;
            };
            let no_worse = case.iter().filter(|ours| ours.is_ours() && error(ours).is_some_and(|e| e <= wrong));
            match no_worse.filter_map(|ours| time(ours)).min_by(f64::total_cmp) {
                Some(ours) => all[at].ratios.push((theirs / ours, row.case.clone())),
                None => all[at].nearer += 1,
            }
            all[at].wrong.extend(row.error.as_ref().filter(|e| !e.is_of_colours()).map(|e| e.wrong_share));
        }
    }
    for against in &mut all {
        against.ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        against.wrong.sort_by(f64::total_cmp);
    }
    all
}

const HEADS: [&str; 8] = [
    "rival",
    "rows",
    "its time over ours: median [least, most]",
    "ours faster in",
    "slower in",
    "its wrong pixels, median %",
    "nearer to the truth than ours in",
    "without a time",
];

impl Against {
    fn median(&self) -> Option<f64> {
        let ratios: Vec<f64> = self.ratios.iter().map(|r| r.0).collect();
        Some(median(&ratios)).filter(|_| !ratios.is_empty())
    }

    fn slower(&self) -> usize {
        self.ratios.iter().filter(|r| r.0 < 1.0 - DRAW).count()
    }

    fn cells(&self) -> [String; 8] {
        let ends = self.ratios.first().zip(self.ratios.last());
        let ratio = self.median().zip(ends).map(|(m, (lo, hi))| format!("{m:.2} [{:.2}, {:.2}]", lo.0, hi.0));
        let faster = self.ratios.iter().filter(|r| r.0 > 1.0 + DRAW).count();
        let wrong = Some(median(&self.wrong)).filter(|_| !self.wrong.is_empty()).map(|w| format!("{:.4}", 100.0 * w));
        [
            self.rival.clone(),
            self.ratios.len().to_string(),
            ratio.unwrap_or_default(),
            faster.to_string(),
            self.slower().to_string(),
            wrong.unwrap_or_default(),
            self.nearer.to_string(),
            self.without_time.to_string(),
        ]
    }
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
    let pixels: u64 = judged.iter().map(|row| pixels(row)).sum();
    let safe: u64 = judged.iter().filter_map(|r| r.error.as_ref()).map(|e| e.wrong_safe).sum();
    text += &format!(
        "<p>{} frames of this engine, {pixels} pixels, compared with an f64 reference: {safe} wrong of those whose answer no shift by \
         1/16 px changes.</p>\n",
        judged.len()
    );
    let all = against_each(rows());
    text += &table(&HEADS, all.iter().map(Against::cells));
    let worst = |a: &Against| {
        a.ratios
            .first()
            .filter(|r| r.0 < 1.0 - DRAW)
            .map(|r| format!("{} in {:.2} of our time ({})", a.rival, r.0, r.1.trim()))
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

    #[test]
    fn a_rival_is_compared_with_the_fastest_way_that_is_no_worse() {
        let rows = [
            row(None, 8.0, 0.0),
            row(None, 2.0, 0.1),
            row(Some("raytrace"), 4.0, 0.05),
            row(Some("raster-warp"), 4.0, 0.2),
        ];
        let all = against_each(rows.iter());
        let ratio = |k: usize| all[k].ratios[0].0;
        assert_eq!((ratio(0), ratio(1)), (0.5, 2.0));
        assert_eq!((all[0].slower(), all[1].slower()), (1, 0));
    }

    #[test]
    fn what_is_nearer_to_the_truth_is_counted_and_not_timed() {
        let rows = [row(None, 8.0, 0.1), row(Some("raytrace"), 80.0, 0.05)];
        let all = against_each(rows.iter());
        assert_eq!((all[0].nearer, all[0].ratios.len()), (1, 0));
    }
}
