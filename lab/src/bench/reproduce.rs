//! `anamorph bench reproduce SUITE/CASE`: a case of a run is run again, and each of its rows compared with what it said.

use super::case::Case;
use super::plot::file_name;
use super::race::{Engines, Rules};
use super::row::{Error, Row};
use super::suites::{SUITES, Suite};
use super::times::Ratio;
use super::{Provenance, Run, run_case, runs};
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
/// Factor between the ends of an interval beyond which it says nothing: the widest of the committed runs has 6.
const WIDE: f64 = 100.0;

/// Whether two runs of a row agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Agreement {
    Agrees,
    Differs,
    /// One run has no error and no ratio that the other has too.
    NotCompared,
}

/// Runs the case again and tells a line a row; returns how many rows do not agree.
///
/// # Errors
/// [`Failure::Input`] if there is no such case, no run of it in `folder`, or nothing to compare in that run; [`Failure`] where the case's scene
/// or the device fails.
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
    let rows = run_case(engines, suite.name, &case, rules)?;
    let mut counts = [0; 2];
    for then in run.rows.iter().filter(|row| row.case == case.name && row.times.is_some()) {
        let again = rows.iter().find(|row| row.label() == then.label());
        // a program that runs beside may be missing here
        let (text, agreement) = again.map_or_else(
            || ("is not run here".to_owned(), Agreement::NotCompared),
            |again| compared(then, again, is_same_adapter),
        );
        let [compared, differ] = &mut counts;
        let verdict = match agreement {
            Agreement::Agrees => "agrees",
            Agreement::Differs => "DIFFERS",
            Agreement::NotCompared => "-",
        };
        *compared += usize::from(agreement != Agreement::NotCompared);
        *differ += usize::from(agreement == Agreement::Differs);
        tell(&format!("  {verdict:<10}{:<50} {text}\n", then.label()));
    }
    match counts {
        [0, _] => Err(Failure::input(format!("{row}: that run has no row with an error or a ratio to compare"))),
        [_, differ] => Ok(differ),
    }
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

/// Compares two runs of a row: their errors and ratios in words, and whether these agree.
fn compared(then: &Row, again: &Row, is_same_adapter: bool) -> (String, Agreement) {
    if let Some(why) = &again.refused {
        return (why.clone(), Agreement::Differs);
    }
    let (error, errors_agree) = match (&then.error, &again.error) {
        (Some(a), Some(b)) => errors(a, b),
        _ => ("no error to compare".to_owned(), None),
    };
    let (time, times_agree) = match (then.to_ours, again.to_ours) {
        (Some(a), Some(b)) if is_same_adapter && is_sound(a) => {
            (format!(", {:.2} of our time, then {:.2}", b.median, a.median), Some(near(a, b)))
        }
        (_, Some(b)) => (format!(", {:.2} of our time", b.median), None),
        _ => (String::new(), None),
    };
    let agreement = match [errors_agree, times_agree] {
        [None, None] => Agreement::NotCompared,
        both if both.contains(&Some(false)) => Agreement::Differs,
        _ => Agreement::Agrees,
    };
    (error + &time, agreement)
}

/// Two errors in words, and whether they agree; `None` if they cannot be compared.
fn errors(a: &Error, b: &Error) -> (String, Option<bool>) {
    if a.is_of_colours() || b.is_of_colours() {
        let (Some(a), Some(b)) = (a.psnr, b.psnr) else {
            return ("colours alone".to_owned(), Some(a.identical == b.identical));
        };
        return (format!("{b:.1} dB, then {a:.1}"), Some((a - b).abs() <= PSNR_DB));
    }
    let (a, b) = (a.wrong_share, b.wrong_share);
    let text = format!("{:.4} % wrong, then {:.4}", 100.0 * b, 100.0 * a);
    let is_share = |share: f64| (0.0..=1.0).contains(&share);
    (text, (is_share(a) && is_share(b)).then(|| (a - b).abs() <= WRONG.max(SHARE_OF_WRONG * a.max(b))))
}

/// The lower and the upper end of a ratio's interval.
fn ends(ratio: Ratio) -> [f64; 2] {
    ratio.interval.unwrap_or([ratio.median; 2])
}

/// A ratio that a race may have: above 0, its median within its interval, and the interval's ends no farther apart than [`WIDE`].
fn is_sound(ratio: Ratio) -> bool {
    let [low, high] = ends(ratio);
    low > 0.0 && low <= ratio.median && ratio.median <= high && high <= WIDE * low
}

fn near(a: Ratio, b: Ratio) -> bool {
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
            (row(0.0215, [1.45, 1.6]), Agreement::Agrees),
            (row(0.0215, [1.55, 1.6]), Agreement::Differs),
            (row(0.023, [1.0, 1.2]), Agreement::Differs),
            (row(0.02, [0.5, 0.75]), Agreement::Differs),
        ] {
            assert_eq!(compared(&then, &again, true).1, agrees, "{again:?}");
        }
        // times of another adapter are not compared
        assert_eq!(compared(&then, &row(0.02, [9.0, 9.1]), false).1, Agreement::Agrees);
    }

    #[test]
    fn rows_without_an_error_or_a_sound_ratio_are_not_compared() {
        let again = row(0.02, [1.0, 1.2]);
        let plain = Row { error: None, to_ours: None, ..again.clone() };
        assert_eq!(compared(&plain, &again, true).1, Agreement::NotCompared);
        for interval in [[0.0, 1e308], [1e-300, 1e300], [f64::NAN, 1.0], [2.0, 3.0]] {
            let to_ours = Some(Ratio { median: 1.0, interval: Some(interval) });
            let then = Row { error: None, to_ours, ..again.clone() };
            assert_eq!(compared(&then, &again, true).1, Agreement::NotCompared, "{interval:?}");
        }
        let then = Row { to_ours: None, ..row(1e300, [1.0, 1.0]) };
        assert_eq!(compared(&then, &again, true).1, Agreement::NotCompared);
    }
}
