//! The files of the page, which are part of the program.

use crate::ask::words;

/// A file as it is sent.
pub(super) struct Asset {
    pub path: &'static str,
    pub kind: &'static str,
    pub text: &'static str,
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// All of them.
pub(super) const ALL: [Asset; 12] = [
    asset(
        "/",
        "text/html; charset=utf-8",
        include_str!("assets/index.html"),
    ),
    asset(
        "/style.css",
        "text/css; charset=utf-8",
        include_str!("assets/style.css"),
    ),
    asset(
        "/icon.svg",
        "image/svg+xml",
        include_str!("assets/icon.svg"),
    ),
    asset("/words.json", "application/json", words::FILE),
    asset("/app.js", SCRIPT, include_str!("assets/app.js")),
    asset("/did.js", SCRIPT, include_str!("assets/did.js")),
    asset("/film.js", SCRIPT, include_str!("assets/film.js")),
    asset("/video.js", SCRIPT, include_str!("assets/video.js")),
    asset("/player.js", SCRIPT, include_str!("assets/player.js")),
    asset("/space.js", SCRIPT, include_str!("assets/space.js")),
    asset("/plots.js", SCRIPT, include_str!("assets/plots.js")),
    asset("/server.js", SCRIPT, include_str!("assets/server.js")),
];

const fn asset(path: &'static str, kind: &'static str, text: &'static str) -> Asset {
    Asset { path, kind, text }
}
