//! The page that explains an error.

use crate::engine::combinations::REFUSALS;
use crate::engine::rival::{NOT_CULLED, NOT_RENDERED};

/// Words of errors, and the page about them.
const PAGES: &[(&str, &str)] = &[
    ("--no-limits", "docs/reference/limits.md"),
    ("--memory", "docs/reference/limits.md"),
    ("needs an adapter", "docs/questions.md"),
    ("unknown key", "docs/reference/scene-file.md"),
];

const COMBINATIONS: &str = "docs/reference/combinations.md";
const RIVALS: &str = "docs/reference/rivals.md";

/// The page about a message, of those of this repository.
pub fn page_of(message: &str) -> Option<&'static str> {
    let about = |(words, page): &(&str, &'static str)| message.contains(words).then_some(*page);
    let is_refusal = || REFUSALS.iter().any(|row| message.ends_with(row.remedy) && has_in_order(message, row.reason));
    let is_of_rival = || {
        let mut rows = NOT_RENDERED.iter().map(|row| (row.1, row.2)).chain([NOT_CULLED]);
        let name = |(what, remedy)| message.strip_suffix(&format!(" {what}; {remedy}"));
        rows.any(|row| name(row).is_some_and(|name: &str| !name.contains(' ')))
    };
    let refused = || is_refusal().then_some(COMBINATIONS).or_else(|| is_of_rival().then_some(RIVALS));
    PAGES.iter().find_map(about).or_else(refused)
}

/// It has the parts of `reason` between the names in braces.
fn has_in_order(message: &str, reason: &str) -> bool {
    let mut rest = message;
    reason.split('{').map(|part| part.split_once('}').map_or(part, |(_, after)| after)).all(|part| {
        let after = rest.split_once(part).map(|(_, after)| after);
        rest = after.unwrap_or(rest);
        after.is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_the_page_about_them() {
        for (message, page) in [
            (
                "scene.toml: camera.pieces: 2000000 pieces are over the limit of 1000000; give fewer, or use --no-limits",
                PAGES[0].1,
            ),
            ("scene.toml:5: unknown key \"vfv\" in camera; nearest known key: \"vfov\"", PAGES[3].1),
            ("gradients are of triangles alone; leave the gradients out", COMBINATIONS),
            ("raytrace has no gradients; use --engine compute", RIVALS),
        ] {
            assert_eq!(page_of(message), Some(page), "{message}");
        }
        assert_eq!(page_of("scene.toml: cannot be read: no such file"), None);
        assert_eq!(page_of("something else; use --engine compute"), None);
        assert_eq!(page_of("the reference has no gradients; use --engine compute"), None);
    }

    #[test]
    fn every_refusal_has_a_page_and_every_page_is_there() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        for row in REFUSALS {
            let message = format!("{}; {}", row.reason, row.remedy);
            assert!(page_of(&message).is_some(), "{message}");
        }
        for page in PAGES.iter().map(|(_, page)| *page).chain([COMBINATIONS]) {
            assert!(root.join(page).is_file(), "{page}");
        }
    }
}
