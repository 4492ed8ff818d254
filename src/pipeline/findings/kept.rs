//! Values that take long to make, as the report of a campaign keeps them, for every verb that asks for the same.

use crate::analysis::cache::Cache;
use crate::pipeline::Context;
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::places::{KEPT_VALUES, REPORT_FOLDER};
use crate::pipeline::infra::own_folder;
use crate::system::program_mark;

/// The program as kept values name it: what another build of it made may differ though nothing else does.
pub(crate) fn program() -> String {
    format!("{CODE_VERSION} {}", program_mark())
}

/// What the report that stands keeps; none where it was altered, or another program made it.
pub(crate) fn of_report(context: &Context) -> Option<Cache> {
    let bytes = own_folder::as_written(&context.folder.join(REPORT_FOLDER), KEPT_VALUES)?;
    Cache::read(&bytes, &program())
}

/// The same, or nothing. Each value stands under a hash over all that it is made from: an old report gives no old value.
pub(crate) fn values(context: &Context) -> Cache {
    of_report(context).unwrap_or_default()
}
