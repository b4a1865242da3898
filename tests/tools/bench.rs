//! The parts of `tools/bench` that need no peer and no device: intervals, tests, cameras, plots.

use std::path::Path;
use std::process::Command;

#[test]
fn the_benchmarks_own_tests_pass() {
    let tools = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools");
    let output = Command::new("python3")
        .args(["-B", "-m", "unittest", "benchmark.test_benchmark"])
        .current_dir(tools)
        .output()
        .expect("python3 is installed (apt-get install python3, or run tools/test)");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    // An empty run passes, too.
    let count = said
        .lines()
        .find_map(|line| line.strip_prefix("Ran ")?.split(' ').next()?.parse().ok());
    assert!(count.is_some_and(|n: u32| n >= 10), "{said}");
}
