//! The page in a browser: what one sees and does.

use crate::browser::Browser;
use crate::needs;
use crate::viewed::{CITY, Viewed};
use serde_json::{Value, json};

pub const PINHOLE: &str = "kind = \"pinhole\" # the simplest\neye = [60, 45, 60]\ntarget = [0, 0, 0]\nvfov = 45";

/// A scene and a window that shows it at rest.
pub fn open(scene: &str) -> Option<(Viewed, Browser)> {
    needs::adapter()?;
    let browser = Browser::open()?;
    let viewed = Viewed::new(scene);
    browser.go(&viewed.address);
    browser.rest();
    Some((viewed, browser))
}

/// The text of the scene as the page shows it.
pub fn text(browser: &Browser) -> String {
    browser.run("return state.scene.text").as_str().unwrap().to_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

/// Nothing on the console, and no request to others; at the end of a test.
pub fn is_quiet(viewed: &Viewed, browser: &mut Browser) {
    browser.read_logs();
    let said: Vec<&String> = browser.console.iter().filter(|line| !line.contains("WebSocket connection")).collect();
    assert!(said.is_empty(), "{said:?}");
    let own = |url: &&String| {
        let here = [&viewed.address, &viewed.address.replace("http:", "ws:").replace("/?", "/socket?")];
        here.contains(url) || url.starts_with("data:") || url.starts_with("blob:")
    };
    let others: Vec<&String> = browser.requests.iter().filter(|url| !own(url)).collect();
    assert!(others.is_empty() && !browser.requests.is_empty(), "{others:?}");
}

#[test]
fn the_picture_at_rest_is_what_render_writes() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    assert!(browser.picture() == viewed.rendered(&viewed.text(), &[]));
    browser.screenshot("start");
    // orbiting: smaller or coarser pictures meanwhile, all of the newest state, and the picture at rest after it
    browser.run(
        "window.seen = []; on('picture', (h) => seen.push([h.quality, h.revision, h.seq, state.seq, performance.now()])); \
         window.released = null; document.getElementById('view').addEventListener('pointerup', () => (released = performance.now()))",
    );
    let before = text(&browser);
    browser.drag(&[[0.5, 0.5], [0.7, 0.45], [0.6, 0.6]].map(|at| browser.in_picture(at)));
    browser.rest();
    let after = text(&browser);
    assert!(after != before && after.contains("kind = \"pinhole\" # the simplest"), "{after}");
    assert!(browser.picture() == viewed.rendered(&after, &[]));
    let seen = browser.run("return seen");
    let seen = seen.as_array().unwrap();
    assert!(seen.iter().any(|picture| picture[0] == "moving"), "{seen:?}");
    let revisions: Vec<u64> = seen.iter().map(|picture| picture[1].as_u64().unwrap()).collect();
    assert!(revisions.is_sorted(), "{revisions:?}");
    // several samples
    browser.choose("#samples", "4");
    browser.wait("picture.header.quality === 'rest'");
    assert!(browser.picture() == viewed.rendered(&after, &["--samples", "4"]));
    browser.choose("#samples", "1");
    // one gesture is undone at once
    browser.click("#undo");
    browser.rest();
    assert_eq!(text(&browser), before);
    browser.click("#redo");
    browser.rest();
    assert_eq!(text(&browser), after);
    is_quiet(&viewed, &mut browser);
}

