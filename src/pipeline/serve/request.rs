//! What a client asks for: the head of an HTTP/1 request, as far as a folder of files needs it.

use std::io::{self, Read};
use std::path::PathBuf;

/// Longest head taken in, bytes.
pub(super) const LONGEST_HEAD: usize = 8 * 1024;
/// The one hidden file that may be read: it says what a report was made from, so that pages notice a new one.
const MADE_FROM: &str = ".made-from";

/// A request that can be answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Whether only the head of the answer is wanted.
    pub head_only: bool,
    /// File below the report's folder; `index.html` for the root.
    pub file: PathBuf,
    /// Tags of the versions that the client has.
    pub known_tags: Option<String>,
    /// What the client calls this machine.
    pub host: String,
    /// Whose page asks, as the browser says it (`Sec-Fetch-Site`); none where it says nothing.
    pub site: Option<String>,
    /// Whether the answer is to be a page of its own, in place of the one that asks.
    pub is_navigation: bool,
    /// What the browser keeps of this server.
    pub cookies: String,
}

/// Why a request is not answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The text is no request, or too long.
    Malformed,
    /// Neither GET nor HEAD.
    Method,
    /// A path that can be no file of a report.
    Path,
    /// It did not come in the time that a request may take.
    Slow,
}

/// Reads the head of a request. None where the client hung up before it.
///
/// # Errors
/// Why it is not answered.
pub fn read(stream: &mut impl Read) -> Result<Option<Request>, Refusal> {
    let mut head = Vec::new();
    let mut part = [0; 1024];
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        if head.len() > LONGEST_HEAD {
            return Err(Refusal::Malformed);
        }
        match stream.read(&mut part) {
            Ok(0) | Err(_) if head.is_empty() => return Ok(None),
            Err(error) if is_late(&error) => return Err(Refusal::Slow),
            Ok(0) | Err(_) => return Err(Refusal::Malformed),
            Ok(count) => head.extend_from_slice(&part[..count]),
        }
    }
    let head = String::from_utf8(head).map_err(|_| Refusal::Malformed)?;
    parsed(&head).map(Some)
}

/// Whether a time limit ended it; systems differ in how they say so.
fn is_late(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock)
}

fn parsed(head: &str) -> Result<Request, Refusal> {
    let mut lines = head.split("\r\n");
    let first: Vec<&str> = lines.next().unwrap_or("").split(' ').collect();
    let [method, target, version] = first.as_slice() else {
        return Err(Refusal::Malformed);
    };
    if !version.starts_with("HTTP/1.") {
        return Err(Refusal::Malformed);
    }
    let head_only = match *method {
        "GET" => false,
        "HEAD" => true,
        _ => return Err(Refusal::Method),
    };
    let fields: Vec<(&str, &str)> = lines.filter_map(|line| line.split_once(':')).collect();
    let field = |name: &str| {
        let found = fields.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        found.map(|(_, value)| value.trim().to_owned())
    };
    let file = file_of(target).ok_or(Refusal::Path)?;
    // Of two names one could be for whoever looks at the first, and the other for whoever looks at the second.
    let hosts = fields
        .iter()
        .filter(|(known, _)| known.eq_ignore_ascii_case("host"));
    let (1, Some(host)) = (hosts.count(), field("host")) else {
        return Err(Refusal::Malformed);
    };
    Ok(Request {
        head_only,
        file,
        known_tags: field("if-none-match"),
        host,
        site: field("sec-fetch-site"),
        is_navigation: field("sec-fetch-mode").as_deref() == Some("navigate")
            && field("sec-fetch-dest").as_deref() == Some("document"),
        cookies: field("cookie").unwrap_or_default(),
    })
}

/// The file that a target names: plain names below the folder, no hidden ones, nothing that leads out of it.
fn file_of(target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    if path.is_empty() {
        return Some(PathBuf::from("index.html"));
    }
    let path = decoded(path)?;
    if path == MADE_FROM {
        return Some(PathBuf::from(path));
    }
    let is_plain = |name: &str| {
        !name.is_empty()
            && !name.starts_with('.')
            && name
                .chars()
                .all(|c| !c.is_control() && !['\\', ':', '/'].contains(&c))
    };
    path.split('/').all(is_plain).then(|| path.split('/').collect())
}

/// A path with its `%20` read; none where that is no text.
fn decoded(path: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let digit = |byte: Option<u8>| (byte? as char).to_digit(16);
                (16 * digit(rest.next())? + digit(rest.next())?) as u8
            }
            other => other,
        });
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::Component;

    fn asked(text: &str) -> Result<Option<Request>, Refusal> {
        read(&mut text.as_bytes())
    }

    #[test]
    fn a_request_is_read() {
        let found = asked(
            "GET /runs/a%20b.html?x=1 HTTP/1.1\r\nHost: localhost:8421\r\nIf-None-Match: \"abc\"\r\n\r\n",
        );
        let request = found.unwrap().unwrap();
        assert_eq!(request.file, PathBuf::from("runs").join("a b.html"));
        assert_eq!(request.known_tags.as_deref(), Some("\"abc\""));
        assert_eq!(request.host, "localhost:8421");
        assert_eq!(
            asked("HEAD / HTTP/1.0\r\nHost: a\r\n\r\n").unwrap().unwrap().file,
            PathBuf::from("index.html")
        );
    }

    #[test]
    fn what_is_no_page_is_refused() {
        for path in [
            "/../campaign.db",
            "/runs/../../campaign.db",
            "/%2e%2e/campaign.db",
            "/runs/%2e%2e%2fcampaign.db",
            "//etc/passwd",
            "/.hidden",
            "/runs/.made-from",
            "/c:/x",
            "/a%5c..%5cb",
            "/a%00.html",
            "/%ff",
            "/%2",
            "index.html",
        ] {
            let found = asked(&format!("GET {path} HTTP/1.1\r\n\r\n"));
            assert_eq!(found, Err(Refusal::Path), "{path}");
        }
        assert_eq!(asked("POST / HTTP/1.1\r\n\r\n"), Err(Refusal::Method));
        assert_eq!(asked("GET /\r\n\r\n"), Err(Refusal::Malformed));
        assert_eq!(asked("GET / HTTP/1.1\r\n"), Err(Refusal::Malformed));
        assert_eq!(asked(&"x".repeat(20_000)), Err(Refusal::Malformed));
        assert_eq!(asked(""), Ok(None));
        for hosts in [
            "",
            "Host: localhost\r\nhost: localhost\r\n",
            "Host: localhost\r\nHost: b\r\n",
        ] {
            let found = asked(&format!("GET / HTTP/1.1\r\n{hosts}\r\n"));
            assert_eq!(found, Err(Refusal::Malformed), "{hosts}");
        }
    }

    proptest! {
        #[test]
        fn no_target_leads_out_of_the_folder(target in "/[ -~]{0,40}") {
            if let Some(file) = file_of(&target) {
                prop_assert!(file.components().all(|part| matches!(part, Component::Normal(_))));
            }
        }
    }
}
