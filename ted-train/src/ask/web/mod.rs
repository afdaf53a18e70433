//! The web page: one person, one server, nothing but this process and its own files.

mod assets;
mod desk;
mod guard;
mod page;
mod range;
mod routes;
mod scene;
mod server;

pub use page::Page;
pub use scene::End;
pub use server::Server;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::str::FromStr;

/// Where the page is served: an address, with a port if a person cares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listen(pub SocketAddr);

impl Default for Listen {
    /// This machine alone, at any port that is free.
    fn default() -> Self {
        Self(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0))
    }
}

impl FromStr for Listen {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let address = text.parse().map(|ip: IpAddr| SocketAddr::new(ip, 0));
        let address = text.parse().or(address);
        let address = address.map_err(|_| {
            format!("{text:?} is not an address such as 127.0.0.1, 127.0.0.1:8021 or [::1]:8021")
        });
        address.map(Self)
    }
}

impl Listen {
    /// Whether only this machine can reach it.
    #[must_use]
    pub fn is_loopback(self) -> bool {
        self.0.ip().is_loopback()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_may_have_a_port_and_need_not() {
        let at = |text: &str| text.parse::<Listen>().map(|listen| listen.0.to_string());
        assert_eq!(at("127.0.0.1").unwrap(), "127.0.0.1:0");
        assert_eq!(at("0.0.0.0:8021").unwrap(), "0.0.0.0:8021");
        assert_eq!(at("[::1]:8021").unwrap(), "[::1]:8021");
        assert!(at("localhost").unwrap_err().contains("127.0.0.1:8021"));
        assert!(
            Listen::default().is_loopback() && !"0.0.0.0".parse::<Listen>().unwrap().is_loopback()
        );
    }
}
