// solve: one thread per (point, candidate leaf): all places of the leaf's rays, pieces or curves, that pass through the point.
// Reads what sift found, pieces or cells, and points; writes to `solved`, for each candidate, the number of its images, all of them proven,
// or NONE where something is not proven; and the images to the list `images`, in any order, its length to `counts`. A candidate whose images
// the list cannot hold is not proven: `counts` then is larger than the list. Bits of points of which anything is not proven are set in
// `wanted`.

#import project/answer.wgsl
#import project/layout.wgsl
#import project/solved
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> found: array<u32>;
var<storage, read> leaves: array<u32>;
var<storage, read> points: array<SolvePoint>;
var<storage, read_write> counts: array<atomic<u32>>;
var<storage, read_write> images: array<SolveImage>;
var<storage, read_write> solved: array<u32>;
var<storage, read_write> wanted: array<atomic<u32>>;

@compute @workgroup_size(64)
fn solve(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a candidate of a point
    let item = item_index(group, groups, lane);
    let point = item / solving.slots;
    let slot = item % solving.slots;
    if point >= solving.points {
        return;
    }
    let list = point * (solving.slots + 1u);
    let count = found[list];
    if count > solving.slots {
        // sift has not listed all
        solved[item] = NONE;
        if slot == 0u {
            atomicOr(&wanted[point / 32u], 1u << (point % 32u));
        }
        return;
    }
    if slot >= count {
        solved[item] = 0u;
        return;
    }

    // solve it, and put its images down
    let leaf = leaves[found[list + 1u + slot]];
    var answer: Answer;
    answer.is_proven = false;
    if leaf != NONE {
        answer = solved_at(leaf, points[point]);
    }
    if answer.is_proven && answer.count > 0u {
        let first = atomicAdd(&counts[0], answer.count);
        answer.is_proven = first + answer.count <= solving.images_most;
        for (var i = 0u; i < answer.count && first + i < solving.images_most; i++) {
            // places that are too few for all stay empty
            answer.images[i].point = select(NONE, point, answer.is_proven);
            answer.images[i].piece = leaf;
            images[first + i] = answer.images[i];
        }
    }
    solved[item] = select(NONE, answer.count, answer.is_proven);
    if !answer.is_proven {
        atomicOr(&wanted[point / 32u], 1u << (point % 32u));
    }
}
