//! The people of a world: they measure, copy, rename, swap, cut short, overwrite and delete, one thing at a time.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use rand::{Rng, RngExt};

/// Rows of a table.
const ROWS: usize = 14;

/// Whether these bytes hold a whole table.
pub fn is_whole(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let lines = text.split_inclusive('\n');
    let lines: Vec<&str> = lines.filter(|line| !line.starts_with('#')).collect();
    text.ends_with('\n') && text.starts_with("time_s") && lines.len() == ROWS + 1
}

/// What lies in the runs folder, and what people know of it.
pub struct People {
    runs: PathBuf,
    /// Files by their names in the runs folder.
    files: BTreeSet<String>,
    /// Tables that an instrument is still writing: what is left of each.
    growing: BTreeMap<String, String>,
    /// Number of the next content: each has a size of its own.
    next: usize,
    /// What the clock shows by which files get their times; none for that of the system.
    pub clock: Option<SystemTime>,
}

impl People {
    /// With nothing measured yet.
    pub fn of(campaign: &Path) -> People {
        People {
            runs: campaign.join("runs"),
            files: BTreeSet::new(),
            growing: BTreeMap::new(),
            next: 1,
            clock: None,
        }
    }

    /// The bytes of every file that is there, by its path in the campaign.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let read = |name: &String| (format!("runs/{name}"), fs::read(self.runs.join(name)).unwrap());
        self.files.iter().map(read).collect()
    }

    /// Every instrument ends what it writes.
    pub fn finish(&mut self) {
        while let Some((name, rest)) = self.growing.pop_first() {
            self.append(&name, &rest);
        }
    }

    /// Somebody does something; gives what, in words.
    pub fn act(&mut self, rng: &mut impl Rng) -> String {
        let free = self.free_name(rng);
        let Some(one) = self.any(rng) else {
            return self.measure(&free);
        };
        match rng.random_range(0..14) {
            0..3 => self.measure(&free),
            3 => self.begin(&free, rng),
            4..6 => self.go_on(rng),
            6 => {
                let wrong = self.numbered("no table\n");
                self.put(&free, &wrong)
            }
            7 => self.rename(&one, &free),
            8 => self.swap(&one, rng),
            9 => self.cut(&one, rng),
            10 => self.delete(&one),
            11 => self.copy(&one, &free),
            12 => {
                let table = self.table();
                self.put(&one, &table)
            }
            _ => self.touch(&one),
        }
    }

    pub fn any(&self, rng: &mut impl Rng) -> Option<String> {
        let place = rng.random_range(0..self.files.len().max(1));
        // What is still written nobody touches.
        let at_rest = |name: &&String| !self.growing.contains_key(*name);
        self.files
            .iter()
            .cycle()
            .skip(place)
            .take(self.files.len())
            .find(at_rest)
            .cloned()
    }

    /// Few names, so that they come back.
    fn free_name(&self, rng: &mut impl Rng) -> String {
        loop {
            let folder = ["", "day1/", "day2/"][rng.random_range(0..3)];
            let name = format!("{folder}{}.csv", rng.random_range(0..20));
            if !self.files.contains(&name) || self.files.len() > 40 {
                return name;
            }
        }
    }

    /// A text with a comment that gives it a size of its own: no clock is so fine that it tells two changes of one moment.
    fn numbered(&mut self, text: &str) -> String {
        self.next += 1;
        format!("{text}#{}\n", "n".repeat(self.next))
    }

    fn table(&mut self) -> String {
        let mut text = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
        for step in -2i32..ROWS as i32 - 2 {
            let on = f64::from(u8::from(step >= 0));
            let current_a = on * 1e-3 * (-f64::from(step) / 5.0).exp() + 1e-9 * self.next as f64;
            text += &format!("{step},{},{current_a:.6e},{:.4}\n", 2.0 * on, on * 0.1);
        }
        self.numbered(&text)
    }

    pub fn measure(&mut self, name: &str) -> String {
        let table = self.table();
        self.put(name, &table)
    }

    pub fn put(&mut self, name: &str, text: &str) -> String {
        let path = self.runs.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        self.written(&path, text.as_bytes());
        self.files.insert(name.to_owned());
        format!("{name} is written, {} bytes", text.len())
    }

    fn written(&self, path: &Path, bytes: &[u8]) {
        fs::write(path, bytes).unwrap();
        if let Some(time) = self.clock {
            fs::File::options()
                .write(true)
                .open(path)
                .unwrap()
                .set_modified(time)
                .unwrap();
        }
    }

    fn begin(&mut self, name: &str, rng: &mut impl Rng) -> String {
        let table = self.table();
        let at = rng.random_range(0..table.len());
        self.files.insert(name.to_owned());
        self.growing.insert(name.to_owned(), table[at..].to_owned());
        let path = self.runs.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        self.written(&path, &table.as_bytes()[..at]);
        format!("{name} begins with {at} bytes")
    }

    fn go_on(&mut self, rng: &mut impl Rng) -> String {
        let Some((name, rest)) = self.growing.pop_first() else {
            return "nothing".to_owned();
        };
        let at = rng.random_range(0..=rest.len());
        if at < rest.len() {
            self.growing.insert(name.clone(), rest[at..].to_owned());
        }
        self.append(&name, &rest[..at]);
        format!("{name} grows by {at} bytes")
    }

    fn append(&self, name: &str, more: &str) {
        let path = self.runs.join(name);
        let text = fs::read_to_string(&path).unwrap() + more;
        self.written(&path, text.as_bytes());
    }

    pub fn rename(&mut self, from: &str, to: &str) -> String {
        let path = self.runs.join(to);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::rename(self.runs.join(from), path).unwrap();
        self.files.remove(from);
        self.files.insert(to.to_owned());
        format!("{from} becomes {to}")
    }

    pub fn swap(&mut self, one: &str, rng: &mut impl Rng) -> String {
        let Some(other) = self.any(rng).filter(|other| other != one) else {
            return "nothing".to_owned();
        };
        let [a, b, aside] = [one, &other, ".swapped"].map(|name| self.runs.join(name));
        fs::rename(&a, &aside).unwrap();
        fs::rename(&b, &a).unwrap();
        fs::rename(&aside, &b).unwrap();
        format!("{one} and {other} are swapped")
    }

    fn cut(&mut self, name: &str, rng: &mut impl Rng) -> String {
        let path = self.runs.join(name);
        let text = fs::read(&path).unwrap();
        let at = rng.random_range(0..=text.len());
        self.written(&path, &text[..at]);
        format!("{name} is cut to {at} bytes")
    }

    pub fn delete(&mut self, name: &str) -> String {
        fs::remove_file(self.runs.join(name)).unwrap();
        self.files.remove(name);
        format!("{name} is deleted")
    }

    pub fn copy(&mut self, from: &str, to: &str) -> String {
        let path = self.runs.join(to);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::copy(self.runs.join(from), path).unwrap();
        self.files.insert(to.to_owned());
        format!("{from} is copied to {to}")
    }

    fn touch(&mut self, name: &str) -> String {
        let file = fs::File::options()
            .write(true)
            .open(self.runs.join(name))
            .unwrap();
        file.set_modified(self.clock.unwrap_or_else(SystemTime::now))
            .unwrap();
        format!("{name} is touched")
    }
}
