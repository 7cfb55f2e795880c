//! Lists that lose their devices.

use super::*;
use crate::gpu::Gpu;
use crate::gpu::device::GpuOptions;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const SCENE: &str = r#"
[[mesh]]
builtin = "icosphere"
rotate = [{ frame = 0, value = [0, 0, 0] }, { frame = 29, value = [0, 90, 0] }]
[camera]
kind = "pinhole"
eye = [0, 0.5, 4]
target = [0, 0, 0]
vfov = 40
"#;
const FRAMES: usize = 30;

/// What a list came to.
struct Ran {
    counts: Counts,
    stopped_by: Option<String>,
    /// How often the first device was opened again.
    reopened: u32,
    /// What was written, in the order of frames.
    files: Vec<Option<Vec<u8>>>,
}

/// Does a list on so many devices, and more beside it with the number of frames done and the first device.
fn run_list(
    devices: usize,
    prepare: impl FnOnce(&mut Worker),
    beside: impl FnOnce(&AtomicUsize, &Gpu) + Send,
) -> Option<Ran> {
    let dir = tempfile::tempdir().unwrap();
    let list = dir.path().join("jobs.toml");
    std::fs::write(dir.path().join("scene.toml"), SCENE).unwrap();
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nsize = \"320x240\"\n";
    std::fs::write(&list, format!("{job}frames = {{ last = {} }}\n", FRAMES - 1)).unwrap();
    let open = |_| Worker::open(GpuOptions::default()).unwrap();
    let mut workers: Vec<Worker> = (0..devices).map(open).collect();
    let Some(gpu) = workers[0].gpu() else {
        println!("skipped: no adapter on this machine");
        return None;
    };
    prepare(&mut workers[0]);
    let batch = Batch::open(&list, None, Vec::new(), Limits::default()).unwrap();
    let options = BatchOptions { writers: Some(2), ..BatchOptions::default() };
    let manifest = Manifest::open(&batch.paths.own, &[], false).unwrap();
    let mut started = Started { frames: Frames { batch: &batch, own: None, manifest }, options, workers };
    let done = AtomicUsize::new(0);
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| beside(&done, &gpu));
        started.run(&|_, counts| done.store(counts.done, Ordering::SeqCst)).unwrap()
    });
    Some(Ran {
        counts: outcome.counts,
        stopped_by: outcome.stopped_by.map(|e| e.to_string()),
        reopened: outcome.devices[0].reopened,
        files: (0..FRAMES).map(|k| std::fs::read(dir.path().join(format!("{k}.png"))).ok()).collect(),
    })
}

fn lose_after_three(done: &AtomicUsize, gpu: &Gpu) {
    while done.load(Ordering::SeqCst) < 3 {
        std::thread::sleep(Duration::from_millis(1));
    }
    gpu.device.destroy();
}

#[test]
fn a_lost_device_is_opened_again_and_all_frames_are_as_without() {
    let Some(expected) = run_list(1, |_| (), |_, _| ()) else { return };
    assert_eq!((expected.counts.done, expected.reopened), (FRAMES, 0));
    assert!(expected.files.iter().all(Option::is_some));
    let seen = run_list(1, |_| (), lose_after_three).unwrap();
    assert_eq!((seen.counts.done, seen.counts.failed, seen.reopened), (FRAMES, 0, 1));
    assert!(seen.files == expected.files);
}

#[test]
fn others_do_what_a_device_has_not_that_is_gone_for_good() {
    let Some(expected) = run_list(1, |_| (), |_, _| ()) else { return };
    let seen = run_list(2, Worker::lose_adapter, lose_after_three).unwrap();
    assert_eq!((seen.counts.done, seen.counts.failed, seen.stopped_by), (FRAMES, 0, None));
    assert!(seen.files == expected.files);
}

#[test]
fn a_batch_stops_with_its_last_device_and_keeps_what_is_done() {
    let Some(seen) = run_list(1, Worker::lose_adapter, lose_after_three) else { return };
    let Counts { done, failed, .. } = seen.counts;
    assert!((3..FRAMES).contains(&done) && failed == 0);
    assert_eq!(seen.files.iter().flatten().count(), done);
    assert!(seen.stopped_by.is_some_and(|why| why.contains("none that is there")));
}
