//! What the process takes of the machine, where the system tells.

use std::fs;

/// Forgets how much memory the process has held so far.
pub(super) fn forget_peak() {
    // Where that is not possible the peak is that of the whole process, and no smaller than it is.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// The most memory that the process has held since [`forget_peak`], in bytes.
pub(super) fn peak_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kibibytes| kibibytes * 1024)
}

/// Seconds that all processors together have worked for the process.
#[cfg(unix)]
pub(super) fn cpu_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

/// Seconds that all processors together have worked for the process.
#[cfg(not(unix))]
pub(super) fn cpu_seconds() -> Option<f64> {
    None
}
