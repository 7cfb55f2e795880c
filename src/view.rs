//! A page in the browser that shows a scene and changes it: [`Document`] holds the text of its file, [`session`] what pages have asked for,
//! [`painter`] draws it, [`server`] connects pages, `page/` is what they run.

mod display;
mod document;
mod lines;
mod messages;
mod page;
mod painter;
mod paths;
mod server;
mod session;
mod values;

use crate::engine::Engine;
use crate::gpu::device::GpuOptions;
use crate::input::{Error, Result};
use crate::scene::Scene;
pub use document::Document;
use painter::Loader;
use session::Session;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::Notify;

/// How a scene is viewed.
#[derive(Default)]
pub struct Options {
    /// The port of 127.0.0.1; 0: any free one.
    pub port: u16,
    /// The token in the address; `None`: a random one.
    pub token: Option<String>,
    pub frame: f64,
    pub gpu: GpuOptions,
}

/// A server of a scene's page. Dropped, it ends when the picture that is being drawn is done.
pub struct Server {
    address: String,
    session: Arc<Session>,
    stop: Arc<Notify>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Serves a scene: the document's, with the meshes of `base` before its own, and what else it does not say from there.
    ///
    /// # Errors
    /// Those of reading the scene; [`Error::Work`] if the adapter or the port cannot be used.
    pub fn start(document: Document, base: Option<Scene>, options: Options) -> Result<Server> {
        // wrong values end it now; later they are said on the page
        document.scene_file(options.frame)?;
        let loader = Arc::new(Loader::new(&document.path, document.limits, base));
        let engine = Engine::open(&options.gpu)?;
        let adapter = engine.as_ref().map_or("the CPU, by the reference".into(), |e| e.gpu.info.name.clone());
        let session = Arc::new(Session::new(document, options.frame, adapter)?);
        let token = options.token.map_or_else(random_word, Ok)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|e| Error::work(format!("the server cannot start: {e}")))?;
        let wanted = options.port;
        let cannot = |e: std::io::Error| {
            Error::work(format!("port {wanted} of 127.0.0.1 cannot be used: {e}; choose another --port"))
        };
        let listener = tokio::net::TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, wanted)));
        let listener = runtime.block_on(listener).map_err(cannot)?;
        let port = listener.local_addr().map_err(cannot)?.port();
        let address = format!("http://127.0.0.1:{port}/?token={token}");
        let stop = Arc::new(Notify::new());
        let mut server = Server { address, session: session.clone(), stop: stop.clone(), threads: Vec::new() };
        let (painting, inspecting, painter_loader) = (session.clone(), session.clone(), loader.clone());
        server.run("painter", move || painter::paint(&painting, painter_loader, engine, options.gpu))?;
        server.run("inspector", move || painter::inspect(&inspecting, &loader))?;
        server.run("server", move || {
            runtime.block_on(server::serve(listener, session.clone(), token, stop));
            session.end();
        })?;
        Ok(server)
    }

    fn run(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> Result<()> {
        let thread = std::thread::Builder::new().name(name.into()).spawn(work);
        self.threads.push(thread.map_err(|e| Error::work(format!("no thread can be started: {e}")))?);
        Ok(())
    }

    /// Where the page is.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Waits until the server ends, which it does not by itself.
    pub fn wait(mut self) {
        self.join();
    }

    fn join(&mut self) {
        for thread in self.threads.drain(..) {
            // a panic has been reported
            let _ = thread.join();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.session.end();
        self.stop.notify_one();
        self.join();
    }
}

/// 128 random bits as text.
fn random_word() -> Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|e| Error::work(format!("the system gives no random numbers: {e}")))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
