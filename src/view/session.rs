//! The scene that is viewed, and the pages that watch it. The server changes it by requests; the painter asks it what to draw next.

mod next;

use super::document::{Document, Gesture, Keys};
use super::messages::{Header, Look, Quality, Request};
use crate::input::{Error, Result};
use crate::jobs::options;
use serde_json::{Value as Json, json};
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// While pictures come, the scene's values are sent at most so often.
const VALUES: Duration = Duration::from_millis(100);
/// Pages that may watch at once.
const PAGES_MAX: usize = 16;
/// Pixels that a page may ask about before the answers come.
const PIXELS_MAX: usize = 8;

pub struct Session {
    state: Mutex<State>,
    /// There is something for the painter, or the inspector, to do.
    work: Condvar,
}

/// A picture on its way to a page.
pub struct Picture {
    pub header: Header,
    pub bytes: Arc<Vec<u8>>,
}

/// A message for a page.
pub enum Outgoing {
    Text(String),
    Picture(Picture),
}

impl Outgoing {
    pub fn bytes(&self) -> usize {
        match self {
            Outgoing::Text(text) => text.len(),
            Outgoing::Picture(picture) => picture.bytes.len(),
        }
    }
}

/// What a picture is of.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    pub revision: u64,
    pub look: Look,
    pub quality: Quality,
}

/// A picture to draw.
#[derive(Clone)]
pub struct Job {
    pub page: u64,
    pub asked: Asked,
    /// Of the page's last input.
    pub seq: u64,
    pub scene: At,
}

/// The text of a scene, and a frame of it.
#[derive(Clone)]
pub struct At {
    pub revision: u64,
    pub text: Arc<str>,
    pub frame: f64,
}

/// Work for the painter.
pub enum Work {
    Picture(Job),
    /// The second picture, by a rival.
    Beside(Job),
    /// The camera's volume.
    Lines(At),
}

/// Work for the inspector: what takes long on the CPU.
pub enum Inspection {
    Pixel {
        page: u64,
        x: u32,
        y: u32,
        tag: u64,
        scene: At,
    },
    /// The second picture, by the reference.
    Beside(Job),
}

impl Inspection {
    fn page(&self) -> u64 {
        match self {
            Inspection::Pixel { page, .. } => *page,
            Inspection::Beside(job) => job.page,
        }
    }
}

pub struct State {
    document: Document,
    frame: f64,
    /// Counts the states of the scene.
    revision: u64,
    text: Arc<str>,
    values: Json,
    keys: Keys,
    /// Why the text of this revision cannot be read.
    problem: Option<String>,
    last_input: Instant,
    is_moving: bool,
    pages: BTreeMap<u64, Page>,
    next_page: u64,
    next_picture: u64,
    /// The page that was drawn for last.
    last_served: u64,
    /// Pictures since the camera's volume was last drawn.
    since_lines: u32,
    inspections: VecDeque<Inspection>,
    /// The camera's volume, and the revision that it is of.
    lines: Option<(u64, Arc<str>)>,
    /// The scene's lines, and a number that changes with them.
    wires: Option<(u64, Arc<str>)>,
    adapter: String,
    has_ended: bool,
}

#[derive(Default)]
struct Page {
    look: Look,
    seq: u64,
    /// Why its picture cannot be drawn.
    problem: Option<String>,
    /// It sees another state of the scene than there is.
    is_stale: bool,
    notify: Arc<Notify>,
    /// What was last drawn for it.
    drawn: Option<Asked>,
    /// What its last whole picture took, of one ray per pixel.
    whole: Duration,
    /// The same as `drawn` of the second picture.
    drawn_beside: Option<(u64, Look)>,
    outgoing: VecDeque<Picture>,
    /// A picture was sent that the page has not drawn yet.
    awaited: Option<u64>,
    answers: Vec<String>,
    /// It has had the first message of the scene, which has more.
    is_greeted: bool,
    sent_at: Option<Instant>,
    sent_lines: u64,
    sent_wires: u64,
}

