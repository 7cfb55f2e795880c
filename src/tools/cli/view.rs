//! `anamorph view`: a page in the browser that shows a scene.

use super::args::ViewArgs;
use super::progress::Progress;
use super::say::{note, print};
use crate::gpu::device::GpuOptions;
use crate::input::Result;
use crate::view::{Document, Options, Server};

pub fn run(args: &ViewArgs) -> Result<()> {
    let progress = Progress::start("reading the scene");
    let change = &args.change;
    let mut document = Document::open(&args.scene, args.caps.limits())?;
    document.change(change.size, &change.set, change.frame)?;
    let gpu = GpuOptions { adapter: args.adapter.clone(), ..Default::default() };
    let options = Options { port: args.port, token: args.token.clone(), frame: change.frame, gpu };
    let server = Server::start(document, None, options)?;
    drop(progress);
    print(&format!("{}\n", server.address()))?;
    if args.open
        && let Err(why) = open::that_detached(server.address())
    {
        note(format_args!("no browser can be opened: {why}; open the address above"));
    }
    server.wait();
    Ok(())
}
