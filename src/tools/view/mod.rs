//! `anamorph view`: a page in the browser that shows a scene and changes it. [`session`] holds the scene's text, [`painter`] draws it,
//! [`server`] connects pages, `page/` is what they run.

mod display;
mod document;
mod keys;
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
use document::{Document, Edit};
use painter::Loader;
use session::Session;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::Arc;

/// How a scene is viewed.
pub struct Options<'a> {
    /// The port; 0: any free one.
    pub port: u16,
    /// The token in the address; `None`: a random one.
    pub token: Option<String>,
    pub frame: f64,
    pub size: Option<(u32, u32)>,
    /// `key=value` texts that change the scene.
    pub set: &'a [String],
    pub gpu: GpuOptions,
}

/// Serves the page of a scene until the process ends. `ready` is called with its address.
///
/// # Errors
/// Those of reading and drawing the scene; [`Error::Work`] if the port cannot be had.
pub fn serve(scene: &Path, options: Options, ready: impl FnOnce(&str) -> Result<()>) -> Result<()> {
    let mut document = Document::open(scene)?;
    document.edit(&edits(&options)?, options.frame, None)?;
    // wrong values end the program now; later they are said on the page
    document.scene_file(options.frame)?;
    let loader = Arc::new(Loader::new(scene));
    let engine = Engine::open(&options.gpu)?;
    let adapter = engine.as_ref().map_or("no adapter: the reference on the CPU".into(), |e| e.gpu.info.name.clone());
    let session = Arc::new(Session::new(document, options.frame, adapter)?);
    let token = options.token.unwrap_or_else(random_word);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|e| Error::work(format!("the server cannot start: {e}")))?;
    let port = options.port;
    let cannot =
        |e: std::io::Error| Error::work(format!("port {port} of 127.0.0.1 cannot be used: {e}; choose another --port"));
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let listener = runtime.block_on(tokio::net::TcpListener::bind(address)).map_err(cannot)?;
    let port = listener.local_addr().map_err(cannot)?.port();
    let gpu = options.gpu;
    std::thread::scope(|scope| {
        let (painting, inspecting) = (session.clone(), session.clone());
        let painters = loader.clone();
        scope.spawn(move || painter::paint(&painting, painters, engine, gpu));
        scope.spawn(move || painter::inspect(&inspecting, &loader));
        let served = ready(&format!("http://127.0.0.1:{port}/?token={token}")).and_then(|()| {
            let served = runtime.block_on(server::serve(listener, session.clone(), token));
            served.map_err(|e| Error::work(format!("the server has failed: {e}")))
        });
        session.end();
        served
    })
}

/// The changes of the command line.
fn edits(options: &Options) -> Result<Vec<Edit>> {
    let size = options.size.into_iter().flat_map(|(width, height)| {
        [("image.width", width), ("image.height", height)]
            .map(|(path, side)| Edit { path: path.into(), value: side.into() })
    });
    let sets = options.set.iter().map(|text| {
        let (path, value) = text
            .split_once('=')
            .ok_or_else(|| Error::input(format!("--set {text:?}: no '='; write it as key=value")))?;
        Ok(Edit { path: path.trim().into(), value: values::json(&crate::input::parse::parse_set_value(value)) })
    });
    size.map(Ok).chain(sets).collect()
}

/// 128 random bits as text.
fn random_word() -> String {
    let mut bytes = [0; 16];
    // without the system's random numbers nothing can be kept from others
    getrandom::fill(&mut bytes).expect("the system has random numbers");
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
