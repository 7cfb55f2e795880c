// Lights of any colour, far away or in a place: two rows each. The first is the way that its light travels, or where it is and the
// distance at which it is as bright as one far away; the second its colour, and 1 where things hide it.
// Provides: arriving
// Needs: Arriving, Lit, largest, reaches
// Binds: lights

fn arriving(k: u32, lit: Lit) -> Arriving {
    let from_there = lights[2u * k];
    let colour = lights[2u * k + 1u];
    var l = -from_there.xyz;
    var strength = colour.xyz;
    // infinity
    var far = bitcast<f32>(0x7f7fffffu);
    if from_there.w > 0.0 {
        let way = from_there.xyz - lit.p;
        let most = max(largest(way), 1e-30);
        far = most * max(length(way / most), 1e-30);
        l = way / far;
        let nearness = from_there.w / far;
        strength *= nearness * nearness;
    }
    if colour.w > 0.0 && dot(lit.n, l) > 0.0 && !reaches(lit, l, far) {
        strength = vec3<f32>(0.0);
    }
    return Arriving(l, strength);
}
