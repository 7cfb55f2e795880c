//! What goes together in a frame: every refused pair is tried and gives its own line, every other pair is planned, and the page says
//! what the table says.

use crate::common;

use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::combinations::{Asked, Feature, REFUSALS, Refusal};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::planned::Planner;
use anamorph::internals::engine::rival::{Choice, MULTISAMPLES, NOT_RENDERED};
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::frame::{Frame, NO_ID};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::jobs::Backend;
use anamorph::internals::scene::style::Style;
use anamorph_lab::rivals::TECHNIQUES;
use common::combined::{COLORS, Case, Compared, WHOLE, compared, frame_of_ids, verdict};
use common::gpu::{engine_on, ids, limit_bindings};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

const PAGE: &str = include_str!("../../docs/reference/combinations.md");

const SIZE: (u32, u32) = (64, 64);

/// What is planned of a case, or why not. No device is touched.
fn plan(case: &Case) -> Result<()> {
    let has = AdapterFeatures {
        f64: true,
        atomics64: true,
        lanes: true,
        wide: false,
        by_pair: false,
        timestamps: false,
        clip_distances: false,
        draw_counts: false,
        software: true,
        f64_is_wrong: false,
    };
    let planner = Planner { name: "test".into(), has, limit: case.limit, table_limit: case.limit };
    let asked = Asked::of(&case.scene, &case.camera, &case.wanted, &case.run);
    asked.check()?;
    // of images that take several frames, the first frame
    let first = Sample { number: 0, count: case.wanted.samples };
    let (mut camera, mut wanted) = (Arc::new(case.camera.clone()), case.wanted.clone());
    if asked.is_separate() {
        camera = Arc::new(camera.of_sample((0.0, 0.0), first)?);
        wanted.samples = 1;
    }
    if let Some(composition) = camera.layered() {
        camera = composition.members[0].camera.clone();
    }
    planner.plan(&case.scene, camera, &wanted, &case.run, None).map(|_| ())
}

/// The row that is to refuse a case.
fn expected(case: &Case) -> Option<&'static Refusal> {
    REFUSALS.iter().find(|row| row.features.iter().all(|f| case.has.contains(f)))
}

/// An error is the line of a row.
fn assert_refused(what: &str, row: &Refusal, error: &Error) {
    let text = error.to_string();
    assert!(error.exit_code() == 2 && !text.contains('\n') && !text.contains('{'), "{what}: {text}");
    // between what stands for the frame's own
    let whole = format!("{}; {}", row.reason, row.remedy);
    let mut rest = text.as_str();
    for part in whole.split('{').map(|p| p.split_once('}').map_or(p, |(_, after)| after)) {
        let at = rest.find(part).unwrap_or_else(|| panic!("{what}: {text:?} is not {whole:?}"));
        rest = &rest[at + part.len()..];
    }
    assert!(rest.is_empty(), "{what}: {text:?} is not {whole:?}");
}

#[test]
fn each_row_refuses_its_pair_and_no_other_pair_is_refused() {
    let pairs = Feature::ALL
        .into_iter()
        .flat_map(|a| Feature::ALL.into_iter().filter(move |b| a <= *b).map(move |b| vec![a, b]));
    let more = REFUSALS.iter().filter(|row| row.features.len() > 2).map(|row| row.features.to_vec());
    let mut reached = BTreeSet::new();
    let (mut refused, mut taken) = (0, 0);
    for pair in pairs.chain(more) {
        let Some(case) = Case::of(&pair, SIZE) else { continue };
        match (plan(&case), expected(&case)) {
            (Err(error), Some(row)) => {
                assert_refused(&format!("{pair:?}"), row, &error);
                reached.insert(row.features);
                refused += 1;
            }
            (Ok(()), None) => taken += 1,
            (got, expected) => panic!("{pair:?}: {:?}, expected {expected:?}", got.map_err(|e| e.to_string())),
        }
    }
    println!("{refused} pairs refused, {taken} taken");
    let missed: Vec<_> = REFUSALS.iter().filter(|row| !reached.contains(row.features)).collect();
    assert!(missed.is_empty(), "rows that refuse nothing: {missed:?}");
}

/// Engines by the size of their bindings.
#[derive(Default)]
struct Engines(Vec<(u64, Engine)>);

impl Engines {
    fn of(&mut self, limit: u64) -> Option<&mut Engine> {
        if !self.0.iter().any(|(own, _)| *own == limit) {
            let engine = engine_on(|gpu| {
                if limit < WHOLE {
                    limit_bindings(gpu, limit);
                }
            })?;
            self.0.push((limit, engine));
        }
        self.0.iter_mut().find(|(own, _)| *own == limit).map(|(_, engine)| engine)
    }
}

