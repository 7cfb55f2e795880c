//! What users of the library see, used as they use it: by public names alone. Without an adapter all of it goes by the reference.

#[path = "library/builder.rs"]
mod builder;
#[path = "library/fit.rs"]
mod fit;
#[path = "library/sparse.rs"]
mod sparse;

use anamorph::{
    Batch, BatchEvent, BatchOptions, Camera, Caster, Channel, Error, Job, Limits, Mesh, NO_ID, Placed, Plane,
    RenderOptions, Rendered, Renderer, Result, Scene, Shard, Views,
};
use std::fs;
use std::path::Path;
use std::sync::Mutex;

const CAMERA: &str = r#"
image = { width = 48, height = 36 }
camera = { kind = "pinhole", eye = [0, 0.5, 4], target = [0, 0, 0], vfov = 40 }
"#;

/// A tetrahedron: no triangle of it is like another.
fn tetrahedron() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let positions = vec![[-1.0, -0.7, 0.0], [1.0, -0.6, 0.2], [0.1, 1.0, -0.3], [0.0, 0.1, 1.1]];
    (positions, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
}

/// The same as a file.
fn write_obj(path: &Path) {
    let (positions, triangles) = tetrahedron();
    let vertices = positions.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    fs::write(path, vertices.chain(faces).collect::<String>()).unwrap();
}

fn options() -> RenderOptions {
    let channels = vec![Channel::T, Channel::TriangleId, Channel::NormalX];
    RenderOptions { channels, color: true, ..Default::default() }
}

/// All values, by their bits.
fn words(rendered: &Rendered) -> Vec<u32> {
    let frame = &rendered.frame;
    let mut words: Vec<u32> = frame.u32(Channel::TriangleId).unwrap().to_vec();
    for channel in [Channel::T, Channel::NormalX] {
        words.extend(frame.f32(channel).unwrap().iter().map(|v| v.to_bits()));
    }
    words.extend(rendered.rgba.as_ref().unwrap().iter().map(|byte| u32::from(*byte)));
    words
}

#[test]
fn a_mesh_of_arrays_is_that_of_a_file() {
    let dir = tempfile::tempdir().unwrap();
    write_obj(&dir.path().join("a.obj"));
    let (positions, triangles) = tetrahedron();
    let mut of_arrays = Scene::parse(CAMERA, ".").unwrap();
    of_arrays.add(Mesh::new(positions, triangles).unwrap().named("a")).unwrap();
    let of_file = Scene::parse(&format!("{}\nmesh = [{{ file = \"a.obj\" }}]", CAMERA), dir.path()).unwrap();
    let mut read = Scene::parse(CAMERA, ".").unwrap();
    read.add(Mesh::read(dir.path().join("a.obj")).unwrap()).unwrap();
    let mut renderer = Renderer::new().unwrap();
    let mut render = |scene: &Scene| words(&renderer.render(scene, &scene.camera().unwrap(), &options()).unwrap());
    let expected = render(&of_file);
    assert!(expected.iter().take(48 * 36).any(|id| *id != NO_ID));
    assert_eq!([render(&of_arrays), render(&read)], [expected.clone(), expected]);
    for scene in [&of_arrays, &of_file, &read] {
        assert_eq!(scene.objects().collect::<Vec<_>>(), [("a", 4)]);
        assert_eq!(scene.bounds(), Some([[-1.0, -0.7, -0.3], [1.0, 1.0, 1.1]]));
    }
    // a second one of that name gets one of its own, and its triangles follow
    of_arrays.add(Mesh::read(dir.path().join("a.obj")).unwrap()).unwrap();
    assert_eq!(of_arrays.objects().collect::<Vec<_>>(), [("a", 4), ("a.2", 4)]);
    assert_eq!(of_arrays.triangle_count(), 8);
}

