//! A scene that `anamorph view` serves.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use tempfile::TempDir;

pub const TOKEN: &str = "a-token-for-tests";

pub struct Viewed {
    pub dir: TempDir,
    pub address: String,
    server: Child,
}

/// A city of 15,000 triangles.
pub const CITY: &str = r#"# a city
[image]
width = 320
height = 240

[[mesh]]
builtin = "city"
triangles = 15000

[camera]
"#;

fn program(folder: &Path) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_anamorph"));
    program.current_dir(folder);
    program
}

impl Viewed {
    /// A folder with `scene.toml`, viewed.
    pub fn new(scene: &str) -> Viewed {
        Viewed::with_file(scene, "other.txt", b"")
    }

    /// The same with another file in the folder.
    pub fn with_file(scene: &str, name: &str, content: &[u8]) -> Viewed {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join(name), content).unwrap();
        std::fs::write(dir.path().join("scene.toml"), scene).unwrap();
        let (server, address) = start(dir.path(), "0");
        Viewed { dir, address, server }
    }

    /// Of a city through a camera.
    pub fn city(camera: &str) -> Viewed {
        Viewed::new(&format!("{CITY}{camera}\n"))
    }

    pub fn port(&self) -> &str {
        self.address.split([':', '/']).nth(4).unwrap()
    }

    pub fn kill(&mut self) {
        self.server.kill().unwrap();
        self.server.wait().unwrap();
    }

    /// Starts the server anew at the same address, after it was killed.
    pub fn restart(&mut self) {
        let port = self.port().to_owned();
        (self.server, self.address) = start(self.dir.path(), &port);
    }

    pub fn is_running(&mut self) -> bool {
        self.server.try_wait().unwrap().is_none()
    }

    /// Lets the server open no more files than it has open.
    #[cfg(target_os = "linux")]
    pub fn limit_open_files(&self) {
        // standard input, output and error have the numbers below 3, and all higher ones are refused
        let limits = ["--pid", &self.server.id().to_string(), "--nofile=3:3"];
        assert!(Command::new("prlimit").args(limits).status().unwrap().success());
    }

    /// Bytes of memory that the server has, not shared.
    pub fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.server.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024
    }

    /// The file that `view` was given.
    pub fn text(&self) -> String {
        std::fs::read_to_string(self.dir.path().join("scene.toml")).unwrap()
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &[&str]) -> Output {
        program(self.dir.path()).args(arguments).output().unwrap()
    }

    /// What `render` writes of some text of a scene.
    pub fn rendered(&self, scene: &str, more: &[&str]) -> Vec<u8> {
        std::fs::write(self.dir.path().join("same.toml"), scene).unwrap();
        let ran = self.run(&[&["render", "same.toml", "-o", "same.png"], more].concat());
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        std::fs::read(self.dir.path().join("same.png")).unwrap()
    }
}

fn start(folder: &Path, port: &str) -> (Child, String) {
    let mut server = program(folder);
    server.args(["view", "scene.toml", "--port", port, "--token", TOKEN]).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut server = server.spawn().unwrap();
    let mut line = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
    if line.is_empty() {
        let mut why = String::new();
        server.stderr.take().unwrap().read_to_string(&mut why).unwrap();
        panic!("no address: {why}");
    }
    (server, line.trim().to_owned())
}

impl Drop for Viewed {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
