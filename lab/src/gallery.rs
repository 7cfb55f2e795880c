//! The scenes of the gallery.

use anamorph::internals::tools::example::{EXAMPLES, Example};

/// What none of the papers has, in the order of the gallery's page.
pub const BEYOND: [&str; 7] =
    ["rolling-shutter", "composite", "table", "hidden-mirror", "helix", "smoke", "video-on-city"];

/// The examples that are after a figure, then those of what no paper has.
pub fn gallery() -> impl Iterator<Item = &'static Example> {
    let beyond = BEYOND.iter().filter_map(|name| EXAMPLES.iter().find(|e| e.name == *name));
    EXAMPLES.iter().filter(|e| e.figure.is_some()).chain(beyond)
}