/// The largest difference of two colors that round to the same 8 bits or to neighboring ones.
const COLOR_ERROR: f32 = 1.0 / 255.0;

/// Renders a case and compares it with the reference: triangles of all samples, proofs, and colors of pixels that are safe.
fn assert_as_the_reference(what: &str, case: &Case, engine: &mut Engine) {
    let Case { scene, camera, .. } = case;
    let compared = compared(case, engine).unwrap_or_else(|e| panic!("{what}: {e}"));
    let Compared { frame, wanted, rows_differ, centres, samples } = compared;
    assert!(!rows_differ, "{what}: rows are not those of the whole image");
    let Some(centres) = centres else {
        assert!(ids(&frame).iter().any(|id| *id != NO_ID), "{what}");
        return;
    };
    assert_eq!(centres.wrong(), 0, "{what}");
    let mut safe = centres.safe;
    // an error in one pixel is found
    let mut planted = ids(&frame).to_vec();
    let mut hits = (0..planted.len()).filter(|k| planted[*k] != NO_ID);
    // along curves no pixel that shows an alpha mask is safe
    let hit = hits.clone().find(|k| safe[*k]).or_else(|| hits.next());
    planted[hit.unwrap_or_else(|| panic!("{what}: no pixel hits anything"))] ^= 1;
    assert!(verdict(scene, camera, &frame_of_ids(camera, planted)).wrong() > 0, "{what}: an error is not found");
    for (number, of_sample) in samples {
        assert_eq!(of_sample.wrong(), 0, "{what}, sample {number}");
        safe.iter_mut().zip(of_sample.safe).for_each(|(all, own)| *all &= own);
    }
    // the reference draws no lines and measures no areas; and where only edge pixels are sampled, a triangle has one shadow in a pixel
    let has_one_shadow = case.has.contains(&Feature::Shadows) && !case.has.contains(&Feature::Separate);
    if scene.style != Style::default() || wanted.analytic || wanted.samples > 1 && has_one_shadow {
        return;
    }
    let colors = Wanted { samples: wanted.samples, ..Wanted::of(COLORS.to_vec()) };
    let (camera, plain) = (Arc::new(camera.clone()), RunOptions::default());
    let truth = Backend::Reference.render(scene, &camera, &colors, &plain, &mut |_| {}).unwrap().frame;
    let differs = |k: &usize| {
        let value = |frame: &Frame, channel| frame.f32(channel).unwrap()[*k].clamp(0.0, 1.0);
        COLORS.into_iter().any(|channel| (value(&frame, channel) - value(&truth, channel)).abs() > COLOR_ERROR)
    };
    let (safe_count, off) =
        (0..safe.len()).filter(|k| safe[*k]).fold((0, 0), |(n, off), k| (n + 1, off + u32::from(differs(&k))));
    println!("{what}: {safe_count} pixels are safe, {off} have another color");
    // a shadow ray that passes an edge within rounding is no matter of safe pixels
    let most = if case.has.contains(&Feature::Shadows) { safe_count / 1000 } else { 0 };
    assert!(safe_count > 0 && off <= most, "{what}: {safe_count} pixels are safe, {off} have another color");
}

#[test]
#[ignore = "slow: make test-all"]
fn every_pair_that_is_not_refused_is_as_the_reference_says() {
    let (mut count, mut wrong) = (0, Vec::new());
    for a in Feature::ALL {
        // an engine keeps all kernels, and few are those of other features
        let mut engines = Engines::default();
        for pair in Feature::ALL.into_iter().filter(|b| a <= *b).map(|b| [a, b]) {
            let Some(case) = Case::of(&pair, SIZE).filter(|case| expected(case).is_none()) else { continue };
            let Some(engine) = engines.of(case.limit) else { return };
            let compared = AssertUnwindSafe(|| assert_as_the_reference(&format!("{pair:?}"), &case, engine));
            wrong.extend(catch_unwind(compared).is_err().then_some(pair));
            count += 1;
        }
    }
    println!("{count} pairs");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn frames_of_other_cameras_and_lights_are_prepared_again() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let prepare = |engine: &mut Engine, case: &Case| {
        engine.prepare(&case.scene, case.camera.clone(), &case.wanted, &case.run).unwrap()
    };
    let [lit, mirror, composed, plain, atlas] =
        [Feature::Caustics, Feature::Optics, Feature::Composed, Feature::OneSample, Feature::Atlas]
            .map(|feature| Case::of(&[feature], SIZE).unwrap());
    let says = |error: Error, what: &str| {
        assert!(error.to_string().contains(what) && error.exit_code() == 2, "{error}");
        assert!(error.to_string().ends_with("; call Engine::prepare again"), "{error}");
    };
    says(prepare(&mut engine, &lit).light(&lit.scene).unwrap_err(), "the light cannot change with caustics");
    says(prepare(&mut engine, &mirror).aim(&mirror.camera).unwrap_err(), "cannot be taken by this reflection");
    says(prepare(&mut engine, &plain).aim(&composed.camera).unwrap_err(), "cannot be taken by this composite");
    let error =
        engine.prepare(&composed.scene, composed.camera.clone(), &composed.wanted, &composed.run).err().unwrap();
    assert!(error.to_string().contains("call Engine::render"), "{error}");
    let none = Wanted { samples: 0, ..plain.wanted.clone() };
    let error = engine.render(&plain.scene, plain.camera.clone(), &none, &plain.run).unwrap_err();
    assert!(error.to_string().contains("use at least 1"), "{error}");
    for (case, is_taken) in [(&lit, false), (&atlas, false), (&composed, false), (&mirror, true), (&plain, true)] {
        assert_eq!(Sequence::takes(&case.scene, &case.camera, &case.wanted), is_taken, "{:?}", case.has);
    }
}

