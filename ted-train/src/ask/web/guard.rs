//! Who may come in: whoever has the token, from a page of this server, under a name that nobody else can give it.
//!
//! The token stands in the address that the command prints. It is changed for a cookie that scripts cannot read and other sites do not
//! send. A `Host` that is neither an address nor `localhost` is a name that somebody made point here (DNS rebinding), and an `Origin`
//! that is not this server is another page.

use std::net::IpAddr;

use axum::http::header::{COOKIE, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, Uri};

use crate::ask::AskError;

/// Bytes of a secret.
const SECRET: usize = 24;

/// What is asked of every request.
pub(super) struct Guard {
    token: String,
    session: String,
    /// The cookie's name: servers on one machine share their cookies, whatever their ports are.
    cookie: String,
    loopback: bool,
}

/// How somebody showed that they may come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entry {
    /// With the token: they are to get the cookie.
    Token,
    /// With the cookie.
    Cookie,
}

/// Why somebody may not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The server is called by a name that is not its own.
    Host,
    /// Another page asks.
    Origin,
    /// Neither token nor cookie.
    Stranger,
}

impl Guard {
    /// A guard with new secrets.
    ///
    /// # Errors
    /// When the system has no randomness.
    pub fn new(port: u16, loopback: bool) -> Result<Self, AskError> {
        Ok(Self {
            token: secret()?,
            session: secret()?,
            cookie: format!("ted-ask-{port}"),
            loopback,
        })
    }

    /// What lets a person in.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// The header that gives them the cookie.
    pub fn set_cookie(&self) -> String {
        let Self {
            cookie, session, ..
        } = self;
        format!("{cookie}={session}; Path=/; HttpOnly; SameSite=Strict")
    }

    /// Judges a request by its head.
    pub fn judge(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<Entry, Refusal> {
        let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
        let host = text(HOST).filter(|host| self.is_mine(host));
        let host = host.ok_or(Refusal::Host)?;
        match headers.contains_key(ORIGIN) {
            true if text(ORIGIN) != Some(&format!("http://{host}")) => return Err(Refusal::Origin),
            // Every browser names the page that posts.
            false if !matches!(*method, Method::GET | Method::HEAD) => return Err(Refusal::Origin),
            _ => {}
        }
        let token =
            uri.path() == "/" && parameter(uri, "token").is_some_and(|it| same(it, &self.token));
        let cookies = headers.get_all(COOKIE).iter();
        let mut cookies = cookies
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(';'))
            .filter_map(|pair| pair.trim().split_once('='));
        if token {
            Ok(Entry::Token)
        } else if cookies.any(|(name, value)| name == self.cookie && same(value, &self.session)) {
            Ok(Entry::Cookie)
        } else {
            Err(Refusal::Stranger)
        }
    }

    /// Whether a `Host` is this server. Its port may be another one: that is what a tunnel does.
    fn is_mine(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
            _ => host,
        };
        let address = name.trim_start_matches('[').trim_end_matches(']');
        match address.parse::<IpAddr>() {
            Ok(address) => !self.loopback || address.is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        }
    }
}

/// A parameter of an address.
fn parameter<'u>(uri: &'u Uri, name: &str) -> Option<&'u str> {
    let pairs = uri.query()?.split('&').filter_map(|it| it.split_once('='));
    pairs
        .into_iter()
        .find_map(|(key, value)| (key == name).then_some(value))
}

/// Whether two secrets are the same, in a time that says nothing about where they differ.
fn same(one: &str, other: &str) -> bool {
    blake3::hash(one.as_bytes()) == blake3::hash(other.as_bytes())
}

fn secret() -> Result<String, AskError> {
    let mut bytes = [0; SECRET];
    getrandom::fill(&mut bytes).map_err(|error| AskError::NoSecret(error.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(
        guard: &Guard,
        method: Method,
        path: &str,
        headers: &[(&str, &str)],
    ) -> Result<Entry, Refusal> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            let name: axum::http::HeaderName = name.parse().unwrap();
            map.insert(name, value.parse().unwrap());
        }
        guard.judge(&method, &path.parse().unwrap(), &map)
    }

    #[test]
    fn the_token_lets_in_where_it_belongs_and_the_cookie_everywhere() {
        let guard = Guard::new(80, true).unwrap();
        let host = ("host", "127.0.0.1:80");
        let at = |path: &str| judged(&guard, Method::GET, path, &[host]);
        assert_eq!(at(&format!("/?token={}", guard.token())), Ok(Entry::Token));
        assert_eq!(at("/?token=0"), Err(Refusal::Stranger));
        assert_eq!(at("/"), Err(Refusal::Stranger));
        assert_eq!(
            at(&format!("/api/scene?token={}", guard.token())),
            Err(Refusal::Stranger)
        );
        let set = guard.set_cookie();
        assert!(
            set.ends_with("; Path=/; HttpOnly; SameSite=Strict"),
            "{set}"
        );
        let (own, _) = set.split_once(';').unwrap();
        let with = |cookies: &str| {
            judged(
                &guard,
                Method::GET,
                "/api/scene",
                &[host, ("cookie", cookies)],
            )
        };
        assert_eq!(with(&format!("ted-ask-81=1; {own}")), Ok(Entry::Cookie));
        assert_eq!(
            with(&own.replace("ask-80", "ask-81")),
            Err(Refusal::Stranger)
        );
        assert_ne!(guard.token(), Guard::new(80, true).unwrap().token());
    }

    #[test]
    fn only_an_address_or_localhost_is_this_server_whatever_the_port_of_a_tunnel() {
        let judge = |loopback: bool, host: &str| {
            let guard = Guard::new(80, loopback).unwrap();
            let path = format!("/?token={}", guard.token());
            judged(&guard, Method::GET, &path, &[("host", host)])
        };
        for host in [
            "127.0.0.1:80",
            "localhost:9000",
            "LOCALHOST",
            "[::1]:80",
            "127.0.0.1",
        ] {
            assert_eq!(judge(true, host), Ok(Entry::Token), "{host}");
        }
        for host in [
            "evil.example",
            "127.0.0.1.evil.example:80",
            "10.0.0.1:80",
            "",
            "localhost.evil.example",
        ] {
            assert_eq!(judge(true, host), Err(Refusal::Host), "{host}");
        }
        assert_eq!(judge(false, "10.0.0.1:80"), Ok(Entry::Token));
        assert_eq!(judge(false, "evil.example"), Err(Refusal::Host));
    }

    #[test]
    fn another_page_is_refused_and_so_is_whoever_posts_without_saying_from_where() {
        let guard = Guard::new(80, true).unwrap();
        let set = guard.set_cookie();
        let (cookie, _) = set.split_once(';').unwrap();
        let post = |origin: Option<&str>| {
            let mut headers = vec![("host", "localhost:80"), ("cookie", cookie)];
            headers.extend(origin.map(|origin| ("origin", origin)));
            judged(&guard, Method::POST, "/api/say", &headers)
        };
        assert_eq!(post(Some("http://localhost:80")), Ok(Entry::Cookie));
        for origin in [
            None,
            Some("null"),
            Some("http://localhost:81"),
            Some("https://evil.example"),
        ] {
            assert_eq!(post(origin), Err(Refusal::Origin), "{origin:?}");
        }
    }
}
