// What a path meets, through a bounding volume hierarchy.

#import hierarchy/nodes.wgsl
#import primitives/met
#import rays/stretch
#import vertices/traced

// The most boxes and triangles that a path is tested against: software adapters end a loop when its 16 threads together have taken 65535
// rounds.
const ROUNDS: u32 = 4000u;

// Groups of boxes that wait; the host refuses deeper hierarchies.
const STACK: u32 = 32u;

// What a path met, after how many nodes and triangles in all, and how many triangles of its stretch.
struct Followed {
    seen: Seen,
    rounds: u32,
    tested: u32,
}

// Walks the hierarchy below `root`, with eight boxes a node (Ylitie et al. 2017). A group stands for the children of one node that are nodes themselves:
// x is the index of the first; the low byte of y says which of the eight children are nodes, the high byte which of these the path may
// still meet, the nearest in the highest bit.
fn walked(path: Path, stretch: Stretch, before: Seen, rounds_before: u32, root: u32) -> Followed {
    let d = stretch.d;
    let least = vec3<f32>(1.0e-20);
    let inverse = 1.0 / select(d, select(least, -least, d < vec3<f32>(0.0)), abs(d) < least);
    let octant = select(4u, 0u, d.x < 0.0) | select(2u, 0u, d.y < 0.0) | select(1u, 0u, d.z < 0.0);
    var seen = before;
    var rounds = rounds_before;
    var tested = 0u;
    var waiting: array<vec2<u32>, STACK>;
    var count = 0u;
    var group = vec2<u32>(root, 0x80000000u);
    loop {
        // take the nearest box of the group, and look at the eight below it
        let bit = firstLeadingBit(group.y);
        let node = group.x + countOneBits(group.y & ~(0xffffffffu << ((bit - 24u) ^ octant)));
        group.y &= ~(1u << bit);
        waiting[count] = group;
        count += select(0u, 1u, group.y >= 0x1000000u);
        let met = box_hits(node, stretch, inverse, octant, last_of(stretch, seen));
        group = met.nodes;
        rounds += 1u + countOneBits(met.triangles);
        tested += countOneBits(met.triangles);

        // test the triangles of those that are leaves
        var triangles = met.triangles;
        loop {
            if triangles == 0u {
                break;
            }
            let index = met.first_triangle + firstTrailingBit(triangles);
            triangles &= triangles - 1u;
            seen = with_primitive(path, stretch, seen, bvh_triangle(index));
        }
        if rounds >= ROUNDS {
            break;
        }
        if group.y < 0x1000000u {
            if count == 0u {
                break;
            }
            count--;
            group = waiting[count];
        }
    }
    return Followed(seen, rounds, tested);
}