#[test]
fn rivals_refuse_what_they_do_not_render() {
    let rival = |culls: bool| {
        let technique = TECHNIQUES.iter().find(|technique| technique.culls == culls).unwrap();
        Choice { technique, parameter: technique.parameter.as_ref().map_or(0, |parameter| parameter.default) }
    };
    let refused = |features: &[Feature], run: RunOptions, what: &str| {
        let case = Case { run, ..Case::of(features, SIZE).unwrap() };
        let name = case.run.rival.unwrap().technique.name;
        let text = plan(&case).unwrap_err().to_string();
        assert!(text.starts_with(&format!("{name} {what}; ")), "{text}");
    };
    let run = RunOptions { rival: Some(rival(true)), ..RunOptions::default() };
    for (feature, what) in [
        (Feature::Gradients, "has no gradients"),
        (Feature::Timed, "sees the whole scene at one time"),
        (Feature::Spheres, "draws triangles alone"),
        (Feature::Certified, "cannot certify pixels"),
        (Feature::AlphaMasks, "ignores alpha masks"),
        (Feature::Optics, "does not follow reflected or refracted rays"),
    ] {
        refused(&[feature], run.clone(), what);
    }
    let four = TECHNIQUES.iter().find(|technique| technique.samples == MULTISAMPLES).unwrap();
    let of_four = RunOptions { rival: Some(Choice { technique: four, parameter: 0 }), ..RunOptions::default() };
    refused(&[Feature::Analytic], of_four, "counts samples, and measures no areas");
    let without_culling = RunOptions { rival: Some(rival(false)), no_cull: true, ..RunOptions::default() };
    refused(&[], without_culling, "culls nothing");
    plan(&Case { run, ..Case::of(&[], SIZE).unwrap() }).unwrap();
}

#[test]
fn the_page_of_rivals_has_their_table() {
    let line = |(feature, what, remedy): (Feature, &str, &str)| format!("| {} | {what} | {remedy} |", feature.name());
    let expected = NOT_RENDERED.map(line).join("\n");
    assert!(include_str!("../../docs/reference/rivals.md").contains(&expected), "rivals.md must have:\n{expected}");
}

/// A row of the page's table.
fn line(row: &Refusal) -> String {
    let names: Vec<&str> = row.features.iter().map(|f| f.name()).collect();
    let plain = |text: &str| {
        let words = [("{camera}", "the camera"), ("{rows}", "some"), ("{chunks}", "several")];
        words.iter().fold(text.to_string(), |text, (from, to)| text.replace(from, to))
    };
    format!("| {} | {} | {} |", names.join(" + "), plain(row.reason), plain(row.remedy))
}

#[test]
fn the_page_is_the_table() {
    let lines: Vec<&str> = PAGE.lines().filter(|l| l.starts_with("| ")).skip(1).collect();
    let expected: Vec<String> = REFUSALS.iter().map(line).collect();
    assert_eq!(lines, expected, "docs/reference/combinations.md must have these rows:\n{}", expected.join("\n"));
    assert!(expected.iter().all(|l| l.matches('|').count() == 4 && !l.contains('{')));
}

/// Features that go with all others.
const NEVER_REFUSED: [Feature; 5] =
    [Feature::Samples, Feature::Moving, Feature::Blended, Feature::Shadows, Feature::Bands];

#[test]
fn every_feature_is_in_a_row_and_named_once() {
    let names: BTreeSet<&str> = Feature::ALL.into_iter().map(Feature::name).collect();
    assert_eq!(names.len(), Feature::ALL.len());
    let in_rows: BTreeSet<Feature> = REFUSALS.iter().flat_map(|r| r.features).copied().collect();
    let refused = BTreeSet::from(Feature::ALL).difference(&BTreeSet::from(NEVER_REFUSED)).copied().collect();
    assert_eq!(in_rows, refused);
}
