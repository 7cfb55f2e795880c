// Reflection by microfacets of Trowbridge and Reitz (GGX; Walter et al. 2007), and emission.

#import shading/lights/arriving
#import shading/lights/openness
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/sky
#import shading/surface.wgsl
#import shading/textures

const PI: f32 = 3.14159265;

fn sent_back(lit: Lit, albedo: vec3<f32>) -> vec3<f32> {
    let material = material_at(triangle_surface(lit.slot).w);
    let n = lit.n;
    let view = lit.view;
    let open = openness(lit);
    let light_count = by_thread(shading.light_count, lit.slot);
    let base = albedo * (1.0 - material.metallic);
    let f0 = mix(material.specular, albedo, material.metallic);
    var sum = material.emissive + open * from_around(base, f0, material.alpha, n, -view);
    if !SKY && light_count == 0u {
        sum += (1.0 - shading.ambient) * open * glossy(base, f0, material.alpha, n, -view, -view);
    }
    for (var k = 0u; k < light_count; k++) {
        let light = arriving(k, lit);
        sum += (1.0 - shading.ambient) * light.strength * glossy(base, f0, material.alpha, n, -view, light.l);
    }
    return sum;
}

// The light reflected in direction v from a light of irradiance pi in direction l: a matte share, and a reflection with
// reflectance `f0` at normal incidence.
fn glossy(base: vec3<f32>, f0: vec3<f32>, alpha: f32, n: vec3<f32>, v: vec3<f32>, l: vec3<f32>) -> vec3<f32> {
    let nl = dot(n, l);
    if nl <= 0.0 {
        return vec3<f32>(0.0);
    }
    let nv = max(dot(n, v), 1e-4);
    let between = l + v;
    if dot(between, between) < 1e-12 {
        // light goes straight on, which no facet does
        return nl * base;
    }
    let h = normalize(between);
    let nh = clamp(dot(n, h), 0.0, 1.0);

    // what reflects nothing straight on does not at grazing angles (Lagarde and de Rousiers 2014)
    let grazing = min(50.0 * max(f0.x, max(f0.y, f0.z)), 1.0);
    let slant = 1.0 - clamp(dot(v, h), 0.0, 1.0);
    let fresnel = f0 + (grazing - f0) * (slant * slant * slant * slant * slant);

    // facets' share about h, and how much of them light and viewer both see (Heitz 2014)
    let a2 = alpha * alpha;
    // 1 - (n . h)^2, without what cancels
    let across = cross(n, h);
    let spread = nh * nh * a2 + dot(across, across);
    let facets = a2 / (PI * spread * spread);
    let seen = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    return nl * (base * (1.0 - fresnel) + PI * facets * seen * fresnel);
}
