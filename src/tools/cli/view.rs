//! `anamorph view`: a page in the browser that shows a scene.

use super::args::ViewArgs;
use super::progress::Progress;
use super::say::{note, print};
use crate::gpu::device::GpuOptions;
use crate::input::Result;
use crate::tools::view::{Options, serve};

pub fn run(args: &ViewArgs) -> Result<()> {
    let progress = Progress::start("reading the scene");
    let options = Options {
        port: args.port,
        token: args.token.clone(),
        frame: args.change.frame,
        size: args.change.size,
        set: &args.change.set,
        gpu: GpuOptions { adapter: args.adapter.clone(), ..Default::default() },
    };
    serve(&args.scene, options, |address| {
        drop(progress);
        print(&format!("{address}\n"))?;
        if args.open
            && let Err(why) = open::that_detached(address)
        {
            note(format_args!("no browser can be opened: {why}; open the address above"));
        }
        Ok(())
    })
}
