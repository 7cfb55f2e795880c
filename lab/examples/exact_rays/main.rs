//! `cargo run --release -p anamorph-lab --example exact_rays -- FOLDER RAYS`: casts rays at five closed meshes, a tenth of them exactly
//! through vertices and edges, and compares every first hit, and all hits of these, with the truth. The meshes, rays and the truth are
//! written to FOLDER, where `peers.py` reads them. Fails where a hit is wrong.

mod meshes;
mod truth;

use anamorph::internals::image::{write_npy_f64, write_text};
use anamorph::internals::input::{Error, Result};
use anamorph::{Caster, Scene};
use clap::Parser;
use glam::DVec3;
use meshes::{Closed, closed};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use truth::Truth;

/// Compares rays cast at closed meshes with the truth
#[derive(Parser)]
struct Args {
    /// Where the table goes, with meshes, rays and the truth
    folder: PathBuf,
    /// How many rays in all
    #[arg(default_value_t = 10_000_000)]
    rays: usize,
}

/// Rays that are compared with all triangles, in all.
const BY_ALL: usize = 10_000;

/// Of ten rays the one that goes through a vertex or an edge.
const AIMED: usize = 10;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(1)
        }
    }
}

fn run(args: &Args) -> Result<bool> {
    std::fs::create_dir_all(&args.folder).map_err(|e| Error::work(format!("{}: {e}", args.folder.display())))?;
    let mut table = String::from(
        "| mesh | triangles | rays | hits | wrong | missed | all hits wrong | decided by fractions | index, s | first hits, M/s | all hits, M/s |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let mut is_right = true;
    let meshes = closed();
    for (number, mesh) in (0u64..).zip(&meshes) {
        let rays = rays(mesh, number, args.rays / meshes.len());
        let found = compared(mesh, &rays, BY_ALL / meshes.len(), &args.folder)?;
        is_right &= found.wrong + found.missed + found.all_wrong == 0;
        // writing to a String cannot fail
        let _ = writeln!(
            table,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {:.2} | {:.2} | {:.2} |",
            mesh.name,
            mesh.triangles.len(),
            rays.len(),
            found.hits,
            found.wrong,
            found.missed,
            found.all_wrong,
            found.by_fractions,
            found.index_s,
            rays.len() as f64 / found.first_s / 1e6,
            (rays.len() / AIMED) as f64 / found.all_s / 1e6,
        );
        println!("{}", table.lines().last().unwrap_or_default());
    }
    write_text(&args.folder.join("exact_rays.md"), &table)?;
    Ok(is_right)
}

type Ray = [[f64; 3]; 2];

/// A ray anywhere, or each tenth through a vertex or the middle of an edge. Coordinates are multiples of 2^-20 below 8, so that f32 holds
/// these rays as well, and such a ray meets its goal without rounding.
fn rays(mesh: &Closed, seed: u64, count: usize) -> Vec<Ray> {
    let ray = |k: usize| {
        let mut random = Random(seed << 32 | k as u64);
        let mut place = |size: f64| DVec3::from([0; 3].map(|_| meshes::rounded(size * (2.0 * random.unit() - 1.0))));
        let (from, near) = (place(3.0), place(0.6));
        let corners = mesh.triangles[(random.unit() * mesh.triangles.len() as f64) as usize];
        let [a, b] = [corners[0], corners[1]].map(|k| mesh.vertices[k as usize]);
        let to = match k % (2 * AIMED) {
            0 => a,
            // a multiple of 2^-20, as all coordinates of meshes are of 2^-19
            AIMED => (a + b) / 2.0,
            _ => near,
        };
        [from.to_array(), (to - from).to_array()]
    };
    (0..count).into_par_iter().map(ray).collect()
}

/// Numbers from 0 to 1: splitmix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

struct Found {
    hits: usize,
    wrong: usize,
    missed: usize,
    all_wrong: usize,
    /// Rays of which the truth took fractions.
    by_fractions: usize,
    index_s: f64,
    first_s: f64,
    all_s: f64,
}

fn compared(mesh: &Closed, rays: &[Ray], by_all: usize, folder: &Path) -> Result<Found> {
    let mut scene = Scene::new();
    let positions = mesh.vertices.iter().map(|v| v.to_array()).collect();
    scene.add(anamorph::Mesh::new(positions, mesh.triangles.clone())?)?;
    let range = [0.0, f64::INFINITY];
    let started = Instant::now();
    let caster = Caster::new(&scene);
    let index_s = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let first = caster.first(rays, range)?;
    let first_s = started.elapsed().as_secs_f64();
    let aimed: Vec<Ray> = rays.iter().step_by(AIMED).copied().collect();
    let started = Instant::now();
    let all = caster.all(&aimed, range)?;
    let all_s = started.elapsed().as_secs_f64();

    let truth = Truth::new(mesh);
    let exact: Vec<truth::Answer> = rays.par_iter().map(|ray| truth.all(ray)).collect();
    let ids: Vec<Option<u32>> = exact.iter().map(|answer| answer.triangles.first().copied()).collect();
    let first: Vec<Option<u32>> = first.iter().map(|hit| hit.map(|hit| hit.triangle)).collect();
    let is_all_wrong = |(hits, answer): (&Vec<anamorph::RayHit>, &truth::Answer)| {
        !hits.iter().map(|hit| hit.triangle).eq(answer.triangles.iter().copied())
    };
    let step = (rays.len() / by_all.max(1)).max(1);
    let unlike =
        rays.par_iter().zip(&exact).step_by(step).filter(|(ray, answer)| truth.by_all(ray) != answer.triangles);
    let unlike = unlike.count();
    if unlike > 0 {
        return Err(Error::work(format!("{}: of {unlike} rays the truth missed triangles", mesh.name)));
    }
    let name = |what: &str| folder.join(format!("{}.{what}.npy", mesh.name));
    let flat = |k: usize| rays.iter().flat_map(|ray| ray[k]).collect::<Vec<f64>>();
    write_npy_f64(&name("origins"), &[rays.len() as u64, 3], &flat(0))?;
    write_npy_f64(&name("directions"), &[rays.len() as u64, 3], &flat(1))?;
    let id = |id: &Option<u32>| id.map_or(-1.0, f64::from);
    write_npy_f64(&name("truth"), &[rays.len() as u64], &ids.iter().map(id).collect::<Vec<_>>())?;
    let vertices: Vec<f64> = mesh.vertices.iter().flat_map(|v| v.to_array()).collect();
    write_npy_f64(&name("vertices"), &[mesh.vertices.len() as u64, 3], &vertices)?;
    let faces: Vec<f64> = mesh.triangles.iter().flatten().map(|k| f64::from(*k)).collect();
    write_npy_f64(&name("faces"), &[mesh.triangles.len() as u64, 3], &faces)?;
    Ok(Found {
        hits: ids.iter().flatten().count(),
        wrong: first.iter().zip(&ids).filter(|(own, truth)| own.is_some() && own != truth).count(),
        missed: first.iter().zip(&ids).filter(|(own, truth)| own.is_none() && truth.is_some()).count(),
        all_wrong: all.iter().zip(exact.iter().step_by(AIMED)).filter(|pair| is_all_wrong(*pair)).count(),
        by_fractions: exact.iter().filter(|answer| answer.by_fractions).count(),
        index_s,
        first_s,
        all_s,
    })
}
