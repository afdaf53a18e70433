//! What can be asked of the server: the page's own files, what it shows, its two clips, their films and videos, and one way to say something.
//! Nothing here takes a name of a file.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Path, Query, Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_LENGTH, CONTENT_TYPE, SET_COOKIE};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;

use super::assets;
use super::desk::{Desk, TooLate};
use super::guard::{Entry, Guard, Refusal};
use super::range;
use super::scene::Word;
use crate::ask::film::{self, Studio};
use crate::ask::words::word;

/// Bytes that somebody may say at once.
const BODY: usize = 1024;
/// How long a page waits for something new.
const PATIENCE: Duration = Duration::from_secs(20);
/// How long any request may take.
const LIMIT: Duration = Duration::from_secs(30);

/// What every answer says to the browser: nothing from elsewhere, nothing inline, in nobody's frame, kept nowhere.
const HEADERS: [(&str, &str); 6] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; media-src 'self'; connect-src 'self'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    (
        "permissions-policy",
        "camera=(), microphone=(), geolocation=()",
    ),
];

/// What the server knows.
#[derive(Clone)]
pub(super) struct Shared {
    pub desk: Arc<Desk>,
    pub studio: Arc<Studio>,
    pub guard: Arc<Guard>,
}

impl Shared {
    /// Whether this is the scene that is shown, and there is something to watch.
    fn is_watched(&self, at: u64) -> bool {
        let shown = self.desk.shown();
        shown.at == at && shown.clips.is_some()
    }
}

/// The clips of a scene, as a request names them.
const SIDES: [&str; 2] = ["left", "right"];

/// Everything there is.
pub(super) fn router(shared: Shared) -> Router {
    let mut router = Router::new();
    for asset in &assets::ALL {
        router = router.route(
            asset.path,
            get(|| async { ([(CONTENT_TYPE, asset.kind)], asset.text) }),
        );
    }
    router
        .route("/api/scene", get(scene))
        .route("/api/clip/{at}/{side}", get(clip))
        .route("/api/film/{at}", get(film))
        .route("/api/film/{at}/{side}/{still}", get(still))
        .route("/api/video/{at}/{side}/{camera}", get(video))
        .route("/api/say", post(say))
        .layer(DefaultBodyLimit::max(BODY))
        .layer(from_fn_with_state(shared.clone(), guarded))
        .with_state(shared)
}

/// Lets a request in or not, in bounded time, and adds what every answer says.
async fn guarded(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let judged = shared
        .guard
        .judge(request.method(), request.uri(), request.headers());
    let mut response = match judged {
        Ok(_) if announced(&request) > BODY as u64 => StatusCode::PAYLOAD_TOO_LARGE.into_response(),
        Ok(_) => match tokio::time::timeout(LIMIT, next.run(request)).await {
            Ok(response) => response,
            Err(_) => StatusCode::REQUEST_TIMEOUT.into_response(),
        },
        Err(refusal) => {
            let why = match refusal {
                Refusal::Host => "refused-host",
                Refusal::Origin => "refused-origin",
                Refusal::Stranger => "refused-stranger",
            };
            (StatusCode::FORBIDDEN, word(why).to_owned()).into_response()
        }
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(
            HeaderName::from_static(name),
            HeaderValue::from_static(value),
        );
    }
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    if judged == Ok(Entry::Token)
        && let Ok(cookie) = HeaderValue::from_str(&shared.guard.set_cookie())
    {
        headers.insert(SET_COOKIE, cookie);
    }
    response
}

/// Bytes that a request says it will send: what is too much is not waited for.
fn announced(request: &Request) -> u64 {
    let length = request.headers().get(CONTENT_LENGTH);
    let length = length.and_then(|value| value.to_str().ok()?.parse().ok());
    length.unwrap_or(0)
}

#[derive(Deserialize)]
struct After {
    after: Option<u64>,
}

async fn scene(State(shared): State<Shared>, Query(After { after }): Query<After>) -> Response {
    json(shared.desk.after(after, PATIENCE).await.scene)
}

async fn clip(State(shared): State<Shared>, Path((at, side)): Path<(u64, String)>) -> Response {
    let shown = shared.desk.shown();
    let clips = shown.clips.filter(|_| shown.at == at);
    match (clips, side.as_str()) {
        (Some([left, _]), "left") => json(left),
        (Some([_, right]), "right") => json(right),
        _ => StatusCode::NOT_FOUND.into_response(),
    }
}

/// How far the films of this scene are.
async fn film(State(shared): State<Shared>, Path(at): Path<u64>) -> Response {
    match shared.is_watched(at) {
        true => Json(shared.studio.progress()).into_response(),
        // It was answered a moment ago, which is no error.
        false => StatusCode::NO_CONTENT.into_response(),
    }
}

/// A still of one of them: only of the scene that is shown, and by its place in the film.
async fn still(
    State(shared): State<Shared>,
    Path((at, side, still)): Path<(u64, String, u32)>,
) -> Response {
    if !shared.is_watched(at) {
        return StatusCode::NO_CONTENT.into_response();
    }
    let side = SIDES.iter().position(|name| *name == side);
    match side.and_then(|side| shared.studio.still(side, still)) {
        Some(jpeg) => ([(CONTENT_TYPE, "image/jpeg")], jpeg).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

/// The video of one clip, or a part of it: only of the scene that is shown, and by the place of its camera.
async fn video(
    State(shared): State<Shared>,
    Path((at, side, camera)): Path<(u64, String, usize)>,
    headers: HeaderMap,
) -> Response {
    if !shared.is_watched(at) {
        return StatusCode::NO_CONTENT.into_response();
    }
    let side = SIDES.iter().position(|name| *name == side);
    let file = side.and_then(|side| shared.studio.video(side, camera));
    match file.and_then(|file| Some((film::kind(&file)?, file))) {
        Some((kind, file)) => range::answer(&file, kind, &headers),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

/// What somebody says, and about which scene.
#[derive(Deserialize)]
struct Said {
    at: u64,
    #[serde(flatten)]
    word: Word,
}

async fn say(State(shared): State<Shared>, Json(Said { at, word }): Json<Said>) -> Response {
    match shared.desk.say(at, word) {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(TooLate) => StatusCode::CONFLICT.into_response(),
    }
}

fn json(bytes: Bytes) -> Response {
    ([(CONTENT_TYPE, "application/json")], bytes).into_response()
}
