//! A kernel: its bindings and the snippets that its source is joined from.

use super::parts::REAL_F64;
use crate::gpu::layout::NONE;
use crate::image::frame::Channel;
use std::collections::HashSet;
use std::fmt::Write;
use std::sync::LazyLock;

/// How a kernel binds a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Access {
    Uniform,
    Read,
    Write,
    /// A texture, whose texels are read one by one.
    Texels,
    /// A texture, whose texels are written one by one.
    WriteTexels,
}

/// One buffer of a kernel: its name is the buffer's name everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Binding {
    pub name: &'static str,
    pub access: Access,
    pub wgsl_type: &'static str,
}

/// One compute kernel, ready to compile.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The stage's name, the entry point's and the file's.
    pub name: &'static str,
    pub bindings: Vec<Binding>,
    pub parts: Vec<&'static Snippet>,
    /// A line before all others.
    pub enables: &'static str,
    pub constants: Vec<(&'static str, f64)>,
    /// It uses f64, and is lowered to 32-bit words where an adapter has none.
    pub f64: bool,
}

/// A part of kernels: a file under `wgsl/`.
#[derive(Debug, PartialEq, Eq)]
pub struct Snippet {
    /// The file's path under `wgsl/`.
    pub name: &'static str,
    pub text: &'static str,
}

/// Snippets in the order in which they are joined.
pub type Parts = &'static [&'static Snippet];

/// [`Parts`] by their names.
macro_rules! snippets {
    ($($name:literal),+) => {{
        use $crate::gpu::kernels::{Parts, Snippet};
        const PARTS: Parts = &[
            $(&Snippet { name: $name, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/", $name)) }),+
        ];
        PARTS
    }};
}
pub(crate) use snippets;

pub fn uniform(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Uniform, wgsl_type }
}

pub fn reads(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Read, wgsl_type }
}

pub fn writes(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Write, wgsl_type }
}

/// Named and bound like buffers.
pub fn texture(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Texels, wgsl_type }
}

pub fn writes_texture(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::WriteTexels, wgsl_type }
}

impl Kernel {
    /// Joined from `parts`, in their order; a snippet that several of them have stands where the first has it.
    pub fn new(name: &'static str, bindings: Vec<Binding>, parts: &[Parts]) -> Kernel {
        let mut seen = HashSet::new();
        let mut parts = parts.concat();
        parts.retain(|p| seen.insert(p.name));
        let f64 = parts.iter().any(|p| p.name == REAL_F64[0].name);
        Kernel { name, bindings, parts, enables: "", constants: Vec::new(), f64 }
    }

    /// What precedes the snippets: the bindings, and of a kernel with `planes` the number of each channel's, [`NONE`] if it is not
    /// rendered.
    fn head(&self) -> String {
        let mut head = self.enables.to_string();
        for (k, b) in self.bindings.iter().enumerate() {
            let space = match b.access {
                Access::Uniform => "<uniform>",
                Access::Read => "<storage, read>",
                Access::Write => "<storage, read_write>",
                Access::Texels | Access::WriteTexels => "",
            };
            // writing to a String cannot fail
            let _ = writeln!(head, "@group(0) @binding({k}) var{space} {}: {};", b.name, b.wgsl_type);
        }
        if self.bindings.iter().any(|b| b.name == "planes") {
            for (_, name) in PLANES.iter() {
                let _ = writeln!(head, "override {name}: u32 = {NONE:#x}u;");
            }
        }
        head
    }

    /// Says which planes there are, in their order.
    pub fn with_planes(mut self, planes: &[Channel]) -> Kernel {
        let name = |channel: &Channel| PLANES.iter().find(|(own, _)| own == channel).map(|(_, name)| name.as_str());
        let constant = |(k, channel): (usize, &Channel)| name(channel).map(|name| (name, k as f64));
        self.constants.extend(planes.iter().enumerate().filter_map(constant));
        self
    }

    /// How many storage buffers it binds.
    pub fn storage_buffers(&self) -> u32 {
        self.bindings.iter().filter(|b| matches!(b.access, Access::Read | Access::Write)).count() as u32
    }

    /// What is compiled: the bindings, then the snippets.
    pub fn source(&self) -> String {
        self.head() + &self.parts.iter().map(|p| p.text).collect::<String>()
    }

    /// The same, each snippet below a line that names it.
    pub fn labelled_source(&self) -> String {
        let part = |p: &&Snippet| format!("// {}:1\n{}", p.name, p.text);
        self.head() + &self.parts.iter().map(part).collect::<String>()
    }

    /// The snippet that holds a line of [`Kernel::source`], and the line's number there, both from 1. The bindings come before all
    /// snippets.
    pub fn place(&self, line: usize) -> (&'static str, usize) {
        let mut before = self.head().lines().count();
        if line <= before {
            return (BINDINGS, line);
        }
        for part in &self.parts {
            let lines = part.text.lines().count();
            if line <= before + lines {
                return (part.name, line - before);
            }
            before += lines;
        }
        (self.name, line)
    }
}

/// The constants with the number of a channel's plane: `PLANE_BARY_U` for `bary.u`. Those that the host computes have none.
static PLANES: LazyLock<Vec<(Channel, String)>> = LazyLock::new(|| {
    let name = |channel: Channel| format!("PLANE_{}", channel.name().to_uppercase().replace('.', "_"));
    Channel::every().filter(|channel| channel.is_rendered()).map(|channel| (channel, name(channel))).collect()
});

/// Stands for a snippet's name in front of the first one.
const BINDINGS: &str = "bindings";
