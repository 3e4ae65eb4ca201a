//! Memory that is available for a computation.

use std::path::Path;
use std::{env, fs};

use asperity::monitor::MEMORY;

/// The environment variable with the memory that a computation may take.
const VARIABLE: &str = "ASPERITY_MEMORY";

/// Units of memory: those of 1000 and of 1024, the latter also by one letter, as batch systems and `ulimit` have them.
const UNITS: [(&str, u64); 13] = [
    ("", 1),
    ("B", 1),
    ("kB", 1_000),
    ("MB", 1_000_000),
    ("GB", 1_000_000_000),
    ("TB", 1_000_000_000_000),
    ("KiB", 1 << 10),
    ("MiB", 1 << 20),
    ("GiB", 1 << 30),
    ("TiB", 1 << 40),
    ("M", 1 << 20),
    ("G", 1 << 30),
    ("T", 1 << 40),
];

/// Bytes of an amount of memory such as `8GB`, `7.5 GiB` or `16G`.
///
/// # Errors
/// A text that is not a number above 0 with a unit; no bytes at all, or more than there can be.
pub fn parse(text: &str) -> Result<u64, String> {
    let bytes = || {
        let number = text.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
        let (_, unit) = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(&text[number.len()..]))?;
        let bytes = number.trim().parse::<f64>().ok()? * *unit as f64;
        (bytes >= 1.0 && bytes < u64::MAX as f64).then_some(bytes as u64)
    };
    bytes().ok_or_else(|| "expected an amount of memory such as 8GB, 7.5GiB or 16G".to_owned())
}

/// The memory that the environment allows a computation, if it does.
///
/// # Errors
/// Something else than an amount of memory.
pub fn in_environment() -> Result<Option<u64>, String> {
    let Some(text) = env::var_os(VARIABLE).filter(|text| !text.is_empty()) else { return Ok(None) };
    let text = text.to_string_lossy();
    parse(&text)
        .map(Some)
        .map_err(|expected| format!("environment variable {VARIABLE}: {expected}, got {text}"))
}

/// A number of bytes, as text.
pub fn words(bytes: u64) -> String {
    let mebibytes = bytes as f64 / f64::from(1 << 20);
    match mebibytes {
        ..1.0 => format!("{bytes} bytes"),
        ..1024.0 => format!("{mebibytes:.0} MiB"),
        _ => format!("{:.1} GiB", mebibytes / 1024.0),
    }
}

/// Bytes available to this process: the free memory of the system, within the limits of the process and of its control
/// groups. 16 GiB if the system is not Linux.
pub fn available() -> u64 {
    [free(), address_space(), group()].into_iter().flatten().min().unwrap_or(MEMORY)
}

/// Memory available without swapping.
fn free() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemAvailable:")
}

/// Remaining address space (`ulimit -v`), if it is limited.
fn address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kibibytes("/proc/self/status", "VmSize:")?))
}

/// Memory that the control groups of this process leave, as in containers and batch jobs.
fn group() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let root = Path::new("/sys/fs/cgroup");
    root.join(own).ancestors().take_while(|folder| folder.starts_with(root)).filter_map(left).min()
}

/// Memory that one control group leaves. Cached files count as free.
fn left(folder: &Path) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let limit = number("memory.max")?;
    let statistics = read("memory.stat")?;
    let files = statistics.lines().find_map(|line| line.strip_prefix("file "))?.parse().ok()?;
    Some(limit.saturating_sub(number("memory.current")?.saturating_sub(files)))
}

/// The number after a name in a table of the system, in bytes.
fn kibibytes(path: &str, name: &str) -> Option<u64> {
    let table = fs::read_to_string(path).ok()?;
    let value = table.lines().find_map(|line| line.strip_prefix(name))?;
    value.split_whitespace().next()?.parse::<u64>().ok().map(|kibibytes| kibibytes << 10)
}

#[cfg(test)]
mod amounts {
    use super::*;

    #[test]
    fn amounts_of_memory_are_read_with_their_units() {
        for (text, bytes) in [
            ("512", 512),
            ("8GB", 8_000_000_000),
            ("8gb", 8_000_000_000),
            ("1.5 GiB", 3 << 29),
            ("16G", 16 << 30),
            ("300MB", 300_000_000),
            ("2tib", 2 << 40),
        ] {
            assert_eq!(parse(text), Ok(bytes), "{text}");
        }
        for text in ["", "GB", "0", "-1GB", "nan", "inf", "8 apples", "8G B", "1e30", "0.1B"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// No machine that runs this has less than some MB free, or more than it has in all.
    #[test]
    fn what_is_left_is_less_than_all() {
        let all = kibibytes("/proc/meminfo", "MemTotal:").unwrap();
        assert!((1 << 20..all).contains(&available()), "{} of {all}", available());
    }
}
