//! The program as a child, with limits of time and memory.

use std::fs::File;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// What a child may take.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Seconds of the processor, of all its threads together.
    pub seconds: u64,
    /// Bytes of addresses.
    pub bytes: u64,
    /// Seconds of the processor after which it is interrupted.
    pub patience: Option<f64>,
}

/// How a child ended.
pub struct Ended {
    /// Its status; none where it was waiting for ever and was ended.
    pub status: Option<ExitStatus>,
    /// Seconds of the processor that it took.
    pub seconds: f64,
    /// What it wrote to the standard error.
    pub errors: String,
}

impl Ended {
    /// Its exit code.
    pub fn code(&self) -> Option<i32> {
        self.status.and_then(|status| status.code())
    }

    /// The signal that ended it.
    pub fn signal(&self) -> Option<i32> {
        self.status.and_then(|status| status.signal())
    }
}

/// The shell sets the limits, which the program inherits.
const LIMITED: &str = r#"ulimit -v "$1" && ulimit -S -t "$2" && shift 2 && exec "$@""#;
/// A child that gets this many times its seconds of wall time, and as many besides, waits for something that never comes.
const PATIENCE: u64 = 20;
/// Clock ticks in a second, a constant of Linux as programs see it.
const TICKS: f64 = 100.0;

/// Runs the program in a folder, what it says going to a folder aside.
pub fn run(arguments: &[&str], folder: &Path, aside: &Path, limits: Limits) -> Ended {
    let errors = aside.join("errors");
    let mut child = Command::new("sh")
        .args(["-c", LIMITED, "sh", &(limits.bytes / 1024).to_string(), &limits.seconds.to_string()])
        .arg(env!("CARGO_BIN_EXE_asperity"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&errors).expect("a file for the errors"))
        .spawn()
        .expect("a shell");
    let (seconds, ended) = watch(&child, limits);
    if !ended {
        let _ = child.kill();
    }
    let status = child.wait().ok().filter(|_| ended);
    let errors = String::from_utf8_lossy(&std::fs::read(errors).unwrap_or_default()).into_owned();
    Ended { status, seconds, errors }
}

/// Looks at a child until it has ended, which its entry in /proc outlives until it is waited for, and interrupts it when it is time:
/// its seconds, and whether it did end.
fn watch(child: &Child, limits: Limits) -> (f64, bool) {
    let (began, entry) = (Instant::now(), format!("/proc/{}", child.id()));
    let longest = Duration::from_secs(PATIENCE * (limits.seconds + PATIENCE));
    let (mut seconds, mut patience) = (0.0, limits.patience);
    while began.elapsed() < longest {
        let stat = std::fs::read_to_string(format!("{entry}/stat")).unwrap_or_default();
        // After the name in parentheses: the state, and as 12th and 13th the ticks in user and system mode.
        let fields: Vec<_> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
        let ticks = |field: usize| fields.get(field).and_then(|ticks| ticks.parse().ok()).unwrap_or(0.0);
        seconds = (ticks(11) + ticks(12)) / TICKS;
        if fields.first().is_none_or(|state| *state == "Z") {
            return (seconds, true);
        }
        if patience.take_if(|patience| seconds > *patience).is_some() {
            let interrupt = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
            assert!(interrupt.is_ok(), "{interrupt:?}");
        }
        std::thread::sleep(Duration::from_millis(3));
    }
    (seconds, false)
}

/// What comes of all items, on as many threads as there are, in the order of the items.
pub fn shared<T: Sync, U: Send>(items: &[T], each: impl Fn(&T) -> Option<U> + Sync) -> Vec<U> {
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(number) else { return };
                    if let Some(one) = each(item) {
                        found.lock().expect("no other thread has failed").push((number, one));
                    }
                }
            });
        }
    });
    let mut found = found.into_inner().expect("no thread has failed");
    found.sort_by_key(|one| one.0);
    found.into_iter().map(|one| one.1).collect()
}
