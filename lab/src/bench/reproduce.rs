//! `anamorph bench reproduce SUITE/CASE`: a case of a run is run again, and each of its rows compared with what it said.

use super::case::Case;
use super::plot::file_name;
use super::race::{Engines, Rules, race};
use super::row::{Error, Row};
use super::suites::{SUITES, Suite};
use super::times::Ratio;
use super::{Provenance, Run, runs};
use anamorph::internals::input::{Error as Failure, Result};
use std::path::Path;

/// Shares of wrong pixels agree that differ by no more than this, or by [`SHARE_OF_WRONG`] of the larger: pixels on edges, which drivers round
/// otherwise.
const WRONG: f64 = 1e-4;
const SHARE_OF_WRONG: f64 = 0.1;
/// Errors of colours, dB.
const PSNR_DB: f64 = 0.5;
/// Intervals of ratios agree that come as near as this: of the ten cases of `make reproduce-quick`, run on two days on shared machines, the median of
/// one ratio changed by a factor of 1.25.
const NEAR: f64 = 1.25;

/// Runs the case again and tells a line a row; returns how many rows do not agree.
///
/// # Errors
/// [`Failure::Input`] if there is no such case, or no run of it in `folder`; [`Failure`] where the case's scene or the device fails.
pub fn reproduce(
    engines: &mut Engines,
    row: &str,
    rules: &Rules,
    folder: &Path,
    mut tell: impl FnMut(&str),
) -> Result<usize> {
    let (suite, case) = find(row)?;
    let now = Provenance::now(&engines.computing, false);
    let Some((name, run)) = newest(runs(folder)?, suite, &case, &now) else {
        return Err(Failure::input(format!("{} has no run with {}/{}", folder.display(), suite.name, case.name)));
    };
    let is_same_adapter = run.provenance.adapter == now.adapter;
    tell(&format!("{}/{}, as in {}\n", suite.name, case.name, folder.join(name).display()));
    if !is_same_adapter {
        tell(&format!("  by {}, here {}: errors are compared, times are not\n", run.provenance.adapter, now.adapter));
    }
    let rows = race(engines, suite.name, &case, rules)?;
    let mut differ = 0;
    for then in run.rows.iter().filter(|row| row.case == case.name && row.times.is_some()) {
        let again = rows.iter().find(|row| row.label() == then.label());
        let (verdict, text) = match again.map(|again| compared(then, again, is_same_adapter)) {
            // such as a program that runs beside
            None => ("-", "is not run here".to_owned()),
            Some((text, true)) => ("agrees", text),
            Some((text, false)) => ("DIFFERS", text),
        };
        differ += usize::from(verdict == "DIFFERS");
        tell(&format!("  {verdict:<10}{:<50} {text}\n", then.label()));
    }
    Ok(differ)
}

/// `SUITE/CASE`, the case by its name or as in the address of its place on the page.
fn find(row: &str) -> Result<(&'static Suite, Case)> {
    let asked = row.split_once('/').and_then(|(suite, case)| Some((SUITES.iter().find(|s| s.name == suite)?, case)));
    let Some((suite, name)) = asked else {
        return Err(Failure::input(format!("{row}: write SUITE/CASE, for example 'papers/Yu 1'")));
    };
    let plain = |name: &str| file_name(name.trim());
    let cases = suite.cases(false);
    let found = cases.iter().find(|case| plain(&case.name) == plain(name)).cloned();
    found.map(|case| (suite, case)).ok_or_else(|| {
        let names: Vec<&str> = cases.iter().map(|case| case.name.trim()).collect();
        Failure::input(format!("{} has no case {name}; there is: {}", suite.name, names.join("; ")))
    })
}

/// The newest whole run with the case, by the same adapter if there is one.
fn newest(runs: Vec<(String, Run)>, suite: &Suite, case: &Case, now: &Provenance) -> Option<(String, Run)> {
    let has_case = |run: &Run| {
        run.suite == suite.name && !run.provenance.quick && run.rows.iter().any(|row| row.case == case.name)
    };
    let key = |run: &Run| (run.provenance.adapter == now.adapter, run.provenance.date.clone());
    runs.into_iter().filter(|(_, run)| has_case(run)).max_by_key(|(_, run)| key(run))
}

