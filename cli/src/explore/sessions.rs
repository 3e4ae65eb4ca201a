//! An engine for each page that is open, and what is given up once a newer request comes.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use asperity_engine::answer::Answer;
use asperity_engine::request::Request;
use asperity_engine::{Engine, Limits};
use asperity_runner::{duration, memory};
use hyper::StatusCode;

use super::refusal::Refusal;

/// Engines that are kept.
const MOST: usize = 4;

/// The engines of the pages, the one used last at the end.
pub struct Sessions {
    kept: Mutex<Vec<Arc<Session>>>,
    longest: Duration,
}

/// The engine of a page.
struct Session {
    name: String,
    /// The number of the newest request.
    newest: AtomicU64,
    /// The bits of the fraction that is done of the request at work.
    done: AtomicU64,
    engine: Arc<tokio::sync::Mutex<Engine>>,
}

impl Sessions {
    /// No engines yet; a request takes at most the time `longest`.
    pub fn new(longest: Duration) -> Self {
        Self { kept: Mutex::default(), longest }
    }

    /// Answers the request of the page `name` with this number; those with lower ones are given up, in whatever order they come.
    ///
    /// # Errors
    /// A newer request of the same page; too many pages.
    pub async fn answer(&self, name: &str, number: u64, request: Request) -> Result<Vec<u8>, Refusal> {
        let session = self.session(name)?;
        session.newest.fetch_max(number, Ordering::SeqCst);
        // This is dropped, too, once the sender closes the connection.
        let abandoned = Abandoned(Arc::default());
        let mut engine = session.engine.clone().lock_owned().await;
        session.done.store(0, Ordering::Relaxed);
        let monitor = RequestMonitor {
            session,
            number,
            abandoned: abandoned.0.clone(),
            until: Instant::now() + self.longest,
        };
        if monitor.is_given_up() {
            return Err(newer());
        }
        let longest = self.longest;
        let work = move || answered(&mut engine, &request, monitor, longest);
        let words = "the engine has failed; this is a mistake of asperity";
        let failed = |_| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, words);
        tokio::task::spawn_blocking(work).await.map_err(failed)?
    }

    /// The fraction that is done of what is computed for the page `name`; 0 where nothing is.
    pub fn progress(&self, name: &str) -> f64 {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let session = kept.iter().find(|session| session.name == name);
        session.map_or(0.0, |session| f64::from_bits(session.done.load(Ordering::Relaxed)))
    }

    /// The session of a page. A new one takes the place of the one that has been idle for longest.
    fn session(&self, name: &str) -> Result<Arc<Session>, Refusal> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept.iter().position(|session| session.name == name);
        let idle = || kept.iter().position(|session| Arc::strong_count(session) == 1);
        let session = match (known, kept.len() < MOST) {
            (Some(place), _) => kept.remove(place),
            (None, true) => Arc::new(Session::new(name)),
            (None, false) => {
                let words = format!("{MOST} pages compute at the same time, which is the most");
                let place = idle().ok_or_else(|| Refusal::new(StatusCode::SERVICE_UNAVAILABLE, words))?;
                kept.remove(place);
                Arc::new(Session::new(name))
            }
        };
        kept.push(session.clone());
        Ok(session)
    }
}

impl Session {
    fn new(name: &str) -> Self {
        let engine = Arc::new(tokio::sync::Mutex::new(Engine::limited(Limits::PAGE)));
        Self { name: name.into(), newest: AtomicU64::new(0), done: AtomicU64::new(0), engine }
    }
}

/// Answers on a thread of its own.
fn answered(
    engine: &mut Engine,
    request: &Request,
    mut monitor: RequestMonitor,
    longest: Duration,
) -> Result<Vec<u8>, Refusal> {
    let mut answer: Answer = engine.answer(request, &mut monitor);
    monitor.session.done.store(0, Ordering::Relaxed);
    if monitor.is_given_up() {
        return Err(newer());
    }
    if answer.stopped {
        let limit = duration::words(longest);
        answer.failures.push(format!("given up after {limit} (asperity explore --max-time)"));
    }
    Ok(answer.to_json())
}

fn newer() -> Refusal {
    Refusal::new(StatusCode::CONFLICT, "given up for a newer request")
}

/// Says that nobody waits for an answer any more, once it is dropped.
struct Abandoned(Arc<AtomicBool>);

impl Drop for Abandoned {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// Stops the work on a request for a newer one, once nobody waits for it, and after a time.
struct RequestMonitor {
    session: Arc<Session>,
    number: u64,
    abandoned: Arc<AtomicBool>,
    until: Instant,
}

impl RequestMonitor {
    fn is_given_up(&self) -> bool {
        self.session.newest.load(Ordering::SeqCst) > self.number || self.abandoned.load(Ordering::SeqCst)
    }
}

impl Monitor for RequestMonitor {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.session.done.store(fraction.to_bits(), Ordering::Relaxed);
        let stops = self.is_given_up() || Instant::now() >= self.until;
        if stops { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// A quarter of what is free, since as many pages may compute.
    fn memory(&self) -> u64 {
        memory::available() / MOST as u64
    }
}
