//! cull: the kernel against its twin, from the same bytes.

use crate::common::ALL_T;
use crate::stages::{
    Bench, Case, POISON, assert_poisoned, cases, counters, list, many_clusters, random_case, read, read_list, run,
    seeds, upload,
};
use anamorph::internals::engine::Capacities;
use anamorph::internals::engine::stage;
use anamorph::internals::gpu::kernels::{Kernel, Variant};
use anamorph::internals::gpu::layout::{COUNTERS, Counter, RAYS_AFFINE};
use anamorph_lab::twin::cull::{
    Address, Bound, Culled, HAND_ON, HAND_ON_LEVEL, REFINEMENTS, cull, hands_on, may_hand_on, node_meets,
};
use anamorph_lab::twin::{KernelInputs, LARGE, Real, bin};
use std::collections::HashMap;

/// What the kernel left: its work items and its counters.
struct Kept {
    work: Vec<[u32; 2]>,
    counters: Vec<u32>,
}

fn run_kernel(bench: &mut Bench, case: &Case, input: &KernelInputs) -> Kept {
    let (gpu, stages) = bench.stages(case.variant(Real::F32, false), &[]);
    let mut buffers = upload(gpu, input);
    let (queue, work) = (input.params.queue_capacity as usize, input.params.work_capacity as usize);
    for name in ["queue_even", "queue_odd"] {
        list(gpu, &mut buffers, name, &[], queue);
    }
    list(gpu, &mut buffers, "work", &[], work);
    let steps = input.cull_steps;
    let zeros: Vec<(u32, u32)> = (1..=steps).chain([Counter::Work.index()]).map(|k| (k, 0)).collect();
    counters(gpu, &mut buffers, &zeros);
    run(gpu, |pass| {
        stages.encode(
            gpu,
            pass,
            &[&buffers],
            &stage::cull::cull(input.params.cluster_count, steps),
            &mut Default::default(),
        )
    });

    // nothing but the lists' own items and the counters of its steps may have changed
    let counters = read(gpu, &buffers, "counters");
    let owned = |k: u32| (1..steps).contains(&k) || k == Counter::Work.index();
    for k in (0..COUNTERS).filter(|&k| !owned(k) && k != steps) {
        assert_eq!(counters[k as usize], POISON, "{}: counter {k}", case.name);
    }
    for (name, parity) in [("queue_even", 0), ("queue_odd", 1)] {
        let queues = (1..steps).filter(|k| k % 2 == parity);
        let written = queues.map(|k| counters[k as usize].min(input.params.queue_capacity)).max().unwrap_or(0);
        assert_poisoned(&read(gpu, &buffers, name), 2 * written as usize, &format!("{}, {name}", case.name));
    }
    let items = read_list(gpu, &buffers, "work");
    let count = (counters[Counter::Work.index() as usize] as usize).min(work);
    assert_poisoned(items.as_flattened(), 2 * count, &format!("{}, work", case.name));
    Kept { work: items[..count].to_vec(), counters }
}

/// A node and those above it, lowest first.
fn upwards(input: &KernelInputs, at: Address) -> Vec<Address> {
    let inside = |at: &Address| at.cell().is_some() || at.level < input.params.levels;
    std::iter::successors(Some(at), |at| Some(input.parent(*at))).take_while(inside).collect()
}

/// The item of `at` or of a node above it.
fn item_above(input: &KernelInputs, items: &HashMap<[u32; 2], usize>, cluster: u32, at: Address) -> Option<Address> {
    upwards(input, at).into_iter().find(|at| items.contains_key(&[cluster, at.pack()]))
}

