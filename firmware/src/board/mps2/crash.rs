//! Abnormal end of a program: the exit code is the cause.

use cortex_m_rt::{ExceptionFrame, exception};
use semihosting::process::exit;

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    exit(102)
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    semihosting::eprintln!("{info}");
    exit(101)
}
