//! Whole files go back in time: somebody puts an older database or journal back, cuts the journal at a line end, or loses it.

use std::fs;
use std::path::PathBuf;

use rand::RngExt;

use super::World;

/// A database and a journal of one moment.
pub struct Older {
    database: Vec<u8>,
    journal: Vec<u8>,
}

impl World {
    fn places(&self) -> [PathBuf; 2] {
        ["campaign.db", "archive/journal.jsonl"].map(|name| self.folder.path().join(name))
    }

    /// Nobody works on the campaign: sometimes its files are copied, sometimes one of them goes back. The openings that
    /// follow, the first of which may be disturbed, make it good.
    pub fn goes_back(&mut self) {
        let [database, journal] = self.places();
        let log = self.folder.path().join("campaign.db-wal");
        let is_whole = fs::metadata(&log).map_or(true, |log| log.len() == 0);
        let Ok(said) = fs::read(&journal) else {
            return;
        };
        if !is_whole || said.is_empty() || self.context.is_some() {
            return;
        }
        let Some(older) = self.older.take() else {
            self.opens();
            let read = |path: &PathBuf| fs::read(path).unwrap();
            self.older = Some(Older {
                database: read(&database),
                journal: read(&journal),
            });
            return;
        };
        let what = self.goes(&older, &said);
        self.tell(|| format!("   {what}"));
        self.disturbed();
        // What is damaged in the middle only a whole look finds.
        fs::write(
            self.folder.path().join("campaign.db.lock"),
            "process 1 on another\n",
        )
        .unwrap();
        self.computer.settle();
        self.opens();
        self.nothing_lost();
    }

    /// One of the files goes back, or is damaged; gives which, in words. Both would be older than what was said.
    fn goes(&mut self, older: &Older, said: &[u8]) -> &'static str {
        let [database, journal] = self.places();
        match self.rng.random_range(0..5) {
            0 => {
                fs::write(&database, &older.database).unwrap();
                let _ = fs::remove_file(self.folder.path().join("campaign.db-shm"));
                "the database is an older one"
            }
            1 => {
                fs::write(&journal, &older.journal).unwrap();
                "the journal is an older one"
            }
            2 => {
                let lines = said.iter().filter(|&&byte| byte == b'\n').count();
                let kept = self.rng.random_range(0..=lines);
                let text = said.split_inclusive(|&byte| byte == b'\n').take(kept);
                fs::write(&journal, text.collect::<Vec<_>>().concat()).unwrap();
                "the journal is cut at a line end"
            }
            3 => {
                let mut flipped = said.to_vec();
                let at = self.rng.random_range(0..said.len());
                flipped[at] ^= 1;
                fs::write(&journal, flipped).unwrap();
                "a byte of the journal is flipped"
            }
            _ => {
                fs::remove_file(&journal).unwrap();
                "the journal is lost"
            }
        }
    }

    /// An opening in any weather.
    fn disturbed(&mut self) {
        self.computer.settle();
        let weather = self.weather();
        self.tell(|| format!("   {weather:?}"));
        self.computer.have(weather);
        if self.asks(|_| Ok(())).is_none() {
            self.context = None;
        }
        self.close();
    }
}