#[test]
fn a_renderer_that_was_used_before_renders_the_same() {
    let (positions, triangles) = tetrahedron();
    let scene = |eye: f64, meshes: usize, keys: &str| {
        let text = CAMERA.replace("eye = [0, 0.5, 4]", &format!("eye = [{eye}, 0.5, 4]"));
        let mut scene = Scene::parse(&format!("{text}\n{keys}"), ".").unwrap();
        for k in 0..meshes {
            let beside = positions.iter().map(|[x, y, z]| [x + 0.4 * k as f64, *y, *z]).collect();
            let mesh = Mesh::new(beside, triangles.clone()).unwrap();
            scene.add(mesh.with_color([0.2, 0.9, 0.4])).unwrap();
        }
        scene
    };
    let light = "light = [{ direction = [-1, -2, -1] }]";
    // another eye, more triangles, another light, more samples, and back
    let steps = [
        (scene(0.0, 1, ""), 1),
        (scene(1.0, 1, ""), 1),
        (scene(1.0, 2, ""), 1),
        (scene(1.0, 2, light), 1),
        (scene(1.0, 2, light), 8),
        (scene(0.0, 1, ""), 1),
    ];
    let mut kept = Renderer::new().unwrap();
    let mut seen = Vec::new();
    for (scene, samples) in &steps {
        let (camera, options) = (scene.camera().unwrap(), RenderOptions { samples: *samples, ..options() });
        let render = |renderer: &mut Renderer| words(&renderer.render(scene, &camera, &options).unwrap());
        let own = render(&mut kept);
        assert_eq!(own, render(&mut Renderer::new().unwrap()));
        // what is not changed between
        assert_eq!(own, render(&mut kept));
        seen.push(own);
    }
    assert_eq!(seen[0], seen[5]);
    assert!(seen.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn the_reference_and_its_check_agree_with_the_engine() {
    let (positions, triangles) = tetrahedron();
    let mut scene = Scene::parse(CAMERA, ".").unwrap();
    scene.add(Mesh::new(positions, triangles).unwrap()).unwrap();
    let camera = scene.camera().unwrap();
    let rendered = Renderer::new().unwrap().render(&scene, &camera, &options()).unwrap();
    let error = anamorph::check(&scene, &camera, &rendered.frame).unwrap();
    assert_eq!((error.wrong_safe, error.pixels), (Some(0), 48 * 36));
    let truth = anamorph::reference(&scene, &camera, &[Channel::TriangleId]);
    let mut wrong = rendered.frame.clone();
    // a planted error in a pixel that is surely safe is found
    let id = truth.u32(Channel::TriangleId).unwrap()[18 * 48 + 24];
    for (channel, plane) in &mut wrong.planes {
        if let (Channel::TriangleId, anamorph::Plane::U32(ids)) = (*channel, plane) {
            ids[18 * 48 + 24] = id.wrapping_add(1) % 4;
        }
    }
    assert_eq!(anamorph::check(&scene, &camera, &wrong).unwrap().wrong_safe, Some(1));
    assert!(anamorph::compare(&wrong, &rendered.frame).unwrap().wrong_triangle == Some(1));
    let other = scene.camera_of_size(8, 8).unwrap();
    assert!(matches!(anamorph::check(&scene, &other, &rendered.frame), Err(Error::Input(_))));
}

#[test]
fn a_point_is_shown_where_its_ray_is() {
    let scene = Scene::parse(CAMERA, ".").unwrap();
    let camera: Camera = scene.camera().unwrap();
    let [origin, direction] = camera.ray(10, 20).unwrap();
    let point = [0, 1, 2].map(|k| origin[k] + 3.0 * direction[k]);
    let images = anamorph::project(&camera, &[point]).unwrap();
    let [image] = &images[0].images[..] else { panic!("{images:?}") };
    // pixel centres; a few roundings of coordinates up to 48
    assert!((image.x - 10.5).abs() < 1e-9 && (image.y - 20.5).abs() < 1e-9 && (image.t - 3.0).abs() < 1e-9);
    let mirror = "kind = 'reflection'\nmirror = { shape = 'sphere', center = [0, 0, 0], radius = 1 }\n\
                  eye = { kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }";
    let mirror = Camera::parse(mirror, ".", &scene, Some((8, 6))).unwrap();
    assert!(anamorph::project(&mirror, &[point]).unwrap_err().to_string().contains("reflects or refracts"));
    assert_eq!((camera.ray(48, 0), camera.kind(), camera.width(), camera.height()), (None, "pinhole", 48, 36));
}

#[test]
fn jobs_and_batches_write_what_the_program_does() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    write_obj(&path("a.obj"));
    fs::write(path("scene.toml"), format!("{}\n[[mesh]]\nfile = \"a.obj\"\n", CAMERA)).unwrap();
    let job = || Job::new(path("scene.toml")).set("camera.vfov=30").channels("Z,triangle.id").unwrap();
    let line = job().exr(path("own.exr")).color(path("own.png")).run(&mut Renderer::new().unwrap()).unwrap();
    assert!(line.contains("48x36") && line.contains("4 triangles"), "{line}");
    let frame = anamorph::read_exr(path("own.exr")).unwrap();
    assert_eq!(frame.planes.iter().map(|p| p.0).collect::<Vec<_>>(), [Channel::Z, Channel::TriangleId]);

    let list = "[[job]]\nscene = \"scene.toml\"\nset = [\"camera.vfov=30\"]\nchannels = [\"Z\", \"triangle.id\"]\n\
                exr = \"{frame}.exr\"\ncolor = \"{frame}.png\"\nframes = [0, 1, 2]\n";
    fs::write(path("jobs.toml"), list).unwrap();
    let run = |options: &BatchOptions| {
        let told = Mutex::new(Vec::new());
        let outcome = Batch::new(path("jobs.toml")).run(options, &|event, counts| {
            let kind = match event {
                BatchEvent::Done(..) => "done",
                BatchEvent::Skipped(_) => "skipped",
                BatchEvent::Again(..) => "again",
                BatchEvent::Failed(..) => "failed",
                BatchEvent::Note(_) => return,
            };
            told.lock().unwrap().push((kind, counts.done + counts.skipped + counts.failed));
        });
        (outcome.unwrap().counts, told.into_inner().unwrap())
    };
    let shard = BatchOptions { shard: Some(Shard::new(1, 3).unwrap()), ..Default::default() };
    assert_eq!(run(&shard).1, [("done", 1)]);
    assert_eq!(Batch::new(path("jobs.toml")).gather().unwrap().len(), 2);
    let resumed = BatchOptions { resume: true, ..Default::default() };
    let (counts, told) = run(&resumed);
    assert_eq!((counts.all, counts.done, counts.skipped, counts.failed), (3, 2, 1, 0));
    assert_eq!(told.iter().map(|t| t.1).collect::<Vec<_>>(), [1, 2, 3]);
    for frame in 0..3 {
        assert_eq!(fs::read(path(&format!("{frame}.png"))).unwrap(), fs::read(path("own.png")).unwrap());
        let own = anamorph::read_exr(path(&format!("{frame}.exr"))).unwrap();
        assert_eq!(
            anamorph::compare(&own, &anamorph::read_exr(path("own.exr")).unwrap()).unwrap().wrong_triangle,
            Some(0)
        );
    }
    // a callback may panic, and 0 writers count as 1: the batch ends
    let none = BatchOptions { writers: Some(0), ..Default::default() };
    let outcome = Batch::new(path("jobs.toml")).run(&none, &|_, _| panic!("a test's own")).unwrap();
    assert!(outcome.stopped_by.is_some_and(|e| e.to_string().contains("watches the batch panicked")));
    // one frame that fails does not end the others
    fs::write(
        path("jobs.toml"),
        list.replace("\"scene.toml\"", "\"scene.toml\"\nsweep = { mesh.0.file = [\"a.obj\", \"b.obj\"] }")
            .replace("{frame}", "{mesh.0.file}-{frame}"),
    )
    .unwrap();
    let (counts, _) = run(&BatchOptions::default());
    assert_eq!((counts.all, counts.done, counts.failed), (6, 3, 3));
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let fails = |result: Result<()>, says: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(says) && !text.contains('\n'), "{text}");
    };
    let (positions, triangles) = tetrahedron();
    let mesh = || Mesh::new(positions.clone(), triangles.clone()).unwrap();
    fails(Mesh::new(positions.clone(), vec![[0, 1, 4]]).map(drop), "4 vertices");
    fails(Mesh::new(vec![[0.0, f64::NAN, 0.0]], Vec::new()).map(drop), "finite");
    fails(mesh().with_normals(vec![[0.0; 3]; 4]).map(drop), "no direction");
    fails(mesh().with_normals(vec![[0.0, 0.0, 1.0]; 3]).map(drop), "3 normals for 4 vertices");
    fails(mesh().with_uvs(vec![[f32::INFINITY; 2]; 4]).map(drop), "finite");
    fails(mesh().with_colors(vec![[0.5; 3]; 5]).map(drop), "5 colours for 4 vertices");
    fails(mesh().with_colors(vec![[0.5, 0.5, 1.5]; 4]).map(drop), "from 0 to 1");
    fails(Scene::parse("image = { width = 8, height = 8 }", ".").map(drop), "no camera");
    fails(Scene::parse("camera = { kind = \"pinhol\" }", ".").map(drop), "pinhole");
    fails(Scene::load("none.toml", &[], 0.0).map(drop), "none.toml");
    fails(Job::new("a.toml").channels("Q").map(drop), "no such channel");
    fails(Job::new("a.toml").engine("rastr").map(drop), "use compute or reference");
    fails(Shard::new(0, 3).map(drop), "I/N");
    let scene = Scene::parse(CAMERA, ".").unwrap();
    let camera = scene.camera().unwrap();
    let mut renderer = Renderer::reference();
    assert_eq!(renderer.adapter(), None);
    let mut render = |options: RenderOptions| renderer.render(&scene, &camera, &options).map(drop);
    fails(render(RenderOptions::default()), "nothing to compute");
    fails(render(RenderOptions { samples: 65, ..options() }), "from 1 to 64");
    fails(render(RenderOptions { analytic: true, ..options() }), "analytic");
    let picture = renderer.render(&scene, &camera, &RenderOptions { color: false, ..options() }).unwrap();
    fails(picture.write_png("never.png"), "without colour");
    assert!(!Path::new("never.png").exists());
}

