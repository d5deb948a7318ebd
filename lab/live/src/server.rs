//! What can be asked for over HTTP: of each rig the page, its events, commands, numbers; of several the wall. All else is 404.

mod connections;

use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
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
use crate::wall::{self, Rig};
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

/// What is served, and to whom.
pub struct Server {
    /// One rig is served at `/`; several are a wall there, and each of them at `/boards/NAME/`.
    rigs: Vec<Arc<Rig>>,
    access: Arc<Access>,
    /// The page of a rig.
    page: Page,
    /// What a browser may do with a page.
    policy: HeaderValue,
}

impl Server {
    /// Of rigs, for those who may ask. With the text of lab.html the page of a rig is that one, which can go over to a board at a port of the
    /// browser's computer; else it watches only.
    ///
    /// # Errors
    /// `lab` is no lab.html.
    pub fn new(rigs: Vec<Arc<Rig>>, access: Access, lab: Option<&str>) -> anyhow::Result<Self> {
        let token = &access.token;
        let (html, policy) = match lab {
            None => (page::html(page::Source::Server(token)), HeaderValue::from_static(POLICY)),
            Some(lab) => (
                page::with_token(lab, token).context("no lab.html, expected what `cargo lab` has written")?,
                HeaderValue::from_str(&format!("{POLICY}{OWN_SESSION}"))?,
            ),
        };
        let access = Arc::new(access);
        Ok(Self { rigs, page: Page::new(&access, html), access, policy })
    }
}

/// A page that holds the token, made once.
#[derive(Clone)]
struct Page {
    access: Arc<Access>,
    html: Bytes,
}

impl Page {
    fn new(access: &Arc<Access>, html: String) -> Self {
        Self { access: access.clone(), html: html.into() }
    }

    /// The page, or what a browser shows in its place that has not brought the token.
    fn shown_to(&self, asked: &Asked) -> Response {
        if self.access.asks && !self.access.knows(asked.token.as_deref()) {
            return (StatusCode::FORBIDDEN, Html(page::DOOR)).into_response();
        }
        Html(self.html.clone()).into_response()
    }
}

struct Shared {
    rig: Arc<Rig>,
    page: Page,
    /// For a body.
    patience: Duration,
}

impl Shared {
    fn access(&self) -> &Access {
        &self.page.access
    }

    /// Its session.
    fn clock(&self) -> Result<&Clock, StatusCode> {
        self.rig.clock().ok_or(StatusCode::SERVICE_UNAVAILABLE)
    }
}

type App = State<Arc<Shared>>;

/// Several rigs.
struct Wall {
    rigs: Vec<Arc<Rig>>,
    page: Page,
}

impl Wall {
    fn rigs(&self) -> impl Iterator<Item = &Rig> {
        self.rigs.iter().map(Arc::as_ref)
    }

    /// Whether it is the wall's own page that asks.
    fn knows(&self, headers: &HeaderMap) -> Result<(), StatusCode> {
        self.page.access.knows(of_page(headers)).then_some(()).ok_or(StatusCode::FORBIDDEN)
    }
}

type All = State<Arc<Wall>>;

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
    let Server { rigs, access, page, policy } = server;
    let of = |rig: &Arc<Rig>| of_rig(Shared { rig: rig.clone(), page: page.clone(), patience });
    let all = match &rigs[..] {
        [rig] => of(rig),
        _ => {
            let boards = rigs
                .iter()
                .fold(Router::new(), |all, rig| all.nest(&format!("/boards/{}/", rig.name()), of(rig)));
            let html = page::wall(&access.token, &wall::key().to_string());
            boards.merge(of_wall(Wall { page: Page::new(&access, html), rigs }))
        }
    };
    all.layer(DefaultBodyLimit::max(LONGEST)).layer(from_fn_with_state((access, policy), guarded))
}

fn of_rig(shared: Shared) -> Router {
    Router::new()
        .route("/", get(page_itself))
        .route("/events", get(events))
        .route("/command", post(command))
        .route("/metrics", get(numbers))
        .with_state(Arc::new(shared))
}

fn of_wall(wall: Wall) -> Router {
    Router::new()
        .route("/", get(wall_itself))
        .route("/tiles", get(tiles))
        .route("/stop", post(stop_all))
        .route("/metrics", get(all_numbers))
        .with_state(Arc::new(wall))
}

