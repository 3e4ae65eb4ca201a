//! The binary, run in an empty folder.
#![allow(dead_code, missing_docs)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};

pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).unwrap();
    }

    /// The program with this folder as its working directory.
    pub fn asperity(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_asperity"));
        command.args(arguments).current_dir(self.path());
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        self.asperity(arguments).output().unwrap()
    }

    /// Runs what must succeed; its standard output.
    pub fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", errors(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Names of what is in the folder, hidden files too.
    pub fn names(&self) -> Vec<String> {
        names(self.path())
    }
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

pub fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").canonicalize().unwrap()
}

/// The scenarios of a folder.
pub fn tomls(folder: &Path) -> Vec<PathBuf> {
    let files = names(folder).into_iter().filter(|name| name.ends_with(".toml"));
    files.map(|name| folder.join(name)).collect()
}

/// The command that computes a scenario.
pub fn command_of(path: &Path) -> &'static str {
    let swept = std::fs::read_to_string(path).unwrap().lines().any(|line| line.starts_with("[sweep"));
    if swept { "sweep" } else { "run" }
}

/// How a process ended.
#[cfg(target_os = "linux")]
pub struct Ended {
    /// Its exit code; none of one that a signal ended.
    pub code: Option<i32>,
    /// Seconds of the processor that it took, of all its threads together.
    pub seconds: f64,
}

/// Waits for a process to end.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "no safe function reports what a process took")]
pub fn reaped(child: Child) -> Ended {
    let (mut status, id) = (0, libc::pid_t::try_from(child.id()).unwrap());
    // SAFETY: `status` and `usage` are there to be written to; all bytes of `usage` may be 0.
    let (usage, waited) = unsafe {
        let mut usage: libc::rusage = std::mem::zeroed();
        let waited = libc::wait4(id, &raw mut status, 0, &raw mut usage);
        (usage, waited)
    };
    assert_eq!(waited, id);
    let seconds = |time: libc::timeval| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64;
    let code = libc::WIFEXITED(status).then(|| libc::WEXITSTATUS(status));
    Ended { code, seconds: seconds(usage.ru_utime) + seconds(usage.ru_stime) }
}
