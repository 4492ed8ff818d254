//! Tests that need measurements and printed tables of others, which are no part of the project and lie beside it in
//! `../shared`. Where a file is absent its test says so and holds nothing; in CI, or with IEAP_NO_SKIP set, it fails.
//!
//! `cargo it needs_shared::` runs them all, with those in files of their subject, which stand in modules of this name.

mod ageing_data;
mod formats_expected;
mod formats_real_files;
mod lumped_reference;
mod models_reference;
mod real_campaigns;
mod real_findings;
mod report_thesis;

use std::path::{Path, PathBuf};

/// With one of these set a test that skips something fails.
const NO_SKIP: [&str; 2] = ["CI", "IEAP_NO_SKIP"];

/// A file or folder of `../shared`; where it is absent, the test that asks is skipped.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name);
    if !path.exists() {
        skip(&format!("../shared/{name} is not there"));
        return None;
    }
    Some(path)
}

/// Says which test holds nothing here, and why; fails it where nothing may be skipped.
pub fn skip(why: &str) {
    let thread = std::thread::current();
    let told = format!("skipped {}: {why}", thread.name().unwrap_or("a test"));
    let strict = NO_SKIP.iter().find(|name| std::env::var_os(name).is_some());
    match strict {
        Some(name) => panic!("{told}; with {name} set nothing may be skipped"),
        None => eprintln!("{told}"),
    }
}
