//! What the server takes and refuses, without a browser.

use crate::needs;
use crate::rng::Rng;
use crate::viewed::{TOKEN, Viewed};
use serde_json::{Value, json};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket, connect};

/// The longest that a page is waited for on a busy machine.
const SERVED: Duration = Duration::from_secs(60);
/// The server's time-out of headers, 5 s, and 25 s for a busy machine.
const CLOSED: Duration = Duration::from_secs(30);

const PINHOLE: &str = "kind = \"pinhole\"\neye = [60, 45, 60]\ntarget = [0, 0, 0]\nvfov = 45";

/// A page's side of a connection.
pub struct Page {
    socket: WebSocket<MaybeTlsStream<std::net::TcpStream>>,
    seq: u64,
    /// Of the last change of what is shown.
    look_seq: u64,
    pub scene: Value,
    pub last: Value,
    /// Why messages were refused.
    pub refused: Vec<String>,
}

impl Page {
    pub fn open(viewed: &Viewed) -> Page {
        let url = format!("ws://127.0.0.1:{}/socket?token={TOKEN}", viewed.port());
        let (socket, _) = connect(url).unwrap();
        Page { socket, seq: 0, look_seq: 0, scene: Value::Null, last: Value::Null, refused: Vec::new() }
    }

    pub fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// Sends a request with a number.
    pub fn ask(&mut self, mut request: Value) {
        self.seq += 1;
        request["seq"] = self.seq.into();
        self.look_seq = if request["do"] == "look" { self.seq } else { self.look_seq };
        self.send(&request.to_string());
    }

    pub fn edit(&mut self, path: &str, value: Value, gesture: Option<u64>) {
        self.ask(json!({ "do": "edit", "edits": [{ "path": path, "value": value }], "gesture": gesture }));
    }

    /// Takes one message, waiting up to so long; whether there was one.
    pub fn take(&mut self, wait: Duration) -> bool {
        if let MaybeTlsStream::Plain(stream) = self.socket.get_ref() {
            stream.set_read_timeout(Some(wait.max(Duration::from_millis(1)))).unwrap();
        }
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                match message["is"].as_str().unwrap() {
                    "scene" => self.scene = message,
                    "refused" => self.refused.push(message["why"].as_str().unwrap().to_owned()),
                    _ => {}
                }
            }
            Ok(Message::Binary(bytes)) => {
                let size = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
                self.last = serde_json::from_slice(&bytes[4..4 + size]).unwrap();
                self.send(&json!({ "do": "drawn", "id": self.last["id"] }).to_string());
            }
            Ok(_) => {}
            Err(tungstenite::Error::Io(e))
                if matches!(e.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut) =>
            {
                return false;
            }
            Err(e) => panic!("{e}"),
        }
        true
    }

    /// Waits for the next refusal, and returns why.
    #[cfg(target_os = "linux")]
    fn refusal(&mut self) -> String {
        let (started, before) = (Instant::now(), self.refused.len());
        while self.refused.len() == before {
            assert!(started.elapsed() < SERVED, "nothing was refused");
            self.take(Duration::from_millis(100));
        }
        self.refused[before].clone()
    }

    /// Waits for the picture at rest of all that was asked for.
    pub fn rest(&mut self) {
        let started = Instant::now();
        let is_at_rest = |page: &Page| {
            page.last["revision"] == page.scene["revision"]
                && page.last["mime"] == "image/png"
                && page.last["seq"].as_u64() >= Some(page.look_seq)
                && page.scene["seq"].as_u64() >= Some(page.seq)
                && page.scene["seq"].as_u64() >= Some(page.seq)
        };
        while !is_at_rest(self) {
            assert!(started.elapsed() < Duration::from_secs(120), "{} {}", self.last, self.scene["problem"]);
            self.take(Duration::from_millis(100));
        }
    }
}

fn viewed() -> Option<Viewed> {
    needs::adapter()?;
    Some(Viewed::city(PINHOLE))
}

