//! `anamorph view`: its server by messages, and its page in a browser.

mod browser;
mod interactions;
#[path = "../common/needs.rs"]
mod needs;
mod page;
mod requests;
#[allow(dead_code)]
#[path = "../common/rng.rs"]
mod rng;
mod viewed;