/// What one caller lifts or grants is no other's, also while both load.
#[test]
fn limits_are_those_of_a_call() {
    let many = "image = { width = 48, height = 36 }\n\
                camera = { kind = \"fisheye\", eye = [0, 0, 4], target = [0, 0, 0], fov = 90, pieces = 1000001 }";
    let load = |limits: Limits| Scene::parse_within(many, ".", limits).map(drop).map_err(|e| e.to_string());
    std::thread::scope(|scope| {
        let lifted = scope.spawn(|| (0..100).map(|_| load(Limits::none())).collect::<Vec<_>>());
        let others: Vec<_> = (0..100).map(|_| load(Limits::default())).collect();
        let refused = |load: &std::result::Result<(), String>| {
            load.as_ref().is_err_and(|e| e.contains("1000001 pieces are over the limit of 1000000"))
        };
        assert!(others.iter().all(refused), "{others:?}");
        assert_eq!(lifted.join().unwrap(), vec![Ok(()); 100]);
    });

    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    write_obj(&path("a.obj"));
    fs::write(path("scene.toml"), format!("{CAMERA}\n[[mesh]]\nfile = \"a.obj\"\n")).unwrap();
    fs::write(path("jobs.toml"), "[[job]]\nscene = \"scene.toml\"\nengine = \"reference\"\nexr = \"b.exr\"\n").unwrap();
    let scene = Scene::load(path("scene.toml"), &[], 0.0).unwrap();
    let camera = scene.camera().unwrap();
    let mut renderer = Renderer::reference();
    for (limits, is_within) in [
        (Limits::default().memory(1 << 10), false),
        (Limits::none().memory(1 << 10), true),
        (Limits::default().memory(1 << 50), true),
    ] {
        let check = |done: Result<()>| match done {
            Err(e) => assert!(!is_within && e.to_string().contains("use --memory or --no-limits"), "{e}"),
            Ok(()) => assert!(is_within, "{limits:?}"),
        };
        let options = RenderOptions { limits, ..options() };
        check(renderer.render(&scene, &camera, &options).map(drop));
        check(renderer.render_many(&scene, std::slice::from_ref(&camera), &options).map(drop));
        let job = Job::new(path("scene.toml")).engine("reference").unwrap().exr(path("a.exr"));
        check(job.limits(limits).run(&mut renderer).map(drop));
        let batch = Batch::new(path("jobs.toml")).limits(limits);
        let outcome = batch.run(&BatchOptions::default(), &|_, _| ()).unwrap();
        check(outcome.failures.first().map_or(Ok(()), |(_, why)| Err(Error::Work(why.clone()))));
    }
}

