//! Ready scenes on built-in geometry.

pub struct Example { pub name: &'static str, pub shows: &'static str }
pub enum Part { Text(String), Vectors { width: u64, height: u64, numbers: Vec<f64> } }
pub const EXAMPLES: [Example; 0] = [];
impl Example { pub fn parts(&self) -> Vec<(String, Part)> { vec![] } pub fn scene_name(&self) -> String { String::new() } }
