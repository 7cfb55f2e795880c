//! The page: one text, put together from the files of `page/`.

use crate::input::Result;
use axum::http::HeaderValue;
use std::sync::LazyLock;

const HTML: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// Scripts, in order: each may use those before it.
const SCRIPTS: [&str; 9] = [
    include_str!("page/vectors.js"),
    include_str!("page/state.js"),
    include_str!("page/picture.js"),
    include_str!("page/controls.js"),
    include_str!("page/handles.js"),
    include_str!("page/volume.js"),
    include_str!("page/tools.js"),
    include_str!("page/panels.js"),
    include_str!("page/main.js"),
];

static PAGE: LazyLock<String> = LazyLock::new(|| {
    let scripts = SCRIPTS.concat();
    HTML.replace("/* style.css */", STYLE).replace("/* scripts */", &scripts)
});

/// The page, and what it may do: run its own script, and connect to where it is from. A frame of a page on this machine, as of a
/// notebook, may show it.
pub fn with_policy() -> Result<(String, HeaderValue)> {
    let nonce = super::random_word()?;
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src blob: data:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'self' http://localhost:* http://127.0.0.1:* https://localhost:* vscode-webview:"
    );
    // a nonce is plain ASCII
    let policy = HeaderValue::from_str(&policy).unwrap_or(HeaderValue::from_static("default-src 'none'"));
    Ok((PAGE.replace("NONCE", &nonce), policy))
}