#[test]
fn rays_are_cast_at_a_scene() {
    let (positions, triangles) = tetrahedron();
    let mut scene = Scene::new();
    scene.add(Mesh::new(positions.clone(), triangles.clone()).unwrap().named("one")).unwrap();
    scene.add(Mesh::new(positions, triangles).unwrap().named("two")).unwrap();
    let caster = Caster::new(&scene);
    let [hit, miss] = [[[0.1, 0.1, 5.0], [0.0, 0.0, -2.0]], [[9.0, 0.1, 5.0], [0.0, 0.0, -2.0]]];
    let first = caster.first(&[hit, miss], [0.0, f64::INFINITY]).unwrap();
    let met = first[0].unwrap();
    // both meshes lie in one place: the lower id is first
    let length = met.normal.iter().map(|x| x * x).sum::<f64>();
    assert!(first[1].is_none() && met.object == 0 && met.triangle < 4 && (length - 1.0).abs() < 1e-15, "{met:?}");
    assert!((met.point[2] - (5.0 - 2.0 * met.t)).abs() < 1e-12 && caster.is_certain(&hit));
    let all = caster.all(&[hit, miss], [0.0, f64::INFINITY]).unwrap();
    assert_eq!((all[0].len(), all[1].len(), all[0][0]), (4, 0, met));
    assert_eq!([0, 1, 2, 3].map(|k| all[0][k].object), [0, 1, 0, 1]);
    assert_eq!(caster.meets_any(&[hit, miss], [0.0, 1.0]).unwrap(), [false, false]);
    let error = caster.first(&[hit, [[0.0; 3]; 2]], [0.0, 1.0]).unwrap_err();
    assert!(error.to_string().starts_with("ray 1: its direction is") && error.exit_code() == 2, "{error}");
    assert!(caster.all(&[hit], [1.0, f64::NAN]).is_err());
}

/// An object that is moved is rendered as one that was added there, normals too.
#[test]
fn objects_move_and_come_back() {
    let mut renderer = Renderer::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let table = |places: &str| format!("builtin = \"icosphere\"\nlevel = 2\nname = \"ball\"\nsmooth = true\n{places}");
    let scene_of = |places: &str| {
        let mut scene = Scene::new();
        let floor = "builtin = \"plane\"\nname = \"floor\"\nscale = 3\ntranslate = [0, -1, 0]";
        for text in [floor, &table(places)] {
            scene.add_placed(Placed::of_table(text, folder.path()).unwrap()).unwrap();
        }
        scene
    };
    let camera = |scene: &Scene| {
        let pinhole = "kind = \"pinhole\"\neye = [0, 1, 5]\ntarget = [0, 0, 0]\nvfov = 40";
        Camera::parse(pinhole, ".", scene, Some((64, 48))).unwrap()
    };
    let options = options();
    let mut seen = |scene: &Scene| words(&renderer.render(scene, &camera(scene), &options).unwrap());
    let mut scene = scene_of("");
    let at_rest = seen(&scene);
    // a quarter turn about y, which is exact, and a step
    let matrix = [[0.0, 0.0, 1.0, 0.5], [0.0, 1.0, 0.0, 0.25], [-1.0, 0.0, 0.0, -0.125]];
    scene.move_object("ball", matrix).unwrap();
    let moved = seen(&scene);
    assert!(moved == seen(&scene_of("rotate = [0, 90, 0]\ntranslate = [0.5, 0.25, -0.125]")) && moved != at_rest);
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    scene.move_object("ball", identity).unwrap();
    assert!(seen(&scene) == at_rest);

    // the same beside something that moves while the image is taken
    let timed = |places: &str| {
        let moves =
            "builtin = \"box\"\ntranslate = [{ frame = 0, value = [0, 0, -9] }, { frame = 1, value = [1, 0, -9] }]";
        let camera = "kind = \"pinhole\"\neye = [0, 1, 5]\ntarget = [0, 0, 0]\nvfov = 40\nline_time = 0.01";
        let image = "[image]\nwidth = 64\nheight = 48";
        let text = format!("{image}\n[[mesh]]\n{moves}\n[[mesh]]\n{}\n[camera]\n{camera}\n", table(places));
        Scene::parse(&text, folder.path()).unwrap()
    };
    let mut beside = timed("");
    let before = seen(&beside);
    beside.move_object("ball", matrix).unwrap();
    let moved = seen(&beside);
    assert!(moved == seen(&timed("rotate = [0, 90, 0]\ntranslate = [0.5, 0.25, -0.125]")) && moved != before);

    // other vertices: those of the ball where it was moved, shaded flat
    let count = scene.objects().find(|(name, _)| *name == "ball").unwrap().1;
    let error = scene.set_vertices("ball", &[[0.0; 3]; 2]).unwrap_err().to_string();
    assert!(count == 320 && error.contains("ball: 2 vertices for an object of 162"), "{error}");
    scene.set_vertices("ball", &vec![[0.0, 50.0, 0.0]; 162]).unwrap();
    let gone = seen(&scene);
    scene.move_object("ball", matrix).unwrap();
    assert!(gone != at_rest && seen(&scene) == gone);
}

