// White distant lights without shadows: one vec4 each, the direction of travel.
// Provides: arriving, openness
// Needs: Arriving, Lit, light_row

fn arriving(k: u32, lit: Lit) -> Arriving {
    return Arriving(-light_row(k).xyz, vec3<f32>(1.0));
}

fn openness(lit: Lit) -> f32 {
    return 1.0;
}
