//! Parts of scenes by their keys, kept while their input files are unchanged.

use crate::input::files::Inputs;
use crate::input::{Loading, Result};
use std::sync::{Arc, Mutex, PoisonError};

/// Cached parts by their keys.
#[derive(Debug)]
pub struct Shelf<K, V> {
    kept: Mutex<Vec<Kept<K, V>>>,
}

#[derive(Debug)]
struct Kept<K, V> {
    key: K,
    value: Arc<V>,
    inputs: Inputs,
    /// Number of scenes loaded since it was last used.
    age: usize,
}

/// A part is dropped after this many scenes that do not use it: frames of two jobs may alternate.
const SCENES: usize = 2;

impl<K, V> Default for Shelf<K, V> {
    fn default() -> Self {
        Shelf { kept: Mutex::new(Vec::new()) }
    }
}

impl<K: PartialEq + Clone, V> Shelf<K, V> {
    /// Ages all parts, and drops old ones.
    pub fn next_scene(&self) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter_mut().for_each(|k| k.age += 1);
        kept.retain(|k| k.age <= SCENES);
    }

    /// The cached part if its inputs are unchanged and it `suits`; else the result of `make`, cached if `keeps`. Either way its inputs are
    /// recorded in `loading`.
    pub fn get(
        &self,
        key: &K,
        keeps: bool,
        suits: impl Fn(&V) -> bool,
        loading: &Loading,
        make: impl FnOnce(&Loading) -> Result<V>,
    ) -> Result<Arc<V>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = kept.iter_mut().find(|k| k.key == *key && suits(&k.value))
            && known.inputs.are_current()
        {
            known.age = 0;
            loading.note_all(&known.inputs);
            return Ok(known.value.clone());
        }
        // others may look for theirs meanwhile
        drop(kept);
        let own = loading.beside();
        let value = make(&own);
        let inputs = own.into_inputs();
        loading.note_all(&inputs);
        let value = Arc::new(value?);
        if !keeps {
            return Ok(value);
        }
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|k| k.key != *key);
        kept.push(Kept { key: key.clone(), value: value.clone(), inputs, age: 0 });
        Ok(value)
    }
}