#[test]
fn objects_move_by_matrices_before_and_after_other_changes() {
    // a pyramid, at steps that f64 holds
    let corners = |[x, y, z]: [f64; 3]| {
        let base = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.0, 0.0, 0.5], [0.0, 0.75, 0.0]];
        base.map(|[a, b, c]| [a + x, b + y, c + z]).to_vec()
    };
    let pyramid = |name: &str, at: [f64; 3]| {
        Mesh::new(corners(at), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap().named(name)
    };
    let scene_of = |all: &[(&str, [f64; 3])]| {
        let mut scene = Scene::parse(CAMERA, ".").unwrap();
        all.iter().for_each(|(name, at)| scene.add(pyramid(name, *at)).unwrap());
        scene
    };
    let by = |[x, y, z]: [f64; 3]| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]];
    let mut renderer = Renderer::new().unwrap();
    let mut seen = |scene: &Scene| words(&renderer.render(scene, &scene.camera().unwrap(), &options()).unwrap());
    let (a, b, c) = ([-0.5, 0.0, 0.0], [0.75, -0.25, 0.0], [0.0, 0.5, -1.0]);
    let mut scene = scene_of(&[("a", a), ("b", b)]);
    let mut changes = vec![seen(&scene)];
    let mut compare = |scene: &Scene, all: &[(&str, [f64; 3])]| {
        changes.push(seen(scene));
        assert!(changes.last() == Some(&seen(&scene_of(all))) && changes.windows(2).all(|pair| pair[0] != pair[1]));
        assert_eq!(scene.bounds(), scene_of(all).bounds());
    };
    scene.move_object("a", by([0.25, 0.0, 0.0])).unwrap();
    compare(&scene, &[("a", [-0.25, 0.0, 0.0]), ("b", b)]);
    scene.add(pyramid("c", c)).unwrap();
    compare(&scene, &[("a", [-0.25, 0.0, 0.0]), ("b", b), ("c", c)]);
    scene.move_object("b", by([0.0, 0.25, 0.0])).unwrap();
    compare(&scene, &[("a", [-0.25, 0.0, 0.0]), ("b", [0.75, 0.0, 0.0]), ("c", c)]);
    scene.set_vertices("c", &corners([0.5, 0.5, -1.0])).unwrap();
    compare(&scene, &[("a", [-0.25, 0.0, 0.0]), ("b", [0.75, 0.0, 0.0]), ("c", [0.5, 0.5, -1.0])]);
    scene.move_object("a", by([0.0; 3])).unwrap();
    compare(&scene, &[("a", a), ("b", [0.75, 0.0, 0.0]), ("c", [0.5, 0.5, -1.0])]);
    scene.move_object("c", by([-0.5, 0.25, 0.0])).unwrap();
    compare(&scene, &[("a", a), ("b", [0.75, 0.0, 0.0]), ("c", [0.0, 0.75, -1.0])]);
}

