//! Who may have what: the report is for its own pages and for the person who opens it, and for no page of another site.
//!
//! A browser lets any page ask any server, and run what comes back as a script. Three things keep the report from it:
//! - The browser says whose page asks (`Sec-Fetch-Site`): what another site, or another server of this machine, asks for is
//!   refused, but for a page that a person goes to by a link. `Cross-Origin-Resource-Policy` has the browser refuse it, too.
//! - An older browser, or one that reaches the server by another address than a loopback one, does not say it: then a page is
//!   given, which no other page can read, and what is no page only with the token that a page gets as a cookie. Browsers send
//!   that with no other site's request (`SameSite=Strict`). It is no password: whoever can ask for a page has it.
//! - `Host` must be an address, or a name that only this machine has: a page of another site can have its own name lead here.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::net::{IpAddr, SocketAddr};

use super::answer::Answer;
use super::request::Request;

/// Who may have what of one server.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    /// Name and value of the cookie: cookies are kept by name of the machine, not by port.
    cookie: String,
    /// Whether others than this machine reach the server.
    is_open: bool,
}

impl Guard {
    /// That of a server at this address, with a token of its own.
    pub fn of(address: SocketAddr) -> Guard {
        // The system's randomness, as it keys the tables of the library.
        let word = || RandomState::new().build_hasher().finish();
        Guard {
            cookie: format!("ieap-{}={:016x}{:016x}", address.port(), word(), word()),
            is_open: !address.ip().is_loopback(),
        }
    }

    /// Why a request is not answered; none where it is.
    pub fn refusal(&self, request: &Request) -> Option<Answer> {
        if !self.is_name_of_this_machine(&request.host) {
            return Some(Answer::wrong_host());
        }
        let is_page = is_page(request);
        let may_have = match request.site.as_deref() {
            Some("same-origin" | "none") => true,
            Some(_) => is_page && request.is_navigation,
            None => is_page || request.cookies.split(';').any(|one| one.trim() == self.cookie),
        };
        (!may_have).then(Answer::not_of_a_page)
    }

    /// The cookie that goes with an answer to it.
    pub fn cookie_with(&self, request: &Request) -> Option<String> {
        is_page(request).then(|| self.cookie.clone())
    }

    /// Whether a `Host` is an address of this machine, or a name that nobody else can give it: `localhost:8421`,
    /// `127.0.0.1`, `[::1]:80`; where others reach the server any address, and the machine's own name.
    fn is_name_of_this_machine(&self, host: &str) -> bool {
        let is_own = |address: IpAddr| self.is_open || address.is_loopback();
        if let Ok(address) = host.parse::<SocketAddr>() {
            return is_own(address.ip());
        }
        let bare = host.trim_start_matches('[').trim_end_matches(']');
        if let Ok(address) = bare.parse::<IpAddr>() {
            return is_own(address);
        }
        let name = host
            .rsplit_once(':')
            .map_or(host, |(name, _)| name)
            .to_lowercase();
        let own = crate::store::host_name().to_lowercase();
        name == "localhost" || (self.is_open && (name == own || name == format!("{own}.local")))
    }
}

/// Whether a page is asked for, or the icon that browsers ask of every server.
fn is_page(request: &Request) -> bool {
    let ending = request.file.extension();
    ending.is_some_and(|ending| ending == "html" || ending == "ico")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str) -> Guard {
        Guard::of(address.parse().unwrap())
    }

    fn names(guard: &Guard, hosts: &[&str]) -> Vec<bool> {
        hosts
            .iter()
            .map(|host| guard.is_name_of_this_machine(host))
            .collect()
    }

    #[test]
    fn only_loopback_names_are_this_machine() {
        let own = [
            "localhost",
            "LOCALHOST:8421",
            "127.0.0.1",
            "127.0.0.1:80",
            "[::1]",
            "[::1]:8421",
        ];
        let (closed, open) = (guard("127.0.0.1:8421"), guard("0.0.0.0:8421"));
        assert_eq!(names(&closed, &own), [true; 6]);
        assert_eq!(names(&open, &own), [true; 6]);
        let foreign = [
            "example.org",
            "localhost.example.org",
            "127.0.0.1.example.org:80",
            "",
        ];
        assert_eq!(names(&closed, &foreign), [false; 4]);
        assert_eq!(names(&open, &foreign), [false; 4]);
        let name = crate::store::host_name();
        let reached = ["192.168.1.4:8421", name.as_str(), "[fe80::1]:8421"];
        assert_eq!(names(&closed, &reached), [false; 3]);
        assert_eq!(names(&open, &reached), [true; 3]);
        assert!(!open.is_name_of_this_machine(&format!("{name}.example.org")));
    }

    #[test]
    fn no_two_servers_have_the_same_token() {
        assert_ne!(guard("127.0.0.1:8421").cookie, guard("127.0.0.1:8421").cookie);
    }
}
