//! How much memory there is.

use std::fs;
use std::path::Path;

/// What is taken to be there where the system does not say.
const UNKNOWN: u64 = 64 << 30;

/// Bytes that a new program could have: what is free, or what this group of processes may have at all, if that is less.
#[must_use]
pub fn free_memory() -> u64 {
    let meminfo = fs::read_to_string("/proc/meminfo").ok();
    let free = meminfo
        .as_deref()
        .and_then(|text| meminfo_bytes(text, "MemAvailable"));
    free.unwrap_or(UNKNOWN).min(limit().unwrap_or(u64::MAX))
}

/// Bytes that `/proc/meminfo` gives for a name.
#[must_use]
pub fn meminfo_bytes(text: &str, name: &str) -> Option<u64> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

/// What a container or a batch system leaves us.
fn limit() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let file = Path::new("/sys/fs/cgroup").join(own).join("memory.max");
    fs::read_to_string(file).ok()?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_from_meminfo() {
        let text = "MemTotal:        8000000 kB\nMemAvailable:    4194304 kB\n";
        assert_eq!(meminfo_bytes(text, "MemAvailable"), Some(4 << 30));
        assert_eq!(meminfo_bytes(text, "Mem"), None);
        assert!(free_memory() > 0);
    }
}
