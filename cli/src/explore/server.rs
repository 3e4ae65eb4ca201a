//! The server of the page: HTTP on this machine alone, for those who know the address.
//!
//! Other pages in the same browser can send requests to this machine, and names of other machines can be made to point here.
//! Hence every request must name this host, come from the page itself, and know its token; nothing is shared with other
//! origins, no file is named by a request, and none is read.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use asperity_engine::page::{self, page, policy};
use http_body_util::{BodyExt as _, Full, LengthLimitError, Limited};
use hyper::body::{Bytes, Incoming};
use hyper::header::{
    ALLOW, CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderMap, HeaderName, HeaderValue,
    LOCATION, ORIGIN, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use serde_json::json;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

use super::refusal::{Refusal, require};
use super::sessions::Sessions;

/// The largest request, in bytes.
pub const LARGEST: usize = 1_000_000;
/// Time in which a request must arrive.
const ARRIVAL: Duration = Duration::from_secs(10);
/// Connections at the same time: a browser keeps six.
const CONNECTIONS: usize = 64;
/// A pause after a connection that could not be accepted.
const AFTER_A_FAILURE: Duration = Duration::from_millis(10);
/// Where requests go, and questions how far the work on one is.
const COMPUTE: &str = "/compute";
const PROGRESS: &str = "/progress";

/// What is known of the page that is served.
pub struct Server {
    port: u16,
    token: String,
    /// Leads to the page once.
    ticket: String,
    is_used: AtomicBool,
    scenario: Option<String>,
    sessions: Sessions,
}

impl Server {
    /// A server at a port, with a page that opens with `scenario`; a request takes at most the time `longest`.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn new(port: u16, scenario: Option<String>, longest: Duration) -> Result<Self, getrandom::Error> {
        let (token, ticket, is_used) = (random()?, random()?, AtomicBool::new(false));
        Ok(Self { port, token, ticket, is_used, scenario, sessions: Sessions::new(longest) })
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// An address that leads to the page once, for a command line, which others on this machine can read.
    pub fn url_once(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.ticket)
    }

    /// Serves for ever.
    pub async fn serve(self, listener: TcpListener) {
        let server = Arc::new(self);
        let places = Arc::new(Semaphore::new(CONNECTIONS));
        loop {
            let Ok(place) = places.clone().acquire_owned().await else { return };
            // A connection that fails is one that the other side has closed, or one too many for the system, which takes a while.
            let Ok((stream, _)) = listener.accept().await else {
                tokio::time::sleep(AFTER_A_FAILURE).await;
                continue;
            };
            let server = server.clone();
            tokio::spawn(async move {
                server.attend(stream).await;
                drop(place);
            });
        }
    }

    /// Answers the requests of a connection.
    async fn attend(self: Arc<Self>, stream: TcpStream) {
        let service = service_fn(move |request| {
            let server = self.clone();
            async move {
                let answered = server.respond(request).await;
                Ok::<_, Infallible>(answered.unwrap_or_else(|Refusal(status, words)| plain(status, words)))
            }
        });
        let mut protocol = hyper::server::conn::http1::Builder::new();
        protocol.timer(TokioTimer::new()).header_read_timeout(ARRIVAL).max_buf_size(64 << 10);
        // An error ends the connection, and nobody is left to be informed.
        let _ = protocol.serve_connection(TokioIo::new(stream), service).await;
    }

    async fn respond(&self, request: Request<Incoming>) -> Result<Response<Full<Bytes>>, Refusal> {
        self.check_origin(request.headers(), request.method())?;
        let path = request.uri().path();
        let of_page = path.strip_prefix('/').and_then(|path| path.strip_suffix('/'));
        if of_page.is_some_and(|token| same(token, &self.token)) {
            return if request.method() == Method::GET { self.page() } else { Ok(only("GET")) };
        }
        let is_ticket = of_page.is_some_and(|ticket| same(ticket, &self.ticket));
        if is_ticket && request.method() == Method::GET && !self.is_used.swap(true, Ordering::SeqCst) {
            return Ok(elsewhere(&self.url()));
        }
        require(
            [COMPUTE, PROGRESS].contains(&path),
            StatusCode::NOT_FOUND,
            "the page is at the address that asperity explore prints",
        )?;
        if request.method() != Method::POST {
            return Ok(only("POST"));
        }
        let (name, number) = self.sender(request.headers())?;
        let answer = if path == PROGRESS {
            json!({ "progress": self.sessions.progress(&name) }).to_string().into_bytes()
        } else {
            let request = serde_json::from_slice(&body(request).await?);
            let words = |why| format!("the request is invalid: {why}");
            let request = request.map_err(|why| Refusal::new(StatusCode::BAD_REQUEST, words(why)))?;
            self.sessions.answer(&name, number, request).await?
        };
        Ok(response(StatusCode::OK, "application/json", "default-src 'none'", answer.into()))
    }

    /// Refuses requests that a page of another origin sends, or that a name of another host brought here.
    fn check_origin(&self, headers: &HeaderMap, method: &Method) -> Result<(), Refusal> {
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let host = only_value(headers, &HOST).filter(|host| hosts.iter().any(|own| own == host));
        let words = "this is not the host of asperity explore";
        let host = host.ok_or_else(|| Refusal::new(StatusCode::FORBIDDEN, words))?;
        let from_page = match only_value(headers, &ORIGIN) {
            Some(origin) => origin.strip_prefix("http://") == Some(host),
            None => method == Method::GET && !headers.contains_key(ORIGIN),
        };
        require(from_page, StatusCode::FORBIDDEN, "the request comes from another origin")
    }

    /// The page, with scripts that a browser knows by a number used once.
    fn page(&self) -> Result<Response<Full<Bytes>>, Refusal> {
        let nonce =
            random().map_err(|why| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, why.to_string()))?;
        let text = page(page::Server::Command, &nonce, self.scenario.as_deref());
        let policy = format!("{}; frame-ancestors 'none'", policy(page::Server::Command, &nonce));
        Ok(response(StatusCode::OK, "text/html; charset=utf-8", &policy, text.into()))
    }

    /// The session of a page that knows the token, and the number of its request.
    fn sender(&self, headers: &HeaderMap) -> Result<(String, u64), Refusal> {
        let value = |name: &HeaderName| only_value(headers, name);
        let token = value(&HeaderName::from_static("asperity-token"));
        let known = token.is_some_and(|token| same(token, &self.token));
        require(
            known,
            StatusCode::FORBIDDEN,
            "the token is not that of asperity explore: open its address anew",
        )?;
        let octets = value(&CONTENT_TYPE) == Some("application/octet-stream");
        require(octets, StatusCode::UNSUPPORTED_MEDIA_TYPE, "expected a body of application/octet-stream")?;
        let name = value(&HeaderName::from_static("asperity-session")).filter(|name| name.len() <= 64);
        let number =
            value(&HeaderName::from_static("asperity-number")).and_then(|number| number.parse().ok());
        let words = "expected headers asperity-session, a name, and asperity-number, that of the request";
        let known = name.map(str::to_owned).zip(number);
        known.ok_or_else(|| Refusal::new(StatusCode::BAD_REQUEST, words))
    }
}

