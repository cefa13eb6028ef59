//! Runs of the binary under watch, and the rules that every one of them keeps.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;

use std::thread;
use std::time::{Duration, Instant};

use crate::cli::harness::Bench;

/// A run that says nothing of the time it needs ends within this. The slowest input that is not a
/// fault takes a few seconds on an idle core; tests share theirs with others.
const PATIENCE: Duration = Duration::from_secs(40);

/// How one run ended.
pub struct Ended {
    /// Exit code; `None` if it was stopped because it took too long.
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: Vec<u8>,
    pub seconds: f64,
}

/// Runs the binary, with its output in files so that no pipe can fill up.
pub fn run(bench: &Bench, arguments: &[String], patience: Duration) -> Ended {
    let (out, err) = (bench.path("stdout.txt"), bench.path("stderr.txt"));
    let begun = Instant::now();
    let mut child = bench
        .command(arguments)
        .stdout(File::create(&out).expect("a file can be written"))
        .stderr(File::create(&err).expect("a file can be written"))
        .spawn()
        .expect("the binary runs");
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child") {
            break Some(status);
        }
        if begun.elapsed() > patience {
            child.kill().expect("the child can be killed");
            child.wait().expect("a child");
            break None;
        }
        thread::sleep(Duration::from_millis(1));
    };
    Ended {
        // a signal ends a process without an exit code: that is a crash
        code: status.map(|status| status.code().unwrap_or(-1)),
        stdout: fs::read(&out).expect("stdout"),
        stderr: fs::read(&err).expect("stderr"),
        seconds: begun.elapsed().as_secs_f64(),
    }
}

/// Counts of what happened, and the inputs that broke a rule.
#[derive(Default)]
pub struct Record {
    inputs: usize,
    codes: BTreeMap<String, usize>,
    slowest: (f64, String),
    faults: Vec<String>,
}

impl Record {
    pub fn input(&mut self) {
        self.inputs += 1;
    }

    /// Runs the binary and holds it to the rules; `codes` are the exit codes that may come.
    pub fn run(
        &mut self,
        bench: &Bench,
        arguments: &[&str],
        codes: &[i32],
        repeat: &str,
    ) -> Option<Ended> {
        let words: Vec<String> = arguments.iter().map(|word| word.to_string()).collect();
        let ended = run(bench, &words, PATIENCE);
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        let line = format!("brakewave {}", words.join(" "));
        if ended.seconds > self.slowest.0 {
            self.slowest = (ended.seconds, line.clone());
        }
        // a run may be long if it says where it is
        let said_where = |words: &&str| said.contains(words);
        let announced = ended.code.is_none()
            && [" left", " points", " rows", " modes", "step "]
                .iter()
                .any(said_where);
        let key = match ended.code {
            Some(code) => code.to_string(),
            None if announced => "stopped, having said how long it takes".into(),
            None => "stopped".into(),
        };
        *self.codes.entry(format!("{} {key}", words[0])).or_default() += 1;
        let fault = match ended.code {
            None if announced => None,
            None => Some("does not end and does not say where it is".to_string()),
            Some(_) if said.contains("panicked") => Some("panics".into()),
            Some(code) if !codes.contains(&code) => Some(format!("exit code {code}")),
            Some(code) if code != 0 && said.trim().is_empty() && ended.stdout.is_empty() => {
                Some(format!("exit code {code} without a word"))
            }
            _ if std::str::from_utf8(&ended.stdout).is_err() => Some("stdout is not UTF-8".into()),
            _ => None,
        };
        if let Some(fault) = fault {
            self.fault(format!(
                "{fault} after {:.1} s: {line}\n{}\n{repeat}",
                ended.seconds,
                said.chars().take(600).collect::<String>()
            ));
            return None;
        }
        Some(ended)
    }

    pub fn fault(&mut self, fault: String) {
        eprintln!("FAULT {fault}\n");
        self.faults.push(fault);
    }

    /// A file of the user's is as it was.
    pub fn untouched(&mut self, path: &Path, content: &[u8], by: &str) {
        if fs::read(path).ok().as_deref() != Some(content) {
            self.fault(format!("{} is lost or changed by {by}", path.display()));
        }
    }

    /// Prints the counts, and fails if a rule was broken.
    pub fn close(self, target: &str) {
        eprintln!(
            "{target}: {} inputs, {} faults",
            self.inputs,
            self.faults.len()
        );
        for (code, count) in &self.codes {
            eprintln!("  {code}: {count}");
        }
        eprintln!("  slowest: {:.1} s, {}", self.slowest.0, self.slowest.1);
        assert!(self.inputs > 0, "{target} made no input");
        assert!(
            self.faults.is_empty(),
            "{} of {} inputs break a rule, the first: {}",
            self.faults.len(),
            self.inputs,
            self.faults[0]
        );
    }
}
