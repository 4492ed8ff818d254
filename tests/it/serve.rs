//! `ieap serve` as a browser meets it: files with tags, nothing else, nobody else.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use ieap::pipeline::serve::Server;

/// A server on a free port until the value is dropped.
pub struct Running {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Running {
    /// Serves the report of the campaign in `folder`.
    pub fn of(folder: &Path) -> Running {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let server = Server::listen(folder, any).expect("a server");
        let (address, stop) = (server.address(), Arc::new(AtomicBool::new(false)));
        let heard = stop.clone();
        let thread = std::thread::spawn(move || server.run(&heard).expect("an orderly end"));
        Running {
            address,
            stop,
            thread: Some(thread),
        }
    }

    /// The whole answer to a request with these lines.
    pub fn ask(&self, lines: &str) -> String {
        let mut stream = TcpStream::connect(self.address).expect("a connection");
        let request = format!("{}\r\n\r\n", lines.replace('\n', "\r\n"));
        stream.write_all(request.as_bytes()).expect("a request");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        String::from_utf8(answer).expect("text")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn campaign() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("report");
    std::fs::create_dir_all(report.join("runs")).expect("a folder");
    for (name, text) in [
        ("index.html", "<h1>Hello</h1>"),
        ("runs/a.html", "<h1>A</h1>"),
        ("site.js", "1"),
        (".made-from", "change 1"),
        (".secret", "no"),
    ] {
        std::fs::write(report.join(name), text).expect("a file");
    }
    std::fs::write(folder.path().join("campaign.db"), "the database").expect("a file");
    folder
}

#[test]
fn pages_are_served_with_their_types_and_tags() {
    let folder = campaign();
    let running = Running::of(folder.path());
    let index = running.ask("GET / HTTP/1.1\nHost: localhost");
    assert!(
        index.starts_with("HTTP/1.1 200 OK\r\nContent-Type: text/html"),
        "{index}"
    );
    assert!(index.ends_with("\r\n\r\n<h1>Hello</h1>"), "{index}");
    let script = running.ask("GET /site.js?x HTTP/1.1\nHost: localhost");
    assert!(script.contains("Content-Type: text/javascript"), "{script}");
    let head = running.ask("HEAD /runs/a.html HTTP/1.1\nHost: localhost");
    assert!(
        head.contains("Content-Length: 10\r\n") && head.ends_with("\r\n\r\n"),
        "{head}"
    );
    assert!(
        running
            .ask("GET /.made-from HTTP/1.1\nHost: localhost")
            .ends_with("change 1")
    );

    let icon = running.ask("GET /favicon.ico HTTP/1.1\nHost: localhost");
    assert!(
        icon.starts_with("HTTP/1.1 200") && icon.contains("image/svg+xml"),
        "{icon}"
    );
    // Maps along a strip are pictures within their page.
    assert!(index.contains("img-src 'self' data:"), "{index}");

    let tag = index
        .lines()
        .find_map(|line| line.strip_prefix("ETag: "))
        .expect("a tag");
    let again = running.ask(&format!("GET / HTTP/1.1\nHost: localhost\nIf-None-Match: {tag}"));
    assert!(again.starts_with("HTTP/1.1 304"), "{again}");
    std::fs::write(folder.path().join("report/index.html"), "<h1>New</h1>").expect("a file");
    let changed = running.ask(&format!("GET / HTTP/1.1\nHost: localhost\nIf-None-Match: {tag}"));
    assert!(changed.ends_with("<h1>New</h1>"), "{changed}");
}

#[test]
fn nothing_but_the_report_is_served_and_only_to_this_machine() {
    let folder = campaign();
    #[cfg(unix)]
    std::os::unix::fs::symlink(
        folder.path().join("campaign.db"),
        folder.path().join("report/link.html"),
    )
    .expect("a link");
    let running = Running::of(folder.path());
    for path in [
        "/../campaign.db",
        "/%2e%2e/campaign.db",
        "/runs/..%2f..%2fcampaign.db",
        "/.secret",
        "/runs",
        "/none.html",
        "/link.html",
    ] {
        let answer = running.ask(&format!("GET {path} HTTP/1.1\nHost: localhost"));
        assert!(answer.starts_with("HTTP/1.1 404"), "{path}: {answer}");
        assert!(!answer.contains("the database"), "{path}");
    }
    let post = running.ask("POST / HTTP/1.1\nHost: localhost");
    assert!(
        post.starts_with("HTTP/1.1 405") && post.contains("Allow: GET, HEAD"),
        "{post}"
    );
    let foreign = running.ask("GET / HTTP/1.1\nHost: evil.example");
    assert!(foreign.starts_with("HTTP/1.1 403"), "{foreign}");
    assert!(running.ask("nonsense").starts_with("HTTP/1.1 400"));
}

#[test]
fn a_campaign_without_a_report_says_so_and_looks_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let running = Running::of(folder.path());
    let answer = running.ask("GET / HTTP/1.1\nHost: localhost");
    assert!(
        answer.starts_with("HTTP/1.1 404") && answer.contains("http-equiv=\"refresh\""),
        "{answer}"
    );
}

#[test]
fn an_address_that_is_taken_is_said() {
    let folder = campaign();
    let running = Running::of(folder.path());
    assert_cmd::Command::cargo_bin("ieap")
        .expect("the program")
        .args(["serve", "--port", &running.address.port().to_string()])
        .arg(folder.path())
        .assert()
        .code(2);
}
