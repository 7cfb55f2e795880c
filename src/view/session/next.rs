//! What is drawn next, and for which page: the newest state only, and no page twice before the others.

use super::{Asked, Inspection, Job, Picture, State, Work};
use crate::view::messages::{Header, Quality};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Without input for so long, a gesture that is still held gets a picture as at rest.
const HELD: Duration = Duration::from_millis(400);
/// A picture of several samples waits so long for further input, and at least as long as a whole one took: it cannot be interrupted.
pub(super) const SETTLED: Duration = Duration::from_millis(150);
/// The camera's volume is drawn after so many pictures at the latest.
const LINES_EVERY: u32 = 4;

impl State {
    /// What the painter is to do next.
    pub(super) fn next_work(&mut self, now: Instant) -> Option<Work> {
        let idle = now - self.last_input;
        let is_moving = self.is_moving && idle < HELD;
        let at = self.at();
        let has_lines = self.lines.as_ref().is_some_and(|(revision, _)| *revision == self.revision);
        let wants_lines = !has_lines && self.problem.is_none() && self.pages.values().any(|page| page.look.volume);
        let mut beside = None;
        let mut picture = None;
        // those after the page that was served last come first
        let after = self.pages.range(self.last_served + 1..);
        for (id, page) in after.chain(self.pages.range(..=self.last_served)) {
            if page.awaited.is_some() || !page.outgoing.is_empty() {
                continue;
            }
            let known = page.drawn.as_ref().filter(|drawn| drawn.revision == self.revision && drawn.look == page.look);
            let known = known.map(|drawn| drawn.quality);
            let rest = if page.look.samples > 1 { Quality::Rest } else { Quality::Whole };
            let next = match known {
                None if is_moving => Some(Quality::Moving),
                None | Some(Quality::Moving) if !is_moving => Some(Quality::Whole),
                Some(Quality::Whole) if rest == Quality::Rest && !is_moving && idle >= SETTLED.max(page.whole) => {
                    Some(Quality::Rest)
                }
                _ => None,
            };
            let job = |quality| Job {
                page: *id,
                asked: Asked { revision: self.revision, look: page.look.clone(), quality },
                seq: page.seq,
                scene: at.clone(),
            };
            if let Some(quality) = next {
                picture = Some(job(quality));
                break;
            }
            let is_at_rest = !is_moving && known >= Some(rest);
            let is_drawn =
                page.drawn_beside.as_ref().is_some_and(|(r, look)| *r == self.revision && *look == page.look);
            if page.look.beside.is_some() && is_at_rest && !is_drawn && beside.is_none() {
                beside = Some(job(rest));
            }
        }
        if wants_lines && (picture.is_none() || self.since_lines >= LINES_EVERY) {
            self.since_lines = 0;
            return Some(Work::Lines(at));
        }
        if let Some(job) = picture {
            (self.last_served, self.since_lines) = (job.page, self.since_lines + 1);
            return Some(Work::Picture(job));
        }
        let job = beside?;
        self.pages.get_mut(&job.page)?.drawn_beside = Some((self.revision, job.asked.look.clone()));
        if job.asked.look.beside.as_deref() == Some("reference") {
            self.inspections.push_back(Inspection::Beside(job));
            return None;
        }
        Some(Work::Beside(job))
    }

    /// Pixels first; what no page waits for any more is dropped.
    pub(super) fn next_inspection(&mut self) -> Option<Inspection> {
        let State { inspections, pages, revision, .. } = self;
        inspections.retain(|inspection| match inspection {
            Inspection::Pixel { page, .. } => pages.contains_key(page),
            Inspection::Beside(job) => {
                job.asked.revision == *revision && pages.get(&job.page).is_some_and(|page| page.look == job.asked.look)
            }
        });
        let pixel = inspections.iter().position(|inspection| matches!(inspection, Inspection::Pixel { .. }));
        inspections.remove(pixel.unwrap_or(0))
    }

    /// Hands over a picture, or why there is none, to all pages that ask for it.
    pub(super) fn drawn(&mut self, job: &Job, result: std::result::Result<(Header, Arc<Vec<u8>>), String>) {
        let is_newest = self.revision == job.asked.revision;
        let (header, bytes) = match result {
            Ok(drawn) => drawn,
            Err(why) => {
                let Some(page) = self.pages.get_mut(&job.page) else { return };
                // not tried again
                page.drawn = Some(Asked { quality: Quality::Rest, ..job.asked.clone() });
                if is_newest && page.look == job.asked.look {
                    (page.problem, page.is_stale) = (Some(why), true);
                    page.notify.notify_one();
                }
                return;
            }
        };
        for (id, page) in &mut self.pages {
            let is_free = page.awaited.is_none() && page.outgoing.is_empty();
            let is_newer = page.drawn.as_ref().is_none_or(|drawn| {
                (drawn.revision, drawn.quality) < (job.asked.revision, job.asked.quality) || drawn.look != page.look
            });
            if page.look != job.asked.look || !is_newer || !(is_free || *id == job.page) {
                continue;
            }
            // one of the newest state shows all that the page has asked for so far
            let seq = if is_newest { page.seq } else { job.seq };
            page.drawn = Some(job.asked.clone());
            if job.asked.quality == Quality::Whole {
                page.whole = header.times.all();
            }
            let header = Header { id: self.next_picture, seq, ..header.clone() };
            self.next_picture += 1;
            page.outgoing.push_back(Picture { header, bytes: bytes.clone() });
            if is_newest && page.problem.take().is_some() {
                page.is_stale = true;
            }
            page.notify.notify_one();
        }
    }
}
