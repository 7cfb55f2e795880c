// Triangles of meshes that stand in several places: the tables hold each mesh once. Slots and ids count the triangles of all places, one place
// after the other. A thread looks at one place at a time. `instances`: twelve rows a place: its first slot, how much larger its slots and ids are
// than those of its mesh, and the root of its mesh's hierarchy, with a bit that says that the mesh is mirrored (row 0); the matrix from the
// hierarchy of places to that of the mesh (1 to 3); the largest sum of the sizes of the first three numbers of a row of that matrix, the place's
// first id, the place in the leaf whose number is this row's place, and in the first place the number of places (4); the matrix from stored
// vertices to vertices relative to the anchor, in f32 (5 to 7), and what f32 leaves of it (8 to 10); the error of the first matrix, without
// that of f32 arithmetic (11).

#import shared/table.wgsl
#import vertices/placed/real.wgsl

var instances: texture_2d<u32>;
var triangles: texture_2d<u32>;

// Errors of a coordinate as stored, in units of the largest.
const CORNER_UNITS: f32 = 1.0;

const INSTANCE_ROWS: u32 = 12u;

// The place that this thread looks at, and its first row.
var<private> instance: u32;
var<private> instance_head: vec4<u32>;

// All pixels see the scene at the same time.
fn take_moment(pixel: u32) {}

fn row_of(place: u32, row: u32) -> vec4<u32> {
    return textureLoad(instances, table_texel(INSTANCE_ROWS * place + row), 0);
}

// A row of the place that this thread looks at.
fn instance_row(row: u32) -> vec4<u32> {
    return row_of(instance, row);
}

fn take_instance(place: u32) {
    instance = place;
    instance_head = row_of(place, 0u);
}

fn slots_before() -> u32 {
    return instance_head.y;
}

fn ids_before() -> u32 {
    return instance_head.z;
}

// The root of the hierarchy of the mesh that stands there.
fn instance_root() -> u32 {
    return instance_head.w & 0x7fffffffu;
}

// The mesh stands there as in a mirror: fronts are where backs are.
fn is_mirrored() -> bool {
    return (instance_head.w >> 31u) == 1u;
}

// The place that is in a leaf of the hierarchy of all.
fn instance_in_leaf(leaf: u32) -> u32 {
    return row_of(leaf, 4u).z;
}

// The last place in which a word of a row is not above a value; from place to place it does not fall.
fn last_instance(row: u32, word: u32, value: u32) -> u32 {
    var low = 0u;
    var high = row_of(0u, 4u).w;
    loop {
        if high - low <= 1u {
            break;
        }
        let middle = (low + high) / 2u;
        let is_above = row_of(middle, row)[word] > value;
        low = select(middle, low, is_above);
        high = select(high, middle, is_above);
    }
    return low;
}

// The packed triangle of a slot, at whose place the thread then looks.
fn triangle_at(slot: u32) -> vec4<u32> {
    take_instance(last_instance(0u, 0u, slot));
    let triangle = textureLoad(triangles, table_texel(own_slot(slot)), 0);
    return vec4<u32>(triangle.xyz, triangle.w + ids_before());
}

// The slot of the same triangle in the tables.
fn own_slot(slot: u32) -> u32 {
    return slot - slots_before();
}