/// Turns away what does not come from here, notes who shows the token, and says what a browser may do with what goes out.
async fn guarded(
    State((access, policy)): State<(Arc<Access>, HeaderValue)>,
    request: Request,
    next: Next,
) -> Response {
    if let Some(caller) = request.extensions().get::<Arc<Caller>>()
        && shows_token(&request, &access)
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
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
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

async fn page_itself(State(app): App, Query(asked): Query<Asked>) -> Response {
    let is_there = app.rig.clock().is_some();
    let page = app.page.shown_to(&asked);
    if is_there || page.status() != StatusCode::OK {
        return page;
    }
    (StatusCode::SERVICE_UNAVAILABLE, Html(page::ABSENT)).into_response()
}

/// One client fewer when it is dropped.
struct Counted(Arc<Shared>);

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.rig.clients.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A page that watches, and how far it has been told.
struct Watcher {
    hello: Option<String>,
    place: Place,
    changed: tokio::sync::watch::Receiver<()>,
    clock: Clock,
    #[expect(dead_code, reason = "counts as long as it is held")]
    counted: Counted,
}

impl Watcher {
    async fn next(&mut self) -> Option<Result<Event, Infallible>> {
        if let Some(hello) = self.hello.take() {
            return Some(event(hello));
        }
        loop {
            self.changed.borrow_and_update();
            let message = self.clock.history().next(&mut self.place);
            if let Some(message) = message {
                return Some(event(message));
            }
            self.changed.changed().await.ok()?;
        }
    }
}

async fn events(State(app): App, Query(asked): Query<Asked>) -> Result<impl IntoResponse, StatusCode> {
    if !app.access().knows(asked.token.as_deref()) {
        return Err(StatusCode::FORBIDDEN);
    }
    let clock = app.clock()?.clone();
    let counted = Counted(app.clone());
    if app.rig.clients.fetch_add(1, Ordering::Relaxed) >= MOST_CLIENTS {
        return Err(StatusCode::TOO_MANY_REQUESTS);
    }
    let (hello, place) = {
        let history = clock.history();
        let from = if asked.session == history.session() { asked.from } else { 0 };
        (history.hello().to_string(), history.place(from))
    };
    let changed = clock.changed.clone();
    let watcher = Watcher { hello: Some(hello), place, changed, clock, counted };
    let stream = stream::unfold(watcher, async |mut watcher| Some((watcher.next().await?, watcher)));
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
    if !app.access().knows(of_page(request.headers())) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let clock = match app.clock() {
        Ok(clock) => clock,
        Err(status) => return status.into_response(),
    };
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
    match clock.ask(ask).await {
        Ok(message) => Json([message]).into_response(),
        Err(refused) => (StatusCode::CONFLICT, Json(refused)).into_response(),
    }
}

async fn numbers(State(app): App, headers: HeaderMap) -> Result<impl IntoResponse, StatusCode> {
    may_have_numbers(app.access(), &headers)?;
    let history = app.clock()?.history();
    Ok(for_prometheus(metrics::text(&history, app.rig.clients.load(Ordering::Relaxed))))
}

fn may_have_numbers(access: &Access, headers: &HeaderMap) -> Result<(), StatusCode> {
    let may = !access.open || access.knows(bearer(headers));
    may.then_some(()).ok_or(StatusCode::UNAUTHORIZED)
}

fn for_prometheus(text: String) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text)
}

async fn wall_itself(State(wall): All, Query(asked): Query<Asked>) -> Response {
    wall.page.shown_to(&asked)
}

async fn tiles(State(wall): All, headers: HeaderMap) -> Result<Json<Value>, StatusCode> {
    wall.knows(&headers)?;
    Ok(Json(wall::tiles(wall.rigs())))
}

async fn stop_all(State(wall): All, headers: HeaderMap) -> Result<Json<Value>, StatusCode> {
    wall.knows(&headers)?;
    Ok(Json(wall::stop(wall.rigs()).await))
}

async fn all_numbers(State(wall): All, headers: HeaderMap) -> Result<impl IntoResponse, StatusCode> {
    may_have_numbers(&wall.page.access, &headers)?;
    Ok(for_prometheus(wall::metrics(wall.rigs())))
}

#[cfg(test)]
mod tests;
