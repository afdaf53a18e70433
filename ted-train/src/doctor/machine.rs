//! Processor, memory and disk.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;

/// What the paper's dataset of one task, its run and the simulator need together.
const DISK_NEEDED_MIB: u64 = 2048;
/// What training on that dataset needs.
const MEMORY_NEEDED_MIB: u64 = 2048;

/// Model where the system says it, architecture, cores, and the vector instructions that the trainer's kernels choose from.
#[must_use]
pub fn processor() -> String {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let features = features();
    let vectors = if features.is_empty() {
        "no vector extensions that are looked for".to_owned()
    } else {
        features.join(" ")
    };
    let model = fs::read_to_string("/proc/cpuinfo").ok();
    let model = model.as_deref().and_then(cpuinfo_model);
    let model = model.map_or(String::new(), |model| format!("{model}, "));
    format!(
        "{model}{}, {cores} cores, {vectors}",
        std::env::consts::ARCH
    )
}

fn cpuinfo_model(text: &str) -> Option<&str> {
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim())
}

#[cfg(target_arch = "x86_64")]
fn features() -> Vec<&'static str> {
    let found = [
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
        ("avx512bw", is_x86_feature_detected!("avx512bw")),
        ("avx512vnni", is_x86_feature_detected!("avx512vnni")),
    ];
    found
        .into_iter()
        .filter_map(|(name, has)| has.then_some(name))
        .collect()
}

#[cfg(target_arch = "aarch64")]
fn features() -> Vec<&'static str> {
    vec!["neon"]
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn features() -> Vec<&'static str> {
    Vec::new()
}

/// Memory, where the system says it in a file.
pub(super) fn memory() -> Result<String, String> {
    let Ok(text) = fs::read_to_string("/proc/meminfo") else {
        return Ok("not known on this system".to_owned());
    };
    let mib = |name| meminfo_mib(&text, name);
    match (mib("MemTotal"), mib("MemAvailable")) {
        (Some(total), Some(free)) if free < MEMORY_NEEDED_MIB => Err(format!(
            "{free} MiB of {total} MiB are free, and training on a full dataset needs about {MEMORY_NEEDED_MIB}: \
             end other programs, or collect fewer episodes"
        )),
        (Some(total), Some(free)) => Ok(format!("{free} MiB of {total} MiB free")),
        _ => Ok("not known on this system".to_owned()),
    }
}

fn meminfo_mib(text: &str, name: &str) -> Option<u64> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024)
}

/// Whether datasets can be written where they go.
pub(super) fn writable(folder: &Path) -> Result<String, String> {
    let place = folder.display();
    let existing = existing(folder);
    match tempfile_in(existing) {
        Ok(()) if existing == folder => Ok(format!("{place}")),
        Ok(()) => Ok(format!("{place}, made by the first collection")),
        Err(error) => Err(format!(
            "{place} cannot be written ({error}): name another place with MINARI_DATASETS_PATH"
        )),
    }
}

/// Free space where datasets go, asked of `df`, whose output POSIX fixes.
pub(super) fn free_disk(folder: &Path) -> Result<String, String> {
    let output = Command::new("df").arg("-Pk").arg(existing(folder)).output();
    let text = output.map_or_else(
        |_| String::new(),
        |output| String::from_utf8_lossy(&output.stdout).into_owned(),
    );
    match df_mib(&text) {
        Some(free) if free < DISK_NEEDED_MIB => Err(format!(
            "{free} MiB at {}, and a full dataset with its run and the simulator need about {DISK_NEEDED_MIB}: \
             free some, or name another place with MINARI_DATASETS_PATH",
            folder.display()
        )),
        Some(free) => Ok(format!("{free} MiB at {}", folder.display())),
        None => Ok("not known on this system".to_owned()),
    }
}

/// The fourth column of the line after the header. A name with spaces would shift it, so it is found from the percent sign.
fn df_mib(text: &str) -> Option<u64> {
    let columns: Vec<&str> = text.lines().nth(1)?.split_whitespace().collect();
    let percent = columns.iter().position(|column| column.ends_with('%'))?;
    let kib: u64 = columns.get(percent.checked_sub(1)?)?.parse().ok()?;
    Some(kib / 1024)
}

/// The folder, or the nearest one above it that is there.
fn existing(folder: &Path) -> &Path {
    folder
        .ancestors()
        .find(|path| path.is_dir())
        .unwrap_or(Path::new("."))
}

fn tempfile_in(folder: &Path) -> std::io::Result<()> {
    let path = folder.join(format!(".ted-doctor-{}", std::process::id()));
    fs::write(&path, b"")?;
    fs::remove_file(&path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_space_is_read_from_df_whatever_the_device_is_called() {
        let text = "Filesystem 1024-blocks Used Available Capacity Mounted on\n\
                    map auto home 41152832 1048576 2097152 4% /data";
        assert_eq!(df_mib(text), Some(2048));
        assert_eq!(df_mib("df: nowhere"), None);
    }

    #[test]
    fn the_model_is_read_from_cpuinfo() {
        let text = "processor\t: 0\nmodel name\t: AMD EPYC 9R14\nmodel name\t: another\n";
        assert_eq!(cpuinfo_model(text), Some("AMD EPYC 9R14"));
        assert_eq!(cpuinfo_model("BogoMIPS\t: 100\n"), None);
    }

    #[test]
    fn memory_is_read_from_meminfo() {
        let text = "MemTotal:        8000000 kB\nMemAvailable:    4194304 kB\n";
        assert_eq!(meminfo_mib(text, "MemAvailable"), Some(4096));
        assert_eq!(meminfo_mib(text, "Mem"), None);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        assert!(writable(&folder.path().join("not/yet")).is_ok());
        assert!(writable(Path::new("/proc/self")).is_err_and(|text| text.contains("MINARI")));
    }
}
