// What a path meets, through a hierarchy of places and those of the meshes that stand there.

#import hierarchy/followed.wgsl
#import hierarchy/nodes.wgsl
#import rays/straight/placed.wgsl
#import rays/stretch
#import vertices/placed/vertex.wgsl

fn followed(path: Path, stretch: Stretch, before: Seen, rounds_before: u32) -> Followed {
    let d = stretch.d;
    let least = vec3<f32>(1.0e-20);
    let inverse = 1.0 / select(d, select(least, -least, d < vec3<f32>(0.0)), abs(d) < least);
    let octant = select(4u, 0u, d.x < 0.0) | select(2u, 0u, d.y < 0.0) | select(1u, 0u, d.z < 0.0);
    var seen = before;
    var rounds = rounds_before;
    var tested = 0u;
    var waiting: array<vec2<u32>, STACK>;
    var count = 0u;
    var group = vec2<u32>(bvh_row(0u).y, 0x80000000u);
    loop {
        // take the nearest box of the group, and look at the eight below it: as `walked`
        let bit = firstLeadingBit(group.y);
        let node = group.x + countOneBits(group.y & ~(0xffffffffu << ((bit - 24u) ^ octant)));
        group.y &= ~(1u << bit);
        waiting[count] = group;
        count += select(0u, 1u, group.y >= 0x1000000u);
        let met = box_hits(node, stretch, inverse, octant, last_of(stretch, seen));
        group = met.nodes;
        rounds += 1u;

        // follow the path through the meshes of those that are leaves
        var leaves = met.triangles;
        loop {
            if leaves == 0u || rounds >= ROUNDS {
                break;
            }
            take_instance(instance_in_leaf(met.first_triangle + firstTrailingBit(leaves)));
            leaves &= leaves - 1u;
            let own = placed_stretch(stretch);
            let known = seen_in(own, seen);
            let found = walked(path, own.stretch, known, rounds, instance_root());
            seen = seen_from(own, seen, known, found.seen);
            rounds = found.rounds;
            tested += found.tested;
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
