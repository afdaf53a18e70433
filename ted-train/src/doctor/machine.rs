//! Processor, memory and disk.

use std::fs;
use std::path::Path;
use std::thread;

use firmware_sim::disk::free_space;
use firmware_sim::memory::meminfo_bytes;

const MIB: u64 = 1 << 20;
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
    let mib = |name| meminfo_bytes(&text, name).map(|bytes| bytes / MIB);
    match (mib("MemTotal"), mib("MemAvailable")) {
        (Some(total), Some(free)) if free < MEMORY_NEEDED_MIB => Err(format!(
            "{free} MiB of {total} MiB are free, and training on a full dataset needs about {MEMORY_NEEDED_MIB}: \
             end other programs, or collect fewer episodes"
        )),
        (Some(total), Some(free)) => Ok(format!("{free} MiB of {total} MiB free")),
        _ => Ok("not known on this system".to_owned()),
    }
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

/// Free space where datasets go.
pub(super) fn free_disk(folder: &Path) -> Result<String, String> {
    match free_space(folder).map(|bytes| bytes / MIB) {
        Some(free) if free < DISK_NEEDED_MIB => Err(format!(
            "{free} MiB at {}, and a full dataset with its run and the simulator need about {DISK_NEEDED_MIB}: \
             free some, or name another place with MINARI_DATASETS_PATH",
            folder.display()
        )),
        Some(free) => Ok(format!("{free} MiB at {}", folder.display())),
        None => Ok("not known on this system".to_owned()),
    }
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
    fn the_model_is_read_from_cpuinfo() {
        let text = "processor\t: 0\nmodel name\t: AMD EPYC 9R14\nmodel name\t: another\n";
        assert_eq!(cpuinfo_model(text), Some("AMD EPYC 9R14"));
        assert_eq!(cpuinfo_model("BogoMIPS\t: 100\n"), None);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        assert!(writable(&folder.path().join("not/yet")).is_ok());
        assert!(writable(Path::new("/proc/self")).is_err_and(|text| text.contains("MINARI")));
    }
}
