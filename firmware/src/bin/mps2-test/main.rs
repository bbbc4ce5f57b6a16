//! Tests that run on the emulated board: one per start, named in the file `test.name`. The exit
//! code is the result:
//!
//! | code | meaning |
//! |---|---|
//! | 0 | passed |
//! | 101 | a panic; its message is on standard error |
//! | 102 | a hard fault |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bench;
#[cfg(target_os = "none")]
mod fake;
#[cfg(target_os = "none")]
mod functions;
#[cfg(target_os = "none")]
mod hardware;
#[cfg(target_os = "none")]
mod paths;
#[cfg(target_os = "none")]
mod queue;
#[cfg(target_os = "none")]
mod timing;

#[cfg(target_os = "none")]
mod target {
    use floe_firmware::board::mps2;
    use semihosting::fs::File;
    use semihosting::io::Read;

    use super::{bench, paths, queue, timing};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        mps2::start();
        let mut name = [0; 32];
        let count = File::open(c"test.name").and_then(|mut f| f.read(&mut name)).unwrap_or(0);
        let name = core::str::from_utf8(&name[..count]).unwrap_or("");
        match name.trim() {
            "tick" => timing::tick_is_exact(),
            "wake" => timing::no_wake_up_is_lost(),
            "queue" => queue::stalls(),
            "maths" => paths::maths(),
            "bytes" => paths::bytes(),
            "panic" => paths::panic(),
            "fault" => paths::fault(),
            "overflow" => paths::overflow(),
            "bench" => bench::run(),
            "maths-bench" => bench::functions(),
            other => panic!("no test {other}"),
        }
        mps2::finish(0)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
