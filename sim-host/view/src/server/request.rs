//! Parses and authorises HTTP/1.1 requests without bodies.
//!
//! Any web page that the user visits can send requests to this computer. Therefore the Host header
//! must be an address of this server, the Origin must be its page, and the page and the WebSocket
//! need the token.

use std::net::{IpAddr, SocketAddr};

pub(super) const LONGEST: usize = 8192;
const HEADERS: usize = 64;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Request {
    Partial,
    Page,
    /// Never empty.
    File(String),
    /// With the key of its handshake.
    Live(String),
    Refused(Refused),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refused {
    Malformed,
    /// Wrong host, wrong origin or missing token.
    Forbidden,
    Method,
}

#[derive(Clone, Debug)]
pub(super) struct Rules {
    pub address: SocketAddr,
    pub token: String,
}

impl Rules {
    /// A number or localhost, with its port.
    fn is_own_host(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let name = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        let is_own_name = match name.parse::<IpAddr>() {
            // A server that is not on loopback has several addresses.
            Ok(ip) => ip == self.address.ip() || !self.address.ip().is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        };
        is_own_name && port == Some(self.address.port())
    }

    /// Takes a time that does not depend on the number of correct characters.
    fn is_token(&self, given: &str) -> bool {
        let pairs = self.token.bytes().zip(given.bytes());
        given.len() == self.token.len() && pairs.fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
    }

    pub fn read(&self, bytes: &[u8]) -> Request {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(bytes) {
            Ok(httparse::Status::Complete(_)) => {}
            Ok(httparse::Status::Partial) if bytes.len() < LONGEST => return Request::Partial,
            _ => return Request::Refused(Refused::Malformed),
        }
        let header = |name: &str| {
            let mut found = request.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
            let first = found.next().and_then(|header| std::str::from_utf8(header.value).ok());
            // A repeated header is rejected, since servers disagree about its meaning.
            first.filter(|_| found.next().is_none())
        };
        let Some(host) = header("host").filter(|host| self.is_own_host(host)) else {
            return Request::Refused(Refused::Forbidden);
        };
        let has_origin = request.headers.iter().any(|header| header.name.eq_ignore_ascii_case("origin"));
        let is_own_page = header("origin").and_then(|origin| origin.strip_prefix("http://")) == Some(host);
        if has_origin && !is_own_page {
            return Request::Refused(Refused::Forbidden);
        }
        if request.method != Some("GET") {
            return Request::Refused(Refused::Method);
        }
        let target = request.path.unwrap_or_default();
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let mut fields = query.split('&').filter_map(|field| field.split_once('='));
        let has_token = fields.any(|(name, value)| name == "token" && self.is_token(value));
        match path {
            "/live" => {
                let key = header("sec-websocket-key").filter(|_| header("sec-websocket-version") == Some("13"));
                match key {
                    Some(key) if has_token => Request::Live(key.to_owned()),
                    Some(_) => Request::Refused(Refused::Forbidden),
                    None => Request::Refused(Refused::Malformed),
                }
            }
            "/" if has_token => Request::Page,
            // The other files contain no secrets, and module imports cannot pass the token.
            path => match path.strip_prefix('/').filter(|name| is_name(name)) {
                Some(name) => Request::File(name.to_owned()),
                None => Request::Refused(Refused::Forbidden),
            },
        }
    }
}

/// Whether a path names a file. Other spellings of the page's own path do not.
fn is_name(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_');
    !name.is_empty() && !name.starts_with('.') && name.bytes().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rules(ip: &str) -> Rules {
        Rules { address: SocketAddr::new(ip.parse().expect("an address"), 8123), token: "0123abcd".to_owned() }
    }

    fn ask(target: &str, host: &str, rest: &str) -> Request {
        rules("127.0.0.1").read(format!("GET {target} HTTP/1.1\r\nHost: {host}\r\n{rest}\r\n").as_bytes())
    }

    const SOCKET: &str = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n";
    const FORBIDDEN: Request = Request::Refused(Refused::Forbidden);

    #[test]
    fn the_printed_address_gets_the_page_and_its_socket() {
        let page = Request::Page;
        for host in ["127.0.0.1:8123", "localhost:8123", "LOCALHOST:8123"] {
            assert_eq!(ask("/?token=0123abcd", host, ""), page);
        }
        assert_eq!(ask("/app.js", "127.0.0.1:8123", ""), Request::File("app.js".to_owned()));
        let own = format!("{SOCKET}Origin: http://127.0.0.1:8123\r\n");
        let live = ask("/live?token=0123abcd", "127.0.0.1:8123", &own);
        assert_eq!(live, Request::Live("dGhlIHNhbXBsZSBub25jZQ==".to_owned()));
    }

    #[test]
    fn other_hosts_origins_and_tokens_are_forbidden() {
        for host in ["evil.example:8123", "127.0.0.1:8124", "127.0.0.1", "10.0.0.1:8123", "[::1]:8123", ""] {
            assert_eq!(ask("/?token=0123abcd", host, ""), FORBIDDEN, "{host}");
        }
        for target in ["/", "/?token=", "/?token=0123abce", "/?token=0123abcd0", "/?nekot=0123abcd"] {
            assert_eq!(ask(target, "127.0.0.1:8123", ""), FORBIDDEN, "{target}");
        }
        for origin in ["http://evil.example", "null", "https://127.0.0.1:8123", "http://127.0.0.1:81230"] {
            let rest = format!("{SOCKET}Origin: {origin}\r\n");
            assert_eq!(ask("/live?token=0123abcd", "127.0.0.1:8123", &rest), FORBIDDEN, "{origin}");
        }
        let twice = format!("{SOCKET}Origin: http://127.0.0.1:8123\r\nOrigin: http://evil.example\r\n");
        assert_eq!(ask("/live?token=0123abcd", "127.0.0.1:8123", &twice), FORBIDDEN);
        let rest = format!("{SOCKET}Host: evil.example\r\n");
        assert_eq!(ask("/live?token=0123abcd", "127.0.0.1:8123", &rest), FORBIDDEN);
        assert_eq!(ask("/live?token=1", "127.0.0.1:8123", SOCKET), FORBIDDEN);
    }

    #[test]
    fn other_spellings_of_the_page_do_not_replace_its_token() {
        let spellings =
            ["//", "///", "/./", "/.", "/..", "/../", "/%2f", "/%2F", "/%", "/\\", "/;", "/#", "/a/", "/a//"];
        let absolute = ["http://127.0.0.1:8123/", "http://127.0.0.1:8123", "https://x/", "*", "127.0.0.1:8123", "?"];
        let tokens = ["", "?token=wrong", "?token=0123abcd", "?token=0123abcd&token=wrong"];
        for target in spellings.into_iter().chain(absolute) {
            for token in tokens {
                let target = format!("{target}{token}");
                assert_eq!(ask(&target, "127.0.0.1:8123", ""), FORBIDDEN, "{target}");
            }
        }
        for target in ["/", "/?", "/??token=0123abcd", "/?token=wrong", "/?a&token", "/?TOKEN=0123abcd"] {
            assert_eq!(ask(target, "127.0.0.1:8123", ""), FORBIDDEN, "{target}");
        }
        assert_eq!(ask("/?a=b&token=0123abcd", "127.0.0.1:8123", ""), Request::Page);
    }

    #[test]
    fn beyond_loopback_the_host_must_be_a_number() {
        let rules = rules("0.0.0.0");
        let ask = |host: &str| rules.read(format!("GET /?token=0123abcd HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes());
        assert_eq!(ask("192.168.1.7:8123"), Request::Page);
        assert_eq!(ask("evil.example:8123"), FORBIDDEN);
    }

    #[test]
    fn malformed_and_oversized_requests_are_rejected() {
        let rules = rules("127.0.0.1");
        assert_eq!(rules.read(b"GET / HT"), Request::Partial);
        let malformed = Request::Refused(Refused::Malformed);
        assert_eq!(rules.read(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"), malformed);
        assert_eq!(rules.read(&[b"GET /".as_slice(), &[b'a'; LONGEST]].concat()), malformed);
        let many = "A: b\r\n".repeat(HEADERS + 1);
        assert_eq!(ask("/", "127.0.0.1:8123", &many), malformed);
        let post = b"POST /?token=0123abcd HTTP/1.1\r\nHost: 127.0.0.1:8123\r\n\r\n";
        assert_eq!(rules.read(post), Request::Refused(Refused::Method));
        assert_eq!(ask("/live?token=0123abcd", "127.0.0.1:8123", ""), malformed);
    }

    proptest! {
        #[test]
        fn any_bytes_get_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = rules("::1").read(&bytes);
            let _ = rules("::1").read(&[b"GET /?token=0123abcd HTTP/1.1\r\nHost: [::1]:8123\r\n".as_slice(), &bytes].concat());
        }
    }
}
