//! Reads of buffers by threads that share a device.

use std::sync::mpsc::channel;
use std::time::Duration;

use anamorph::internals::gpu::buffers::wait;
use anamorph::internals::gpu::readback::{PendingRead, readback};

use crate::common::projection::gpu;

/// wgpu hands the answers of all reads that are done to whichever thread asks first. Here that thread is slow to pass on
/// the second, and the one that waits for it finds nothing left to wait for.
#[test]
fn a_read_that_another_thread_answers_is_waited_for() {
    let Some(gpu) = gpu() else { return };
    let (slow, read) = (readback(gpu, 4), readback(gpu, 4000));
    let (send, is_held) = channel();
    slow.map_async(wgpu::MapMode::Read, .., move |_| {
        send.send(()).unwrap();
        std::thread::sleep(Duration::from_millis(50));
    });
    let pending = PendingRead::start(&read);
    std::thread::scope(|threads| {
        threads.spawn(|| wait(gpu).unwrap());
        is_held.recv().unwrap();
        wait(gpu).unwrap();
        assert_eq!(pending.words(gpu).unwrap().len(), 1000);
    });
}
