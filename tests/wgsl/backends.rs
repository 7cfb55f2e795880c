//! naga's translations of a kernel for the backends of wgpu, as wgpu asks for them.

use anamorph::internals::gpu::kernels::Kernel;
use naga::back::{hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

/// A language that kernels are translated to.
#[derive(Debug, Clone, Copy)]
pub enum Language {
    SpirV,
    Hlsl,
    Msl,
}

impl Language {
    pub const ALL: [Language; 3] = [Language::SpirV, Language::Hlsl, Language::Msl];

    /// The text of an entry point of a module without overrides, which uses these capabilities; of SPIR-V the entry point's name. The
    /// error is naga's.
    pub fn translate(
        self,
        module: &Module,
        info: &ModuleInfo,
        caps: Capabilities,
        entry: (ShaderStage, &str),
    ) -> Result<String, String> {
        let entry_point = Some((entry.0, entry.1.to_string()));
        let text = match self {
            Language::SpirV => {
                let options = spv::PipelineOptions { shader_stage: entry.0, entry_point: entry.1.into() };
                let words = spv::write_vec(module, info, &spv::Options::default(), Some(&options));
                assert_eq!(words.map_err(|e| e.to_string())?.first(), Some(&0x0723_0203), "the magic number of SPIR-V");
                String::from(entry.1)
            }
            Language::Hlsl => {
                let options = hlsl::Options { shader_model: shader_model(caps), ..Default::default() };
                let mut text = String::new();
                let pipeline = hlsl::PipelineOptions { entry_point };
                let mut writer = hlsl::Writer::new(&mut text, &options, &pipeline);
                let written = writer.write(module, info, None).map_err(|e| e.to_string())?;
                written.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
                text
            }
            Language::Msl => {
                let policy = BoundsCheckPolicy::Restrict;
                let options = msl::Options {
                    lang_version: MSL_VERSION,
                    bounds_check_policies: BoundsCheckPolicies {
                        index: policy,
                        buffer: policy,
                        image_load: policy,
                        binding_array: BoundsCheckPolicy::Unchecked,
                    },
                    ..Default::default()
                };
                let pipeline = msl::PipelineOptions { entry_point, ..Default::default() };
                let (text, written) =
                    msl::write_string(module, info, &options, &pipeline).map_err(|e| e.to_string())?;
                written.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
                text
            }
        };
        assert!(text.contains(entry.1), "a text without {}", entry.1);
        Ok(text)
    }
}

/// macOS 12: the first with 64-bit atomics.
const MSL_VERSION: (u8, u8) = (2, 4);

/// The least for these capabilities: 5.1 is what wgpu takes without dxcompiler.dll.
fn shader_model(caps: Capabilities) -> hlsl::ShaderModel {
    if caps.contains(Capabilities::SHADER_INT64_ATOMIC_MIN_MAX) {
        hlsl::ShaderModel::V6_6
    } else if caps.intersects(Capabilities::SHADER_INT64 | Capabilities::SUBGROUP) {
        hlsl::ShaderModel::V6_0
    } else {
        hlsl::ShaderModel::V5_1
    }
}

/// Translates a kernel's entry points, with f64 to all languages but MSL; an error is naga's.
pub fn assert_translated(kernel: &Kernel, module: &Module, info: &ModuleInfo, caps: Capabilities) {
    let mut constants = naga::back::PipelineConstants::default();
    constants.extend(kernel.constants.iter().map(|&(name, value)| (name.to_string(), value)));
    let languages = if caps.contains(Capabilities::FLOAT64) { &Language::ALL[..2] } else { &Language::ALL };
    for entry in &module.entry_points {
        let entry = (entry.stage, entry.name.as_str());
        let (module, info) = naga::back::pipeline_constants::process_overrides(module, info, Some(entry), &constants)
            .unwrap_or_else(|e| panic!("{}: {e}", kernel.name));
        for language in languages {
            let translated = language.translate(&module, &info, caps, entry);
            assert!(translated.is_ok(), "{} to {language:?}: {translated:?}", entry.1);
        }
    }
}

/// naga has no f64 in MSL; and in HLSL it writes 64-bit numbers whose bits are taken as they are, so that HLSL converts them.
#[test]
fn what_is_not_translated_is_in_the_documentation() {
    let limits = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/reference/limits.md")).unwrap();
    let source = "@group(0) @binding(0) var<storage, read_write> list: array<u64>;
        @compute @workgroup_size(1) fn bits() { list[1] = bitcast<u64>(f64(f32(list[0])) + 1.0lf); }";
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let caps = Capabilities::FLOAT64 | Capabilities::SHADER_INT64;
    let info = Validator::new(ValidationFlags::all(), caps).validate(&module).unwrap();
    let translate = |language: Language| language.translate(&module, &info, caps, (ShaderStage::Compute, "bits"));
    translate(Language::SpirV).unwrap();
    let hlsl = translate(Language::Hlsl).unwrap();
    assert!(hlsl.contains("double") && !hlsl.contains("asuint") && !hlsl.contains("asdouble"), "{hlsl}");
    let panic = std::panic::catch_unwind(|| translate(Language::Msl)).expect_err("a panic");
    let rows = [
        format!("| the adapter's f64 | MSL | panics: {} |", panic.downcast_ref::<String>().expect("a message")),
        "| the adapter's f64 | HLSL | no error, but `bitcast` of 64-bit numbers converts them |".to_string(),
    ];
    let (_, table) = limits.split_once("| kernels with | to | naga |\n|---|---|---|\n").expect("the table");
    let table: Vec<&str> = table.lines().take_while(|line| line.starts_with('|')).collect();
    assert_eq!(table, rows);
}
