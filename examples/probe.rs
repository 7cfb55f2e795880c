use anamorph::*; use anamorph::frame::Channel; use std::path::Path;
fn main(){
  let a:Vec<String>=std::env::args().collect();
  let scene=scene::Scene::load(Path::new(&a[1]),&a[2..]).unwrap();
  let t=std::time::Instant::now();
  let camera=scene.camera().unwrap();
  eprintln!("camera {:?}", t.elapsed());
  let gpu=gpu::Gpu::open(&gpu::GpuOptions{adapter:None,no_int64:std::env::var("NO64").is_ok()}).unwrap().unwrap();
  let mut e=engine::Engine::new(gpu);
  let chans=match std::env::var("CH"){Ok(c)=>c.split(',').filter_map(Channel::from_name).collect(),_=>Channel::ALL.to_vec()};
  let wanted=plan::Wanted{channels:chans,srgb8:std::env::var("NORGB").is_err(),counting:std::env::var("COUNT").is_ok()};
  let rep=std::env::var("REP").ok().and_then(|r|r.parse().ok()).unwrap_or(5);
  let t=std::time::Instant::now();
  let r=e.render(&scene,&camera,&wanted,&engine::RunOptions{repeat:rep,..Default::default()}).unwrap_or_else(|e|panic!("{e}"));
  eprintln!("render {:?} ms {:?}\n stages {:?}\n {:?} bytes {} grown {}", t.elapsed(), r.frame_ms, r.stages, r.counts, r.bytes, r.grown);
  let cpu=std::fs::read_to_string("/proc/self/stat").unwrap(); let f:Vec<&str>=cpu.rsplit(')').next().unwrap().split_whitespace().collect(); eprintln!("cpu s {}",(f[11].parse::<f64>().unwrap()+f[12].parse::<f64>().unwrap())/100.0);
  if wanted.srgb8 {output::write_png(Path::new("/tmp/probe.png"),camera.width,camera.height,r.srgb8.as_ref().unwrap()).unwrap();}
  if std::env::var("NOCHECK").is_ok(){return}
  let t=std::time::Instant::now();
  let j=reference::image::judge(&scene,&camera,&r.frame);
  eprintln!("judge {:?}",t.elapsed());
  let c=compare::compare(&r.frame,&j.truth,Some(&j.safe),Some(&j.scales)).unwrap();
  println!("{c}\nnot_near {}",j.not_near);
  if let (Some(x),Some(y))=(r.frame.u32(Channel::TriangleId),j.truth.u32(Channel::TriangleId)){
    let mut n=0; for k in 0..x.len(){ if j.safe[k]&&x[k]!=y[k]&&n<5{ n+=1; println!("px {},{} got {} want {}",k%camera.width as usize,k/camera.width as usize,x[k] as i32,y[k] as i32);}}
  }
}
