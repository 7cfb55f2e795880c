//! Opening pipes and devices for writing.

use std::fs::File;
use std::io;
use std::path::Path;
use std::time::Duration;

/// How long to wait for a pipe to be opened for reading.
pub const PIPE_WAIT: Duration = Duration::from_secs(10);

/// Opens a pipe or a device for writing. For a pipe, waits until another process opens it for reading, at most for `timeout`.
///
/// # Errors
/// Those of the system, and the timeout.
#[cfg(unix)]
pub fn open(path: &Path, timeout: Duration) -> io::Result<File> {
    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
    use rustix::io::Errno;
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    use std::time::Instant;

    const PAUSE: Duration = Duration::from_millis(20);
    let mut options = File::options();
    options.write(true);
    if !std::fs::metadata(path)?.file_type().is_fifo() {
        return options.open(path);
    }
    // a blocking open would wait forever
    options.custom_flags(OFlags::NONBLOCK.bits() as i32);
    let started = Instant::now();
    loop {
        match options.open(path) {
            Ok(file) => {
                // writes block, as usual
                fcntl_setfl(&file, fcntl_getfl(&file)? - OFlags::NONBLOCK)?;
                return Ok(file);
            }
            Err(e) if e.raw_os_error() != Some(Errno::NXIO.raw_os_error()) => return Err(e),
            Err(_) if started.elapsed() < timeout => std::thread::sleep(PAUSE),
            Err(_) => {
                let why = format!("it is a pipe, and no process opened it to read for {} s", timeout.as_secs_f64());
                return Err(io::Error::other(why));
            }
        }
    }
}

#[cfg(not(unix))]
pub fn open(path: &Path, _: Duration) -> io::Result<File> {
    File::options().write(true).open(path)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::process::Command;

    fn pipe_in(folder: &Path) -> std::path::PathBuf {
        let path = folder.join("pipe");
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    }

    #[test]
    fn opening_a_pipe_without_a_reader_times_out() {
        let dir = tempfile::tempdir().unwrap();
        let path = pipe_in(dir.path());
        let error = open(&path, Duration::from_millis(100)).unwrap_err();
        assert_eq!(error.to_string(), "it is a pipe, and no process opened it to read for 0.1 s");
    }

    #[test]
    fn a_pipe_waits_for_its_reader_and_takes_more_than_its_buffer() {
        let dir = tempfile::tempdir().unwrap();
        let path = pipe_in(dir.path());
        let bytes: Vec<u8> = (0..1 << 20).map(|k: u32| (k % 251) as u8).collect();
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(100));
                let mut file = File::open(&path).unwrap();
                std::thread::sleep(Duration::from_millis(100));
                let mut read = Vec::new();
                file.read_to_end(&mut read).unwrap();
                read
            });
            let mut file = open(&path, PIPE_WAIT).unwrap();
            file.write_all(&bytes).unwrap();
            drop(file);
            assert!(reader.join().unwrap() == bytes);
        });
    }
}