#[test]
fn spheres_are_added_and_moved() {
    let mut scene = Scene::parse(CAMERA, ".").unwrap();
    let centers = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    scene.add_spheres(&centers, &[0.5, 0.25], Some(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).unwrap();
    assert_eq!(scene.objects().collect::<Vec<_>>(), [("spheres", 2)]);
    assert_eq!(scene.bounds(), Some([[-0.5; 3], [1.25, 0.5, 0.5]]));
    let mut renderer = Renderer::new().unwrap();
    let mut seen = |scene: &Scene| words(&renderer.render(scene, &scene.camera().unwrap(), &options()).unwrap());
    let at_rest = seen(&scene);
    assert!([0, 1, NO_ID].iter().all(|id| at_rest[..48 * 36].contains(id)));

    // a half turn about z
    scene.move_object("spheres", [[-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
    assert_eq!(scene.bounds(), Some([[-1.25, -0.5, -0.5], [0.5; 3]]));
    let turned = seen(&scene);
    let mut other = Scene::parse(CAMERA, ".").unwrap();
    other.add_spheres(&[[0.0; 3], [-1.0, 0.0, 0.0]], &[0.5, 0.25], Some(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).unwrap();
    assert!(turned == seen(&other) && turned != at_rest);

    let refused = |result: Result<()>, says: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(says) && !text.contains('\n'), "{text}");
    };
    let twice = [[2.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]];
    refused(scene.move_object("spheres", twice), "the matrix scales or stretches spheres");
    assert!(seen(&scene) == turned);
    refused(scene.add_spheres(&centers, &[0.5], None), "1 radii for 2 spheres");
    refused(scene.add_spheres(&centers, &[0.5, 0.0], None), "sphere 1 has the radius 0");
    refused(
        Mesh::spheres(&centers, &[1.0; 2]).unwrap().with_uvs(vec![[0.0; 2]; 2]).map(|_| ()),
        "spheres and capsules have no texture",
    );
    assert!(Placed::of_mesh(Mesh::spheres(&centers, &[1.0; 2]).unwrap(), "scale = [1, 2, 1]", ".").is_err());
}

#[test]
fn capsules_are_added_and_moved() {
    let mut scene = Scene::parse(CAMERA, ".").unwrap();
    let ends = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[0.0, 0.5, 0.0], [0.0, 0.5, 0.0]]];
    scene.add_capsules(&ends, &[0.25, 0.125], Some(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).unwrap();
    assert_eq!(scene.objects().collect::<Vec<_>>(), [("capsules", 2)]);
    assert_eq!(scene.bounds(), Some([[-0.25; 3], [1.25, 0.625, 0.25]]));
    let mut renderer = Renderer::new().unwrap();
    let mut shown = |scene: &Scene| words(&renderer.render(scene, &scene.camera().unwrap(), &options()).unwrap());
    let at_rest = shown(&scene);
    assert!([0, 1, NO_ID].iter().all(|id| at_rest[..48 * 36].contains(id)));
    // a capsule whose ends are one point is a sphere
    let mut other = Scene::parse(CAMERA, ".").unwrap();
    other.add_capsules(&ends[..1], &[0.25], Some(&[[1.0, 0.0, 0.0]])).unwrap();
    other.add_spheres(&[ends[1][0]], &[0.125], Some(&[[0.0, 1.0, 0.0]])).unwrap();
    assert!(shown(&other)[..48 * 36] == at_rest[..48 * 36]);

    // a half turn about z, by the matrix and by other ends
    scene.move_object("capsules", [[-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
    let mut turned = Scene::parse(CAMERA, ".").unwrap();
    let ends = ends.map(|pair| pair.map(|[x, y, z]: [f64; 3]| [-x, -y, z]));
    turned.add_capsules(&ends, &[0.25, 0.125], Some(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).unwrap();
    assert!(shown(&scene) == shown(&turned) && shown(&scene) != at_rest);

    let refused = |result: Result<()>, says: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(says) && !text.contains('\n'), "{text}");
    };
    refused(scene.add_capsules(&ends, &[0.5], None), "1 radii for 2 capsules");
    refused(scene.add_capsules(&[[[0.0; 3], [f64::NAN; 3]]], &[0.5], None), "finite");
    refused(scene.add_capsules(&ends, &[0.5, 0.0], None), "has the radius 0");
}

/// The caster meets a capsule at its ends, beside its segment and along it.
#[test]
fn rays_are_cast_at_capsules() {
    let mut scene = Scene::new();
    scene.add_capsules(&[[[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]], &[1.0], None).unwrap();
    let caster = Caster::new(&scene);
    let cast = |origin: [f64; 3], direction: [f64; 3]| {
        let hit = caster.first(&[[origin, direction]], [0.0, f64::INFINITY]).unwrap().remove(0);
        hit.map(|hit| (hit.t, hit.point, hit.normal))
    };
    assert_eq!(cast([1.0, 0.0, -5.0], [0.0, 0.0, 1.0]), Some((4.0, [1.0, 0.0, -1.0], [0.0, 0.0, -1.0])));
    assert_eq!(cast([-9.0, 0.0, 0.0], [2.0, 0.0, 0.0]), Some((3.0, [-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0])));
    assert_eq!(cast([2.5, 0.0, -5.0], [0.0, 0.0, -1.0]), None);
    let (t, ..) = cast([2.6, 0.0, -5.0], [0.0, 0.0, 1.0]).unwrap();
    assert!((t - 4.2).abs() < 1e-12, "{t}");
}

/// A ball and a box, and a camera that is not used.
const BALL: &str = r#"
image = { width = 50, height = 37 }
mesh = [{ builtin = "icosphere", level = 3 }, { builtin = "box", translate = [1.5, 0.2, 0.3] }]
camera = { kind = "pinhole", eye = [0, 0.5, 4], target = [0, 0, 0], vfov = 40 }
"#;

/// A camera for each of some places around the ball, with these keys.
fn around(scene: &Scene, size: (u32, u32), count: u32, keys: &dyn Fn(u32) -> String) -> Vec<Camera> {
    let camera = |k: u32| {
        let (sine, cosine) = (f64::from(k) * 0.7).sin_cos();
        let eye = format!("eye = [{}, {}, {}]", 4.0 * sine, 0.3 * f64::from(k) - 1.0, 4.0 * cosine);
        let table = format!("{}\n{eye}\ntarget = [{}, 0, 0]", keys(k), 0.1 * f64::from(k));
        Camera::parse(&table, ".", scene, Some(size)).unwrap()
    };
    (0..count).map(camera).collect()
}

/// Part `k` of `count` equal ones.
fn part<T>(all: &[T], k: usize, count: usize) -> &[T] {
    let each = all.len() / count;
    &all[k * each..(k + 1) * each]
}

fn report_of(views: &Views) -> serde_json::Value {
    serde_json::from_str(&views.report()).unwrap()
}

#[test]
fn many_images_in_one_frame_are_those_of_one_frame_each() {
    const COUNT: usize = 7;
    let scene = Scene::parse(BALL, ".").unwrap();
    let around = |keys: &dyn Fn(u32) -> String| around(&scene, (50, 37), COUNT as u32, keys);
    // a piece, several pieces, and a ray for each pixel
    let kinds = [
        around(&|k| format!("kind = \"pinhole\"\nvfov = {}", 40 + k)),
        around(&|_| "kind = \"cylinder\"".into()),
        around(&|k| format!("kind = \"fisheye\"\nfov = {}", 100 + 20 * k)),
    ];
    let mut renderer = Renderer::new().unwrap();
    for (cameras, samples) in kinds.iter().flat_map(|kind| [(kind, 1), (kind, 4)]) {
        use Channel::{A, NormalX, ObjectId, PieceId, T, TriangleId, Z};
        let options = RenderOptions {
            channels: vec![A, Z, T, TriangleId, PieceId, NormalX, ObjectId],
            color: true,
            samples,
            analytic: false,
            limits: Limits::default(),
        };
        let views = renderer.render_many(&scene, cameras, &options).unwrap();
        let frames = if renderer.adapter().is_some() { 1 } else { COUNT as u64 };
        let report = report_of(&views);
        assert_eq!(
            [&report["views"], &report["frame_ms"]["runs"]].map(|n| n.as_u64()),
            [Some(7), Some(frames)],
            "{report}"
        );
        for (k, camera) in cameras.iter().enumerate() {
            let alone = renderer.render(&scene, camera, &options).unwrap();
            assert_eq!(views.planes.len(), alone.frame.planes.len());
            for ((channel, all), (_, own)) in views.planes.iter().zip(&alone.frame.planes) {
                match (all, own) {
                    (Plane::U32(all), Plane::U32(own)) => assert_eq!(part(all, k, COUNT), own, "{channel:?} {k}"),
                    (Plane::F32(all), Plane::F32(own)) => {
                        let is_near = |a: f32, b: f32| match channel {
                            Z | T => a == b || a.to_bits().abs_diff(b.to_bits()) == 1,
                            // both ends of an edge of 0.1 at least are stored to 2^-24 of less than 8
                            NormalX => (a - b).abs() < 2.0 * 8.0 / 0.1 / (1 << 24) as f32,
                            _ => a == b,
                        };
                        assert!(part(all, k, COUNT).iter().zip(own).all(|(a, b)| is_near(*a, *b)), "{channel:?} {k}");
                    }
                    _ => panic!("{channel:?} has two types"),
                }
            }
            let (all, own) = (views.rgba.as_ref().unwrap(), alone.rgba.as_ref().unwrap());
            assert!(part(all, k, COUNT).iter().zip(own).all(|(a, b)| a.abs_diff(*b) <= 1), "{k}");
        }
    }
}

#[test]
fn images_that_cannot_be_one_frame_are_rendered_one_after_another() {
    let scene = Scene::parse(BALL, ".").unwrap();
    let of = |keys: &str| around(&scene, (50, 37), 2, &|_| keys.into());
    let fisheye = of("kind = \"fisheye\"\nfov = 150");
    let unlike = [of("kind = \"pinhole\"\nvfov = 40"), fisheye.clone()].concat();
    let mirror = |x: u32| {
        let table = format!(
            "kind = \"reflection\"\nmirror = {{ shape = \"sphere\", center = [0, 2, 0], radius = 0.8 }}\n
             eye = {{ kind = \"pinhole\", vfov = 40, eye = [{x}, 1, 5], target = [0, 1, 0] }}"
        );
        Camera::parse(&table, ".", &scene, Some((50, 37))).unwrap()
    };
    let mirrors = vec![mirror(0), mirror(1)];
    let ranges = [fisheye, of("kind = \"fisheye\"\nfov = 150\nt_range = [0, 3.5]")].concat();
    // more than 2^14 pixels, of which only images of pieces share a frame
    let large = |keys: &str| around(&scene, (200, 164), 2, &|_| keys.into());
    let large_fisheyes = large("kind = \"fisheye\"\nfov = 150");
    let mut renderer = Renderer::new().unwrap();
    let views = renderer.render_many(&scene, &large("kind = \"pinhole\"\nvfov = 40"), &options()).unwrap();
    let frames = if renderer.adapter().is_some() { 1 } else { 2 };
    assert_eq!(report_of(&views)["frame_ms"]["runs"], frames);
    for (cameras, why) in [
        (unlike, "some cameras have pieces"),
        (mirrors, "mirror or lens"),
        (ranges, "range of t"),
        (large_fisheyes, "faster at this size"),
    ] {
        let views = renderer.render_many(&scene, &cameras, &options()).unwrap();
        let report = report_of(&views);
        if renderer.adapter().is_some() {
            assert!(report["left_out"].to_string().contains(why), "{report}");
        }
        for (k, camera) in cameras.iter().enumerate() {
            let alone = renderer.render(&scene, camera, &options()).unwrap();
            for ((_, all), (_, own)) in views.planes.iter().zip(&alone.frame.planes) {
                match (all, own) {
                    (Plane::U32(all), Plane::U32(own)) => assert_eq!(part(all, k, cameras.len()), own),
                    (Plane::F32(all), Plane::F32(own)) => assert_eq!(part(all, k, cameras.len()), own),
                    _ => panic!("a plane has two types"),
                }
            }
            assert_eq!(part(views.rgba.as_ref().unwrap(), k, cameras.len()), alone.rgba.unwrap());
        }
    }
}

#[test]
fn more_images_than_fit_a_frame_take_several() {
    let scene = Scene::parse(BALL, ".").unwrap();
    let cameras = around(&scene, (1100, 1000), 5, &|k| format!("kind = \"pinhole\"\nvfov = {}", 40 + k));
    let mut renderer = Renderer::new().unwrap();
    if renderer.adapter().is_none() {
        return println!("skipped: there is no adapter");
    }
    let options = RenderOptions { channels: vec![Channel::TriangleId], ..Default::default() };
    let views = renderer.render_many(&scene, &cameras, &options).unwrap();
    assert_eq!(report_of(&views)["frame_ms"]["runs"].as_u64(), Some(2));
    let Plane::U32(ids) = &views.planes[0].1 else { panic!("ids") };
    for (k, camera) in cameras.iter().enumerate() {
        let alone = renderer.render(&scene, camera, &options).unwrap();
        assert_eq!(part(ids, k, cameras.len()), alone.frame.u32(Channel::TriangleId).unwrap());
    }
}

#[test]
fn impossible_image_sizes_are_refused() {
    let scene = Scene::parse(CAMERA, "").unwrap();
    for (width, height) in [(0, 8), (8, 0), (0, 0), (70_000, 2), (60_000, 60_000)] {
        let error = scene.camera_of_size(width, height).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(&format!("{width} x {height}")), "{error}");
    }
}

#[test]
fn images_of_two_sizes_are_refused() {
    let scene = Scene::parse(BALL, ".").unwrap();
    let of = |size| around(&scene, size, 1, &|_| "kind = \"pinhole\"\nvfov = 40".into());
    let refused =
        |cameras: &[Camera]| Renderer::new().unwrap().render_many(&scene, cameras, &options()).unwrap_err().to_string();
    let two = [of((50, 37)), of((50, 40))].concat();
    assert_eq!(refused(&two), "camera 1 is 50x40, camera 0 50x37; all images need one size");
    assert_eq!(refused(&[]), "there is no camera; give one or more");
}

/// Numbered after all triangles, as in frames, with the place and the outward normal of the exact sphere.
#[test]
fn rays_are_cast_at_spheres() {
    let (positions, triangles) = tetrahedron();
    let mut scene = Scene::new();
    scene.add_spheres(&[[0.0, 0.0, 9.0], [0.0, 3.0, 9.0]], &[2.0, 0.5], None).unwrap();
    scene.add(Mesh::new(positions, triangles).unwrap().named("after")).unwrap();
    let objects: Vec<(String, usize)> = scene.objects().map(|(name, count)| (name.to_owned(), count)).collect();
    let caster = Caster::new(&scene);
    let first_sphere = objects.iter().position(|(_, count)| *count == 2).unwrap();
    let before: usize = objects[..first_sphere].iter().map(|(_, count)| count).sum();
    let rays =
        [[[1.2, 0.0, 20.0], [0.0, 0.0, -4.0]], [[0.0, 3.0, 9.0], [0.0, 0.25, 0.0]], [[2.0, 0.0, 0.0], [0.0, 0.0, 1.0]]];
    let hits: Vec<_> = caster.first(&rays, [0.0, f64::INFINITY]).unwrap().into_iter().map(Option::unwrap).collect();
    let expected = [
        (2.35, 0, [1.2, 0.0, 10.6], [0.6, 0.0, 0.8]),
        (2.0, 1, [0.0, 3.5, 9.0], [0.0, 1.0, 0.0]),
        (9.0, 0, [2.0, 0.0, 9.0], [1.0, 0.0, 0.0]),
    ];
    for (hit, (t, sphere, point, normal)) in hits.iter().zip(expected) {
        assert_eq!((hit.triangle, hit.object, hit.bary), (before as u32 + sphere, first_sphere as u32, [0.0; 2]));
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!((hit.t - t).abs() < 1e-14 && near(hit.point, point) && near(hit.normal, normal), "{hit:?}");
    }
    // in and out, and out alone from inside
    let counts: Vec<usize> = caster.all(&rays, [0.0, f64::INFINITY]).unwrap().iter().map(Vec::len).collect();
    assert_eq!(counts[1..], [1, 2]);
    assert!(rays.iter().all(|ray| caster.is_certain(ray)));
    // the frame of a camera names them by the same numbers
    let keys = "kind = \"orthographic\"\neye = [1.2, 0, 20]\ntarget = [1.2, 0, 0]\nheight = 0.5";
    let camera = Camera::parse(keys, ".", &scene, Some((9, 9))).unwrap();
    let frame = Renderer::reference().render(&scene, &camera, &options()).unwrap();
    let ids = frame.frame.u32(Channel::TriangleId).unwrap();
    assert_eq!(ids[40], hits[0].triangle);
}

#[test]
fn a_ray_from_very_far_meets_a_tiny_triangle_once() {
    let mut scene = Scene::new();
    let corners = vec![[2e-20, 0.0, 0.0], [0.0, 2e-20, 0.0], [0.0, 0.0, 2e-20]];
    scene.add(Mesh::new(corners, vec![[0, 1, 2]]).unwrap()).unwrap();
    let rays = [[[1e20; 3], [-1.0; 3]], [[-1e20; 3], [1.0; 3]]];
    let caster = Caster::new(&scene);
    assert!(rays.iter().all(|ray| caster.is_certain(ray)));
    for hits in caster.all(&rays, [0.0, f64::INFINITY]).unwrap() {
        assert_eq!(hits.iter().map(|hit| hit.triangle).collect::<Vec<_>>(), [0]);
    }
}

#[test]
fn gradients_are_arrays_by_their_names() {
    let (positions, triangles) = tetrahedron();
    let mut scene = Scene::parse(CAMERA, ".").unwrap();
    scene.add(Mesh::new(positions, triangles).unwrap()).unwrap();
    let camera = scene.camera().unwrap();
    let of = ["vertices", "camera.vfov", "camera.eye.2"];
    let quantities = ["depth", "position", "barycentrics", "t", "coverage"];
    let mut by_both = Vec::new();
    for mut renderer in [Renderer::new().unwrap(), Renderer::reference()] {
        let found = renderer.gradients(&scene, &camera, &quantities, &of).unwrap();
        assert_eq!(found.f32("depth.vertices").unwrap().0, [36, 48, 3, 3]);
        assert_eq!(found.f32("position.vertices").unwrap().0, [36, 48, 3, 3, 3]);
        assert_eq!(found.f32("barycentrics.camera").unwrap().0, [36, 48, 3, 2]);
        assert_eq!(found.u32("coverage.pixels").unwrap().0, [36, 48, 2]);
        assert_eq!(found.parameters.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), of[1..]);
        assert!(found.json().unwrap().contains("\"camera.eye.2\""));
        // weights sum to 1, so their changes to 0; and a plane that moves with all corners moves its hits by N / (N . D)
        let (ids, (_, weights)) = (found.u32("triangle").unwrap().1, found.f32("barycentrics.vertices").unwrap());
        assert!(ids.iter().filter(|id| **id != NO_ID).count() > 200);
        for (id, weights) in ids.iter().zip(weights.as_chunks::<27>().0) {
            let sums = (0..9).map(|n| weights[n] + weights[9 + n] + weights[18 + n]);
            // f32 of weights that change by some units a unit
            assert!(sums.into_iter().all(|sum| sum.abs() < 1e-5), "{id}: {weights:?}");
            assert!(*id != NO_ID || weights.iter().all(|n| *n == 0.0));
        }
        by_both.push(found);
    }
    let [engine, reference] = [0, 1].map(|k| by_both[k].f32("depth.camera").unwrap().1);
    // f32 of numbers of some units
    assert!(engine.iter().zip(reference).all(|(a, b)| (a - b).abs() < 1e-5));
    let mut renderer = Renderer::new().unwrap();
    let mut refused = |quantities: &[&str], of: &[&str]| {
        let error = renderer.gradients(&scene, &camera, quantities, of).unwrap_err();
        assert!(matches!(error, Error::Input(_)) && !error.to_string().contains('\n'), "{error}");
        error.to_string()
    };
    assert!(refused(&["colour"], &[]).contains("known: depth, t, position"));
    assert!(refused(&[], &[]).contains("no gradient is asked for"));
    assert!(refused(&["depth"], &["vfov"]).contains("camera.vfov"));
    assert!(refused(&["depth"], &["camera.fov"]).contains("it has eye.0, eye.1, eye.2, target.0"));
    let rays = vec![[0.0, 0.0, 1.0]; 4];
    let of_rays = Camera::of_rays((2, 2), &rays, &[[0.0, 0.0, -1.0]; 4], [0.0, 9.0]).unwrap();
    assert!(renderer.gradients(&scene, &of_rays, &["t"], &["vertices"]).is_ok());
    assert!(
        renderer.gradients(&scene, &of_rays, &["t"], &["camera.x"]).unwrap_err().to_string().contains("has no keys")
    );
}
