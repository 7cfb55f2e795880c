//! Compiles kernels: errors name the place in the source, and `--dump-kernels` writes the sources to files.

use super::device::{Gpu, one_line};
use super::kernels::{Binding, File, Kernel, reached};
use crate::input::{Error, Result};
use std::borrow::Cow;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A folder for the sources of all compiled kernels.
pub(super) struct Dump {
    folder: PathBuf,
    /// Kernel names and file texts, in the order of compilation.
    written: Mutex<Vec<(&'static str, String)>>,
}

impl Dump {
    /// Makes the folder.
    ///
    /// # Errors
    /// [`Error::Work`] if it cannot be made.
    pub fn new(folder: &Path) -> Result<Dump> {
        let refused = |e| Error::work(format!("{}: cannot make a folder for kernels: {e}", folder.display()));
        std::fs::create_dir_all(folder).map_err(refused)?;
        Ok(Dump { folder: folder.into(), written: Mutex::default() })
    }

    /// Writes NAME.wgsl, then NAME-2.wgsl and so on for further variants. Each file stands below a line with its path; overrides
    /// come last.
    fn write(&self, kernel: &Kernel, is_lowered: bool) -> std::io::Result<()> {
        let mut text = kernel.labelled_source();
        for (name, value) in &kernel.constants {
            // writing to a String cannot fail
            let _ = writeln!(text, "// override {name} = {value}");
        }
        if is_lowered {
            text.push_str("// compiled with f64 in 32-bit words\n");
        }
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        let variants = || written.iter().filter(|(name, _)| *name == kernel.name);
        if variants().any(|(_, there)| *there == text) {
            return Ok(());
        }
        let file = match variants().count() {
            0 => format!("{}.wgsl", kernel.name),
            n => format!("{}-{}.wgsl", kernel.name, n + 1),
        };
        std::fs::write(self.folder.join(file), &text)?;
        written.push((kernel.name, text));
        Ok(())
    }
}

impl Gpu {
    /// The kernel with [`Gpu::replaced`] files.
    pub(super) fn with_replaced(&self, kernel: &Kernel) -> Kernel {
        let other = |file: &&'static File| *self.replaced.iter().find(|r| r.path == file.path).unwrap_or(file);
        let mut kernel = kernel.clone();
        kernel.files = kernel.files.iter().map(other).collect();
        kernel
    }

    /// Whether a kernel is compiled with f64 in 32-bit words.
    pub(super) fn lowers(&self, kernel: &Kernel) -> bool {
        kernel.has_f64() && !self.has.f64
    }

    /// Compiles a kernel, with f64 in 32-bit words on an adapter without f64. An error becomes the device's failure.
    pub fn compile(&self, kernel: &Kernel) -> Module {
        let kernel = &self.with_replaced(kernel);
        let text = kernel.source();
        let is_lowered = self.lowers(kernel);
        if let Some(Err(e)) = self.dump.as_ref().map(|dump| dump.write(kernel, is_lowered)) {
            self.failed(format!("kernel {} cannot be written to a file: {e}", kernel.name));
        }
        let parsed = match is_lowered {
            true => lowered(&text),
            false => wgpu::naga::front::wgsl::parse_str(&text).map_err(|e| e.to_string()),
        };
        let mut bindings = Vec::new();
        let as_text = || wgpu::ShaderSource::Wgsl(text.as_str().into());
        let (source, is_wgsl) = match parsed {
            Ok(module) => {
                bindings = reached(&module, &kernel.bindings());
                (wgpu::ShaderSource::Naga(Cow::Owned(module)), is_lowered)
            }
            // the device reports below what cannot be parsed, and where
            Err(_) if !is_lowered || wgpu::naga::front::wgsl::parse_str(&text).is_err() => (as_text(), true),
            Err(e) => {
                self.failed(format!("kernel {}: {}", kernel.name, one_line(e)));
                (as_text(), true)
            }
        };
        let made = |source| {
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
            let module = self.create_module(wgpu::ShaderModuleDescriptor { label: Some(kernel.name), source });
            (module, pollster::block_on(scope.pop()))
        };
        let (mut module, mut error) = made(source);
        if error.is_some() && !is_wgsl {
            // a module without its text knows no places in it
            (module, error) = made(as_text());
        }
        if let Some(error) = error {
            let info = pollster::block_on(module.get_compilation_info());
            let message = info.messages.into_iter().find(|m| m.message_type == wgpu::CompilationMessageType::Error);
            self.failed(match message {
                Some(message) => fault(kernel, &message),
                None => format!("kernel {}: {}", kernel.name, one_line(error)),
            });
        }
        Module { module, bindings }
    }
}

/// A compiled kernel, and the bindings that it reaches with their numbers.
pub struct Module {
    pub module: wgpu::ShaderModule,
    pub bindings: Vec<(u32, Binding)>,
}

/// Most characters of a source line that an error shows.
const SHOWN: usize = 100;

/// A compiler error on one line: the kernel, the place, what is wrong, the source line.
fn fault(kernel: &Kernel, message: &wgpu::CompilationMessage) -> String {
    let lines = || message.message.lines().map(str::trim);
    // the message has a headline, the source with marks, and notes
    let headline =
        lines().find_map(|l| l.split_once("error: ")).map_or_else(|| one_line(&message.message), |l| l.1.into());
    let notes = lines().filter_map(|l| l.strip_prefix("= ")).map(|note| format!(", {note}"));
    let what: String = std::iter::once(headline).chain(notes).collect();
    let name = kernel.name;
    let Some(at) = message.location else { return format!("kernel {name}: {what}") };
    let (line, column) = (at.line_number as usize, at.line_position);
    let source = kernel.source();
    let shown: String =
        source.lines().nth(line.saturating_sub(1)).unwrap_or_default().trim().chars().take(SHOWN).collect();
    let (file, line) = kernel.place(line);
    format!("kernel {name}, {file}:{line}:{column}: {what}: {shown} (--dump-kernels DIR writes the whole source)")
}

/// Functions of kernels that convert between an f64 and its two words.
const WORDS: [&str; 2] = ["real_to_bits", "real_from_bits"];

/// A kernel's module with f64 in 32-bit words; the error says what cannot be lowered.
pub fn lowered(source: &str) -> std::result::Result<wgpu::naga::Module, String> {
    naga_soft_f64::lower_wgsl(source, &WORDS)
}
