//! What can be asked for over HTTP: the page, its events, commands, numbers. All else is 404.

use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use anyhow::Context;
use axum::extract::{DefaultBodyLimit, Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::stream;
use pt326_lab::scene::Order;
use pt326_lab::{page, protocol};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::net::TcpListener;

use crate::clock::{Ask, Clock};
use crate::guard::{Access, check};
use crate::history::Place;
use crate::metrics;

/// Pages that may watch at once.
const MOST_CLIENTS: usize = 256;
/// Longest command, bytes.
const LONGEST: usize = 64 * 1024;
/// A stream says that it lives, so often.
const ALIVE: Duration = Duration::from_secs(10);

/// What the server needs to know of its session.
pub struct Server {
    /// The session.
    pub clock: Clock,
    /// Its name for people.
    pub name: String,
    /// What it is.
    pub kind: &'static str,
    /// Which commands make sense.
    pub can: &'static [&'static str],
    /// Ts in s.
    pub sample_time: f64,
    /// Its scene at the start, of a simulated rig.
    pub scene: Value,
    /// Who may ask.
    pub access: Access,
}

struct Shared {
    server: Server,
    /// Of this life: a page that was with another begins anew.
    session: String,
    clients: AtomicUsize,
}

type App = State<Arc<Shared>>;

/// Takes `address`, or any port of it that is free; says where it listens, then serves until the program ends.
///
/// # Errors
/// No port is free; `told` fails.
pub fn listen(
    server: Server,
    address: SocketAddr,
    told: impl FnOnce(SocketAddr, &str) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    runtime.block_on(async {
        let listener = match TcpListener::bind(address).await {
            Ok(listener) => listener,
            Err(_) => TcpListener::bind(SocketAddr::new(address.ip(), 0)).await.context("no free port")?,
        };
        let query =
            if server.access.open { format!("?token={}", server.access.token) } else { String::new() };
        told(listener.local_addr()?, &query)?;
        axum::serve(listener, app(server)?).await.context("the server has ended")
    })
}

fn app(server: Server) -> anyhow::Result<Router> {
    let session = Access::local()?.token;
    let shared = Arc::new(Shared { server, session, clients: AtomicUsize::new(0) });
    Ok(Router::new()
        .route("/", get(page_itself))
        .route("/events", get(events))
        .route("/command", post(command))
        .route("/metrics", get(numbers))
        .layer(DefaultBodyLimit::max(LONGEST))
        .layer(from_fn(guarded))
        .with_state(shared))
}

/// Turns away what does not come from here, and says what a browser may do with what goes out.
async fn guarded(request: Request, next: Next) -> Response {
    // A request that names its host in its target is one to a proxy.
    let to_here = request.uri().authority().is_none().then_some(()).ok_or(StatusCode::MISDIRECTED_REQUEST);
    let mut response = match to_here.and_then(|()| check(request.headers())) {
        Ok(()) => next.run(request).await,
        Err(status) => status.into_response(),
    };
    const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data:; \
        connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    let headers: [(HeaderName, &'static str); 5] = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    for (name, value) in headers {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

#[derive(Deserialize)]
struct Asked {
    token: Option<String>,
    #[serde(default)]
    from: usize,
    #[serde(default)]
    session: String,
}

async fn page_itself(State(app): App, Query(asked): Query<Asked>) -> Result<Html<String>, StatusCode> {
    let access = &app.server.access;
    if access.open && !access.knows(asked.token.as_deref()) {
        return Err(StatusCode::FORBIDDEN);
    }
    Ok(Html(page::html(page::Source::Server(&access.token))))
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
    let from = if asked.session == app.session { asked.from } else { 0 };
    let place = app.server.clock.history().place(from);
    let changed = app.server.clock.changed.clone();
    let next = move |(greeted, mut place, mut changed, counted): (
        bool,
        Place,
        tokio::sync::watch::Receiver<()>,
        Counted,
    )| async move {
        if !greeted {
            let hello = greeting(&counted.0);
            return Some((event(hello), (true, place, changed, counted)));
        }
        loop {
            changed.borrow_and_update();
            let message = counted.0.server.clock.history().next(&mut place);
            if let Some(message) = message {
                return Some((event(message), (true, place, changed, counted)));
            }
            changed.changed().await.ok()?;
        }
    };
    let stream = stream::unfold((false, place, changed, counted), next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::new().interval(ALIVE)))
}

fn event(message: String) -> Result<Event, Infallible> {
    Ok(Event::default().data(message))
}

/// The hello of the protocol, with what only a server has.
fn greeting(app: &Shared) -> String {
    let mut hello: Value =
        serde_json::from_str(&protocol::hello(app.server.kind, app.server.can)).unwrap_or_default();
    hello["session"] = json!(app.session);
    hello["ts"] = json!(app.server.sample_time);
    hello["name"] = json!(app.server.name);
    hello["scene"] = app.server.scene.clone();
    hello.to_string()
}

#[derive(Deserialize)]
#[serde(tag = "command", rename_all = "lowercase")]
enum Command {
    Order { order: Order },
    Run { speed: f64 },
    Skip,
    Scene,
    Trace,
}

async fn command(
    State(app): App,
    headers: HeaderMap,
    body: Result<Json<Value>, axum::extract::rejection::JsonRejection>,
) -> Response {
    let token = headers.get("x-lab-token").and_then(|value| value.to_str().ok());
    if !app.server.access.knows(token) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let body = match body {
        Ok(Json(body)) => body,
        Err(rejection) => return rejection.into_response(),
    };
    // By way of a value: straight from the text serde_json takes no number of a tagged enum where its `arbitrary_precision` is on, which any
    // program built along with this one may ask for.
    let ask = match serde_json::from_value(body) {
        Ok(Command::Order { order }) => Ask::Order(order),
        Ok(Command::Run { speed }) => Ask::Run(speed),
        Ok(Command::Skip) => Ask::Skip,
        Ok(Command::Scene) => Ask::Scene,
        Ok(Command::Trace) => Ask::Trace,
        Err(error) => return (StatusCode::UNPROCESSABLE_ENTITY, error.to_string()).into_response(),
    };
    match app.server.clock.ask(ask).await {
        Ok(message) => Json([message]).into_response(),
        Err(why) => (StatusCode::CONFLICT, why).into_response(),
    }
}

async fn numbers(State(app): App, headers: HeaderMap) -> Result<impl IntoResponse, StatusCode> {
    let access = &app.server.access;
    let bearer =
        headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
    if access.open && !access.knows(bearer) {
        return Err(StatusCode::UNAUTHORIZED);
    }
    let history = app.server.clock.history();
    let text = metrics::text(history.last(), history.end(), app.clients.load(Ordering::Relaxed));
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text))
}

#[cfg(test)]
mod tests;
