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
    let strict = NO_SKIP.into_iter().find(|name| std::env::var_os(name).is_some());
    match told(thread.name().unwrap_or("a test"), why, strict) {
        Ok(skipped) => eprintln!("{skipped}"),
        Err(failed) => panic!("{failed}"),
    }
}

fn told(test: &str, why: &str, strict: Option<&str>) -> Result<String, String> {
    match strict {
        None => Ok(format!("skipped {test}: {why}")),
        Some(name) => Err(format!(
            "{test} was not made: {why}; with {name} set nothing may be skipped"
        )),
    }
}

#[test]
fn what_is_skipped_is_said_and_fails_where_nothing_may_be() {
    let skipped = told("dma::t", "../shared/a is not there", None);
    assert_eq!(skipped.unwrap(), "skipped dma::t: ../shared/a is not there");
    let failed = told("dma::t", "../shared/a is not there", Some("CI")).unwrap_err();
    assert!(failed.contains("dma::t") && failed.contains("CI"), "{failed}");
}
