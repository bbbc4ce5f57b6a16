//! Running a command: its folder and its output.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

/// An empty directory for one test. Test programs run in parallel, so the directory is named after
/// the program and the test, and no directory lies in another.
pub fn directory(test: &str) -> PathBuf {
    assert_eq!(Path::new(test).components().count(), 1, "{test} lies in another test's");
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME"));
    let path = own.join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Asserts exit code 2, no standard output, and one line on standard error that contains all of
/// `parts`.
pub fn assert_refused(output: &Output, parts: &[&str]) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(text(&output.stdout), "", "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    for part in parts {
        assert!(said.contains(part), "'{part}' is not in: {said}");
    }
}
