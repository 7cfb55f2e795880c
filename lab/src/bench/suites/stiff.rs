//! Scenes that grow stiff, by this engine in all its arithmetics and by rivals.

use crate::bench::case::{Arm, Case};
use crate::bench::row::Stiffness;
use crate::bench::stiff::{Family, families};
use anamorph::internals::engine::Arithmetic;

fn case(family: &Family, value: f64) -> Case {
    let single = Arm::ours().arithmetic(Arithmetic::Single, "f32 alone");
    let double = Arm::ours().arithmetic(Arithmetic::Double, "f64 throughout");
    let rivals = family.rivals.iter().map(|name| Arm::rival(name));
    let arms = [Arm::ours(), single, double].into_iter().chain(rivals).collect();
    let stiffness = Stiffness { family: family.name.into(), parameter: family.parameter.into(), value };
    Case::new(format!("{}: {value:e} {}", family.name, family.parameter), (family.scene)(value), arms)
        .counted()
        .stiff(stiffness)
}

pub fn cases() -> Vec<Case> {
    families().iter().flat_map(|f| f.values.iter().map(|v| case(f, *v))).collect()
}

/// The mildest and the stiffest of some.
pub fn quick() -> Vec<Case> {
    const FEW: [&str; 3] = ["double root", "needles", "focus of a mirror"];
    let all = families();
    let few = all.iter().filter(|f| FEW.contains(&f.name));
    few.flat_map(|f| [f.values[0], f.values[f.values.len() - 1]].map(|v| case(f, v))).collect()
}
