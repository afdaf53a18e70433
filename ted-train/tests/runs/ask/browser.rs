//! As much of a browser as HTTP needs: a cookie, an origin, and nothing hidden.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::Value;

/// Somebody with the page open.
#[derive(Clone)]
pub struct Browser {
    host: String,
    cookie: Option<String>,
    at: Option<u64>,
}

/// What came back.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Answer {
    /// Fails unless it came with this status.
    #[track_caller]
    pub fn with(self, status: u16) -> Self {
        assert_eq!(self.status, status, "{self:?}");
        self
    }
}

impl Browser {
    /// Waits for the address on a command's standard error, and opens it.
    pub fn open(told: &mut impl Read) -> Self {
        Self::at(&address(told))
    }

    /// Opens an address.
    fn at(address: &str) -> Self {
        let (host, path) = address.split_once('/').unwrap();
        let stranger = Self {
            host: host.to_owned(),
            cookie: None,
            at: None,
        };
        let opened = stranger.get(&format!("/{path}")).with(200);
        let set = opened
            .head
            .lines()
            .find_map(|line| line.strip_prefix("set-cookie: "))
            .unwrap();
        assert!(
            set.contains("HttpOnly") && set.contains("SameSite=Strict"),
            "{set}"
        );
        let (cookie, _) = set.split_once(';').unwrap();
        Self {
            cookie: Some(cookie.to_owned()),
            ..stranger
        }
    }

    /// The same browser's second tab.
    pub fn tab(&self) -> Self {
        Self {
            at: None,
            ..self.clone()
        }
    }

    /// Somebody else on the same machine.
    pub fn stranger(&self) -> Self {
        Self {
            cookie: None,
            ..self.clone()
        }
    }

    pub fn origin(&self) -> String {
        format!("http://{}", self.host)
    }

    /// Waits for a scene of this phase.
    pub fn until(&mut self, phase: &str) -> Value {
        loop {
            let query = self.at.map_or(String::new(), |at| format!("?after={at}"));
            let answer = self.get(&format!("/api/scene{query}")).with(200);
            let scene: Value = serde_json::from_str(&answer.body).unwrap();
            if scene["phase"] == phase {
                return scene;
            }
            assert_ne!(scene["phase"], "ended", "{scene}");
            self.at = scene["at"].as_u64();
        }
    }

    /// Says something about a scene, and looks for what comes next.
    pub fn say(&mut self, scene: &Value, mut word: Value) -> Answer {
        word["at"] = scene["at"].clone();
        self.at = scene["at"].as_u64();
        self.post_as(&word.to_string(), &[("Origin", &self.origin())])
    }

    pub fn get(&self, path: &str) -> Answer {
        self.get_as(path, &[])
    }

    pub fn get_as(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        self.send(&format!("GET {path}"), headers, "")
    }

    pub fn post_as(&self, body: &str, headers: &[(&str, &str)]) -> Answer {
        let length = body.len().to_string();
        let own = [
            ("Content-Type", "application/json"),
            ("Content-Length", &length),
        ];
        self.send("POST /api/say", &[&own, headers].concat(), body)
    }

    /// Announces a body of this many bytes, and sends the first few.
    pub fn announce(&self, bytes: u64, origin: &str) -> Answer {
        let length = bytes.to_string();
        let headers = [
            ("Content-Type", "application/json"),
            ("Content-Length", length.as_str()),
            ("Origin", origin),
        ];
        self.send("POST /api/say", &headers, "{\"at\":")
    }

    fn send(&self, what: &str, headers: &[(&str, &str)], body: &str) -> Answer {
        let mut all = vec![("Connection", "close")];
        if !headers.iter().any(|(name, _)| *name == "Host") {
            all.push(("Host", &self.host));
        }
        if let Some(cookie) = &self.cookie {
            all.push(("Cookie", cookie));
        }
        send(&self.host, what, &[&all, headers].concat(), body)
    }
}

/// Waits for the address that a command says on standard error; what comes before the first slash is the host.
pub fn address(told: &mut impl Read) -> String {
    // Byte by byte: what is said afterwards is for somebody else.
    let mut reader = BufReader::with_capacity(1, told);
    let mut line = String::new();
    loop {
        line.clear();
        assert!(reader.read_line(&mut line).unwrap() > 0, "no address");
        if let Some((_, address)) = line.split_once("answer here: http://") {
            return address.trim().to_owned();
        }
    }
}

/// Sends a request and reads what comes back, which says how long it is.
pub fn send(host: &str, what: &str, headers: &[(&str, &str)], body: &str) -> Answer {
    let mut stream = TcpStream::connect(host).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let headers = headers
        .iter()
        .map(|(name, value)| format!("{name}: {value}\r\n"));
    let headers: String = headers.collect();
    let request = format!("{what} HTTP/1.1\r\n{headers}\r\n{body}");
    stream.write_all(request.as_bytes()).unwrap();
    let mut reader = BufReader::new(stream);
    let mut head = String::new();
    while !head.ends_with("\r\n\r\n") {
        assert!(reader.read_line(&mut head).unwrap() > 0, "{head}");
    }
    let length = head.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.eq_ignore_ascii_case("content-length")
            .then_some(value.trim())
    });
    let mut body = vec![0; length.map_or(0, |length| length.parse().unwrap())];
    reader.read_exact(&mut body).unwrap();
    Answer {
        status: head.split(' ').nth(1).unwrap().parse().unwrap(),
        head,
        body: String::from_utf8_lossy(&body).into_owned(),
    }
}
