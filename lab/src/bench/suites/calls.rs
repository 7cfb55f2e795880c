//! Whole calls: from the change to the arrays in the caller's memory.

use crate::bench::calls::{Lens, Motion, Plan, Work};
use crate::bench::case::{Arm, Case};

/// Poses of the path.
const POSES: u32 = 100;
/// Images of a batch, and of a call of many.
const IMAGES: u32 = 200;

/// Triangles of the cases that cross cameras, sizes and motions.
const CROSSED: u32 = 100_000;

const SIZES: [(u32, u32); 2] = [(320, 240), (1920, 1080)];
const MOTIONS: [Motion; 3] = [Motion::Still, Motion::Objects, Motion::Vertices];

fn images(lens: Lens, motion: Motion, triangles: u32, size: (u32, u32)) -> Plan {
    Plan { work: Work::Image, lens, motion, triangles, size, poses: POSES }
}

fn case(plan: Plan) -> Case {
    let (width, height) = plan.lens.own_size().unwrap_or(plan.size);
    let moving = match plan.motion {
        Motion::Still => "",
        Motion::Objects => ", objects move",
        Motion::Vertices => ", vertices move",
    };
    let work = match plan.work {
        Work::Image => String::new(),
        Work::Views => format!(", {} at once", plan.poses),
        Work::Batch => format!(", {} EXRs", plan.poses),
    };
    let (lens, thousands) = (plan.lens.name(), plan.triangles / 1000);
    plan.case(format!("{lens}, {thousands}k, {width} x {height}{moving}{work}"))
}

/// Every camera at every size with every motion.
fn crossed(sizes: &[(u32, u32)], motions: &[Motion]) -> Vec<Plan> {
    let mut all = Vec::new();
    for &motion in motions {
        for (k, &size) in sizes.iter().enumerate() {
            let has_size = |lens: &&Lens| k == 0 || lens.own_size().is_none();
            all.extend(Lens::ALL.iter().filter(has_size).map(|lens| images(*lens, motion, CROSSED, size)));
        }
    }
    all
}

/// Many small images.
fn many(count: u32, triangles: u32) -> [Plan; 2] {
    let small = Plan { poses: count, ..images(Lens::Pinhole, Motion::Still, triangles, (160, 120)) };
    [Work::Views, Work::Batch].map(|work| Plan { work, ..small })
}

pub fn cases() -> Vec<Case> {
    let scaled = |triangles: u32| {
        let case = case(images(Lens::Pinhole, Motion::Still, triangles, SIZES[0]));
        let arms = vec![Arm::ours().parameter("triangles", f64::from(triangles))];
        Case { arms, ..case }
    };
    let by_triangles = [15_000, 1_000_000, 10_000_000].map(scaled);
    crossed(&SIZES, &MOTIONS).into_iter().chain(many(IMAGES, 15_000)).map(case).chain(by_triangles).collect()
}

pub fn quick() -> Vec<Case> {
    let small = [(160, 120)];
    let still = crossed(&small, &MOTIONS[..1]);
    let moved = MOTIONS[1..].iter().map(|motion| images(Lens::Pinhole, *motion, CROSSED, small[0]));
    still.into_iter().chain(moved).map(|plan| Plan { poses: 8, ..plan }).chain(many(16, 15_000)).map(case).collect()
}
