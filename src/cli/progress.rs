//! How far work is: a bar on a terminal; elsewhere a line on standard error every ten seconds, the first
//! after one second if there is long to wait. The ten seconds go on from one stage of the work to the next.

use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::failure::VerbFailure;

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(10);

/// When the first estimate is worth a line, if it is beyond [`EVERY`].
const FIRST: Duration = Duration::from_secs(1);

/// Time after which a stage of the work has said where it is.
const SETTLED: Duration = Duration::from_millis(100);

/// When the last line was written, or the first work began: standard error is one for all stages.
static SPOKEN: Mutex<Option<Instant>> = Mutex::new(None);

/// Part of the work whose pace tells that of the rest: the first steps after a start or a resume are short, and a branch is slow around
/// an event.
const TELLING: f64 = 1e-4;

/// What is shown until the first look.
const BEGINNING: &str = "at the first step";

/// Parts of the bar.
const PARTS: u64 = 1000;

/// Where work is: the part done, not a number where nobody knows, and more in words.
pub(crate) type Here = (f64, String);

/// Takes steps until there is none left, and shows after each where the work is.
pub(crate) fn drive(
    quiet: bool,
    mut step: impl FnMut() -> Result<Option<Here>, VerbFailure>,
) -> Result<(), VerbFailure> {
    let progress = ProgressLine::new(quiet);
    while let Some((part, words)) = step()? {
        progress.show(part, words);
    }
    Ok(())
}

/// Does the same with everything in a list, in parallel, and shows how many are done; outcomes in the
/// order of the list, or the end of all work with an error where a `Result` collects them.
pub(crate) fn each<T: Sync, R: Send, C: FromParallelIterator<R>>(
    quiet: bool,
    list: &[T],
    what: &str,
    work: impl Fn(&T) -> R + Sync,
) -> C {
    let tally = WorkTally {
        before: 0,
        all: list.len(),
        what,
    };
    tallied(quiet, list, tally, |one, done| {
        let outcome = work(one);
        done();
        outcome
    })
}

/// What is counted of some work.
pub(crate) struct WorkTally<'a> {
    /// How many an earlier run has done.
    pub before: usize,
    /// How many there are with those.
    pub all: usize,
    /// What they are, in a word.
    pub what: &'a str,
}

/// The same where each of the list is more than one of what is counted: `work` says when one is done.
pub(crate) fn tallied<T: Sync, R: Send, C: FromParallelIterator<R>>(
    quiet: bool,
    list: &[T],
    WorkTally { before, all, what }: WorkTally<'_>,
    work: impl Fn(&T, &(dyn Fn() + Sync)) -> R + Sync,
) -> C {
    let (progress, done) = (ProgressLine::new(quiet), AtomicUsize::new(before));
    let show = |done: usize| {
        let words = format!("{done} of {all} {what}");
        progress.show(done as f64 / all as f64, words);
    };
    show(before);
    let one_more = || show(done.fetch_add(1, Ordering::Relaxed) + 1);
    let outcomes = list.par_iter().map(|one| work(one, &one_more));
    outcomes.collect()
}

/// What is known of the work.
struct WorkState {
    part: f64,
    words: String,
    /// When and where it was first known to be: resumed work does not begin at 0.
    first: Option<(Instant, f64)>,
}

impl WorkState {
    /// Seconds left at the pace since the first look.
    fn left(&self) -> Option<f64> {
        let (begun, first) = self.first?;
        left(begun.elapsed(), first, self.part)
    }
}

/// What is shown of work, until it is dropped.
pub(crate) struct ProgressLine {
    state: Arc<Mutex<WorkState>>,
    bar: Option<ProgressBar>,
    /// The thread that writes lines, and what ends it.
    lines: Option<(Sender<()>, JoinHandle<()>)>,
}

impl ProgressLine {
    /// Begins to count time.
    pub(crate) fn new(quiet: bool) -> ProgressLine {
        let state = Arc::new(Mutex::new(WorkState {
            part: f64::NAN,
            words: BEGINNING.to_owned(),
            first: None,
        }));
        let seen = state.clone();
        let lines = || {
            let (stop, stopped) = channel();
            let thread = Builder::new().spawn(move || write_lines(&seen, &stopped));
            // without a thread there are no lines
            Some((stop, thread.ok()?))
        };
        let terminal = stderr().is_terminal();
        ProgressLine {
            state,
            bar: (!quiet && terminal).then(bar),
            lines: (!quiet && !terminal).then(lines).flatten(),
        }
    }