/// What two runs of a row have in common, in words, and whether they agree.
fn compared(then: &Row, again: &Row, is_same_adapter: bool) -> (String, bool) {
    if let Some(why) = &again.refused {
        return (why.clone(), false);
    }
    let (error, errors_agree) = match (&then.error, &again.error) {
        (Some(a), Some(b)) => errors(a, b),
        _ => ("no error to compare".to_owned(), true),
    };
    let ratios = (then.to_ours, again.to_ours);
    let (time, times_agree) = match ratios {
        (Some(a), Some(b)) if is_same_adapter => {
            (format!(", {:.2} of our time, then {:.2}", b.median, a.median), near(a, b))
        }
        (_, Some(b)) => (format!(", {:.2} of our time", b.median), true),
        _ => (String::new(), true),
    };
    (error + &time, errors_agree && times_agree)
}

fn errors(a: &Error, b: &Error) -> (String, bool) {
    if a.is_of_colours() || b.is_of_colours() {
        let (Some(a), Some(b)) = (a.psnr, b.psnr) else {
            return ("colours alone".to_owned(), a.identical == b.identical);
        };
        return (format!("{b:.1} dB, then {a:.1}"), (a - b).abs() <= PSNR_DB);
    }
    let (a, b) = (a.wrong_share, b.wrong_share);
    let text = format!("{:.4} % wrong, then {:.4}", 100.0 * b, 100.0 * a);
    (text, (a - b).abs() <= WRONG.max(SHARE_OF_WRONG * a.max(b)))
}

fn near(a: Ratio, b: Ratio) -> bool {
    let ends = |r: Ratio| r.interval.unwrap_or([r.median; 2]);
    let ([a_low, a_high], [b_low, b_high]) = (ends(a), ends(b));
    a_low <= NEAR * b_high && b_low <= NEAR * a_high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::case::Arm;
    use crate::bench::times::Times;

    fn row(wrong_share: f64, ratio: [f64; 2]) -> Row {
        let (_, case) = find("papers/Yu 1").unwrap();
        let error = Error { wrong_share, t_median: Some(0.0), ..Error::none() };
        let to_ours = Some(Ratio { median: ratio[0], interval: Some(ratio) });
        Row { times: Some(Times::of(&[1.0])), error: Some(error), to_ours, ..Row::new("papers", &case, &Arm::ours()) }
    }

    #[test]
    fn a_case_is_found_by_its_name_and_by_its_address() {
        assert_eq!(find("papers/Yu 1").unwrap().1.name, find("papers/yu-1").unwrap().1.name);
        for (row, says) in [("Yu 1", "SUITE/CASE"), ("paper/Yu 1", "SUITE/CASE"), ("papers/Yu 99", "no case Yu 99")] {
            assert!(find(row).err().is_some_and(|e| e.to_string().contains(says)), "{row}");
        }
    }

    /// Rows that the docs name can be run.
    #[test]
    fn claims_name_cases_that_are_there() {
        let quick = include_str!("../../reproduce-quick.txt");
        assert_eq!(quick.lines().map(|row| find(row).map(|_| row)).collect::<Result<Vec<_>>>().unwrap().len(), 10);
        let claims = include_str!("../../../docs/claims.md");
        let is_row = |text: &&str| SUITES.iter().any(|s| text.strip_prefix(s.name).is_some_and(|t| t.starts_with('/')));
        let named: Vec<&str> = claims.split('`').filter(is_row).collect();
        assert!(named.len() >= 8 && named.iter().all(|row| find(row).is_ok()), "{named:?}");
    }

    #[test]
    fn rows_agree_whose_errors_and_ratios_are_near() {
        let then = row(0.02, [1.0, 1.2]);
        for (again, agrees) in [
            (row(0.0215, [1.45, 1.6]), true),
            (row(0.0215, [1.55, 1.6]), false),
            (row(0.023, [1.0, 1.2]), false),
            (row(0.02, [0.5, 0.75]), false),
        ] {
            assert_eq!(compared(&then, &again, true).1, agrees, "{again:?}");
        }
        // times of another adapter are not compared
        assert!(compared(&then, &row(0.02, [9.0, 9.1]), false).1);
    }
}
