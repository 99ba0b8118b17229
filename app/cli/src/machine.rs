//! What the machine has: cores and memory.

use std::fs;
use std::path::Path;

use crate::exit::Stop;

/// Assumed where the system does not tell.
const SOME_MEMORY: usize = 8 << 30;

/// Makes the threads that modules share, and tells how many there are.
pub fn set_threads(asked: Option<usize>) -> Result<usize, Stop> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = asked.unwrap_or(cores);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| Stop::usage(format!("cannot start {threads} threads: {error}")))?;
    Ok(threads)
}

/// Reads a number of threads, jobs and the like.
pub fn parse_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=4096).contains(&count) => Ok(count),
        _ => Err("write a whole number from 1 to 4096".to_owned()),
    }
}

/// Reads a size of memory: `4G`, `512MiB`, `1.5 GB`. Units are powers of 1024.
pub fn parse_size(text: &str) -> Result<usize, String> {
    let form = "write a size such as 4G or 512M";
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let number: f64 = number.parse().map_err(|_| form)?;
    let unit = unit.trim().to_ascii_uppercase();
    let power = match unit.trim_end_matches('B').trim_end_matches('I') {
        "" => 0,
        "K" => 1,
        "M" => 2,
        "G" => 3,
        "T" => 4,
        _ => return Err(form.to_owned()),
    };
    let bytes = number * 1024_f64.powi(power);
    if (1.0..1e18).contains(&bytes) { Ok(bytes as usize) } else { Err(form.to_owned()) }
}

/// Half of the memory that the process may have.
pub fn half_of_memory() -> usize {
    let machine = fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
        line.trim().trim_end_matches("kB").trim().parse::<usize>().ok().map(|k| k * 1024)
    });
    // Containers and jobs of a cluster have less than their machine.
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limit = limit_of(&groups, Path::new("/sys/fs/cgroup"));
    machine.unwrap_or(SOME_MEMORY).min(limit.unwrap_or(usize::MAX)) / 2
}

/// The least limit of the control groups that a process is in, by the lines of its
/// `/proc/self/cgroup`: of each group and of those around it, of either version of such groups.
fn limit_of(groups: &str, root: &Path) -> Option<usize> {
    let limits = groups.lines().flat_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
        let (folder, file) = match controllers {
            "" => (root.to_owned(), "memory.max"),
            list if list.split(',').any(|name| name == "memory") => {
                (root.join(list), "memory.limit_in_bytes")
            }
            _ => return Vec::new(),
        };
        let group = folder.join(path.trim_start_matches('/'));
        let around = group.ancestors().take_while(|above| above.starts_with(&folder));
        let limit = |group: &Path| fs::read_to_string(group.join(file)).ok()?.trim().parse().ok();
        around.filter_map(limit).collect()
    });
    limits.min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_limit_of_nested_groups_counts() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("slurm/job_7/memory.max", "4096\n");
        write("slurm/job_7/step_0/memory.max", "max\n");
        write("slurm/memory.max", "8192\n");
        let of = |groups: &str| limit_of(groups, root.path());
        assert_eq!(of("0::/slurm/job_7/step_0\n"), Some(4096));
        assert_eq!(of("0::/slurm\n"), Some(8192));
        assert_eq!(of("0::/other\n"), None);
        write("memory/slurm/job_8/memory.limit_in_bytes", "1024\n");
        assert_eq!(of("5:cpu:/slurm/job_7\n4:memory:/slurm/job_8/step_1\n"), Some(1024));
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(parse_size("4G"), Ok(4 << 30));
        assert_eq!(parse_size("512MiB"), Ok(512 << 20));
        assert_eq!(parse_size("1.5 gb"), Ok(3 << 29));
        assert_eq!(parse_size("1000"), Ok(1000));
        for bad in ["", "G", "4X", "-1G", "1e3"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
