//! The WGSL files, read once: their imports, bindings and constants.

use include_dir::{Dir, include_dir};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// How a kernel binds a buffer or texture.
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

/// A buffer or texture that a file declares: its name is the buffer's name everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Binding {
    pub name: &'static str,
    pub access: Access,
    pub wgsl_type: &'static str,
}

/// A file under `wgsl/`.
#[derive(Debug, PartialEq, Eq)]
pub struct File {
    /// The path under `wgsl/`.
    pub path: &'static str,
    pub text: &'static str,
    /// The text as it is compiled, line by line; the number of a binding is still missing.
    pub(super) lines: Vec<Line>,
    /// Paths of files, and names of interfaces.
    pub imports: Vec<&'static str>,
    /// Interfaces, and the implementation that an entry file chooses for its whole kernel.
    pub(super) chosen: Vec<(&'static str, &'static str)>,
    /// The names of its `override` constants.
    pub(super) constants: Vec<&'static str>,
}

/// A line of a file.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Line {
    Code(&'static str),
    /// An import or a choice, which the compiler does not see.
    Directive(&'static str),
    /// `enable NAME;`, which precedes all other code of a kernel.
    Enable(&'static str),
    Binding(Binding),
}

impl File {
    pub fn new(path: &'static str, text: &'static str) -> File {
        let lines: Vec<Line> = text.lines().map(Line::of).collect();
        let directives = || text.lines().filter_map(|line| line.strip_prefix('#')?.split_once(' '));
        let named = |wanted: &'static str| directives().filter(move |(name, _)| *name == wanted).map(|(_, rest)| rest);
        File {
            path,
            text,
            lines,
            imports: named("import").collect(),
            chosen: named("choose").filter_map(|rest| rest.split_once(' ')).collect(),
            constants: text
                .lines()
                .filter_map(|line| Some(line.strip_prefix("override ")?.split_once(':')?.0))
                .collect(),
        }
    }

    /// Returns the buffers and textures that the file declares.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> {
        self.lines.iter().filter_map(|line| if let Line::Binding(binding) = line { Some(*binding) } else { None })
    }

    /// The name of its compute entry point.
    pub(super) fn entry_point(&self) -> Option<&'static str> {
        let (_, after) = self.text.split_once("@compute")?;
        let (_, name) = after.split_once("fn ")?;
        name.split_once('(').map(|(name, _)| name)
    }
}

impl Line {
    fn of(line: &'static str) -> Line {
        match Binding::of(line) {
            Some(binding) => Line::Binding(binding),
            None if line.starts_with('#') => Line::Directive(line),
            None if line.starts_with("enable ") => Line::Enable(line),
            None => Line::Code(line),
        }
    }
}

impl Binding {
    /// Reads a line such as `var<storage, read> pairs: array<vec2<u32>>;`. `None`: it declares no binding.
    fn of(line: &'static str) -> Option<Binding> {
        const SPACES: [(&str, Access); 4] = [
            ("var<uniform> ", Access::Uniform),
            ("var<storage, read> ", Access::Read),
            ("var<storage, read_write> ", Access::Write),
            ("var ", Access::Texels),
        ];
        let of_space = |(space, access): (&str, Access)| Some((line.strip_prefix(space)?, access));
        let (declared, access) = SPACES.into_iter().find_map(of_space)?;
        let (name, wgsl_type) = declared.split_once(';')?.0.split_once(": ")?;
        let access = if wgsl_type.starts_with("texture_storage") { Access::WriteTexels } else { access };
        Some(Binding { name, access, wgsl_type })
    }

    /// Its declaration, with its number.
    pub(super) fn numbered(&self, number: usize) -> String {
        let space = match self.access {
            Access::Uniform => "<uniform>",
            Access::Read => "<storage, read>",
            Access::Write => "<storage, read_write>",
            Access::Texels | Access::WriteTexels => "",
        };
        format!("@group(0) @binding({number}) var{space} {}: {};", self.name, self.wgsl_type)
    }
}

/// Files by their paths.
#[derive(Debug, Default)]
pub struct Files(BTreeMap<&'static str, &'static File>);

/// The folder of the product's files.
static WGSL: Dir = include_dir!("$CARGO_MANIFEST_DIR/wgsl");

impl Files {
    /// Returns the product's files.
    pub fn own() -> &'static Files {
        static OWN: LazyLock<Files> = LazyLock::new(|| Files::default().with(&WGSL));
        &OWN
    }

    /// Returns these files and those of a folder, which are kept as long as the program runs.
    pub fn with(&self, folder: &'static Dir) -> Files {
        let mut files = Files(self.0.clone());
        let mut folders = vec![folder];
        while let Some(folder) = folders.pop() {
            folders.extend(folder.dirs());
            for file in folder.files() {
                let Some((path, text)) = file.path().to_str().zip(file.contents_utf8()) else { continue };
                files.0.insert(path, Box::leak(Box::new(File::new(path, text))));
            }
        }
        files
    }

    /// Returns a library of these files alone.
    #[cfg(feature = "internals")]
    pub fn of(files: &[&'static File]) -> Files {
        Files(files.iter().map(|file| (file.path, *file)).collect())
    }

    pub fn get(&self, path: &str) -> Option<&'static File> {
        self.0.get(path).copied()
    }

    /// The file of an import: itself, or the first that there is among the implementations of its interface. The interface of
    /// `rays/pixel` is `rays`, and its implementations are folders, `rays/pieces` with `pixel.wgsl`; that of `arithmetic` has files. An
    /// implementation in another folder has a path that begins with `/`; one that is a path of a file has all of the interface.
    pub(super) fn imported(
        &self,
        import: &str,
        implementations: &dyn Fn(&str) -> &'static [&'static str],
    ) -> Option<&'static File> {
        if import.ends_with(".wgsl") {
            return self.get(import);
        }
        let ends = import.match_indices('/').map(|(at, _)| at).chain([import.len()]);
        let of = |end: usize| {
            let (interface, rest) = import.split_at(end);
            implementations(interface).iter().find_map(|name| match name.strip_prefix('/') {
                _ if name.ends_with(".wgsl") => self.get(name),
                Some(path) => self.get(&format!("{path}{rest}.wgsl")),
                None => self.get(&format!("{interface}/{name}{rest}.wgsl")),
            })
        };
        ends.rev().find_map(of)
    }
}