/// The body of a request, if it is small and comes soon.
async fn body(request: Request<Incoming>) -> Result<Bytes, Refusal> {
    let too_large =
        || Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, format!("a request has up to {LARGEST} bytes"));
    let limited = Limited::new(request.into_body(), LARGEST);
    match tokio::time::timeout(ARRIVAL, limited.collect()).await {
        Ok(Ok(whole)) => Ok(whole.to_bytes()),
        Ok(Err(error)) if error.is::<LengthLimitError>() => Err(too_large()),
        Ok(Err(error)) => Err(Refusal::new(StatusCode::BAD_REQUEST, error.to_string())),
        Err(_) => Err(Refusal::new(StatusCode::REQUEST_TIMEOUT, "the request did not arrive in time")),
    }
}

/// The value of a header that is there once.
fn only_value<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    values.next().filter(|_| values.next().is_none())?.to_str().ok()
}

/// Whether two words are equal, in a time that does not depend on where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

/// A number of 128 random bits.
fn random() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The response where another method is used.
fn only(method: &'static str) -> Response<Full<Bytes>> {
    let mut refused = plain(StatusCode::METHOD_NOT_ALLOWED, format!("expected {method}"));
    refused.headers_mut().insert(ALLOW, HeaderValue::from_static(method));
    refused
}

/// The response that leads to another address.
fn elsewhere(address: &str) -> Response<Full<Bytes>> {
    let mut moved = plain(StatusCode::SEE_OTHER, "the page is elsewhere".to_owned());
    let address = HeaderValue::from_str(address).expect("an address is of letters and digits");
    moved.headers_mut().insert(LOCATION, address);
    moved
}

fn plain(status: StatusCode, words: String) -> Response<Full<Bytes>> {
    response(status, "text/plain; charset=utf-8", "default-src 'none'", words.into())
}

fn response(status: StatusCode, kind: &str, policy: &str, body: Bytes) -> Response<Full<Bytes>> {
    Response::builder()
        .status(status)
        .header(CONTENT_TYPE, kind)
        .header(CONTENT_SECURITY_POLICY, policy)
        .header(X_CONTENT_TYPE_OPTIONS, "nosniff")
        .header(REFERRER_POLICY, "no-referrer")
        .header(CACHE_CONTROL, "no-store")
        .header("cross-origin-resource-policy", "same-origin")
        .body(Full::new(body))
        .expect("the headers are words")
}