#[test]
fn wrong_tokens_hosts_and_origins_are_refused() {
    let Some(mut viewed) = viewed() else { return };
    let port = viewed.port().to_owned();
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let get = |path: &str, headers: &[(&str, &str)]| {
        let request = agent.get(format!("http://127.0.0.1:{port}{path}"));
        headers.iter().fold(request, |request, (name, value)| request.header(*name, *value)).call().unwrap()
    };
    let page = format!("/?token={TOKEN}");
    for k in 0..1000 {
        let wrong = format!("/?token={}{k}", &TOKEN[..TOKEN.len() - 1]);
        assert_eq!(get(&wrong, &[]).status(), 403);
    }
    for (path, headers, status) in [
        (page.as_str(), [("host", format!("127.0.0.1:{port}"))], 200),
        (&page, [("host", "localhost:9999".into())], 200),
        (&page, [("host", "evil.example".into())], 403),
        (&page, [("host", format!("localhost.evil.example:{port}"))], 403),
        (&page, [("origin", "http://evil.example".into())], 403),
        (&page, [("origin", "null".into())], 403),
        (&page, [("origin", format!("https://127.0.0.1:{port}"))], 403),
        (&page, [("origin", format!("http://127.0.0.1:{port}"))], 200),
        ("/", [("accept", "*/*".into())], 403),
        ("/?token=", [("accept", "*/*".into())], 403),
        ("/other", [("accept", "*/*".into())], 404),
        ("/../../etc/passwd", [("accept", "*/*".into())], 404),
    ] {
        let headers: Vec<(&str, &str)> = headers.iter().map(|(name, value)| (*name, value.as_str())).collect();
        assert_eq!(get(path, &headers).status(), status, "{path} {headers:?}");
    }
    let policy = get(&page, &[]);
    let policy = policy.headers()["content-security-policy"].to_str().unwrap();
    assert!(
        policy.starts_with("default-src 'none'; script-src 'nonce-") && policy.contains("connect-src 'self'"),
        "{policy}"
    );
    // sockets
    for (token, origin) in [("wrong", None), ("", None), (TOKEN, Some("http://evil.example")), (TOKEN, Some("null"))] {
        let mut request = format!("ws://127.0.0.1:{port}/socket?token={token}").into_client_request().unwrap();
        if let Some(origin) = origin {
            request.headers_mut().insert("origin", origin.parse().unwrap());
        }
        match connect(request) {
            Err(tungstenite::Error::Http(response)) => assert_eq!(response.status(), 403, "{token} {origin:?}"),
            other => panic!("{token} {origin:?}: {other:?}"),
        }
    }
    assert!(viewed.is_running());
    Page::open(&viewed).rest();
}

#[test]
fn malformed_messages_are_refused_without_harm() {
    let Some(mut viewed) = viewed() else { return };
    let mut page = Page::open(&viewed);
    page.rest();
    let before = page.scene["text"].clone();
    let wrong = [
        "",
        "x",
        "{",
        "[]",
        "null",
        "{\"do\":\"no\"}",
        "{\"do\":\"edit\"}",
        "{\"do\":\"frame\",\"frame\":1e999,\"playing\":false,\"seq\":0}",
        "{\"do\":\"pixel\",\"x\":-1,\"y\":0,\"tag\":1}",
        "{\"do\":\"look\",\"look\":{\"samples\":0},\"seq\":0}",
        "{\"do\":\"look\",\"look\":{\"shown\":\"x\"},\"seq\":0}",
        "{\"do\":\"look\",\"look\":{\"beside\":\"x\"},\"seq\":0}",
        "{\"do\":\"edit\",\"edits\":[{\"path\":\"\",\"value\":1}],\"gesture\":null,\"seq\":0}",
        "{\"do\":\"edit\",\"edits\":[{\"path\":\"camera..eye\",\"value\":1}],\"gesture\":null,\"seq\":0}",
        "{\"do\":\"edit\",\"edits\":[{\"path\":\"camera.eye.7\",\"value\":1}],\"gesture\":null,\"seq\":0}",
        "{\"do\":\"edit\",\"edits\":[{\"path\":\"mesh.9.scale\",\"value\":1}],\"gesture\":null,\"seq\":0}",
        "{\"do\":\"edit\",\"edits\":[{\"path\":\"camera.none\",\"value\":null}],\"gesture\":null,\"seq\":0}",
        "{\"do\":\"undo\",\"seq\":0,\"more\":2}",
        "{\"do\":\"offsets\",\"seq\":0}",
        "\u{0}\u{1}",
    ];
    let mut sent = 0;
    while sent < 1000 {
        for text in wrong {
            page.send(text);
            sent += 1;
        }
        page.socket.send(Message::binary(vec![0, 159, 146, 150])).unwrap();
        sent += 1;
        while page.take(Duration::from_millis(1)) {}
    }
    let started = Instant::now();
    while page.refused.len() < sent && started.elapsed() < Duration::from_secs(30) {
        page.take(Duration::from_millis(100));
    }
    assert_eq!(page.refused.len(), sent, "each is refused once");
    assert_eq!(page.scene["text"], before);
    // a message that is too long ends the connection, and no other
    let mut other = Page::open(&viewed);
    let _broken_pipe = other.socket.send(Message::text("x".repeat(8 << 20)));
    let ended = (0..1000).any(|_| matches!(other.socket.read(), Err(e) if !matches!(&e, tungstenite::Error::Io(e) if e.kind() == std::io::ErrorKind::WouldBlock)));
    assert!(ended);
    page.edit("camera.vfov", json!(50), None);
    page.rest();
    assert!(viewed.is_running() && page.scene["text"].as_str().unwrap().contains("vfov = 50"));
}

