//! Shows the report over HTTP, by default to this machine alone.
//!
//! A report is a folder of files, so that the server sends one file a request and closes the connection: no library is
//! needed for that, and none that is small is kept up. Only GET and HEAD of plain names below `report/` are answered.
//! Whoever asks or takes too slowly is left ([`Limits`]), and whoever has not asked yet gives way to others, so that nobody
//! keeps others from the report; who cannot be served because the system has no more open files is told to come again. Who may have what
//! says `guard`.

pub mod answer;
mod clients;
mod deadline;
mod guard;
pub mod request;

use std::io::{self, Read};
use std::net::{IpAddr, Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::pipeline::Observer;
use crate::pipeline::campaign::places::REPORT_FOLDER;
use answer::{Answer, is_of_too_few_files};
use clients::Clients;
use deadline::Timed;
use guard::Guard;

/// Port that is taken without a wish.
pub const DEFAULT_PORT: u16 = 8421;
/// Address that is taken without a wish: this machine alone.
pub const DEFAULT_BIND: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
/// How often the server looks whether it is to stop.
const GLANCE: Duration = Duration::from_millis(50);

/// What a client may take of the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Clients served at a time; for the next one the oldest that has not asked yet gives way, or it is told to come again.
    pub clients: usize,
    /// Time that a whole request may take, from the connection on, and longest time in which nothing of an answer is taken.
    pub patience: Duration,
    /// Slowest line that is served, bytes a second: an answer may take its size over this, and `patience` more.
    pub slowest_bytes_per_s: u64,
}

impl Default for Limits {
    /// 64 clients, of which a browser is at most six; 10 s are long for a request of one line; 50 kB/s is a slow mobile line.
    fn default() -> Limits {
        Limits {
            clients: 64,
            patience: Duration::from_secs(10),
            slowest_bytes_per_s: 50_000,
        }
    }
}

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    limits: Limits,
    listener: TcpListener,
    root: PathBuf,
    address: SocketAddr,
    guard: Guard,
}

impl Server {
    /// Listens at `address` for requests of the report of the campaign in `folder`; port 0 takes a free one.
    ///
    /// # Errors
    /// What the system says: the port is taken, or the address is not one of this machine.
    pub fn listen(folder: &Path, address: SocketAddr, limits: Limits) -> io::Result<Server> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Server {
            limits,
            address,
            guard: Guard::of(address),
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

    /// Answers until `stop`. A client that cannot be heard costs no other one its answer; `observer` hears of the first of a
    /// row of them.
    ///
    /// # Errors
    /// The listening socket failed.
    pub fn run(&self, stop: &AtomicBool, observer: &dyn Observer) -> io::Result<()> {
        let clients = Arc::new(Clients::default());
        let mut spare = self.listener.try_clone().ok();
        let mut is_told = false;
        while !stop.load(Ordering::SeqCst) {
            match self.listener.accept() {
                Ok((stream, _)) => {
                    is_told = false;
                    self.hand_over(stream, &clients);
                }
                Err(error) => match error.kind() {
                    io::ErrorKind::WouldBlock => std::thread::sleep(GLANCE),
                    // A client that hung up between asking and being heard is no fault of the server.
                    io::ErrorKind::ConnectionAborted | io::ErrorKind::Interrupted => {}
                    // It does not listen.
                    io::ErrorKind::InvalidInput => return Err(error),
                    _ => {
                        if !std::mem::replace(&mut is_told, true) {
                            observer.warn(&unheard(&error));
                        }
                        self.turn_one_away(&mut spare);
                        std::thread::sleep(GLANCE);
                    }
                },
            }
        }
        Ok(())
    }

    /// Gives an open file that is kept for this to a client for which the system has none, to tell it so: else it would wait,
    /// and nobody would hear of it.
    fn turn_one_away(&self, spare: &mut Option<TcpListener>) {
        *spare = None;
        if let Ok((stream, _)) = self.listener.accept() {
            turn_away(&stream);
        }
        *spare = self.listener.try_clone().ok();
    }

    fn hand_over(&self, stream: TcpStream, clients: &Arc<Clients>) {
        let stream = Arc::new(stream);
        if !clients.let_in(&stream, self.limits.clients) {
            turn_away(&stream);
            return;
        }
        let (root, guard, limits) = (self.root.clone(), self.guard.clone(), self.limits);
        let (asking, of) = (stream.clone(), clients.clone());
        let served = std::thread::Builder::new().spawn(move || {
            // A client that goes away in the middle concerns nobody else.
            let _ = serve(&asking, &of, &root, &guard, limits);
        });
        // Where no thread can be had the client goes.
        if served.is_err() {
            drop(clients.has_asked(&stream));
        }
    }
}

/// What is said of a client that cannot be heard.
fn unheard(error: &io::Error) -> String {
    let mend = if is_of_too_few_files(error) {
        "; more open files are needed: `ulimit -n` says how many there may be, and sets it"
    } else {
        ""
    };
    format!("a client could not be answered ({error}) and may come again{mend}")
}

/// How long a client that is turned away may take to ask.
const HEARD_OUT: Duration = Duration::from_millis(100);

/// Says that there are too many clients, and waits for what this one asks no longer than [`HEARD_OUT`].
fn turn_away(stream: &TcpStream) {
    let is_timed = stream.set_nonblocking(false).is_ok()
        && stream.set_read_timeout(Some(HEARD_OUT)).is_ok()
        && stream.set_write_timeout(Some(HEARD_OUT)).is_ok();
    if is_timed {
        // A request that stays unread would have the system take the answer back.
        let _ = (&mut &*stream).read(&mut [0; request::LONGEST_HEAD]);
        let _ = Answer::busy().write(&mut &*stream, false);
        let _ = stream.shutdown(Shutdown::Write);
    }
}

fn serve(
    stream: &Arc<TcpStream>,
    clients: &Clients,
    root: &Path,
    guard: &Guard,
    limits: Limits,
) -> io::Result<()> {
    let mut asking = Timed::new(stream, limits.patience, limits.patience);
    let asked = match stream.set_nonblocking(false) {
        Ok(()) => request::read(&mut asking),
        Err(_) => Ok(None),
    };
    let Some(_place) = clients.has_asked(stream) else {
        return Ok(());
    };
    let (answer, head_only) = match asked {
        Ok(None) => return Ok(()),
        Err(why) => (Answer::refusal(why), false),
        Ok(Some(request)) => {
            let answer = guard.refusal(&request).unwrap_or_else(|| Answer {
                cookie: guard.cookie_with(&request),
                ..Answer::to(&request, root)
            });
            (answer, request.head_only)
        }
    };
    let of_size = Duration::from_secs(answer.body.size_bytes() / limits.slowest_bytes_per_s.max(1));
    let mut taking = Timed::new(stream, limits.patience + of_size, limits.patience);
    answer.write(&mut taking, head_only)
}
