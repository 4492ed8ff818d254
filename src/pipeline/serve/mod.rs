//! Shows the report over HTTP, by default to this machine alone.
//!
//! A report is a folder of small files, so that the server reads one file a request and closes the connection: no
//! library is needed for that, and none that is small is kept up. Only GET and HEAD of plain names below `report/` are
//! answered. On a loopback address the request must call the machine by a loopback name, so that no page of another
//! site reads the report through a name of its own.

pub mod answer;
pub mod request;

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::report::REPORT_FOLDER;
use answer::Answer;

/// Port that is taken without a wish.
pub const DEFAULT_PORT: u16 = 8421;
/// Address that is taken without a wish: this machine alone.
pub const DEFAULT_BIND: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
/// Clients served at a time.
const MOST_CLIENTS: usize = 64;
/// How long a client may take to ask, or to take its answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often the server looks whether it is to stop.
const GLANCE: Duration = Duration::from_millis(50);

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    root: PathBuf,
    address: SocketAddr,
}

impl Server {
    /// Listens at `address` for requests of the report of the campaign in `folder`; port 0 takes a free one.
    ///
    /// # Errors
    /// What the system says: the port is taken, or the address is not one of this machine.
    pub fn listen(folder: &Path, address: SocketAddr) -> io::Result<Server> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Server {
            address: listener.local_addr()?,
            listener,
            root: folder.join(REPORT_FOLDER),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether others than this machine can reach it.
    pub fn is_open(&self) -> bool {
        !self.address.ip().is_loopback()
    }

    /// Answers until `stop`.
    ///
    /// # Errors
    /// The listening socket failed.
    pub fn run(&self, stop: &AtomicBool) -> io::Result<()> {
        let clients = Arc::new(AtomicUsize::new(0));
        while !stop.load(Ordering::SeqCst) {
            match self.listener.accept() {
                Ok((stream, _)) => self.hand_over(stream, &clients),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => std::thread::sleep(GLANCE),
                // A client that hung up between asking and being heard is no fault of the server.
                Err(error) if error.kind() == io::ErrorKind::ConnectionAborted => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn hand_over(&self, mut stream: TcpStream, clients: &Arc<AtomicUsize>) {
        let timed = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
            .and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
        if timed.is_err() {
            return;
        }
        if clients.load(Ordering::SeqCst) >= MOST_CLIENTS {
            let _ = Answer::busy().write(&mut stream, false);
            return;
        }
        clients.fetch_add(1, Ordering::SeqCst);
        let (root, counted, only_loopback) = (self.root.clone(), clients.clone(), !self.is_open());
        let spawned = std::thread::Builder::new().spawn(move || {
            // A client that goes away in the middle concerns nobody else.
            let _ = serve(&mut stream, &root, only_loopback);
            counted.fetch_sub(1, Ordering::SeqCst);
        });
        if spawned.is_err() {
            clients.fetch_sub(1, Ordering::SeqCst);
        }
    }
}

fn serve(stream: &mut TcpStream, root: &Path, only_loopback: bool) -> io::Result<()> {
    let (answer, head_only) = match request::read(stream) {
        Ok(None) => return Ok(()),
        Err(why) => (Answer::refusal(why), false),
        Ok(Some(request)) => match only_loopback && !request.host.as_deref().is_none_or(is_loopback_name) {
            true => (Answer::wrong_host(), request.head_only),
            false => (Answer::to(&request, root), request.head_only),
        },
    };
    answer.write(stream, head_only)
}

/// Whether a `Host` is a name that only this machine has: `localhost:8421`, `127.0.0.1`, `[::1]:80`.
fn is_loopback_name(host: &str) -> bool {
    if let Ok(address) = host.parse::<SocketAddr>() {
        return address.ip().is_loopback();
    }
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    if let Ok(address) = bare.parse::<IpAddr>() {
        return address.is_loopback();
    }
    let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
    name.eq_ignore_ascii_case("localhost")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_names_are_this_machine() {
        for host in [
            "localhost",
            "LOCALHOST:8421",
            "127.0.0.1",
            "127.0.0.1:80",
            "[::1]",
            "[::1]:8421",
        ] {
            assert!(is_loopback_name(host), "{host}");
        }
        for host in [
            "example.org",
            "localhost.example.org",
            "192.168.1.4:8421",
            "127.0.0.1.example.org",
            "",
        ] {
            assert!(!is_loopback_name(host), "{host}");
        }
    }
}