impl Session {
    /// # Errors
    /// Those of [`Document::values`].
    pub fn new(document: Document, frame: f64, adapter: String) -> Result<Session> {
        let (text, values, keys) = (document.text().into(), document.values(frame)?, document.keys());
        let state = State {
            document,
            frame,
            revision: 1,
            text,
            values,
            keys,
            problem: None,
            last_input: Instant::now(),
            is_moving: false,
            pages: BTreeMap::new(),
            next_page: 1,
            next_picture: 1,
            last_served: 0,
            since_lines: 0,
            inspections: VecDeque::new(),
            lines: None,
            wires: None,
            adapter,
            has_ended: false,
        };
        Ok(Session { state: Mutex::new(state), work: Condvar::new() })
    }

    pub fn state(&self) -> MutexGuard<'_, State> {
        // a state is whole between statements; what panics elsewhere is reported
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new page: its number, and what tells it that there are messages. `None`: too many watch.
    pub fn join(&self) -> Option<(u64, Arc<Notify>)> {
        let mut state = self.state();
        if state.pages.len() >= PAGES_MAX {
            return None;
        }
        let (id, notify) = (state.next_page, Arc::new(Notify::new()));
        state.next_page += 1;
        let page = Page {
            look: Look { volume: false, ..Look::default() },
            is_stale: true,
            notify: notify.clone(),
            ..Page::default()
        };
        state.pages.insert(id, page);
        drop(state);
        notify.notify_one();
        self.work.notify_all();
        Some((id, notify))
    }

    pub fn leave(&self, page: u64) {
        let mut state = self.state();
        state.pages.remove(&page);
        state.inspections.retain(|inspection| inspection.page() != page);
    }

    /// Ends the threads that work for it.
    pub fn end(&self) {
        self.state().has_ended = true;
        self.work.notify_all();
    }

    /// Does what a page asks. What is wrong with it is a message to that page.
    pub fn take(&self, page: u64, text: &str) {
        let mut state = self.state();
        let request = serde_json::from_str::<Request>(text).map_err(|e| Error::input(format!("not a message: {e}")));
        if let Err(error) = request.and_then(|request| state.take(page, request)) {
            state.answer(page, &json!({ "is": "refused", "why": error.to_string() }));
            // what the page has put into its own copy is not there
            state.say();
        }
        drop(state);
        self.work.notify_all();
    }

    /// Waits for what the painter is to do next; `None` at the end.
    pub fn next_work(&self) -> Option<Work> {
        let mut state = self.state();
        loop {
            if state.has_ended {
                return None;
            }
            let now = Instant::now();
            let work = state.next_work(now);
            if !state.inspections.is_empty() {
                self.work.notify_all();
            }
            if work.is_some() {
                return work;
            }
            state = if state.pages.is_empty() {
                self.work.wait(state).unwrap_or_else(PoisonError::into_inner)
            } else {
                // what waits for further input has its time soon
                self.work.wait_timeout(state, next::SETTLED / 2).unwrap_or_else(PoisonError::into_inner).0
            };
        }
    }

