//! How long work tells what it does; the library itself never prints.

/// Hears of progress and messages. Called from several threads.
pub trait Observer: Sync {
    /// A step of `total` parts begins.
    fn begin(&self, step: &str, total: u64);
    /// One more part of the step is done.
    fn advance(&self);
    /// `done` of the step's parts are done.
    fn reach(&self, done: u64);
    /// The step is over.
    fn end(&self);
    /// Something worth a line was done.
    fn say(&self, text: &str);
    /// Something a user must know went wrong; the work goes on.
    fn warn(&self, text: &str);
}

/// Hears nothing.
#[derive(Debug, Clone, Copy)]
pub struct Silent;

impl Observer for Silent {
    fn begin(&self, _step: &str, _total: u64) {}
    fn advance(&self) {}
    fn reach(&self, _done: u64) {}
    fn end(&self) {}
    fn say(&self, _text: &str) {}
    fn warn(&self, _text: &str) {}
}
