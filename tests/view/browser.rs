//! Headless Chromium, driven by chromedriver's protocol (WebDriver, W3C).

use crate::needs;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What a page may take to get where a test waits for it: kernels are compiled meanwhile, on machines that do other things too.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Browser {
    driver: Child,
    session: String,
    agent: ureq::Agent,
    /// All that the page said on its console and asked of the network so far.
    pub console: Vec<String>,
    pub requests: Vec<String>,
}

impl Browser {
    /// A window; `None`, as is said, where there is no chromedriver or no Chromium.
    pub fn open() -> Option<Browser> {
        let found = |name: &str| Command::new(name).arg("--version").output().is_ok_and(|ran| ran.status.success());
        if !found("chromedriver") || !found("chromium") {
            needs::skip("no chromium and chromedriver (Debian: apt-get install chromium chromium-driver)");
            return None;
        }
        let mut driver = Command::new("chromedriver");
        driver.args(["--port=0"]).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut driver = driver.spawn().unwrap();
        let mut lines = BufReader::new(driver.stdout.take().unwrap()).lines().map_while(Result::ok);
        let port =
            lines.find_map(|line| Some(line.split_once("successfully on port ")?.1.trim_end_matches('.').to_owned()));
        let port: u16 = port.expect("chromedriver says its port").parse().unwrap();
        // what else it says is read, so that it does not wait
        std::thread::spawn(move || lines.for_each(drop));
        let config = ureq::Agent::config_builder().timeout_global(Some(PATIENCE)).http_status_as_error(false);
        let mut browser = Browser {
            driver,
            session: format!("http://127.0.0.1:{port}/session"),
            agent: config.build().into(),
            console: Vec::new(),
            requests: Vec::new(),
        };
        let arguments =
            ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1500,1000"];
        let options = json!({ "args": arguments, "binary": "/usr/bin/chromium" });
        let options = if Path::new("/usr/bin/chromium").exists() { options } else { json!({ "args": arguments }) };
        let wanted = json!({
            "browserName": "chrome",
            "goog:chromeOptions": options,
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
        });
        let opened = browser.call("POST", "", &json!({ "capabilities": { "alwaysMatch": wanted } }));
        browser.session += &format!("/{}", opened["sessionId"].as_str().expect("a session"));
        Some(browser)
    }

    fn call(&self, method: &str, path: &str, body: &Value) -> Value {
        let url = format!("{}{path}", self.session);
        let answer = match method {
            "POST" => self.agent.post(url).send_json(body),
            "DELETE" => self.agent.delete(url).call(),
            _ => self.agent.get(url).call(),
        };
        let mut answer: Value = answer.expect("chromedriver answers").body_mut().read_json().expect("JSON");
        let value = answer["value"].take();
        assert!(value["error"].is_null(), "{method} {path}: {} {}", value["error"], value["message"]);
        value
    }

    /// Opens a page, and has it show one ray per pixel, as `render` does if it is not told otherwise.
    pub fn go(&self, address: &str) {
        self.call("POST", "/url", &json!({ "url": address }));
        self.wait("state.scene");
        self.run("look({ samples: 1 }); document.getElementById('samples').value = '1'");
    }