    /// Waits for what the inspector is to do next; `None` at the end.
    pub fn next_inspection(&self) -> Option<Inspection> {
        let mut state = self.state();
        loop {
            if state.has_ended {
                return None;
            }
            if let Some(inspection) = state.next_inspection() {
                return Some(inspection);
            }
            state = self.work.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Hands over a picture, or why there is none. Pages that ask for the same get it too.
    pub fn drawn(&self, job: &Job, result: std::result::Result<(Header, Arc<Vec<u8>>), String>) {
        self.state().drawn(job, result);
        self.work.notify_all();
    }

    /// Hands over a second picture, or why there is none.
    pub fn drawn_beside(&self, job: &Job, result: std::result::Result<(Header, Arc<Vec<u8>>), String>) {
        let mut state = self.state();
        let id = state.next_picture;
        state.next_picture += 1;
        let is_current = state.revision == job.asked.revision;
        let Some(page) = state.pages.get_mut(&job.page).filter(|page| is_current && page.look == job.asked.look) else {
            return;
        };
        match result {
            Ok((header, bytes)) => {
                page.outgoing.push_back(Picture { header: Header { id, beside: true, ..header }, bytes });
                page.notify.notify_one();
            }
            Err(why) => {
                let why = json!({ "is": "refused", "why": why });
                state.answer(job.page, &why);
            }
        }
    }

    /// Hands over the volume of a camera.
    pub fn lined(&self, at: &At, camera: Json) {
        let mut state = self.state();
        let text = json!({ "is": "volume", "revision": at.revision, "camera": camera }).to_string();
        state.lines = Some((at.revision, text.into()));
        state.pages.values().for_each(|page| page.notify.notify_one());
    }

    /// Hands over the lines of the scene's meshes.
    pub fn wired(&self, number: u64, scene: Json) {
        let mut state = self.state();
        let mut whole = scene;
        whole["is"] = "wires".into();
        state.wires = Some((number, whole.to_string().into()));
    }
}

impl State {
    fn take(&mut self, id: u64, request: Request) -> Result<()> {
        let Some(page) = self.pages.get_mut(&id) else { return Ok(()) };
        let seq = match request {
            Request::Edit { seq, .. }
            | Request::Text { seq, .. }
            | Request::Undo { seq }
            | Request::Redo { seq }
            | Request::Frame { seq, .. }
            | Request::Look { seq, .. }
            | Request::Rest { seq }
            | Request::Offsets { seq } => Some(seq),
            _ => None,
        };
        page.seq = seq.unwrap_or(0).max(page.seq);
        match request {
            Request::Edit { edits, gesture, .. } => {
                let gesture: Option<Gesture> = gesture.map(|number| (id, number));
                self.document.edit(&edits, self.frame, gesture)?;
                self.changed(gesture.is_some());
            }
            Request::Text { text, .. } => {
                self.document.replace(text, None)?;
                self.changed(false);
            }
            Request::Undo { .. } => {
                self.document.undo();
                self.changed(false);
            }
            Request::Redo { .. } => {
                self.document.redo();
                self.changed(false);
            }
            Request::Save {} => {
                self.document.save()?;
                self.say();
            }
            Request::Frame { frame, playing, .. } => {
                if !frame.is_finite() {
                    return Err(Error::input("frame: use a finite number"));
                }
                self.frame = frame;
                self.changed(playing);
            }
            Request::Look { look, .. } => {
                options::samples(&look.samples.to_string()).map_err(Error::Input)?;
                if let Some(name) = &look.beside {
                    options::engine(name).map_err(|why| Error::Input(format!("{name}: {why}")))?;
                }
                // drawn anew even if it is the same, so that each such request has its picture
                (page.look, page.drawn, page.drawn_beside) = (look, None, None);
                self.say();
            }
            Request::Rest { .. } => {
                self.is_moving = false;
                self.say();
            }
            Request::Drawn { id: picture } => {
                if page.awaited == Some(picture) {
                    page.awaited = None;
                    page.notify.notify_one();
                }
            }
            Request::Pixel { x, y, tag } => {
                let is_own = |i: &&Inspection| matches!(i, Inspection::Pixel { page, .. } if *page == id);
                if self.inspections.iter().filter(is_own).count() >= PIXELS_MAX {
                    return Err(Error::input("too many pixels at once; wait for the answers"));
                }
                self.inspections.push_back(Inspection::Pixel { page: id, x, y, tag, scene: self.at() });
            }
            Request::Command {} => {
                let samples = page.look.samples;
                let answer = match self.document.command(self.frame, samples) {
                    Ok(command) => json!({ "is": "command", "text": command }),
                    Err(why) => json!({ "is": "command", "why": why.to_string() }),
                };
                self.answer(id, &answer);
            }
            Request::Offsets { .. } => {
                self.document.inline_offsets(&self.values, self.frame)?;
                self.changed(false);
            }
        }
        Ok(())
    }

    /// The scene is another one, by input that goes on or not.
    fn changed(&mut self, is_moving: bool) {
        (self.last_input, self.is_moving) = (Instant::now(), is_moving);
        self.revision += 1;
        self.text = self.document.text().into();
        self.keys = self.document.keys();
        self.problem = None;
        match self.document.values(self.frame) {
            Ok(values) => self.values = values,
            // pages keep the last values, and see why the text is wrong
            Err(why) => self.problem = Some(why.to_string()),
        }
        self.say();
    }

    /// Pages see another state.
    fn say(&mut self) {
        for page in self.pages.values_mut() {
            page.is_stale = true;
            page.notify.notify_one();
        }
    }

    fn at(&self) -> At {
        At { revision: self.revision, text: self.text.clone(), frame: self.frame }
    }

    /// Sends a page an answer.
    pub fn answer(&mut self, id: u64, answer: &Json) {
        if let Some(page) = self.pages.get_mut(&id) {
            page.answers.push(answer.to_string());
            page.notify.notify_one();
        }
    }

    /// The messages that a page has to get now, and how long to wait for those that are held back.
    pub fn outgoing(&mut self, id: u64, now: Instant) -> (Vec<Outgoing>, Option<Duration>) {
        let Some(page) = self.pages.get_mut(&id) else { return (Vec::new(), None) };
        let mut messages: Vec<Outgoing> = page.answers.drain(..).map(Outgoing::Text).collect();
        let wait = page.sent_at.map_or(Duration::ZERO, |at| VALUES.saturating_sub(now - at));
        let is_held = self.is_moving && !wait.is_zero();
        let later = (page.is_stale && is_held).then_some(wait);
        if page.is_stale && !is_held {
            messages.push(Outgoing::Text(self.scene_message(id)));
        }
        let Some(page) = self.pages.get_mut(&id) else { return (messages, later) };
        if page.is_stale && !is_held {
            (page.is_stale, page.is_greeted, page.sent_at) = (false, true, Some(now));
        }
        if page.look.volume {
            for (sent, lines) in [(&mut page.sent_wires, &self.wires), (&mut page.sent_lines, &self.lines)] {
                if let Some((number, text)) = lines.as_ref().filter(|(number, _)| number != sent) {
                    messages.push(Outgoing::Text(text.to_string()));
                    *sent = *number;
                }
            }
        }
        if page.awaited.is_none()
            && let Some(picture) = page.outgoing.pop_front()
        {
            page.awaited = Some(picture.header.id);
            messages.push(Outgoing::Picture(picture));
        }
        (messages, later)
    }

    fn scene_message(&self, id: u64) -> String {
        let document = &self.document;
        let page = self.pages.get(&id);
        let mut message = json!({
            "is": "scene",
            "revision": self.revision,
            "seq": page.map_or(0, |page| page.seq),
            "text": &*self.text,
            "values": self.values,
            "problem": self.problem.as_ref().or(page.and_then(|page| page.problem.as_ref())),
            "frame": self.frame,
            "frames": self.keys.frames,
            "keyframed": self.keys.paths,
            "has_poses": self.keys.has_poses,
            "saved": document.is_saved(),
            "undo": document.can_undo(),
            "redo": document.can_redo(),
        });
        if !page.is_some_and(|page| page.is_greeted) {
            message["name"] = document.name().into();
            message["has_file"] = document.has_file().into();
            message["adapter"] = self.adapter.as_str().into();
            message["cameras"] = json!(crate::scene::keys::of_cameras());
            message["sections"] = json!(crate::scene::keys::of_sections());
            let rivals: Vec<&str> = crate::engine::rival::techniques().iter().map(|t| t.name).collect();
            message["engines"] = json!([vec!["reference"], rivals].concat());
        }
        message.to_string()
    }
}
