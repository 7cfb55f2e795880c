// Pictures thrown onto surfaces: colours in place of a surface's own, and light.

#import primitives/flat
#import rays/ray.wgsl
#import shading/lights/openness
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/pictures/places.wgsl
#import shading/surface.wgsl
#import shading/textures/filter.wgsl
#import shading/textures/mapped.wgsl
#import vertices/vertex

const PICTURES: bool = true;

// The diffuse colour that is lit, and what is seen as it is.
struct Painted {
    lit: vec3<f32>,
    seen: vec3<f32>,
}

// How the hit moves on the triangle's plane for a pixel to the right and one down, times the width of the filter.
var<private> hit_right: vec3<f32>;
var<private> hit_down: vec3<f32>;

// What a picture shows at a hit.
struct Shown {
    share: f32,             // 0: it does not reach it
    colour: vec3<f32>,
    l: vec3<f32>,           // unit, to the start of the ray that shows the hit
    far: f32,               // world units
    cosine: f32,
}

fn shown_by(picture: Header, lit: Lit) -> Shown {
    var shown: Shown;
    shown.share = 0.0;
    let place = place_of(picture, picture.scale * lit.p);
    if !place.is_there {
        return shown;
    }
    let speed = length(place.d);
    shown.l = -place.d / speed;
    shown.far = (place.t + picture.skipped) * speed / picture.scale;
    shown.cosine = dot(lit.n, shown.l);
    let border = min(place.px, picture.size - place.px);
    let inside = select(1.0, clamp(min(border.x, border.y) / picture.feather, 0.0, 1.0), picture.feather > 0.0);
    if shown.cosine <= 0.0 || shown.far <= 0.0 || inside <= 0.0 || (picture.occlusion != 0u && !reaches(lit, shown.l, shown.far)) {
        return shown;
    }
    let right = picture.scale * vec2<f32>(dot(hit_right, place.right), dot(hit_right, place.down));
    let down = picture.scale * vec2<f32>(dot(hit_down, place.right), dot(hit_down, place.down));
    var f: Footprint;
    f.uv = place.px / picture.size;
    f.right = right / picture.size;
    f.down = down / picture.size;
    shown.colour = image_mean(material_at(picture.material), f);
    shown.share = inside;
    return shown;
}

// Weights are compared by their logarithms: powers of far distances are no numbers in f32.
fn painted(lit: Lit, differential: RayDifferential, albedo: vec3<f32>) -> Painted {
    let flat = flat_normal(triangle_at(lit.slot), lit.view);
    let along = lit.view / dot(flat, lit.view);
    hit_right = shading.filter_width * (differential.right - along * dot(flat, differential.right));
    hit_down = shading.filter_width * (differential.down - along * dot(flat, differential.down));
    var bare = 1.0;
    var weights = 0.0;
    var top = -3e38;
    var seen = vec3<f32>(0.0);
    var all_of_it = vec3<f32>(0.0);
    let count = by_thread(shading.picture_count, lit.slot);
    for (var k = 0u; k < count; k++) {
        let picture = header_of(k);
        if picture.mode == MODE_LIGHT {
            continue;
        }
        let shown = shown_by(picture, lit);
        let cover = picture.strength * shown.share;
        if cover <= 0.0 {
            continue;
        }
        bare *= 1.0 - cover;
        let power = log(cover) + picture.angle_power * log(shown.cosine) - picture.distance_power * log(shown.far);
        let before = exp(min(top - power, 0.0));
        let weight = exp(min(power - top, 0.0));
        top = max(top, power);
        weights = before * weights + weight;
        all_of_it = before * all_of_it + weight * shown.colour;
        seen = before * seen + select(weight, 0.0, picture.mode == MODE_PAINT) * shown.colour;
    }
    if weights == 0.0 {
        return Painted(albedo, vec3<f32>(0.0));
    }
    let cover = (1.0 - bare) / weights;
    return Painted(bare * albedo + cover * (all_of_it - seen), cover * seen);
}

// The light of a picture.
fn thrown(k: u32, lit: Lit) -> Arriving {
    let picture = header_of(k);
    let shown = shown_by(picture, lit);
    if shown.share <= 0.0 {
        return Arriving(lit.n, vec3<f32>(0.0));
    }
    let nearness = select(1.0, picture.distance / shown.far, picture.distance > 0.0);
    return Arriving(shown.l, picture.strength * shown.share * nearness * nearness * shown.colour);
}
