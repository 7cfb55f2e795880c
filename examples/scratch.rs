use anamorph::camera::Camera;
use anamorph::frame::Channel;
use anamorph::plan::*;
use anamorph::scene::Scene;
use std::time::Instant;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let gpu = anamorph::gpu::Gpu::open(&Default::default()).unwrap().unwrap();
    for _ in 0..4 {
        let t = Instant::now();
        let scene = Scene::load(path.as_ref(), &[], 0.0).unwrap();
        let a = t.elapsed();
        let t = Instant::now();
        let camera = Camera::in_scene(&scene.camera, scene.size, &scene.mesh).unwrap();
        let b = t.elapsed();
        let t = Instant::now();
        let around = Surroundings::of(&camera, scene.bounds());
        let mut w = Wanted::of(vec![Channel::R, Channel::G, Channel::B]);
        w.srgb8 = true;
        let plan = Plan::new(&camera, Contents::of(&scene), around, &w, gpu.has, gpu.binding_limit());
        let c = t.elapsed();
        let t = Instant::now();
        let cl = anamorph::scene::clusters::cluster(&scene.mesh, plan.anchor, false, gpu.binding_limit());
        let d = t.elapsed();
        let t = Instant::now();
        let bytes: Vec<u8> = (0..800 * 600 * 3).map(|k| ((k * 7) % 251) as u8).collect();
        anamorph::output::write_png("/tmp/b/x.png".as_ref(), 800, 600, &bytes).unwrap();
        let e = t.elapsed();
        println!("load {a:?} camera {b:?} plan {c:?} cluster {d:?} {} png {e:?}", cl.chunks.len());
    }
}
