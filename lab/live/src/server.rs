//! What can be asked for over HTTP: the page, its events, commands, numbers. All else is 404.

mod connections;

use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use anyhow::Context;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, FromRequest, Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::stream;
use pt326_lab::page;
use pt326_lab::scene::{Order, Scene};
use serde::Deserialize;
use serde_json::Value;
use tokio::time::timeout;

use crate::clock::{Ask, Clock};
use crate::guard::{Access, check};
use crate::history::Place;
use crate::metrics;
use connections::{Caller, Limits};

/// Pages that may watch at once.
const MOST_CLIENTS: usize = 256;
/// Longest command, bytes.
const LONGEST: usize = 64 * 1024;
/// A stream says that it lives, so often.
const ALIVE: Duration = Duration::from_secs(10);

/// What a browser may do with what is sent: a page as one text, and its own server.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'; script-src 'unsafe-inline' data:";
/// What ends it where the page has a session within it: WebAssembly in a worker.
const OWN_SESSION: &str = " 'wasm-unsafe-eval'; worker-src blob:";

/// What the server needs to know of its session.
pub struct Server {
    /// The session.
    pub clock: Clock,
    /// Who may ask.
    pub access: Access,
    /// The page with its token, made once.
    page: Bytes,
    /// What a browser may do with it.
    policy: HeaderValue,
}

impl Server {
    /// Of a session, for those who may ask. With the text of lab.html the page is that one, which can go over to a board at a port of the
    /// browser's computer; else it watches only.
    ///
    /// # Errors
    /// `lab` is no lab.html.
    pub fn new(clock: Clock, access: Access, lab: Option<&str>) -> anyhow::Result<Self> {
        let token = &access.token;
        let (page, policy) = match lab {
            None => (page::html(page::Source::Server(token)), HeaderValue::from_static(POLICY)),
            Some(lab) => (
                page::with_token(lab, token).context("no lab.html, expected what `cargo lab` has written")?,
                HeaderValue::from_str(&format!("{POLICY}{OWN_SESSION}"))?,
            ),
        };
        Ok(Self { clock, access, page: page.into(), policy })
    }
}

struct Shared {
    server: Server,
    clients: AtomicUsize,
    /// For a body.
    patience: Duration,
}

type App = State<Arc<Shared>>;

/// Takes `address`, or any port of it that is free; says where it listens and, where the page is not for everybody, the query that asks
/// for it with the token; then serves until the program ends.
///
/// # Errors
/// No port is free; `told` fails.
pub fn listen(
    server: Server,
    address: SocketAddr,
    told: impl FnOnce(SocketAddr, &str) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    listen_within(Limits::default(), server, address, told)
}

fn listen_within(
    limits: Limits,
    server: Server,
    address: SocketAddr,
    told: impl FnOnce(SocketAddr, &str) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    runtime.block_on(async {
        let listener = connections::listen(address)
            .or_else(|_| connections::listen(SocketAddr::new(address.ip(), 0)))
            .context("no free port")?;
        let query =
            if server.access.asks { format!("?token={}", server.access.token) } else { String::new() };
        told(listener.local_addr()?, &query)?;
        connections::serve(listener, app(server, limits.patience), limits).await;
        Ok(())
    })
}

fn app(server: Server, patience: Duration) -> Router {
    let shared = Arc::new(Shared { server, clients: AtomicUsize::new(0), patience });
    Router::new()
        .route("/", get(page_itself))
        .route("/events", get(events))
        .route("/command", post(command))
        .route("/metrics", get(numbers))
        .layer(DefaultBodyLimit::max(LONGEST))
        .layer(from_fn_with_state(shared.clone(), guarded))
        .with_state(shared)
}

