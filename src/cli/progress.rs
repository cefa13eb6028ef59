//! How far a run is: a bar on a terminal; elsewhere a line on standard error every ten seconds, the
//! first after one second if there is long to wait.

use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(10);

/// When the first estimate is worth a line, if it is beyond [`EVERY`].
const FIRST: Duration = Duration::from_secs(1);

/// Time between two positions of the bar.
const REDRAWN: Duration = Duration::from_millis(100);

/// Parts of the bar.
const PARTS: u64 = 1000;

/// What is shown of a run.
pub struct Progress {
    quiet: bool,
    bar: Option<ProgressBar>,
    begun: Instant,
    shown: Option<Instant>,
    /// When and where the run was first known to be: a resumed one does not begin at 0.
    first: (Instant, f64),
}

impl Progress {
    /// Begins to count time.
    pub fn new(quiet: bool) -> Progress {
        let bar = (!quiet && stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(PARTS);
            // the template is constant and valid
            if let Ok(style) =
                ProgressStyle::with_template("{spinner} [{bar:40}] {msg} ({elapsed})")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        });
        Progress {
            quiet,
            bar,
            begun: Instant::now(),
            shown: None,
            first: (Instant::now(), f64::NAN),
        }
    }

    /// Shows that a part from 0 to 1 is done, or that nobody knows (NaN), in the words given.
    pub fn show(&mut self, part: f64, words: impl FnOnce() -> String) {
        if self.quiet {
            return;
        }
        if self.first.1.is_nan() {
            self.first = (Instant::now(), part);
        }
        let left = left(self.first.0.elapsed(), self.first.1, part);
        let since = self.shown.unwrap_or(self.begun).elapsed();
        if let Some(bar) = &self.bar {
            if self.shown.is_none() || since >= REDRAWN {
                bar.set_position((part.clamp(0.0, 1.0) * PARTS as f64) as u64);
                bar.set_message(line(part, left, &words()));
                self.shown = Some(Instant::now());
            }
            return;
        }
        let long = self.shown.is_none() && left.is_some_and(|left| left > EVERY.as_secs_f64());
        if since >= if long { FIRST } else { EVERY } {
            let _ = writeln!(stderr(), "{}", line(part, left, &words()));
            self.shown = Some(Instant::now());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Says every ten seconds on standard error where work is that does not say it itself, from a thread of
/// its own; nothing on a terminal.
pub struct Ticker {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Ticker {
    /// Begins to count time.
    pub fn new(quiet: bool, words: impl Fn() -> String + Send + 'static) -> Ticker {
        if quiet || stderr().is_terminal() {
            return Ticker {
                stop: None,
                thread: None,
            };
        }
        let (stop, stopped) = channel::<()>();
        // without a thread there are no lines
        let thread = Builder::new().spawn(move || {
            while stopped.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                let _ = writeln!(stderr(), "{}", words());
            }
        });
        Ticker {
            stop: Some(stop),
            thread: thread.ok(),
        }
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Seconds left at the pace since the first look.
fn left(elapsed: Duration, first: f64, part: f64) -> Option<f64> {
    let left = elapsed.as_secs_f64() * (1.0 - part) / (part - first);
    (part > first && left.is_finite()).then_some(left.max(0.0))
}

fn line(part: f64, left: Option<f64>, words: &str) -> String {
    let mut text = String::new();
    if part.is_finite() {
        text.push_str(&format!("{:.0} %: ", 100.0 * part));
    }
    text.push_str(words);
    if let Some(left) = left {
        text.push_str(&format!(", about {} left", duration(left)));
    }
    text
}

/// Seconds as a reader wants them: a number below 120 of the largest fitting unit.
pub fn duration(seconds: f64) -> String {
    let units = [
        (60.0, "s"),
        (60.0, "min"),
        (24.0, "h"),
        (f64::INFINITY, "d"),
    ];
    let mut value = seconds;
    for (next, unit) in units {
        if value < 2.0 * next {
            return if value < 1e6 {
                format!("{value:.0} {unit}")
            } else {
                format!("{value:.0e} {unit}")
            };
        }
        value /= next;
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_that_of_the_pace() {
        let elapsed = Duration::from_secs(30);
        assert_eq!(left(elapsed, 0.0, 0.25), Some(90.0));
        // a run resumed at one half has done half of what it had left
        assert_eq!(left(elapsed, 0.5, 0.75), Some(30.0));
        assert_eq!(left(elapsed, 0.0, 1.0), Some(0.0));
        for unknown in [f64::NAN, 0.0] {
            assert_eq!(left(elapsed, 0.0, unknown), None);
        }
        assert_eq!(
            line(0.25, Some(90.0), "5 of 20 steps"),
            "25 %: 5 of 20 steps, about 90 s left"
        );
        assert_eq!(line(f64::NAN, None, "step 3"), "step 3");
    }

    #[test]
    fn durations_are_read_at_a_glance() {
        for (seconds, text) in [
            (0.0, "0 s"),
            (119.0, "119 s"),
            (120.0, "2 min"),
            (10_800.0, "3 h"),
            (864_000.0, "10 d"),
            (8.64e12, "1e8 d"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }
}
