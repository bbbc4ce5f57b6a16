//! A command from outside: its folder and what it says.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A directory of one test's own, empty: the programs of tests run side by side, so that one
/// name in two of them stands for two directories, and no directory lies in another.
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

/// Exit 2, nothing on standard output, one line on standard error that holds
/// all of `parts`.
pub fn assert_refused(output: &Output, parts: &[&str]) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(text(&output.stdout), "", "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    for part in parts {
        assert!(said.contains(part), "'{part}' is not in: {said}");
    }
}
