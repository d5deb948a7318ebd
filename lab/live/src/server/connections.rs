//! Connections. Those that have shown the token are kept; of the others only so many are, and the oldest makes room: whoever sends half a
//! request ten thousand times keeps nobody out who has the token.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::task::AbortHandle;

/// Connections that may wait to be accepted; the system may allow fewer.
const BACKLOG: u32 = 4096;
/// After a connection could not be accepted, until the next is.
const RECOVER: Duration = Duration::from_millis(5);

/// What a connection may take up.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Connections that have not shown the token: half of the descriptors that most systems give to a program.
    pub(super) strangers: usize,
    /// Time for the head of a request, and again for its body.
    pub(super) patience: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self { strangers: 512, patience: Duration::from_secs(10) }
    }
}

/// Listens on an address.
pub(super) fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    // A server that begins anew has its port again at once. Elsewhere than on Unix this would share it.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// Accepts connections for ever.
pub(super) async fn serve(listener: TcpListener, app: Router, limits: Limits) {
    let strangers = Strangers::default();
    loop {
        match listener.accept().await {
            Ok((stream, _)) => {
                let (app, patience) = (app.clone(), limits.patience);
                strangers.admit(|caller| converse(stream, app, caller, patience));
                if strangers.lock().waiting.len() > limits.strangers {
                    strangers.turn_away_oldest();
                }
            }
            // Mostly there is no descriptor left.
            Err(_) => {
                strangers.turn_away_oldest();
                tokio::time::sleep(RECOVER).await;
            }
        }
        // Whoever has come is heard before the next is let in.
        tokio::task::yield_now().await;
    }
}

/// Serves one connection to its end.
async fn converse(stream: TcpStream, app: Router, caller: Arc<Caller>, patience: Duration) {
    let app = TowerToHyperService::new(app);
    let service = service_fn(|request| {
        let mut request: Request<hyper::body::Incoming> = request;
        request.extensions_mut().insert(caller.clone());
        app.call(request)
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(patience);
    let _ = http.serve_connection(TokioIo::new(stream), service).await; // who has gone needs no answer
}

/// The connections that have not shown the token yet, by their numbers: the oldest first.
#[derive(Clone, Default)]
struct Strangers(Arc<Mutex<Waiting>>);

#[derive(Default)]
struct Waiting {
    next: u64,
    waiting: BTreeMap<u64, AbortHandle>,
}

impl Strangers {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to serve a connection that nothing is known of.
    fn admit<F: Future<Output = ()> + Send + 'static>(&self, serve: impl FnOnce(Arc<Caller>) -> F) {
        let mut lock = self.lock();
        let number = lock.next;
        lock.next += 1;
        let caller = Arc::new(Caller { number, strangers: self.clone() });
        lock.waiting.insert(number, tokio::spawn(serve(caller)).abort_handle());
    }

    fn turn_away_oldest(&self) {
        let oldest = self.lock().waiting.pop_first();
        if let Some((_, connection)) = oldest {
            connection.abort();
        }
    }
}

/// Who is at the other end of a connection.
pub(super) struct Caller {
    number: u64,
    strangers: Strangers,
}

impl Caller {
    /// It has shown the token: its connection is not closed to make room for another.
    pub(super) fn is_known(&self) {
        self.strangers.lock().waiting.remove(&self.number);
    }
}

impl Drop for Caller {
    fn drop(&mut self) {
        self.is_known();
    }
}
