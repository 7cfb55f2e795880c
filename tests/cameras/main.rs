//! Each kind of camera against its definition, and what cameras are turned into: rays, projected points, exported files.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/exact.rs"]
mod exact;

mod calibrated;
mod calibration_files;
mod camera_truth;
mod casting;
mod casting_spheres;
mod chain;
mod composed;
mod composite;
mod curve_roots;
mod detours;
mod exact_casting;
mod exported;
mod glc_family;
mod graph;
mod incoherent;
mod lens_cameras;
mod moving;
mod opencv;
mod povray;
mod project;
mod project_named;
mod projector;
mod round_cameras;
mod scans;
mod screen_cameras;
mod track;
mod track_moving;
mod viewing_volumes;
