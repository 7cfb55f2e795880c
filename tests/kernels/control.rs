//! read_only, write_only and subgroup_width: every item is read or written, by whatever number of threads.

use crate::common::needs;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::layout::NONE;
use anamorph::internals::gpu::single::{run, words};
use anamorph_lab::control::{read_only, subgroup_widths, write_only};

/// Items of a list whose length no number of threads divides.
const ITEMS: u32 = 1009;

#[test]
fn every_item_is_written() {
    let Some(gpu) = needs::adapter() else { return };
    let pipeline = Pipeline::new(&gpu, write_only()).unwrap();
    for groups in [1, 3, 40] {
        let mut buffers = Buffers::default();
        buffers.upload(&gpu, "list", &vec![[NONE; 4]; ITEMS as usize]).unwrap();
        run(&gpu, "write_only", &pipeline, &buffers, groups).unwrap();
        let list = words(&gpu, buffers.get("list").unwrap()).unwrap();
        assert!(list.into_iter().eq((0..ITEMS).flat_map(|k| [k; 4])), "{groups} workgroups");
    }
}

#[test]
fn every_item_is_read() {
    let Some(gpu) = needs::adapter() else { return };
    let pipeline = Pipeline::new(&gpu, read_only()).unwrap();
    let places = [None, Some(0), Some(500), Some(ITEMS as usize - 1)];
    for (groups, place) in [1, 3, 40].into_iter().flat_map(|groups| places.map(|place| (groups, place))) {
        let mut list = vec![[0; 4]; ITEMS as usize];
        if let Some(place) = place {
            list[place][2] = NONE;
        }
        let mut buffers = Buffers::default();
        buffers.upload(&gpu, "list", &list).unwrap();
        buffers.upload(&gpu, "found", &[0]).unwrap();
        run(&gpu, "read_only", &pipeline, &buffers, groups).unwrap();
        let found = words(&gpu, buffers.get("found").unwrap()).unwrap()[0];
        assert_eq!(found, u32::from(place.is_some()), "{groups} workgroups, {place:?}");
    }
}

#[test]
fn subgroups_are_as_wide_as_the_adapter_says() {
    let Some(gpu) = needs::adapter() else { return };
    if let Some([least, most]) = subgroup_widths(&gpu).unwrap() {
        assert!(gpu.info.subgroup_min_size <= least && least <= most && most <= gpu.info.subgroup_max_size);
    }
}