#[test]
fn wrong_scenes_say_why_and_keep_the_picture() {
    let Some(viewed) = viewed() else { return };
    let mut page = Page::open(&viewed);
    page.rest();
    let right = page.scene["text"].as_str().unwrap().to_owned();
    for (text, why) in [
        (right.replace("vfov = 45", "vfov = 450"), "must lie between 0 and 180"),
        (right.replace("vfov", "vfof"), "nearest known key: \"vfov\""),
        (right.replace("[camera]", "[camera"), "not valid TOML"),
        (right.replace("builtin = \"city\"\ntriangles = 15000", "file = \"none.obj\""), "none.obj"),
        (right.replace("width = 320", "width = 65536").replace("height = 240", "height = 65536"), "65536"),
        (String::new(), "there is no camera"),
    ] {
        page.ask(json!({ "do": "text", "text": text }));
        let started = Instant::now();
        while !page.scene["problem"].as_str().is_some_and(|p| p.contains(why)) {
            assert!(started.elapsed() < Duration::from_secs(60), "{why}: {}", page.scene["problem"]);
            page.take(Duration::from_millis(100));
        }
    }
    page.ask(json!({ "do": "text", "text": right }));
    page.rest();
    assert_eq!(page.scene["problem"], Value::Null);
    for _ in 0..6 {
        page.ask(json!({ "do": "undo" }));
    }
    page.ask(json!({ "do": "redo" }));
    page.ask(json!({ "do": "undo" }));
    page.ask(json!({ "do": "undo" }));
    page.rest();
    assert_eq!((page.scene["undo"].clone(), page.scene["saved"].clone()), (json!(false), json!(true)));
    assert_eq!(page.scene["text"], json!(right));
}

/// Random input: orbits, sliders, frames, channels, regions, undo. `ANAMORPH_VIEW_EVENTS` says how many.
#[test]
fn random_input_leaves_the_newest_picture_and_no_memory() {
    if needs::adapter().is_none() {
        return;
    }
    let events: u64 = std::env::var("ANAMORPH_VIEW_EVENTS").map_or(300, |text| text.parse().unwrap());
    let minutes: f64 = std::env::var("ANAMORPH_VIEW_MINUTES").map_or(0.0, |text| text.parse().unwrap());
    let camera = "kind = \"top_down\"\neye = [60, 45, 60]\ntarget = [0, 0, 0]\nvfov = [{ frame = 0, value = 40 }, { frame = 24, value = 50 }]\nregions = []";
    let mut viewed = Viewed::city(camera);
    let mut page = Page::open(&viewed);
    page.ask(json!({ "do": "look", "look": { "volume": true } }));
    page.rest();
    let mut rng = Rng(7);
    // all kernels that it takes
    let all = ["color", "depth", "triangle", "object", "piece", "normal", "certified"];
    for regions in [json!([{ "rect": [0.3, 0.3, 0.5, 0.5], "eye": [50, 60, 50] }]), json!([])] {
        page.edit("camera.regions", regions, None);
        for (shown, samples) in all.into_iter().flat_map(|shown| [(shown, 1), (shown, 4)]) {
            page.ask(json!({ "do": "look", "look": { "volume": true, "shown": shown, "samples": samples } }));
            page.rest();
        }
    }
    let (started, mut memory) = (Instant::now(), vec![viewed.memory()]);
    let mut gesture = 0;
    for event in 0..events {
        let real = |rng: &mut Rng, lo: f64, hi: f64| lo + (hi - lo) * rng.unit();
        match rng.below(20) {
            0..=8 => {
                let eye: Vec<f64> =
                    [(30., 80.), (20., 60.), (30., 80.)].map(|(lo, hi)| real(&mut rng, lo, hi)).to_vec();
                page.edit("camera.eye", json!(eye), Some(gesture));
            }
            9..=11 => {
                let vfov = real(&mut rng, 10.0, 100.0);
                page.edit("camera.vfov", json!(vfov), Some(gesture));
            }
            12 => {
                gesture += 1;
                page.ask(json!({ "do": "rest" }));
            }
            13 => page.ask(json!({ "do": "frame", "frame": rng.below(24), "playing": rng.below(2) == 0 })),
            14 => {
                let shown = all[rng.below(all.len())];
                let samples = [1, 4][rng.below(2)];
                page.ask(json!({ "do": "look", "look": { "volume": true, "shown": shown, "samples": samples } }));
            }
            15 => page.ask(json!({ "do": "undo" })),
            16 => page.ask(json!({ "do": "redo" })),
            17 => {
                let (a, b) = (real(&mut rng, 0.15, 0.6), real(&mut rng, 0.15, 0.6));
                let region = json!([{ "rect": [a, b, a + 0.2, b + 0.2], "eye": [50, 60, 50] }]);
                page.edit("camera.regions", region, None);
            }
            18 => page.edit("camera.regions", json!([]), None),
            _ => {
                page.send(&json!({ "do": "pixel", "x": rng.below(320), "y": rng.below(240), "tag": event }).to_string())
            }
        }
        let pause = Duration::from_secs_f64(minutes * 60.0 / events as f64).max(Duration::from_millis(3));
        let until = Instant::now() + pause;
        while Instant::now() < until {
            page.take(until.saturating_duration_since(Instant::now()));
        }
        assert!(viewed.is_running(), "after {event} events");
        if (event + 1) % (events / 4).max(1) == 0 {
            memory.push(viewed.memory());
        }
    }
    page.ask(json!({ "do": "look", "look": { "volume": true } }));
    page.edit("camera.eye", json!([60, 45, 60]), None);
    page.rest();
    assert!(page.refused.iter().all(|why| why.contains("too many pixels")), "{:?}", page.refused);
    let (seconds, mib) =
        (started.elapsed().as_secs_f64(), memory.iter().map(|bytes| bytes >> 20).collect::<Vec<u64>>());
    eprintln!("{events} events in {seconds:.0} s; memory before, and after each quarter, MiB: {mib:?}");
    // undo keeps up to 32 MiB of texts; early on there are kernels to compile, and a copy of the scene for moving pictures: some 40 MiB
    let (from, most) = if events >= 1000 { (memory[2], 32 << 20) } else { (memory[0], 96 << 20) };
    assert!(memory[4] < from + most, "memory grew from {from} to {} bytes", memory[4]);
}

