//! `ieap serve` as a browser meets it: files with tags, nothing else, nobody else.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ieap::pipeline::Silent;
use ieap::pipeline::serve::{Limits, Server};

/// A server on a free port until the value is dropped.
pub struct Running {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Running {
    /// Serves the report of the campaign in `folder`.
    pub fn of(folder: &Path) -> Running {
        Running::with(folder, Limits::default())
    }

    /// The same for clients with those limits.
    fn with(folder: &Path, limits: Limits) -> Running {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let server = Server::listen(folder, any, limits).expect("a server");
        let (address, stop) = (server.address(), Arc::new(AtomicBool::new(false)));
        let heard = stop.clone();
        let thread = std::thread::spawn(move || server.run(&heard, &Silent).expect("an orderly end"));
        Running {
            address,
            stop,
            thread: Some(thread),
        }
    }

    fn connect(&self) -> TcpStream {
        TcpStream::connect(self.address).expect("a connection")
    }

    /// The whole answer to a request with these lines.
    pub fn ask(&self, lines: &str) -> String {
        self.try_ask(lines).expect("an answer")
    }

    /// The same where the server may hang up.
    fn try_ask(&self, lines: &str) -> std::io::Result<String> {
        let mut stream = self.connect();
        // What a person types is said to be nobody's page.
        let whose =
            if lines.contains("Host: localhost") && !lines.contains("Sec-Fetch") && !lines.contains("Cookie")
            {
                "\nSec-Fetch-Site: none"
            } else {
                ""
            };
        let request = format!("{lines}{whose}\n\n").replace('\n', "\r\n");
        stream.write_all(request.as_bytes())?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer)?;
        Ok(String::from_utf8(answer).expect("text"))
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
    for hosts in ["", "\nHost: localhost\nHost: evil.example"] {
        let answer = running.ask(&format!("GET / HTTP/1.1{hosts}"));
        assert!(answer.starts_with("HTTP/1.1 400"), "{answer}");
    }
    let foreign = running.ask("GET / HTTP/1.1\nHost: evil.example");
    assert!(foreign.starts_with("HTTP/1.1 403"), "{foreign}");
    assert!(running.ask("nonsense").starts_with("HTTP/1.1 400"));
}

/// Any page of another site read the report by `<script src="http://127.0.0.1:8421/runs.js">`.
#[test]
fn the_report_is_given_to_its_own_pages_and_to_whoever_opens_it() {
    let folder = campaign();
    let running = Running::of(folder.path());
    let page = running.ask("GET / HTTP/1.1\nHost: localhost\nSec-Fetch-Site: none");
    for said in [
        "Cross-Origin-Resource-Policy: same-origin",
        "Cross-Origin-Opener-Policy: same-origin",
        "X-Content-Type-Options: nosniff",
        "X-Frame-Options: DENY",
        "frame-ancestors 'none'",
        "SameSite=Strict",
    ] {
        assert!(page.contains(said), "{said}: {page}");
    }
    let cookie = page
        .lines()
        .find_map(|line| line.strip_prefix("Set-Cookie: "))
        .expect("a cookie");
    let (cookie, _) = cookie.split_once(';').expect("what is to be kept");
    let (head, last) = cookie.split_at(cookie.len() - 1);
    let wrong = format!("{head}{}", if last == "0" { "1" } else { "0" });
    let dests = [
        "script", "image", "style", "iframe", "object", "empty", "video", "document",
    ];
    let (mut given, mut refused) = (0, 0);
    for site in ["", "none", "same-origin", "same-site", "cross-site", "unheard-of"] {
        for dest in dests {
            for cookie in ["", cookie, &wrong] {
                for (file, is_page) in [
                    ("/", true),
                    ("/runs/a.html", true),
                    ("/site.js", false),
                    ("/.made-from", false),
                ] {
                    let mode = if dest == "document" { "navigate" } else { "no-cors" };
                    let mut lines = format!("GET {file} HTTP/1.1\nHost: localhost\nCookie: a=b; {cookie}");
                    if !site.is_empty() {
                        lines += &format!(
                            "\nSec-Fetch-Site: {site}\nSec-Fetch-Mode: {mode}\nSec-Fetch-Dest: {dest}"
                        );
                    }
                    let wanted = match site {
                        "none" | "same-origin" => true,
                        "" => is_page || (!cookie.is_empty() && *cookie != wrong),
                        _ => is_page && dest == "document",
                    };
                    let answer = running.ask(&lines);
                    assert_eq!(answer.starts_with("HTTP/1.1 200"), wanted, "{lines}: {answer}");
                    assert_eq!(answer.starts_with("HTTP/1.1 403"), !wanted, "{lines}: {answer}");
                    *(if wanted { &mut given } else { &mut refused }) += 1;
                }
            }
        }
    }
    assert_eq!((given, refused), (274, 302));
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

/// Clients that connect and ask nothing, or drop by drop, held every place: nobody else was served.
#[test]
fn clients_that_do_not_ask_give_way_to_others() {
    let folder = campaign();
    let limits = Limits {
        clients: 8,
        patience: Duration::from_secs(60),
        ..Limits::default()
    };
    let running = Running::with(folder.path(), limits);
    let mut half_open: Vec<TcpStream> = (0..200).map(|_| running.connect()).collect();
    for _ in 0..3 {
        for stream in &mut half_open {
            // Those that gave way take no more.
            let _ = stream.write_all(b"G");
        }
        let answer = running.ask("GET / HTTP/1.1\nHost: localhost");
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    }
    drop(half_open);
}

/// Those that are answered hold their places until they have taken all, or are left.
#[test]
fn who_comes_while_every_place_is_answered_is_told_to_come_again() {
    let folder = campaign();
    let large = folder.path().join("report/large.csv");
    std::fs::write(&large, vec![b'x'; 30_000_000]).expect("a file");
    let limits = Limits {
        clients: 2,
        patience: Duration::from_secs(2),
        slowest_bytes_per_s: 100_000_000,
    };
    let running = Running::with(folder.path(), limits);
    let taking: Vec<TcpStream> = (0..limits.clients)
        .map(|_| {
            let mut stream = running.connect();
            let request = b"GET /large.csv HTTP/1.1\r\nHost: localhost\r\nSec-Fetch-Site: none\r\n\r\n";
            stream.write_all(request).expect("a request");
            // Its answer has begun.
            stream.read_exact(&mut [0; 100]).expect("a beginning");
            stream
        })
        .collect();
    let busy = running.ask("GET / HTTP/1.1\nHost: localhost");
    assert!(busy.starts_with("HTTP/1.1 503"), "{busy}");
    let begun = Instant::now();
    while !running
        .try_ask("GET / HTTP/1.1\nHost: localhost")
        .is_ok_and(|answer| answer.starts_with("HTTP/1.1 200"))
    {
        assert!(begun.elapsed() < Duration::from_secs(60), "nobody else is served");
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(taking);
}

/// Whoever takes an answer too slowly is left in the middle of it.
#[test]
fn clients_that_take_drop_by_drop_are_left() {
    let folder = campaign();
    let large = folder.path().join("report/large.csv");
    std::fs::write(&large, vec![b'x'; 30_000_000]).expect("a file");
    let limits = Limits {
        patience: Duration::from_millis(300),
        slowest_bytes_per_s: 100_000_000,
        ..Limits::default()
    };
    let running = Running::with(folder.path(), limits);
    let mut stream = running.connect();
    stream
        .write_all(b"GET /large.csv HTTP/1.1\r\nHost: localhost\r\nSec-Fetch-Site: none\r\n\r\n")
        .expect("a request");
    std::thread::sleep(Duration::from_millis(1500));
    let mut taken = Vec::new();
    let _ = stream.read_to_end(&mut taken);
    assert!(
        taken.starts_with(b"HTTP/1.1 200") && taken.len() < 30_000_000,
        "{}",
        taken.len()
    );
    // Whoever takes it at once has all of it.
    let whole = Running::of(folder.path()).ask("GET /large.csv HTTP/1.1\nHost: localhost");
    assert!(whole.len() > 30_000_000, "{}", whole.len());
}

/// 60 clients that do not read 30 MB held 1.15 GB.
#[cfg(target_os = "linux")]
#[test]
fn clients_that_do_not_read_cost_no_memory() {
    let folder = campaign();
    std::fs::write(folder.path().join("campaign.toml"), "[campaign]\nid = \"a\"\n").expect("a file");
    std::fs::write(folder.path().join("report/large.csv"), vec![b'x'; 30_000_000]).expect("a file");
    let mut server = std::process::Command::new(assert_cmd::cargo::cargo_bin("ieap"))
        .args(["serve", "--port", "0", "--json"])
        .arg(folder.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the program");
    let mut said = String::new();
    let mut stdout = server.stdout.take().expect("its output");
    let mut part = [0; 256];
    while !said.contains('}') {
        let count = stdout.read(&mut part).expect("its output");
        said.push_str(std::str::from_utf8(&part[..count]).expect("text"));
    }
    let url: serde_json::Value = serde_json::from_str(&said).expect("a document");
    let url = url["url"].as_str().expect("a text");
    let address: SocketAddr = url
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .parse()
        .expect("an address");
    let waiting: Vec<TcpStream> = (0..40)
        .map(|_| {
            let mut stream = TcpStream::connect(address).expect("a connection");
            let request = b"GET /large.csv HTTP/1.1\r\nHost: localhost\r\nSec-Fetch-Site: none\r\n\r\n";
            stream.write_all(request).expect("a request");
            stream
        })
        .collect();
    std::thread::sleep(Duration::from_secs(3));
    let status = std::fs::read_to_string(format!("/proc/{}/status", server.id())).expect("its state");
    server.kill().expect("its end");
    let _ = server.wait();
    drop(waiting);
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let largest_kb: u64 = line
        .and_then(|line| line.trim().trim_end_matches(" kB").parse().ok())
        .expect("a size");
    assert!(largest_kb < 150_000, "{largest_kb} kB");
}

/// A program that serves with so few open files that its clients use them up.
#[cfg(unix)]
#[test]
fn on_too_few_open_files_a_client_is_turned_away_and_the_server_lives() {
    use std::process::{Command, Stdio};
    let folder = campaign();
    std::fs::write(folder.path().join("campaign.toml"), "").expect("a file");
    let program = crate::campaign::command(folder.path(), &[]);
    let mut server = Command::new("sh")
        .args(["-c", "ulimit -n 24; exec \"$0\" serve --port 0"])
        .arg(program.get_program())
        .current_dir(folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a server");
    let mut said = std::io::BufReader::new(server.stderr.take().expect("what it says"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).expect("its address");
    let at = line
        .split("http://")
        .nth(1)
        .and_then(|rest| rest.split('/').next());
    let address: SocketAddr = at.and_then(|at| at.parse().ok()).expect(&line);
    let ask = |patience: Duration| {
        let mut stream = TcpStream::connect(address).expect("a connection");
        stream.set_read_timeout(Some(patience)).expect("a limit");
        stream
            .write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            .expect("a request");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).map(|_| answer)
    };
    // Clients that connect and ask nothing hold an open file each, for 10 s.
    let idle: Vec<TcpStream> = (0..40)
        .map(|_| TcpStream::connect(address).expect("a connection"))
        .collect();
    let answer = ask(Duration::from_secs(60)).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 503"), "{answer}");
    drop(idle);
    let begun = Instant::now();
    while !ask(Duration::from_secs(60))
        .expect("an answer")
        .starts_with("HTTP/1.1 200")
    {
        assert!(begun.elapsed() < Duration::from_secs(60), "it never came back");
    }
    assert!(server.try_wait().expect("a server").is_none(), "it ended");
    server.kill().expect("its end");
    server.wait().expect("its end");
    line.clear();
    said.read_to_string(&mut line).expect("what it said");
    assert!(
        line.contains("a client could not be answered") && line.contains("ulimit -n"),
        "{line}"
    );
}
