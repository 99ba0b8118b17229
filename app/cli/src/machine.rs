//! What the machine has: cores and memory.

use std::fs;

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
    // Containers have less than their machine.
    let group = fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let group = group.and_then(|text| text.trim().parse::<usize>().ok());
    machine.unwrap_or(SOME_MEMORY).min(group.unwrap_or(usize::MAX)) / 2
}

#[cfg(test)]
mod tests {
    use super::*;

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
