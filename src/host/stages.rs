//! Where the time goes from the start of the program to its first sample.
//!
//! One record for the process, as for a log: the stages lie in all layers, and several run at the same time.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// Start-up so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Startup {
    /// Seconds from the start of the program to its first finished samples; none if there are none.
    pub first_sample: Option<f64>,
    /// Seconds of each stage.
    pub stages: Stages,
}

/// Stages and their seconds, in the order in which they first ended. Stages on different threads overlap.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stages(pub Vec<(&'static str, f64)>);

impl Serialize for Stages {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, seconds) in &self.0 {
            map.serialize_entry(name, seconds)?;
        }
        map.end()
    }
}

impl Stages {
    fn add(&mut self, name: &'static str, seconds: f64) {
        match self.0.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += seconds,
            None => self.0.push((name, seconds)),
        }
    }
}

#[derive(Debug)]
struct Record {
    begin: Option<Instant>,
    startup: Startup,
}

static RECORD: Mutex<Record> = Mutex::new(Record {
    begin: None,
    startup: Startup {
        first_sample: None,
        stages: Stages(Vec::new()),
    },
});

fn record() -> MutexGuard<'static, Record> {
    RECORD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The program starts: counts from here.
pub fn begin() {
    record().begin = Some(Instant::now());
}

/// Seconds since the start of the program; 0 where nobody said when that was.
pub fn seconds_since_start() -> f64 {
    let begin = record().begin;
    begin.map_or(0.0, |begin| begin.elapsed().as_secs_f64())
}

/// Runs a stage and notes its time; the times of one name add up. After the first sample nothing is noted.
pub fn stage<T>(name: &'static str, work: impl FnOnce() -> T) -> T {
    timed_stage(name, work).0
}

/// As [`stage`]; also gives the time.
pub fn timed_stage<T>(name: &'static str, work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = work();
    let time = start.elapsed();
    let mut record = record();
    if record.startup.first_sample.is_none() {
        record.startup.stages.add(name, time.as_secs_f64());
    }
    (result, time)
}

/// The first samples are finished; later calls change nothing.
pub fn first_sample() {
    let mut record = record();
    if let (None, Some(begin)) = (record.startup.first_sample, record.begin) {
        record.startup.first_sample = Some(begin.elapsed().as_secs_f64());
    }
}

/// What was noted.
pub fn startup() -> Startup {
    record().startup.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_s_times_add_up_and_the_order_stays() {
        let mut stages = Stages::default();
        stages.add("read", 1.0);
        stages.add("bvh", 2.0);
        stages.add("read", 0.5);
        let text = serde_json::to_string(&stages).expect("JSON");
        assert_eq!(text, r#"{"read":1.5,"bvh":2.0}"#);
    }
}