    /// What a script returns; it may be a promise.
    pub fn run(&self, script: &str) -> Value {
        self.call("POST", "/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// Waits until an expression of the page is true.
    pub fn wait(&self, expression: &str) {
        let started = Instant::now();
        while self.run(&format!("return Boolean({expression})")) != json!(true) {
            if started.elapsed() > PATIENCE {
                let said = self.run("return [document.getElementById('problem')?.textContent, document.getElementById('connection')?.textContent]");
                panic!("not in time: {expression}; the page says {said}");
            }
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits for the picture at rest of all that was changed so far.
    pub fn rest(&self) {
        self.wait(
            "state.gesture === null && waiting.size === 0 && state.scene?.seq >= state.seq && picture.header?.seq >= state.lookSeq \
             && picture.header.revision === state.scene.revision && picture.header.mime === 'image/png'",
        );
    }

    /// The bytes of the last picture.
    pub fn picture(&self) -> Vec<u8> {
        let text = self.run(
            "let text = ''; for (const byte of picture.bytes) text += String.fromCharCode(byte); return btoa(text)",
        );
        from_base64(text.as_str().unwrap())
    }

    /// Middle of an element on the page, px.
    pub fn middle(&self, selector: &str) -> [f64; 2] {
        let script = format!(
            "const it = document.querySelector({selector:?}); it.scrollIntoView({{ block: 'nearest' }}); \
             const b = it.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]"
        );
        let at = self.run(&script);
        [at[0].as_f64().unwrap(), at[1].as_f64().unwrap()]
    }

    /// A place in the picture on the page, px: shares of its width and height.
    pub fn in_picture(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        let script =
            "const b = document.getElementById('view').getBoundingClientRect(); return [b.x, b.y, b.width, b.height]";
        let script = format!("document.getElementById('view').scrollIntoView({{ block: 'nearest' }}); {script}");
        let view = self.run(&script);
        let number = |k: usize| view[k].as_f64().unwrap();
        [number(0) + a * number(2), number(1) + b * number(3)]
    }

    /// Presses at the first place, moves through the others in some steps, and releases.
    pub fn drag(&self, path: &[[f64; 2]]) {
        let place = |[x, y]: [f64; 2], ms: u32| json!({ "type": "pointerMove", "duration": ms, "x": x.round(), "y": y.round(), "origin": "viewport" });
        let mut actions = vec![place(path[0], 0), json!({ "type": "pointerDown", "button": 0 })];
        for pair in path.windows(2) {
            let step = |k: f64| [0, 1].map(|c| pair[0][c] + (pair[1][c] - pair[0][c]) * k / 6.0);
            actions.extend((1..=6).map(|k| place(step(f64::from(k)), 30)));
        }
        actions.push(json!({ "type": "pointerUp", "button": 0 }));
        let mouse =
            json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions });
        self.call("POST", "/actions", &json!({ "actions": [mouse] }));
    }

    pub fn click(&self, selector: &str) {
        self.drag(&[self.middle(selector)]);
    }

    /// Chooses an option of a select.
    pub fn choose(&self, selector: &str, value: &str) {
        let script = "it.dispatchEvent(new Event('change', { bubbles: true }))";
        self.run(&format!("const it = document.querySelector({selector:?}); it.value = {value:?}; {script}"));
    }

    /// Types keys, one after another; `\u{e014}` and so on are WebDriver's names of keys without characters.
    pub fn keys(&self, keys: &str) {
        let actions =
            keys.chars().flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })));
        let keyboard = json!({ "type": "key", "id": "keys", "actions": actions.collect::<Vec<_>>() });
        self.call("POST", "/actions", &json!({ "actions": [keyboard] }));
    }

    /// A command of Chromium's own protocol.
    pub fn chromium(&self, command: &str, parameters: Value) -> Value {
        self.call("POST", "/goog/cdp/execute", &json!({ "cmd": command, "params": parameters }))
    }

    /// Writes what is seen to a PNG below the folder for tests.
    pub fn screenshot(&self, name: &str) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("view");
        std::fs::create_dir_all(&folder).unwrap();
        let png = self.call("GET", "/screenshot", &Value::Null);
        std::fs::write(folder.join(format!("{name}.png")), from_base64(png.as_str().unwrap())).unwrap();
    }

    /// Reads the page's console and its requests since the last call.
    pub fn read_logs(&mut self) {
        let messages = self.call("POST", "/se/log", &json!({ "type": "browser" }));
        self.console.extend(messages.as_array().unwrap().iter().map(|m| m["message"].as_str().unwrap().to_owned()));
        let events = self.call("POST", "/se/log", &json!({ "type": "performance" }));
        for event in events.as_array().unwrap() {
            let message: Value = serde_json::from_str(event["message"].as_str().unwrap()).unwrap();
            let own = &message["message"];
            let url = match own["method"].as_str() {
                Some("Network.requestWillBeSent") => &own["params"]["request"]["url"],
                Some("Network.webSocketCreated") => &own["params"]["url"],
                _ => continue,
            };
            self.requests.push(url.as_str().unwrap().to_owned());
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.call("DELETE", "", &Value::Null);
        }
        // chromedriver ends its browser too
        let _ = self.agent.get(self.session.split("/session").next().unwrap().to_owned() + "/shutdown").call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

fn from_base64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> =
        text.bytes().filter(|c| *c != b'=' && !c.is_ascii_whitespace()).map(|c| value(c).into()).collect();
    digits
        .chunks(4)
        .flat_map(|four| {
            let bits = four.iter().fold(0, |all, digit| all << 6 | digit) << (6 * (4 - four.len()));
            bits.to_be_bytes()[1..four.len()].to_vec()
        })
        .collect()
}
