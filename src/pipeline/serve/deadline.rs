//! A connection that must be done by a moment, however slowly the other side goes on.
//!
//! A time limit of the socket begins anew with every byte, so that a client that sends or takes one byte now and then
//! would hold its place for ever. Here each step gets what is left of the whole.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// A connection with a moment at which it ends.
pub(super) struct Timed<'a> {
    stream: &'a TcpStream,
    end: Instant,
    /// Longest time without any progress.
    stall: Duration,
}

impl<'a> Timed<'a> {
    /// From now on for `whole`, with at most `stall` without progress.
    pub fn new(stream: &'a TcpStream, whole: Duration, stall: Duration) -> Timed<'a> {
        Timed {
            stream,
            end: Instant::now() + whole,
            stall,
        }
    }

    /// What the next step may take.
    fn left(&self) -> io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            Err(io::ErrorKind::TimedOut.into())
        } else {
            Ok(left.min(self.stall))
        }
    }
}

impl Read for Timed<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        (&mut &*self.stream).read(into)
    }
}

impl Write for Timed<'_> {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        (&mut &*self.stream).write(from)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