/// What is wrong with a list of work items: items that must be there and are not, items twice or below others, items
/// that no bound allows, nodes handed on undivided, or not, against the rule.
fn differences(input: &KernelInputs, kernel: &[[u32; 2]], needed: &Culled) -> Vec<String> {
    let mut wrong = Vec::new();
    let levels = input.params.levels;
    let mut items: HashMap<[u32; 2], usize> = HashMap::new();
    kernel.iter().for_each(|item| *items.entry(*item).or_default() += 1);
    for (&[cluster, node], &count) in &items {
        let at = Address::unpack(node);
        let size = |k: u32, l: &[u32; 8]| k < l[at.level as usize];
        let in_level = || size(at.x, &input.params.level_width) && size(at.y, &input.params.level_height);
        let exists = match at.cell() {
            Some(cell) => (cell as usize) < input.cells.len(),
            None => at.level < levels && in_level(),
        };
        let exists = exists && (cluster as usize) < input.clusters.len();
        if !exists {
            wrong.push(format!("cluster {cluster}, {at:?}: no such item"));
            continue;
        }
        let path = upwards(input, at);
        if count > 1 || path[1..].iter().any(|above| items.contains_key(&[cluster, above.pack()])) {
            wrong.push(format!("cluster {cluster}, {at:?}: more than once"));
        }
        for above in
            path.iter().filter(|&&above| !node_meets(input, above, &input.clusters[cluster as usize], Bound::ALLOWED))
        {
            wrong.push(format!("cluster {cluster}, {at:?}: no ray of {above:?} comes near it"));
        }
        let met = |at: Address, bound| {
            input
                .children(at)
                .into_iter()
                .filter(|&child| node_meets(input, child, &input.clusters[cluster as usize], bound))
                .count()
        };
        // by the twin's rule, or because an extent says where in the bundle the cluster is seen
        if input.is_descended(at) && !may_hand_on(input, at) {
            wrong.push(format!("cluster {cluster}, {at:?}: not descended"));
        }
        for &above in &path[1..] {
            if !input.is_descended(above) || hands_on(input, above, met(above, Bound::NEEDED)) {
                wrong.push(format!("cluster {cluster}, {above:?}: not handed on"));
            }
        }
    }
    for &[cluster, node] in &needed.work {
        // what the twin hands on undivided the kernel may have descended, if it met fewer children
        for at in lowest(input, Address::unpack(node)) {
            let must = node_meets(input, at, &input.clusters[cluster as usize], Bound::NEEDED);
            if must && item_above(input, &items, cluster, at).is_none() {
                wrong.push(format!("cluster {cluster}, {at:?}: missing"));
            }
        }
    }
    wrong
}

/// The nodes of level 1.
fn first_nodes(input: &KernelInputs) -> Vec<Address> {
    let p = &input.params;
    (0..p.level_height[1]).flat_map(|y| (0..p.level_width[1]).map(move |x| Address { level: 1, x, y })).collect()
}

/// The nodes below one, or itself, from which cull goes on no further.
fn lowest(input: &KernelInputs, at: Address) -> Vec<Address> {
    if !input.is_descended(at) {
        return vec![at];
    }
    input.children(at).into_iter().flat_map(|child| lowest(input, child)).collect()
}

/// Lowest nodes in which a triangle of a cluster truly covers a pixel, whatever the bounds say; at any t, so only for
/// cameras that look both ways.
fn truly_met(input: &KernelInputs) -> Vec<[u32; 2]> {
    let nodes = first_nodes(input).into_iter().flat_map(|node| lowest(input, node));
    let all: Vec<[u32; 2]> = nodes.flat_map(|n| (0..input.clusters.len() as u32).map(move |c| [c, n.pack()])).collect();
    let covers = |item: &[u32; 2]| bin::bin(input, &[*item], Real::F64).iter().any(|b| b.certain != 0);
    all.into_iter().filter(covers).collect()
}

#[test]
fn the_kernel_keeps_what_it_must_and_nothing_that_no_bound_allows() {
    let Some(mut bench) = Bench::open() else { return };
    let (mut multi_level, mut handed_on, mut cells) = (0, 0, 0);
    for case in cases().into_iter().chain([many_clusters()]).chain(seeds().map(random_case)) {
        let tables = case.tables();
        let large = Capacities { queue: 4096, work: 16384, ..LARGE };
        for input in case.inputs(&tables, large) {
            let kernel = run_kernel(&mut bench, &case, &input);
            let needed = cull(&input, Bound::NEEDED);
            let wrong = differences(&input, &kernel.work, &needed);
            assert!(wrong.is_empty(), "{}: {} differences, the first: {}", case.name, wrong.len(), wrong[0]);
            let plain = cull(&input, Bound::PLAIN);
            println!("{}: {} items, twin {}", case.name, kernel.work.len(), plain.work.len());
            multi_level += u32::from(input.params.levels > 2);
            let at = |w: &[u32; 2]| Address::unpack(w[1]);
            handed_on += kernel.work.iter().filter(|w| at(w).cell().is_none() && at(w).level > 1).count();
            cells += kernel.work.iter().filter(|w| at(w).cell().is_some()).count();
            if input.nodes.iter().any(|n| n.rays == RAYS_AFFINE) {
                assert!(plain.queues.len() as u32 == input.cull_steps, "{}", case.name);
            }
        }
    }
    assert!(
        multi_level > 0 && handed_on > 0 && cells > 0,
        "the cases must descend ({multi_level}), hand on ({handed_on}) and come to cells ({cells})"
    );
}