    /// Shows where the work is.
    pub(crate) fn show(&self, part: f64, words: String) {
        let mut state = lock(&self.state);
        if let Some(bar) = self
            .bar
            .as_ref()
            .filter(|_| part.is_nan() != state.part.is_nan())
        {
            wear(bar, STYLES[usize::from(part.is_nan())]);
        }
        if state.first.is_none() && !part.is_nan() {
            state.first = Some((Instant::now(), part));
        }
        (state.part, state.words) = (part, words);
        if let Some(bar) = &self.bar {
            bar.set_position((part.clamp(0.0, 1.0) * PARTS as f64) as u64);
            bar.set_message(line(part, state.left(), &state.words));
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.lines.take() {
            drop(stop);
            let _ = thread.join();
        }
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// What a terminal shows where the part done is known, and where nobody knows it.
const STYLES: [&str; 2] = [
    "{spinner} [{bar:40}] {msg} ({elapsed})",
    "{spinner} {msg} ({elapsed})",
];

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(PARTS).with_message(BEGINNING);
    wear(&bar, STYLES[1]);
    bar
}

fn wear(bar: &ProgressBar, style: &str) {
    // the templates are constant and valid
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style.progress_chars("=> "));
    }
}

/// A state is whole between any two statements.
fn lock<T>(state: &Mutex<T>) -> MutexGuard<'_, T> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a line now and then, also where a step takes long.
fn write_lines(state: &Mutex<WorkState>, stopped: &Receiver<()>) {
    let mut shown = false;
    let since = || spoken(&SPOKEN).elapsed();
    while stopped.recv_timeout(pause(since())) == Err(RecvTimeoutError::Timeout) {
        let state = lock(state);
        let left = state.left();
        let long = !shown && left.is_some_and(|left| left > EVERY.as_secs_f64());
        if since() >= if long { FIRST } else { EVERY } {
            let _ = writeln!(stderr(), "{}", line(state.part, left, &state.words));
            *lock(&SPOKEN) = Some(Instant::now());
            shown = true;
        }
    }
}

/// When something was said last: now, where nothing has been.
fn spoken(last: &Mutex<Option<Instant>>) -> Instant {
    *lock(last).get_or_insert_with(Instant::now)
}

/// Time until the next look, after so long without a line.
fn pause(since: Duration) -> Duration {
    EVERY.saturating_sub(since).clamp(SETTLED, FIRST)
}

/// Seconds left at the pace since the first look: what an earlier run has done took none of the time. Of less than [`TELLING`] of
/// the work nothing is concluded.
fn left(elapsed: Duration, first: f64, part: f64) -> Option<f64> {
    let left = elapsed.as_secs_f64() * (1.0 - part) / (part - first);
    (part - first >= TELLING && left.is_finite()).then_some(left.max(0.0))
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
pub(crate) fn duration(seconds: f64) -> String {
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
        // one short step after a resume says nothing of hours
        assert_eq!(left(elapsed, 0.5, 0.5001), None);
        for unknown in [f64::NAN, 0.0] {
            assert_eq!(left(elapsed, 0.0, unknown), None);
        }
        assert_eq!(
            line(0.25, Some(90.0), "5 of 20 steps"),
            "25 %: 5 of 20 steps, about 90 s left"
        );
        assert_eq!(line(f64::NAN, None, "step 3"), "step 3");
    }

    /// Stages of nine seconds each leave no silence of more than ten: the clock does not begin anew with a stage.
    #[test]
    fn ten_seconds_go_on_from_stage_to_stage() {
        let last = Mutex::new(None);
        let begun = spoken(&last);
        std::thread::sleep(Duration::from_millis(2));
        assert_eq!(spoken(&last), begun);
        // a stage that begins nine seconds after the last line looks after one
        let seconds = Duration::from_secs;
        assert_eq!(pause(seconds(9)), FIRST);
        assert_eq!(pause(seconds(0)), FIRST);
        assert_eq!(
            pause(Duration::from_millis(9800)),
            Duration::from_millis(200)
        );
        assert_eq!(pause(seconds(12)), SETTLED);
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