#[test]
fn keys_alone_suffice() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    let focus = |browser: &Browser, selector: &str| {
        for _ in 0..120 {
            browser.keys("\u{e004}");
            if browser.run(&format!("return document.activeElement.matches({selector:?})")) == json!(true) {
                return;
            }
        }
        panic!("Tab does not lead to {selector}");
    };
    focus(&browser, "#view");
    let eye = |browser: &Browser| number(&browser.run("return state.values.camera.eye[0]"));
    let before = eye(&browser);
    browser.keys("\u{e012}\u{e012}");
    browser.rest();
    assert_ne!(eye(&browser), before, "arrow keys orbit");
    let at = browser.run("return state.values.camera.eye");
    browser.keys("+");
    browser.rest();
    let distance = |v: &Value| (0..3).map(|k| number(&v[k]).powi(2)).sum::<f64>().sqrt();
    assert!(distance(&browser.run("return state.values.camera.eye")) < 0.95 * distance(&at), "plus comes closer");
    // a handle of the volume
    focus(&browser, "#handles .handle");
    let before = text(&browser);
    browser.keys("\u{e014}");
    browser.rest();
    assert_ne!(text(&browser), before);
    // tabs, and a slider
    focus(&browser, "#tab-controls");
    browser.keys("\u{e014}");
    assert_eq!(browser.run("return document.getElementById('pixel').hidden"), json!(false));
    browser.keys("\u{e012}");
    focus(&browser, "[data-path='camera.vfov']");
    browser.keys("\u{e014}");
    browser.rest();
    assert!(number(&browser.run("return state.values.camera.vfov")) > 45.0);
    assert_eq!(browser.run("return document.activeElement.dataset.path"), json!("camera.vfov"), "the focus stays");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn controls_change_the_scene_and_its_text() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    // a slider by the mouse
    let [x, y] = browser.middle("[data-path='camera.vfov']");
    browser.drag(&[[x - 20.0, y], [x, y], [x + 10.0, y]]);
    browser.rest();
    let vfov = number(&browser.run("return state.values.camera.vfov"));
    assert!((80.0..110.0).contains(&vfov), "{vfov}");
    assert!(browser.picture() == viewed.rendered(&text(&browser), &[]));
    // a key that is not there yet, in another section; a choice; a light
    browser.run("document.querySelectorAll('#controls details').forEach((d) => (d.open = true))");
    browser.choose("[aria-label='Key to add to image']", "tone");
    browser.click("[aria-label='Add the key to image']");
    browser.rest();
    browser.choose("[data-path='image.tone']", "aces");
    browser.rest();
    browser
        .run("[...document.querySelectorAll('#controls button')].find((b) => b.textContent === 'Add a light').click()");
    browser.rest();
    let after = text(&browser);
    assert!(after.contains("tone = \"aces\"") && after.contains("direction = [-1, -2, -1]"), "{after}");
    assert!(browser.picture() == viewed.rendered(&after, &[]));
    // the text by hand: a mistake says where it is, and what was seen stays
    browser.click("#tab-text");
    browser.run("const t = document.getElementById('scene-text'); t.value = t.value.replace('vfov', 'vfof'); t.dispatchEvent(new Event('input'))");
    browser.click("#apply-text");
    browser.wait("!document.getElementById('problem').hidden");
    let problem = browser.run("return document.getElementById('problem').textContent");
    assert!(problem.as_str().unwrap().contains("nearest known key: \"vfov\""), "{problem}");
    browser.click("#undo");
    browser.rest();
    browser.wait("document.getElementById('problem').hidden");
    // the command line that renders the same
    browser.click("#copy-command");
    browser.wait("document.getElementById('command-text').value !== ''");
    let command = browser.run("return document.getElementById('command-text').value");
    let shell = command.as_str().unwrap().replacen("anamorph", env!("CARGO_BIN_EXE_anamorph"), 1);
    let ran = std::process::Command::new("sh").args(["-c", &shell]).current_dir(viewed.dir.path()).output().unwrap();
    assert!(ran.status.success(), "{shell}: {}", String::from_utf8_lossy(&ran.stderr));
    assert!(std::fs::read(viewed.dir.path().join("scene.png")).unwrap() == browser.picture(), "{shell}");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn a_pixel_is_explained_as_render_does() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    browser.choose("#tool", "inspect");
    browser.drag(&[browser.in_picture([0.5003, 0.5004])]);
    browser.wait("document.getElementById('pixel-text').textContent !== ''");
    let (shown, names) = (
        browser.run("return document.getElementById('pixel-text').textContent"),
        browser.run("return document.getElementById('pixel-names').textContent"),
    );
    let shown = shown.as_str().unwrap();
    let pixel = shown.lines().next().unwrap().trim_start_matches("pixel ");
    // pointers stand on whole pixels of the page
    assert!(["159,119", "159,120", "160,119", "160,120"].contains(&pixel), "{pixel}");
    let ran = viewed.run(&["render", "scene.toml", "--pixel", pixel]);
    assert_eq!(shown, String::from_utf8_lossy(&ran.stdout).trim_end());
    assert!(shown.contains("hit: triangle") && names.as_str().unwrap().contains("object: city"), "{names}");
    browser.screenshot("pixel");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn channels_are_shown_and_compared() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    for (shown, legend) in [
        ("depth", "world units"),
        ("normal", ""),
        ("triangle", ""),
        ("object", "city"),
        ("material", ""),
        ("piece", ""),
        ("certified", "proven in f32"),
        ("overdraw", "surfaces along the ray"),
    ] {
        let before = browser.picture();
        browser.choose("#shown", shown);
        browser.rest();
        assert!(browser.picture() != before, "{shown}");
        let seen = browser.run("return document.getElementById('legend').textContent");
        assert!(seen.as_str().unwrap().contains(legend), "{shown}: {seen}");
        browser.screenshot(&format!("shown-{shown}"));
    }
    browser.choose("#shown", "color");
    browser.choose("#beside", "reference");
    browser.wait("picture.beside && picture.beside.revision === state.scene.revision && !document.getElementById('other').hidden");
    // colours are rounded to 8 bits from values that differ in their last places
    let differ = browser.run(
        "const of = (id) => { const c = document.getElementById(id); const o = new OffscreenCanvas(c.width, c.height).getContext('2d', { willReadFrequently: true }); \
         o.drawImage(c, 0, 0); return o.getImageData(0, 0, c.width, c.height).data }; \
         const [a, b] = [of('picture'), of('other')]; return a.reduce((n, x, k) => n + (Math.abs(x - b[k]) > 1 ? 1 : 0), 0) / a.length",
    );
    assert!(number(&differ) < 0.002, "{differ}");
    browser.screenshot("beside");
    browser.choose("#beside", "");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn what_is_saved_is_there_again_and_two_pages_watch_one_scene() {
    let Some((mut viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    let second = Browser::open().unwrap();
    second.go(&viewed.address);
    second.rest();
    browser.run("edit([['camera.vfov', 61.5]])");
    browser.rest();
    second.wait("state.values.camera.vfov === 61.5 && state.scene.text.includes('61.5')");
    second.rest();
    assert!(second.picture() == browser.picture());
    drop(second);
    assert!(!viewed.text().contains("61.5"));
    browser.click("#save");
    browser.wait("state.scene.saved");
    assert_eq!(viewed.text(), text(&browser));
    browser.go(&viewed.address);
    browser.rest();
    assert!(text(&browser).contains("vfov = 61.5"));
    // another program changes the file: it is not overwritten
    std::fs::write(viewed.dir.path().join("scene.toml"), viewed.text() + "# by hand\n").unwrap();
    browser.run("edit([['camera.vfov', 62]])");
    browser.rest();
    browser.click("#save");
    browser.wait("document.getElementById('problem').textContent.includes('another program has changed')");
    assert!(viewed.text().ends_with("# by hand\n") && viewed.text().contains("61.5"));
    // the server ends; the page finds the next one, which does not know what was not saved
    viewed.kill();
    browser.wait("document.getElementById('connection').textContent.includes('lost')");
    viewed.restart();
    browser.wait("document.getElementById('connection').textContent === 'connected'");
    browser.wait("document.getElementById('scene-text').value.includes('vfov = 62') && !document.getElementById('apply-text').disabled");
    browser.click("#apply-text");
    browser.rest();
    assert!(text(&browser).contains("vfov = 62"));
    browser.console.clear();
    browser.read_logs();
    let said: Vec<&String> = browser.console.iter().filter(|line| !line.contains("WebSocket connection to")).collect();
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn keyframes_play_and_get_keys() {
    let camera = "kind = \"pinhole\"\neye = [{ frame = 0, value = [60, 45, 60] }, { frame = 12, value = [70, 45, 50] }]\ntarget = [0, 0, 0]\nvfov = 45";
    let Some((viewed, mut browser)) = open(&format!("{CITY}{camera}\n")) else { return };
    assert_eq!(browser.run("return document.getElementById('timeline').hidden"), json!(false));
    browser.click("#play");
    browser.wait("playing === null && state.scene.frame === 12");
    browser.rest();
    assert!(browser.picture() == viewed.rendered(&viewed.text(), &["--frame", "12"]));
    browser.run("showFrame(6, false)");
    browser.wait("state.scene.frame === 6");
    browser.run("edit([['camera.eye', [50, 50, 50]]])");
    browser.rest();
    let after = text(&browser);
    assert!(after.replace(' ', "").contains("{frame=6,value=[50,50,50]}"), "{after}");
    assert!(browser.picture() == viewed.rendered(&after, &["--frame", "6"]));
    is_quiet(&viewed, &mut browser);
}

#[test]
fn it_is_readable_in_light_and_dark() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    for scheme in ["light", "dark"] {
        let feature = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        browser.chromium("Emulation.setEmulatedMedia", feature);
        // WCAG 2.1: at least 4.5 between text and what is behind it
        let contrasts = browser.run(
            "const light = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).slice(0, 3).map((x) => x / 255).map((x) => x <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b }; \
             const behind = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor; if (!c.endsWith(', 0)') && c !== 'transparent') return c } return 'rgb(255, 255, 255)' }; \
             const shown = [...document.querySelectorAll('body *')].filter((e) => e.checkVisibility() && !e.disabled && !e.closest('svg') && [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim())); \
             return shown.map((e) => { const [a, b] = [light(getComputedStyle(e).color), light(behind(e))]; return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e.textContent.slice(0, 30)] })",
        );
        let contrasts = contrasts.as_array().unwrap();
        let poor: Vec<&Value> = contrasts.iter().filter(|c| number(&c[0]) < 4.5).collect();
        assert!(poor.is_empty() && contrasts.len() > 20, "{scheme}: {poor:?}");
        browser.screenshot(scheme);
    }
    // a narrow window has the same, one below another, and nothing to scroll to the side
    browser.chromium(
        "Emulation.setDeviceMetricsOverride",
        json!({ "width": 420, "height": 900, "deviceScaleFactor": 1, "mobile": true }),
    );
    assert_eq!(browser.run("return document.documentElement.scrollWidth <= innerWidth"), json!(true));
    browser.screenshot("narrow");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn touch_turns_and_pinches() {
    let Some((viewed, mut browser)) = open(&format!("{CITY}{PINHOLE}\n")) else { return };
    let touch = |kind: &str, points: &[[f64; 2]]| {
        let points: Vec<Value> =
            points.iter().enumerate().map(|(id, [x, y])| json!({ "x": x, "y": y, "id": id })).collect();
        browser.chromium("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }));
    };
    let distance = || number(&browser.run("return length(sub(state.values.camera.eye, state.values.camera.target))"));
    let (middle, before) = (browser.in_picture([0.5, 0.5]), distance());
    let at = |dx: f64| [middle[0] + dx, middle[1]];
    touch("touchStart", &[at(0.0)]);
    (1..=5).for_each(|k| touch("touchMove", &[at(8.0 * f64::from(k))]));
    touch("touchEnd", &[]);
    browser.rest();
    assert_ne!(browser.run("return state.values.camera.eye"), json!([60, 45, 60]));
    assert!((distance() / before - 1.0).abs() < 1e-3, "one finger orbits");
    touch("touchStart", &[at(-20.0), at(20.0)]);
    (1..=5).for_each(|k| touch("touchMove", &[at(-20.0 - 8.0 * f64::from(k)), at(20.0 + 8.0 * f64::from(k))]));
    touch("touchEnd", &[]);
    browser.rest();
    // from 40 px apart to 120
    assert!((distance() / before - 1.0 / 3.0).abs() < 0.02, "{} of {before}", distance());
    is_quiet(&viewed, &mut browser);
}

/// How often pictures come while the camera is dragged, and how long after it the whole picture does, by the page's clock. Other tests that
/// run beside make it slower: `ANAMORPH_VIEW_RATES` asks that it be fast enough.
#[test]
fn rates() {
    let scene = CITY.replace("width = 320", "width = 800").replace("height = 240", "height = 600");
    let Some((viewed, mut browser)) = open(&format!("{scene}{PINHOLE}\n")) else { return };
    // 4 seconds of moves, one each 16 ms, as a mouse gives them
    let measured = browser.run(
        "return (async () => { const [view, seen] = [document.getElementById('view'), []]; \
         on('picture', (h) => seen.push({ at: performance.now(), moving: h.quality === 'moving', width: h.width, since: performance.now() - sentAt.get(h.seq) })); \
         const box = view.getBoundingClientRect(); let [x, y] = [box.x + box.width / 2, box.y + box.height / 2]; \
         const event = (type) => view.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, pointerId: 1, buttons: 1, bubbles: true, cancelable: true })); \
         view.setPointerCapture = () => {}; event('pointerdown'); \
         for (let k = 0; k < 250; k++) { await new Promise((done) => setTimeout(done, 16)); x += 2 * Math.cos(k / 20); y += Math.sin(k / 15); event('pointermove'); } \
         const released = performance.now(); event('pointerup'); delete view.setPointerCapture; \
         while (!seen.some((s) => s.at > released && !s.moving)) await new Promise((done) => setTimeout(done, 5)); \
         const moving = seen.filter((s) => s.moving).slice(5); const whole = seen.find((s) => s.at > released && !s.moving); \
         const since = moving.map((s) => s.since).sort((a, b) => a - b); \
         return { rate: (moving.length - 1) / ((moving.at(-1).at - moving[0].at) / 1000), since: since[since.length >> 1], most: since[Math.floor(since.length * 0.95)], \
                  width: moving.at(-1).width, whole: whole.at - released } })()",
    );
    let [rate, since, most, width, whole] =
        ["rate", "since", "most", "width", "whole"].map(|name| number(&measured[name]));
    eprintln!(
        "800x600, 15,000 triangles: {rate:.1} pictures a second while dragging, the last {width} px wide; {since:.0} ms after the input, \
         95 % within {most:.0} ms; the whole picture {whole:.0} ms after release"
    );
    if std::env::var_os("ANAMORPH_VIEW_RATES").is_some() {
        assert!(rate >= 8.0 && whole < 300.0);
    }
    assert!(rate > 0.5, "pictures come while the pointer moves");
    is_quiet(&viewed, &mut browser);
}
