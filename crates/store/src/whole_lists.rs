//! Lists that were read whole, for as long as the database is as it was: a verb asks many questions of the same rows, and each
//! row is read, held against its hash and understood once.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the database was when a list was read: what other connections changed, and what this one did.
pub(super) type State = (i64, u64);

/// A list as somebody understood it.
pub(super) type List = Arc<dyn Any + Send + Sync>;

/// Lists that were read, all of one state of the database.
#[derive(Debug, Default)]
pub(super) struct WholeLists {
    /// Whether a batch is open: what is read in it may be taken back, so that nothing of it is kept.
    in_batch: Cell<bool>,
    of: Cell<State>,
    lists: RefCell<BTreeMap<&'static str, List>>,
}

impl WholeLists {
    pub fn batch_begins(&self) {
        self.in_batch.set(true);
    }

    /// Also where it was given up.
    pub fn batch_ended(&self) {
        self.in_batch.set(false);
    }

    /// Whether lists are kept now; those of another state of the database are forgotten.
    pub fn are_kept(&self, now: State) -> bool {
        if self.of.replace(now) != now {
            self.lists.borrow_mut().clear();
        }
        !self.in_batch.get()
    }

    pub fn known<T: Send + Sync + 'static>(&self, name: &str) -> Option<Arc<T>> {
        let list = self.lists.borrow().get(name).cloned()?;
        list.downcast().ok()
    }

    pub fn keep(&self, name: &'static str, list: List) {
        self.lists.borrow_mut().insert(name, list);
    }
}
