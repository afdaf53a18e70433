//! A file in answer to a request that may want a part of it, as browsers do who play videos: one range of bytes (RFC 9110, section 14).

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes};
use axum::http::header::{ACCEPT_RANGES, CONTENT_RANGE, CONTENT_TYPE, RANGE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use hyper::body::{Frame, SizeHint};

/// Bytes that are read at once.
const PIECE: u64 = 64 * 1024;

/// The file, or the part of it that these headers name; nothing is there where it cannot be read.
pub(super) fn answer(path: &Path, kind: &'static str, headers: &HeaderMap) -> Response {
    let text = headers.get(RANGE).and_then(|value| value.to_str().ok());
    read(path, kind, text).unwrap_or_else(|_| StatusCode::NOT_FOUND.into_response())
}

fn read(path: &Path, kind: &'static str, range: Option<&str>) -> io::Result<Response> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let (status, first, left, place) = match Wanted::of(range, length) {
        Wanted::Whole => (StatusCode::OK, 0, length, None),
        Wanted::Part { first, last } => {
            let place = format!("bytes {first}-{last}/{length}");
            (
                StatusCode::PARTIAL_CONTENT,
                first,
                last - first + 1,
                Some(place),
            )
        }
        Wanted::Nothing => {
            let place = format!("bytes */{length}");
            (StatusCode::RANGE_NOT_SATISFIABLE, 0, 0, Some(place))
        }
    };
    file.seek(SeekFrom::Start(first))?;
    let mut response = (status, Body::new(Part { file, left })).into_response();
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(kind));
    headers.insert(ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    if let Some(Ok(place)) = place.map(HeaderValue::try_from) {
        headers.insert(CONTENT_RANGE, place);
    }
    Ok(response)
}

/// What a request wants of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// All of it: no range is named, several are, or what is named is none.
    Whole,
    /// From one byte to another one, both included and both there.
    Part { first: u64, last: u64 },
    /// A range without a byte in it.
    Nothing,
}

impl Wanted {
    fn of(range: Option<&str>, length: u64) -> Self {
        let digits = |text: &str| text.bytes().all(|it| it.is_ascii_digit());
        let number = |text: &str| text.parse::<u64>().ok().filter(|_| digits(text));
        let named = range.and_then(|it| it.trim().strip_prefix("bytes="));
        let (first, last) = match named.and_then(|it| it.split_once('-')) {
            Some(("", count)) => match number(count) {
                // The last so many bytes.
                Some(count) => (length.saturating_sub(count), u64::MAX),
                None => return Self::Whole,
            },
            Some((first, "")) => match number(first) {
                Some(first) => (first, u64::MAX),
                None => return Self::Whole,
            },
            Some((first, last)) => match (number(first), number(last)) {
                (Some(first), Some(last)) if first <= last => (first, last),
                _ => return Self::Whole,
            },
            None => return Self::Whole,
        };
        if first >= length {
            return Self::Nothing;
        }
        Self::Part {
            first,
            last: last.min(length - 1),
        }
    }
}

/// A part of a file, read piece by piece as it is sent.
struct Part {
    file: File,
    left: u64,
}

impl hyper::body::Body for Part {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<io::Result<Frame<Bytes>>>> {
        let part = self.get_mut();
        if part.left == 0 {
            return Poll::Ready(None);
        }
        let mut piece = vec![0; part.left.min(PIECE) as usize];
        // A file that has become shorter is the end of the connection, not of the video.
        let read = part.file.read_exact(&mut piece).map(|()| {
            part.left -= piece.len() as u64;
            Frame::data(Bytes::from(piece))
        });
        Poll::Ready(Some(read))
    }

    fn is_end_stream(&self) -> bool {
        self.left == 0
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_a_part_that_is_there_or_nothing_and_what_is_no_range_is_the_whole() {
        let wanted = |text: &str| Wanted::of(Some(text), 100);
        let part = |first, last| Wanted::Part { first, last };
        for (text, expected) in [
            ("bytes=0-", part(0, 99)),
            ("bytes=0-0", part(0, 0)),
            ("bytes=10-19", part(10, 19)),
            ("bytes=90-1000", part(90, 99)),
            ("bytes=-10", part(90, 99)),
            ("bytes=-1000", part(0, 99)),
            ("bytes=99-", part(99, 99)),
            ("bytes=100-", Wanted::Nothing),
            ("bytes=100-200", Wanted::Nothing),
            ("bytes=-0", Wanted::Nothing),
            ("bytes=19-10", Wanted::Whole),
            ("bytes=0-1,5-6", Wanted::Whole),
            ("bytes=-", Wanted::Whole),
            ("bytes=a-5", Wanted::Whole),
            ("bytes=5-a", Wanted::Whole),
            ("bytes=+1-5", Wanted::Whole),
            ("bytes=18446744073709551616-", Wanted::Whole),
            ("rows=0-5", Wanted::Whole),
            ("", Wanted::Whole),
        ] {
            assert_eq!(wanted(text), expected, "{text}");
        }
        assert_eq!(Wanted::of(None, 100), Wanted::Whole);
        for text in ["bytes=0-", "bytes=-1"] {
            assert_eq!(Wanted::of(Some(text), 0), Wanted::Nothing, "of nothing");
        }
    }
}
