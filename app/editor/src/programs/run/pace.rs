//! How fast a program runs, and when it will be done.

use std::time::Duration;

/// What is known of a program under way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pace {
    /// Seconds of each step that has ended, now or before.
    pub ended: Vec<f64>,
    /// Seconds that each running step has taken so far.
    pub running: Vec<f64>,
    /// Steps that have not ended, the running ones among them.
    pub left: usize,
    /// Steps that run at once.
    pub jobs: usize,
}

impl Pace {
    /// The time that is left, if what is to come takes as long as what has ended; `None` before
    /// anything has.
    pub fn time_left(&self) -> Option<Duration> {
        let Self { ended, running, left, jobs } = self;
        if *left == 0 {
            return Some(Duration::ZERO);
        }
        let mean = ended.iter().sum::<f64>() / ended.len() as f64;
        if ended.is_empty() || !mean.is_finite() {
            return None;
        }
        // A step that has taken longer than the mean is about to end, for all that is known.
        let begun: f64 = running.iter().map(|seconds| seconds.min(mean)).sum();
        let at_once = (*jobs).clamp(1, *left) as f64;
        // The last step cannot be shared out.
        let seconds = ((mean * *left as f64 - begun) / at_once).max(0.0);
        Duration::try_from_secs_f64(seconds).ok()
    }
}

/// A time as a person says it: `3 s`, `12 min`, `2 h 05 min`.
pub fn in_words(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 3570.0 => format!("{:.0} min", s / 60.0),
        s => {
            let minutes = (s / 60.0).round() as u64;
            let (hours, minutes) = (minutes / 60, minutes % 60);
            if hours < 48 {
                format!("{hours} h {minutes:02} min")
            } else {
                format!("{} days", hours / 24)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds_left(pace: &Pace) -> f64 {
        pace.time_left().unwrap().as_secs_f64()
    }

    #[test]
    fn what_is_left_takes_as_long_as_what_has_ended() {
        let pace = Pace { ended: vec![2.0, 4.0], running: vec![], left: 6, jobs: 2 };
        assert!((seconds_left(&pace) - 9.0).abs() < 1e-9);
        let begun = Pace { running: vec![1.0, 100.0], ..pace.clone() };
        assert!((seconds_left(&begun) - 7.0).abs() < 1e-9);
        let last = Pace { left: 1, jobs: 8, ..pace };
        assert!((seconds_left(&last) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_known_before_a_step_has_ended() {
        let pace = Pace { left: 3, jobs: 1, ..Pace::default() };
        assert_eq!(pace.time_left(), None);
        assert_eq!(Pace::default().time_left(), Some(Duration::ZERO));
    }

    #[test]
    fn times_are_short_words() {
        let words = |seconds: f64| in_words(Duration::from_secs_f64(seconds));
        let said = [0.25, 42.0, 600.0, 3580.0, 7500.0, 1e6].map(words);
        assert_eq!(said, ["0.2 s", "42 s", "10 min", "1 h 00 min", "2 h 05 min", "11 days"]);
    }
}
