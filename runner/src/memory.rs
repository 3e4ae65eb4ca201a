//! Memory that is available for a computation.

use std::fs;
use std::path::Path;

use asperity::monitor::MEMORY;

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