#[test]
fn every_cluster_that_is_truly_seen_in_a_node_is_kept() {
    let Some(mut bench) = Bench::open() else { return };
    let both_ways = |c: &Case| c.camera.t_range == ALL_T;
    for case in cases().into_iter().chain(seeds().map(random_case)).filter(both_ways) {
        let tables = case.tables();
        for input in case.inputs(&tables, Capacities { queue: 4096, work: 16384, ..LARGE }) {
            let kernel = run_kernel(&mut bench, &case, &input);
            let items: HashMap<[u32; 2], usize> = kernel.work.iter().map(|w| (*w, 1)).collect();
            let seen = truly_met(&input);
            for [cluster, node] in seen {
                let at = Address::unpack(node);
                assert!(item_above(&input, &items, cluster, at).is_some(), "{}: {cluster}, {at:?}", case.name);
            }
        }
    }
}

#[test]
fn counters_keep_counting_past_the_end_of_full_lists() {
    let Some(mut bench) = Bench::open() else { return };
    let case = cases().into_iter().find(|c| c.name == "large").expect("a large case");
    let tables = case.tables();
    let input = case.inputs(&tables, Capacities { queue: 4096, work: 16384, ..LARGE })[0];
    let whole = run_kernel(&mut bench, &case, &input);
    let input = case.inputs(&tables, Capacities { queue: 4096, work: 10, ..LARGE })[0];
    let overflowed = run_kernel(&mut bench, &case, &input);
    assert!(whole.work.len() > 10 && overflowed.work.len() == 10);
    assert_eq!(overflowed.counters, whole.counters);
    assert!(overflowed.work.iter().all(|item| whole.work.contains(item)));
    // a queue that runs over loses items, but never writes behind its end (run_kernel asserts that)
    let input = case.inputs(&tables, Capacities { queue: 3, work: 16384, ..LARGE })[0];
    let short = run_kernel(&mut bench, &case, &input);
    assert!(short.counters[1] == whole.counters[1] && short.work.len() < whole.work.len());
}

/// Two rules are the same numbers on both sides; the other numbers of the kernel are its own.
#[test]
fn the_twin_s_constants_are_the_kernel_s() {
    let source = Kernel::new("cull.wgsl", Variant::every(true, true)[0], &[]).source();
    for (name, value) in [("HAND_ON", HAND_ON as u32), ("HAND_ON_LEVEL", HAND_ON_LEVEL), ("REFINEMENTS", REFINEMENTS)] {
        assert!(source.contains(&format!("const {name}: u32 = {value}u;")), "{name} is not {value}");
    }
}

#[test]
fn the_comparison_sees_planted_errors() {
    let case = cases().into_iter().find(|c| c.name == "large").expect("a large case");
    let tables = case.tables();
    let input = case.inputs(&tables, LARGE)[0];
    let needed = cull(&input, Bound::NEEDED);
    let right = cull(&input, Bound::PLAIN).work;
    assert_eq!(differences(&input, &right, &needed), Vec::<String>::new());
    let found = |change: &dyn Fn(&mut Vec<[u32; 2]>), words: &str| {
        let mut work = right.clone();
        change(&mut work);
        let wrong = differences(&input, &work, &needed);
        assert!(wrong.iter().any(|w| w.contains(words)), "{words}: {wrong:?}");
    };
    let level = |w: &[u32; 2]| Address::unpack(w[1]).level;
    let strictly =
        |w: &&[u32; 2]| node_meets(&input, Address::unpack(w[1]), &input.clusters[w[0] as usize], Bound::NEEDED);
    let first = *right.iter().filter(strictly).find(|w| level(w) == 1).unwrap();
    found(&|work| work.retain(|w| *w != first), "missing");
    found(&|work| work.push(first), "more than once");
    found(&|work| work.push([first[0], Address { level: 1, x: 4000, y: 0 }.pack()]), "no such item");
    found(&|work| work.push([first[0], input.parent(Address::unpack(first[1])).pack()]), "more than once");
    let nodes = first_nodes(&input);
    let mut all = (0..input.clusters.len() as u32).flat_map(|c| nodes.iter().map(move |&at| (c, at)));
    let far = all.find(|&(c, at)| !node_meets(&input, at, &input.clusters[c as usize], Bound::ALLOWED)).unwrap();
    found(&|work| work.push([far.0, far.1.pack()]), "no ray of");
    let handed = *right.iter().find(|w| level(w) > 1).unwrap();
    found(
        &|work| {
            work.retain(|w| *w != handed);
            let children = input.children(Address::unpack(handed[1])).into_iter();
            work.extend(
                children
                    .filter(|&c| node_meets(&input, c, &input.clusters[handed[0] as usize], Bound::PLAIN))
                    .map(|c| [handed[0], c.pack()]),
            );
        },
        "not handed on",
    );
}
