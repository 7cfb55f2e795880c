//! The page and its connections, on loopback alone, for those who have the token.

use super::page;
use super::session::{Outgoing, Session};
use axum::Router;
use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use serde::Deserialize;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;

/// The longest message of a page, bytes: a scene's text, and what goes with it.
const MESSAGE_MAX: usize = super::document::TEXT_MAX + (1 << 20);
/// A page that has not taken what is sent after so long is let go: a minute, and a second for each of so many bytes.
const SEND_TIMEOUT: Duration = Duration::from_secs(60);
const SLOWEST: u64 = 50_000;
/// Time within which a connection must send the whole header of its next request. A browser sends a header in one packet.
const HEADER_TIMEOUT: Duration = Duration::from_secs(5);
/// Most open connections that are not yet a page's WebSocket; a browser opens six. One more closes the oldest of them, so that connections
/// that wait never keep a page out.
const CONNECTIONS_MAX: usize = 64;
/// Pause after a connection could not be accepted, as at the limit of open files, until some may have been closed.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

#[derive(Clone)]
struct Shared {
    session: Arc<Session>,
    token: Arc<str>,
}

#[derive(Deserialize)]
struct Access {
    #[serde(default)]
    token: String,
}

/// Serves until it is stopped.
pub async fn serve(listener: TcpListener, session: Arc<Session>, token: String, stop: Arc<tokio::sync::Notify>) {
    let shared = Shared { session, token: token.into() };
    let router = Router::new()
        .route("/", get(page))
        .route("/socket", get(socket))
        .layer(middleware::from_fn(only_local))
        .with_state(shared);
    tokio::select! {
        () = accept(listener, router) => {}
        () = stop.notified() => {}
    }
}

/// Accepts connections, without end. A connection that became a WebSocket counts no more: the session bounds the number of pages.
async fn accept(listener: TcpListener, router: Router) {
    let mut open: VecDeque<AbortHandle> = VecDeque::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_PAUSE).await;
            continue;
        };
        open.retain(|connection| !connection.is_finished());
        if open.len() >= CONNECTIONS_MAX
            && let Some(oldest) = open.pop_front()
        {
            oldest.abort();
        }
        open.push_back(tokio::spawn(answer(stream, router.clone())).abort_handle());
    }
}

/// Answers the requests of one connection.
async fn answer(stream: TcpStream, router: Router) {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIMEOUT);
    let connection = http.serve_connection(TokioIo::new(stream), TowerToHyperService::new(router));
    // its client sees the error: the connection ends
    let _ = connection.with_upgrades().await;
}

/// Refuses other names of this machine, which a page of another site may use to reach it (DNS rebinding), and requests from such pages.
async fn only_local(request: Request, next: Next) -> Response {
    let headers = request.headers();
    let host = text(headers, header::HOST);
    if !host.is_some_and(is_loopback) {
        return refusal(StatusCode::FORBIDDEN, "use http://localhost or http://127.0.0.1");
    }
    let origin = headers.get(header::ORIGIN).map(|_| text(headers, header::ORIGIN).unwrap_or(""));
    if origin.is_some_and(|origin| origin.strip_prefix("http://") != host) {
        return refusal(StatusCode::FORBIDDEN, "requests from pages of other sites are refused");
    }
    next.run(request).await
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// A name of this machine's loopback, with any port: ports differ where they are forwarded, as by `ssh -L`.
fn is_loopback(host: &str) -> bool {
    let after = ["localhost", "127.0.0.1", "[::1]"].iter().find_map(|name| host.strip_prefix(name));
    after.is_some_and(|rest| rest.is_empty() || rest.strip_prefix(':').is_some_and(|port| port.parse::<u16>().is_ok()))
}

fn refusal(status: StatusCode, why: &'static str) -> Response {
    (status, why).into_response()
}

impl Shared {
    /// Compares in the same time however much of it is right.
    fn admits(&self, access: &Access) -> bool {
        let (own, given) = (self.token.as_bytes(), access.token.as_bytes());
        own.len() == given.len() && own.iter().zip(given).fold(0, |all, (a, b)| all | (a ^ b)) == 0
    }
}

async fn page(State(shared): State<Shared>, Query(access): Query<Access>) -> Response {
    if !shared.admits(&access) {
        return refusal(StatusCode::FORBIDDEN, "this address needs the token that anamorph view printed");
    }
    let (text, policy) = match page::with_policy() {
        Ok(page) => page,
        Err(why) => return (StatusCode::INTERNAL_SERVER_ERROR, why.to_string()).into_response(),
    };
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::CONTENT_SECURITY_POLICY, policy),
    ];
    (headers, text).into_response()
}

async fn socket(
    State(shared): State<Shared>,
    Query(access): Query<Access>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !shared.admits(&access) {
        return refusal(StatusCode::FORBIDDEN, "this address needs the token that anamorph view printed");
    }
    // browsers always send it here
    if headers.get(header::ORIGIN).is_none() && headers.contains_key("sec-fetch-mode") {
        return refusal(StatusCode::FORBIDDEN, "requests without an origin are refused");
    }
    upgrade
        .max_message_size(MESSAGE_MAX)
        .max_frame_size(MESSAGE_MAX)
        .on_upgrade(move |socket| watch(socket, shared.session))
}

/// One page's connection.
async fn watch(mut socket: WebSocket, session: Arc<Session>) {
    let Some((id, notify)) = session.join() else {
        let why = serde_json::json!({ "is": "full", "why": "too many pages watch this scene; close one" });
        let _closed_anyway = socket.send(Message::Text(why.to_string().into())).await;
        return;
    };
    let mut later = None;
    loop {
        let held = tokio::time::sleep(later.unwrap_or(Duration::from_secs(3600)));
        tokio::select! {
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => session.take(id, &text),
                Some(Ok(Message::Binary(_))) => {
                    let why = serde_json::json!({ "is": "refused", "why": "not a message: send JSON as text" });
                    session.state().answer(id, &why);
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Close(_)) | Err(_)) | None => break,
            },
            () = notify.notified() => {}
            () = held => {}
        }
        let (messages, wait) = session.state().outgoing(id, Instant::now());
        later = wait;
        let bytes = messages.iter().map(Outgoing::bytes).sum::<usize>() as u64;
        let sent = tokio::time::timeout(SEND_TIMEOUT + Duration::from_secs(bytes / SLOWEST), async {
            for message in messages {
                socket.send(message.into()).await?;
            }
            Ok::<(), axum::Error>(())
        });
        if !matches!(sent.await, Ok(Ok(()))) {
            break;
        }
    }
    session.leave(id);
}

impl From<Outgoing> for Message {
    /// A picture: the length of its header, 4 bytes, little-endian; the header; the file.
    fn from(outgoing: Outgoing) -> Message {
        match outgoing {
            Outgoing::Text(text) => Message::Text(text.into()),
            Outgoing::Picture(picture) => {
                let header = serde_json::to_vec(&picture.header).unwrap_or_default();
                let length = (header.len() as u32).to_le_bytes();
                let whole = [&length[..], &header, &picture.bytes].concat();
                Message::Binary(Bytes::from(whole))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_loopback_are_taken() {
        for host in ["localhost", "localhost:80", "127.0.0.1:65535", "[::1]", "[::1]:8000"] {
            assert!(is_loopback(host), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "localhost.evil.example:80",
            "127.0.0.1.nip.io",
            "localhost:x",
            "10.0.0.1:80",
            "[::1",
            "[::1]x",
            "localhost:99999",
        ] {
            assert!(!is_loopback(host), "{host}");
        }
    }
}
