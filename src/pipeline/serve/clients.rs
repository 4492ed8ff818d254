//! Who is served now: those that are answered hold their places, those that have not asked yet give way to others.

use std::collections::VecDeque;
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The clients of a server.
#[derive(Debug, Default)]
pub(super) struct Clients(Mutex<Places>);

#[derive(Debug, Default)]
struct Places {
    /// Connections of which the request is not there yet, the oldest first.
    asking: VecDeque<Arc<TcpStream>>,
    /// How many are answered.
    answered: usize,
}

/// A place among those that are answered, until it is dropped.
pub(super) struct Place<'a>(&'a Clients);

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.0.places().answered -= 1;
    }
}

impl Clients {
    fn places(&self) -> MutexGuard<'_, Places> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a connection in where there are fewer than `most`, or where one that has not asked yet gives way: the oldest.
    pub fn let_in(&self, stream: &Arc<TcpStream>, most: usize) -> bool {
        let mut places = self.places();
        if places.asking.len() + places.answered >= most {
            let Some(oldest) = places.asking.pop_front() else {
                return false;
            };
            let _ = oldest.shutdown(Shutdown::Both);
        }
        places.asking.push_back(stream.clone());
        true
    }

    /// A connection has asked, or will not: it gives way no more. Gives none where it had to before.
    pub fn has_asked(&self, stream: &Arc<TcpStream>) -> Option<Place<'_>> {
        let mut places = self.places();
        let at = places
            .asking
            .iter()
            .position(|asking| Arc::ptr_eq(asking, stream))?;
        places.asking.remove(at);
        places.answered += 1;
        Some(Place(self))
    }
}
