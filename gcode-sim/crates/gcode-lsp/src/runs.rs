//! Runs in the background: what a document's program did, one run for each state of the texts.
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use gcode_control::Progress;
use gcode_ide::{FileEdit, FileId, ProgramKey};

use crate::run_facts::RunFacts;

/// Ticks of the server's clock after which a run is ended.
const MAX_TICKS: u32 = 12;

/// Runs of one state of the texts. An edit replaces them all.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    slots: Mutex<BTreeMap<FileId, Arc<Slot>>>,
    /// Proved edits that renumber a program, or why there are none.
    renumberings: Mutex<BTreeMap<ProgramKey, Renumbering>>,
    is_outdated: AtomicBool,
}

/// Proved edits that renumber a program, or the reason why there are none.
pub(crate) type Renumbering = Result<Vec<FileEdit>, String>;

#[derive(Debug, Default)]
struct Slot {
    facts: OnceLock<Arc<RunFacts>>,
    progress: Arc<Progress>,
    ticks: AtomicU32,
}

impl Runs {
    /// Returns the facts of a file's run, which `run` computes once; a second caller waits for the first.
    /// `None` if an edit has made the run useless.
    pub(crate) fn facts(
        &self,
        file: FileId,
        run: impl FnOnce(&Arc<Progress>) -> RunFacts,
    ) -> Option<Arc<RunFacts>> {
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(slots.entry(file).or_default())
        };
        if self.is_outdated.load(Ordering::Relaxed) {
            return None;
        }
        let facts = Arc::clone(slot.facts.get_or_init(|| Arc::new(run(&slot.progress))));
        (!self.is_outdated.load(Ordering::Relaxed)).then_some(facts)
    }

    /// Returns the renumbering of a program, proved once; one whose proof was cancelled is not kept.
    pub(crate) fn renumbering(
        &self,
        program: ProgramKey,
        progress: &Progress,
        prove: impl FnOnce() -> Renumbering,
    ) -> Renumbering {
        let known = || self.renumberings.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(renumbering) = known().get(&program) {
            return renumbering.clone();
        }
        let renumbering = prove();
        if !progress.cancel.load(Ordering::Relaxed) {
            known().insert(program, renumbering.clone());
        }
        renumbering
    }

    /// Ends all runs, whose results no longer count.
    pub(crate) fn outdate(&self) {
        self.is_outdated.store(true, Ordering::Relaxed);
        self.for_each(|slot| slot.progress.cancel.store(true, Ordering::Relaxed));
    }

    /// Ends the runs that take too long.
    pub(crate) fn tick(&self) {
        self.for_each(|slot| {
            if slot.facts.get().is_none() && MAX_TICKS <= slot.ticks.fetch_add(1, Ordering::Relaxed) {
                slot.progress.cancel.store(true, Ordering::Relaxed);
            }
        });
    }

    fn for_each(&self, each: impl Fn(&Slot)) {
        let slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
        slots.values().for_each(|slot| each(slot));
    }
}
