//! Answers: a file of the report with its tag, or why there is none.
//!
//! A file goes from the disk to the client piece by piece, so that a client that takes it slowly costs no memory. The open
//! file stays the one whose tag was sent: a report is exchanged whole and its files are never written over.

use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::Path;

use super::request::{Refusal, Request};

/// A bent strip: browsers ask every server for an icon.
const ICON: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 32 32\"><path d=\"M4 6c12 0 20 6 22 20\" \
                    fill=\"none\" stroke=\"#0072b2\" stroke-width=\"5\" stroke-linecap=\"round\"/></svg>";
/// Shown while there is no report; it looks again by itself.
const NO_REPORT: &str = "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"3\">\
<title>No report yet</title></head><body><main><h1>No report yet</h1><p><code>ieap run</code> makes one; this page looks again by itself.</p>\
</main></body></html>";

/// Bytes of a file that are in memory at a time.
const PIECE_BYTES: usize = 64 * 1024;

/// What is sent after the head.
#[derive(Debug)]
pub enum Body {
    /// A short text.
    Text(Vec<u8>),
    /// A file from its beginning, and its size in bytes.
    File(File, u64),
}

impl Body {
    /// Its size, bytes.
    pub fn size_bytes(&self) -> u64 {
        match self {
            Body::Text(text) => text.len() as u64,
            Body::File(_, size_bytes) => *size_bytes,
        }
    }
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// Status line, `200 OK`.
    pub status: &'static str,
    /// Media type of the body.
    pub media_type: &'static str,
    /// Tag of the body's version.
    pub tag: Option<String>,
    /// Body.
    pub body: Body,
    /// What the browser is to keep and send with whatever the page asks for.
    pub cookie: Option<String>,
}

impl Answer {
    fn told(status: &'static str, text: &str) -> Answer {
        Answer {
            status,
            media_type: "text/plain; charset=utf-8",
            tag: None,
            body: Body::Text(format!("{text}\n").into_bytes()),
            cookie: None,
        }
    }

    /// What is said of a request that is not answered.
    pub fn refusal(why: Refusal) -> Answer {
        match why {
            Refusal::Malformed => Answer::told("400 Bad Request", "this is no request for a page"),
            Refusal::Method => Answer::told("405 Method Not Allowed", "pages can be read and nothing else"),
            Refusal::Path => Answer::told("404 Not Found", "the report has no such file"),
            Refusal::Slow => Answer::told("408 Request Timeout", "the request took too long"),
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

    /// What is said where the page of another site asks, or nobody's page.
    pub fn not_of_a_page() -> Answer {
        Answer::told(
            "403 Forbidden",
            "this is for the pages of the report: open the address that `ieap serve` printed",
        )
    }

    /// What is said while as many clients are served as may be.
    pub fn busy() -> Answer {
        Answer::told("503 Service Unavailable", "too many requests at once; try again")
    }

    /// The file below `root` that `request` asks for.
    pub fn to(request: &Request, root: &Path) -> Answer {
        let found = opened(root, &request.file).and_then(|file| file.map(tagged).transpose());
        let (body, tag) = match found {
            Ok(Some(found)) => found,
            Ok(None) => return Answer::without_file(request),
            Err(error) if is_of_too_few_files(&error) => return Answer::busy(),
            Err(_) => return Answer::told("500 Internal Server Error", "the file cannot be read"),
        };
        let is_known = |known: &String| {
            known
                .split(',')
                .any(|one| [tag.as_str(), "*"].contains(&one.trim()))
        };
        let (status, body) = if request.known_tags.as_ref().is_some_and(is_known) {
            ("304 Not Modified", Body::Text(Vec::new()))
        } else {
            ("200 OK", body)
        };
        Answer {
            status,
            media_type: media_type(&request.file),
            tag: Some(tag),
            body,
            cookie: None,
        }
    }

    /// What is said where the report has no such file.
    fn without_file(request: &Request) -> Answer {
        match request.file.to_str() {
            Some("favicon.ico") => Answer {
                status: "200 OK",
                media_type: "image/svg+xml",
                tag: None,
                body: Body::Text(ICON.into()),
                cookie: None,
            },
            Some("index.html") => Answer {
                media_type: "text/html; charset=utf-8",
                body: Body::Text(NO_REPORT.into()),
                ..Answer::refusal(Refusal::Path)
            },
            _ => Answer::refusal(Refusal::Path),
        }
    }

    /// Writes the answer; without its body where only the head is wanted.
    ///
    /// # Errors
    /// The client is gone or too slow, or the file cannot be read any more.
    pub fn write(self, out: &mut impl Write, head_only: bool) -> io::Result<()> {
        let mut head = format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-cache\r\n\
             X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n\
             Content-Security-Policy: default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'\r\n",
            self.status,
            self.media_type,
            self.body.size_bytes()
        );
        if let Some(tag) = &self.tag {
            head.push_str(&format!("ETag: {tag}\r\n"));
        }
        if let Some(cookie) = &self.cookie {
            head.push_str(&format!(
                "Set-Cookie: {cookie}; Path=/; HttpOnly; SameSite=Strict\r\n"
            ));
        }
        if self.status.starts_with("405") {
            head.push_str("Allow: GET, HEAD\r\n");
        }
        head.push_str("\r\n");
        out.write_all(head.as_bytes())?;
        match self.body {
            _ if head_only => {}
            Body::Text(text) => out.write_all(&text)?,
            // Never more than the head said.
            Body::File(file, size_bytes) => in_pieces(file.take(size_bytes), |piece| out.write_all(piece))?,
        }
        out.flush()
    }
}

/// Whether the program, or the system, has as many files open as it may.
pub fn is_of_too_few_files(error: &io::Error) -> bool {
    const ENFILE: i32 = 23;
    const EMFILE: i32 = 24;
    const WSAEMFILE: i32 = 10_024;
    matches!(error.raw_os_error(), Some(ENFILE | EMFILE | WSAEMFILE))
}

/// A file of the folder; none where there is none. A link that leads out of it is none.
fn opened(root: &Path, file: &Path) -> io::Result<Option<File>> {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    let found = real(root).and_then(|root| real(&root.join(file)).filter(|path| path.starts_with(&root)));
    match found.filter(|path| path.is_file()).map(File::open) {
        Some(Err(error)) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        opened => opened.transpose(),
    }
}

/// A file as a body, and the tag of its content.
fn tagged(mut file: File) -> io::Result<(Body, String)> {
    let (mut hasher, mut size_bytes) = (blake3::Hasher::new(), 0);
    in_pieces(&mut file, |piece| {
        hasher.update(piece);
        size_bytes += piece.len() as u64;
        Ok(())
    })?;
    file.rewind()?;
    let tag = format!("\"{}\"", &hasher.finalize().to_hex()[..24]);
    Ok((Body::File(file, size_bytes), tag))
}

/// Hands over what can be read, piece by piece.
fn in_pieces(mut from: impl Read, mut hand_over: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    let mut piece = vec![0; PIECE_BYTES];
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(count) => hand_over(&piece[..count])?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
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
