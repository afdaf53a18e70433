//! The server: a thread of its own, a bounded number of connections, each for a bounded time.

use std::net::TcpListener;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;
use tokio::sync::{Semaphore, oneshot};

use super::Listen;
use super::desk::Desk;
use super::guard::Guard;
use super::routes::{Shared, router};
use crate::ask::AskError;
use crate::ask::film::Studio;

/// Connections at a time. A page needs two or three.
const CONNECTIONS: usize = 32;
/// Time for the head of a request.
const HEAD: Duration = Duration::from_secs(10);
/// Bytes of the head of a request.
const HEAD_BYTES: usize = 16 * 1024;
/// Time that one connection may last.
const CONNECTION: Duration = Duration::from_secs(600);
/// Time in which the page sees how it ended.
const FAREWELL: Duration = Duration::from_secs(3);

/// A server at work.
pub struct Server {
    address: String,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens, and serves what is on the desk.
    ///
    /// # Errors
    /// When the address is taken or not this machine's, or there is no randomness for a secret.
    pub(super) fn start(
        listen: Listen,
        desk: Arc<Desk>,
        studio: Arc<Studio>,
    ) -> Result<Self, AskError> {
        let failed = |source| AskError::Listen {
            address: listen.0,
            source,
        };
        let listener = TcpListener::bind(listen.0).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let at = listener.local_addr().map_err(failed)?;
        let guard = Guard::new(at.port(), listen.is_loopback())?;
        let address = format!("http://{at}/?token={}", guard.token());
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(failed)?;
        let routes = router(Shared {
            desk: Arc::clone(&desk),
            studio,
            guard: Arc::new(guard),
        });
        let (stop, stopped) = oneshot::channel();
        let thread = thread::spawn(move || {
            runtime.block_on(async {
                let listener = match tokio::net::TcpListener::from_std(listener) {
                    Ok(listener) => listener,
                    Err(_) => return,
                };
                tokio::spawn(accept(listener, routes));
                // An end without a word is an end too.
                let _ = stopped.await.is_ok();
                desk.seen_to_its_end(FAREWELL).await;
                // What is on its way arrives.
                tokio::time::sleep(Duration::from_millis(200)).await;
            });
            runtime.shutdown_background();
        });
        Ok(Self {
            address,
            stop: Some(stop),
            thread: Some(thread),
        })
    }

    /// The address that lets a person in.
    pub(super) fn address(&self) -> &str {
        &self.address
    }

    /// Ends, once the page has seen the last scene.
    pub(super) fn stop(mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A server that panicked has ended as well.
            let _ = thread.join().is_ok();
        }
    }
}

/// Takes connections as long as there is room. Whoever comes on top of that is turned away at once.
async fn accept(listener: tokio::net::TcpListener, routes: Router) {
    let room = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        match listener.accept().await {
            Ok((stream, _)) => {
                if let Ok(place) = Arc::clone(&room).try_acquire_owned() {
                    let routes = routes.clone();
                    tokio::spawn(async move {
                        serve(stream, routes).await;
                        drop(place);
                    });
                }
            }
            // Such as no file handles: others will be given back.
            Err(_) => tokio::time::sleep(Duration::from_millis(100)).await,
        }
    }
}

async fn serve(stream: TcpStream, routes: Router) {
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes));
    // A connection that breaks is the other end's business: it asks again.
    let _ = tokio::time::timeout(CONNECTION, connection).await.is_ok();
}
