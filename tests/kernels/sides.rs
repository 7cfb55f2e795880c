//! sides.wgsl: on which side of an edge a ray passes in the plane, against exact arithmetic.

use crate::exact::{Dyadic, Rng};
use crate::stages::Bench;
use anamorph_lab::twin::Real;

/// Reads two places as the words of f64, and writes which of two products is larger, the side of the edge either way round, and whether
/// the ray is between three corners: these two and one opposite, and thrice the first, one behind the other.
const PROBE: &str = "
@group(0) @binding(0) var<storage, read> edges: array<array<vec2<u32>, 4>>;
@group(0) @binding(1) var<storage, read_write> found: array<array<i32, 5>>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&edges) {
        return;
    }
    let e = edges[id.x];
    let u = vec2<real>(real_from_bits(e[0]), real_from_bits(e[1]));
    let v = vec2<real>(real_from_bits(e[2]), real_from_bits(e[3]));
    let zero = real3(0.0);
    let b = Bundle(zero, zero, zero, real3(0.0, 0.0, 1.0), zero, zero, real(1.0), real(0.0), real(0.0));
    let about = array<real3, 3>(real3(u, 1.0), real3(v, 2.0), real3(-u - v, 3.0));
    let edge_on = array<real3, 3>(real3(u, 1.0), real3(u, 2.0), real3(u, 3.0));
    found[id.x] = array<i32, 5>(
        order_of_products(u.x, v.y, u.y, v.x),
        side_of(u, v),
        side_of(v, u),
        i32(is_between(b, about)),
        i32(is_between(b, edge_on)),
    );
}
";

/// (ux, uy, vx, vy): any; almost or wholly in line with the ray, near ones and far ones; with zeros; the same place twice.
fn edges(real: Real) -> Vec<[f64; 4]> {
    let mut rng = Rng(1);
    let rounded = |v: f64| if real == Real::F64 { v } else { f64::from(v as f32) };
    let next = |v: f64, steps: i64| match real {
        Real::F64 => f64::from_bits((v.to_bits() as i64 + steps) as u64),
        Real::F32 => f64::from(f32::from_bits(((v as f32).to_bits() as i64 + steps) as u32)),
    };
    let mut list = Vec::new();
    for k in 0..40_000_i32 {
        let scale = f64::from(k % 31 - 15).exp2();
        let [x, y, a, b] = [0; 4].map(|_| rounded(rng.signed()));
        let few = [x, y, a].map(|v| (v * 2048.0).round());
        let (along, steps) = (rounded(a * scale), i64::from(k % 5 - 2));
        list.extend([
            [x, y, a * scale, b * scale],
            [x, y, next(rounded(x * along), steps), next(rounded(y * along), -steps)],
            // exactly in line
            [few[0], few[1], few[0] * few[2] * scale, few[1] * few[2] * scale],
            [x, y, x, y],
            [x, y, x, b],
            [if k % 2 == 0 { 0.0 } else { x }, if k % 3 == 0 { -0.0 } else { y }, 0.0, b],
        ]);
    }
    list
}

fn sign_of(e: [f64; 4]) -> i32 {
    let [ux, uy, vx, vy] = e.map(Dyadic::of);
    let negative = Dyadic::of(-1.0);
    i32::from(ux.times(&vy).plus(&uy.times(&vx).times(&negative)).sign())
}

/// Of a ray next to it where the ray itself meets the edge's line: a step along x, and a much smaller one along y.
fn side_of(e: [f64; 4]) -> i32 {
    let [ux, uy, vx, vy] = e;
    let order = |a: f64, b: f64| i32::from(a > b) - i32::from(a < b);
    let signs = [sign_of(e), order(uy, vy), order(vx, ux), 1];
    signs.into_iter().find(|s| *s != 0).unwrap_or(1)
}

#[test]
fn sides_are_exact() {
    let Some(bench) = Bench::open() else { return };
    let reals = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0);
    for real in reals {
        let arithmetic = match real {
            Real::F64 => include_str!("../../wgsl/arithmetic/f64.wgsl"),
            Real::F32 => include_str!("../../wgsl/arithmetic/f32.wgsl"),
        };
        let shared =
            [include_str!("../../wgsl/rays/affine_bundle.wgsl"), include_str!("../../wgsl/rays/straight/sides.wgsl")]
                .concat();
        let edges = edges(real);
        let words: Vec<[u64; 4]> = edges.iter().map(|e| e.map(f64::to_bits)).collect();
        let found = bench.probe(&[arithmetic, &shared, PROBE].concat(), &words, 5);
        let mut ties = 0;
        for (k, (&e, found)) in edges.iter().zip(found.chunks_exact(5)).enumerate() {
            let [ux, uy, vx, vy] = e;
            let expected = [sign_of(e), side_of(e), side_of([vx, vy, ux, uy])];
            assert_eq!(found[..3], expected.map(|s| s as u32), "{real:?}: {e:?}");
            // the first of each six is any
            assert!(k % 6 > 0 || found[3] == 1, "{real:?}: {e:?} goes about the ray");
            assert_eq!(found[4], 0, "{real:?}: {e:?} is edge-on");
            ties += usize::from(expected[0] == 0);
        }
        println!("{real:?}: {} edges, {ties} of them through the ray", edges.len());
        assert!(ties > edges.len() / 4);
    }
}
