//! How much memory the process has.

/// Bytes of memory that the process holds; `None` where the system does not tell.
pub(super) fn resident_bytes() -> Option<usize> {
    // The second number is the resident set, in pages. Pages are 4 KiB wherever it matters here;
    // larger ones make the estimate low, and the budget looser.
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse::<usize>().ok().map(|pages| pages * 4096)
}
