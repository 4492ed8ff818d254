//! Answers: a file of the report with its tag, or why there is none.

use std::io::{self, Write};
use std::path::Path;

use super::request::{Refusal, Request};

/// A bent strip: browsers ask every server for an icon.
const ICON: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 32 32\"><path d=\"M4 6c12 0 20 6 22 20\" \
                    fill=\"none\" stroke=\"#0072b2\" stroke-width=\"5\" stroke-linecap=\"round\"/></svg>";
/// Shown while there is no report; it looks again by itself.
const NO_REPORT: &str = "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"3\">\
<title>No report yet</title></head><body><main><h1>No report yet</h1><p><code>ieap run</code> makes one; this page looks again by itself.</p>\
</main></body></html>";

/// An answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Status line, `200 OK`.
    pub status: &'static str,
    /// Media type of the body.
    pub media_type: &'static str,
    /// Tag of the body's version.
    pub tag: Option<String>,
    /// Body.
    pub body: Vec<u8>,
}

impl Answer {
    fn told(status: &'static str, text: &str) -> Answer {
        Answer {
            status,
            media_type: "text/plain; charset=utf-8",
            tag: None,
            body: format!("{text}\n").into_bytes(),
        }
    }

    /// What is said of a request that is not answered.
    pub fn refusal(why: Refusal) -> Answer {
        match why {
            Refusal::Malformed => Answer::told("400 Bad Request", "this is no request for a page"),
            Refusal::Method => Answer::told("405 Method Not Allowed", "pages can be read and nothing else"),
            Refusal::Path => Answer::told("404 Not Found", "the report has no such file"),
        }
    }

    /// What is said to a client that calls this machine by a name that is not its own: a page of another site that
    /// has its name lead here must not read the report.
    pub fn wrong_host() -> Answer {
        Answer::told(
            "403 Forbidden",
            "ask for the report by the address that `ieap serve` printed, or give --bind",
        )
    }

    /// What is said while as many clients are served as may be.
    pub fn busy() -> Answer {
        Answer::told("503 Service Unavailable", "too many requests at once; try again")
    }

    /// The file below `root` that `request` asks for.
    pub fn to(request: &Request, root: &Path) -> Answer {
        let Some(body) = contents(root, &request.file) else {
            if request.file == Path::new("favicon.ico") {
                return Answer {
                    status: "200 OK",
                    media_type: "image/svg+xml",
                    tag: None,
                    body: ICON.into(),
                };
            }
            if request.file == Path::new("index.html") {
                return Answer {
                    media_type: "text/html; charset=utf-8",
                    body: NO_REPORT.into(),
                    ..Answer::refusal(Refusal::Path)
                };
            }
            return Answer::refusal(Refusal::Path);
        };
        let tag = format!("\"{}\"", &blake3::hash(&body).to_hex()[..24]);
        let media_type = media_type(&request.file);
        let is_known = |known: &String| {
            known
                .split(',')
                .any(|one| [tag.as_str(), "*"].contains(&one.trim()))
        };
        match request.known_tags.as_ref().is_some_and(is_known) {
            true => Answer {
                status: "304 Not Modified",
                media_type,
                tag: Some(tag),
                body: Vec::new(),
            },
            false => Answer {
                status: "200 OK",
                media_type,
                tag: Some(tag),
                body,
            },
        }
    }

    /// Writes the answer; without its body where only the head is wanted.
    ///
    /// # Errors
    /// The client is gone.
    pub fn write(&self, out: &mut impl Write, head_only: bool) -> io::Result<()> {
        let mut head = format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-cache\r\n\
             X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Content-Security-Policy: default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'\r\n",
            self.status,
            self.media_type,
            self.body.len()
        );
        if let Some(tag) = &self.tag {
            head.push_str(&format!("ETag: {tag}\r\n"));
        }
        if self.status.starts_with("405") {
            head.push_str("Allow: GET, HEAD\r\n");
        }
        head.push_str("\r\n");
        out.write_all(head.as_bytes())?;
        if !head_only {
            out.write_all(&self.body)?;
        }
        out.flush()
    }
}

/// Bytes of a file of the folder. A link that leads out of it is none.
fn contents(root: &Path, file: &Path) -> Option<Vec<u8>> {
    let root = std::fs::canonicalize(root).ok()?;
    let path = std::fs::canonicalize(root.join(file)).ok()?;
    if !path.starts_with(&root) || !path.is_file() {
        return None;
    }
    std::fs::read(path).ok()
}

fn media_type(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("csv") => "text/csv; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("pdf") => "application/pdf",
        None => "text/plain; charset=utf-8",
        Some(_) => "application/octet-stream",
    }
}