/// Turns away what does not come from here, notes who shows the token, and says what a browser may do with what goes out.
async fn guarded(State(app): App, request: Request, next: Next) -> Response {
    if let Some(caller) = request.extensions().get::<Arc<Caller>>()
        && shows_token(&request, &app.server.access)
    {
        caller.is_known();
    }
    // A request that names its host in its target is one to a proxy.
    let to_here = request.uri().authority().is_none().then_some(()).ok_or(StatusCode::MISDIRECTED_REQUEST);
    let mut response = match to_here.and_then(|()| check(request.headers())) {
        Ok(()) => next.run(request).await,
        Err(status) => status.into_response(),
    };
    let headers: [(HeaderName, &'static str); 4] = [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    for (name, value) in headers {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, app.server.policy.clone());
    response
}

/// Whether the token is in the headers or the query.
fn shows_token(request: &Request, access: &Access) -> bool {
    let headers = request.headers();
    let asked = Query::<Asked>::try_from_uri(request.uri()).ok();
    let query = asked.as_ref().and_then(|asked| asked.token.as_deref());
    [of_page(headers), bearer(headers), query].into_iter().any(|token| access.knows(token))
}

fn of_page(headers: &HeaderMap) -> Option<&str> {
    headers.get("x-lab-token")?.to_str().ok()
}

fn bearer(headers: &HeaderMap) -> Option<&str> {
    headers.get(header::AUTHORIZATION)?.to_str().ok()?.strip_prefix("Bearer ")
}

#[derive(Deserialize)]
struct Asked {
    token: Option<String>,
    #[serde(default)]
    from: usize,
    #[serde(default)]
    session: String,
}

/// The page, or what a browser shows in its place that has not brought the token.
async fn page_itself(State(app): App, Query(asked): Query<Asked>) -> Response {
    let access = &app.server.access;
    if access.asks && !access.knows(asked.token.as_deref()) {
        return (StatusCode::FORBIDDEN, Html(page::DOOR)).into_response();
    }
    Html(app.server.page.clone()).into_response()
}

/// One client fewer when it is dropped.
struct Counted(Arc<Shared>);

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::Relaxed);
    }
}

async fn events(State(app): App, Query(asked): Query<Asked>) -> Result<impl IntoResponse, StatusCode> {
    if !app.server.access.knows(asked.token.as_deref()) {
        return Err(StatusCode::FORBIDDEN);
    }
    let counted = Counted(app.clone());
    if app.clients.fetch_add(1, Ordering::Relaxed) >= MOST_CLIENTS {
        return Err(StatusCode::TOO_MANY_REQUESTS);
    }
    let (hello, place) = {
        let history = app.server.clock.history();
        let from = if asked.session == history.session() { asked.from } else { 0 };
        (history.hello().to_string(), history.place(from))
    };
    let changed = app.server.clock.changed.clone();
    let next = move |(hello, mut place, mut changed, counted): (
        Option<String>,
        Place,
        tokio::sync::watch::Receiver<()>,
        Counted,
    )| async move {
        if let Some(hello) = hello {
            return Some((event(hello), (None, place, changed, counted)));
        }
        loop {
            changed.borrow_and_update();
            let message = counted.0.server.clock.history().next(&mut place);
            if let Some(message) = message {
                return Some((event(message), (None, place, changed, counted)));
            }
            changed.changed().await.ok()?;
        }
    };
    let stream = stream::unfold((Some(hello), place, changed, counted), next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::new().interval(ALIVE)))
}

fn event(message: String) -> Result<Event, Infallible> {
    Ok(Event::default().data(message))
}

#[derive(Deserialize)]
#[serde(tag = "command", rename_all = "lowercase")]
enum Command {
    Order { order: Order },
    Open { scene: Scene, at: Option<u32> },
    Run { speed: f64 },
    Skip,
    Scene,
    Trace,
}

async fn command(State(app): App, request: Request) -> Response {
    // Nothing is read of a body before that.
    if !app.server.access.knows(of_page(request.headers())) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let body: Value = match timeout(app.patience, Json::from_request(request, &())).await {
        Ok(Ok(Json(body))) => body,
        Ok(Err(rejection)) => return rejection.into_response(),
        Err(_) => return StatusCode::REQUEST_TIMEOUT.into_response(),
    };
    // By way of a value, for the reason that `protocol::read` tells.
    let ask = match serde_json::from_value(body) {
        Ok(Command::Order { order }) => Ask::Order(order),
        Ok(Command::Open { scene, at }) => Ask::Open(scene, at),
        Ok(Command::Run { speed }) => Ask::Run(speed),
        Ok(Command::Skip) => Ask::Skip,
        Ok(Command::Scene) => Ask::Scene,
        Ok(Command::Trace) => Ask::Trace,
        Err(error) => return (StatusCode::UNPROCESSABLE_ENTITY, error.to_string()).into_response(),
    };
    match app.server.clock.ask(ask).await {
        Ok(message) => Json([message]).into_response(),
        Err(refused) => (StatusCode::CONFLICT, Json(refused)).into_response(),
    }
}

async fn numbers(State(app): App, headers: HeaderMap) -> Result<impl IntoResponse, StatusCode> {
    let access = &app.server.access;
    if access.open && !access.knows(bearer(&headers)) {
        return Err(StatusCode::UNAUTHORIZED);
    }
    let history = app.server.clock.history();
    let text = metrics::text(&history, app.clients.load(Ordering::Relaxed));
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text))
}

#[cfg(test)]
mod tests;
