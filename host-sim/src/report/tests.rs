//! The page as a whole.

use super::sample_log::SampleLog;

/// Pages to look at, in `target/report-preview/`.
#[test]
#[ignore = "writes pages for the eye"]
fn previews() {
    let folder = std::path::Path::new("../target/report-preview");
    std::fs::create_dir_all(folder).unwrap();
    let mut single = SampleLog::dff8_13(6.0);
    single.keep_events(1);
    let pages = [
        ("usual", SampleLog::dff8_13(120.0)),
        ("hour", SampleLog::dff8_13(3600.0)),
        ("troubled", SampleLog::troubled(40.0)),
        ("tiny", SampleLog::troubled(40.0).scaled(4e-4)),
        ("single", single),
        ("none", SampleLog::dff8_13(40.0).without_events()),
    ];
    for (name, log) in pages {
        std::fs::write(folder.join(format!("{name}.html")), log.page()).unwrap();
    }
}
