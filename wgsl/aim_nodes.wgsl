// aim_nodes: one thread per node of a lens.
// Reads bounds on the rays of the lens, in the viewer's frame, and the viewer's pose; writes the same bounds in the world.

#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> lens_nodes: array<Node>;
var<storage, read_write> nodes: array<Node>;

// Rounding of what is written, and of what kernels compute from it, relative to the sizes: 2^-20, or 16 units of 2^-24. A turned vector takes 9:
// each axis has 1 for the stored number, 1 for the viewer's axis, 1 for the product and 2 for sums, and a vector of three such axes is off by less
// than 9. The eye takes 1, adding it 1, and a kernel's own use of the node 4. What is left covers the perturbation of directions, 2^-42.
const AIM_TOLERANCE: f32 = 1.0 / 1048576.0;

// A vector of the viewer's frame in the world.
fn turned(v: vec3<f32>) -> vec3<f32> {
    return v.x * viewer.right + v.y * viewer.up + v.z * viewer.forward;
}

// At least the vector's length, also where its square is no f32 number.
fn size(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

@compute @workgroup_size(64)
fn aim_nodes(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = item_index(group, groups, lane);
    if item >= viewer.node_count {
        return;
    }
    var node = lens_nodes[item];
    if node.rays != RAYS_NONE {
        let size_p = size(viewer.eye) + size(node.p) + size(node.px) + size(node.py);
        let size_d = size(node.d) + size(node.dx) + size(node.dy);
        node.r_p += viewer.perturb + AIM_TOLERANCE * (size_p + node.r_p + viewer.perturb);
        node.r_d += AIM_TOLERANCE * (size_d + node.r_d);
        node.p = viewer.eye + turned(node.p);
        node.px = turned(node.px);
        node.py = turned(node.py);
        node.d = turned(node.d);
        node.dx = turned(node.dx);
        node.dy = turned(node.dy);
    }
    nodes[item] = node;
}