/// Half a header of a request, which then waits.
fn half_request(port: &str) -> TcpStream {
    let mut stream = TcpStream::connect(format!("127.0.0.1:{port}")).unwrap();
    stream.write_all(format!("GET /?token={TOKEN} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n").as_bytes()).unwrap();
    stream
}

#[test]
fn connections_that_wait_keep_no_page_out_and_are_closed() {
    let Some(mut viewed) = viewed() else { return };
    let port = viewed.port().to_owned();
    let mut page = Page::open(&viewed);
    page.rest();
    // far more than are kept open, in one process as in several
    let mut waiting: Vec<TcpStream> = (0..300).map(|_| half_request(&port)).collect();
    let started = Instant::now();
    let agent: ureq::Agent = ureq::Agent::config_builder().timeout_global(Some(SERVED)).build().into();
    let got = agent.get(format!("http://127.0.0.1:{port}/?token={TOKEN}")).call().unwrap();
    assert_eq!(got.status(), 200);
    assert!(started.elapsed() < SERVED, "{:?}", started.elapsed());
    // the page that was there before, and a new one
    page.edit("camera.vfov", json!(50), None);
    page.rest();
    Page::open(&viewed).rest();
    // the first of them were closed for newer ones, the last one by the time-out of headers
    for stream in [waiting.remove(0), waiting.pop().unwrap()] {
        let mut stream = stream;
        stream.set_read_timeout(Some(CLOSED)).unwrap();
        let ended = stream.read_to_end(&mut Vec::new());
        let is_open = |e: &std::io::Error| matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut);
        assert!(ended.as_ref().err().is_none_or(|e| !is_open(e)), "{ended:?}");
    }
    assert!(viewed.is_running());
}

/// A server that may open no more files says so when a scene is saved, and loses nothing.
#[cfg(target_os = "linux")]
#[test]
fn saving_at_the_limit_of_open_files_says_so() {
    let Some(viewed) = viewed() else { return };
    let mut page = Page::open(&viewed);
    page.rest();
    page.edit("camera.vfov", json!(50), None);
    page.rest();
    let before = viewed.text();
    viewed.limit_open_files();
    page.send(&json!({ "do": "save" }).to_string());
    let why = page.refusal();
    assert!(why.contains("Too many open files") && why.contains("nothing is saved"), "{why}");
    assert_eq!(viewed.text(), before);
}
