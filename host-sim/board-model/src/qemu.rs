//! QEMU's internal functions, found by name in the program that has loaded this plugin.
//!
//! They belong to QEMU 10, not to its plugin interface; a QEMU without one of them is rejected with
//! a message of one line. All `unsafe` code of the model is here.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock};

use crate::board::{BASES, Board, Emulator};
use crate::rtt::Memory;
use crate::run::SETUP_FILE;

/// Version of the plugin interface of QEMU 10.
#[unsafe(no_mangle)]
pub static qemu_plugin_version: c_int = 4;

unsafe extern "C" {
    fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// Opaque pointer to a structure of QEMU.
type Pointer = *mut c_void;

const VIRTUAL_CLOCK: c_int = 1;
const GUEST_RESET: c_int = 5;
const HOST_QUIT: c_int = 3;
const OK: u32 = 0;
const BUS_ERROR: u32 = 1;
/// Sizes of QEMU's structures, with a margin, bytes.
const REGION_LEN: usize = 1024;
const TIMER_LEN: usize = 512;
const REGION_SIZE: u64 = 0x400;
/// Searched entries of the accelerator's function table, including its head and the clock.
const TABLE_LEN: usize = 30;

#[repr(C)]
struct Limits {
    smallest: u32,
    largest: u32,
    unaligned: bool,
    accepts: Option<extern "C" fn()>,
}

#[repr(C)]
struct ImplementedLimits {
    smallest: u32,
    largest: u32,
    unaligned: bool,
}

type ReadWithAttributes = extern "C" fn(Pointer, u64, *mut u64, u32, u64) -> u32;
type WriteWithAttributes = extern "C" fn(Pointer, u64, u64, u32, u64) -> u32;

/// `MemoryRegionOps`.
#[repr(C)]
struct RegionFunctions {
    read: Option<extern "C" fn()>,
    write: Option<extern "C" fn()>,
    read_with_attributes: ReadWithAttributes,
    write_with_attributes: WriteWithAttributes,
    endianness: c_int,
    valid: Limits,
    implemented: ImplementedLimits,
}

static FUNCTIONS: RegionFunctions = RegionFunctions {
    read: None,
    write: None,
    read_with_attributes: on_read,
    write_with_attributes: on_write,
    endianness: 2,
    valid: Limits { smallest: 1, largest: 4, unaligned: false, accepts: None },
    implemented: ImplementedLimits { smallest: 1, largest: 4, unaligned: false },
};

macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// QEMU's functions.
        #[derive(Clone, Copy)]
        struct Qemu { $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

        impl Qemu {
            /// Finds all functions.
            fn find() -> Result<Self, String> {
                Ok(Self { $($name: {
                    let found = symbol(stringify!($name))?;
                    // SAFETY: QEMU 10 declares a function of this name with this signature.
                    unsafe { std::mem::transmute::<
                        Pointer, unsafe extern "C" fn($($argument),*) $(-> $result)?
                    >(found) }
                },)* })
            }
        }
    };
}

functions! {
    qemu_plugin_register_vcpu_init_cb: fn(u64, extern "C" fn(u64, u32));
    get_system_memory: fn() -> Pointer;
    memory_region_init_io: fn(Pointer, Pointer, *const RegionFunctions, Pointer, *const c_char, u64);
    memory_region_add_subregion_overlap: fn(Pointer, u64, Pointer, c_int);
    object_resolve_path: fn(*const c_char, *mut bool) -> Pointer;
    qdev_get_gpio_in: fn(Pointer, c_int) -> Pointer;
    qemu_set_irq: fn(Pointer, c_int);
    qemu_clock_get_ns: fn(c_int) -> i64;
    qemu_clock_deadline_ns_all: fn(c_int, c_int) -> i64;
    qemu_get_cpu: fn(c_int) -> Pointer;
    cpu_exit: fn(Pointer);
    arm_cpu_gdb_write_register: fn(Pointer, *const u8, c_int) -> c_int;
    icount_get: fn() -> i64;
    cpus_get_accel: fn() -> *mut Pointer;
    timer_init_full: fn(Pointer, Pointer, c_int, c_int, c_int, extern "C" fn(Pointer), Pointer);
    timer_mod: fn(Pointer, i64);
    qemu_system_reset_request: fn(c_int);
    qemu_register_reset: fn(extern "C" fn(Pointer), Pointer);
    qemu_system_shutdown_request: fn(c_int);
    cpu_physical_memory_rw: fn(u64, Pointer, u64, bool);
}

fn symbol(name: &str) -> Result<Pointer, String> {
    let c_name = CString::new(name).map_err(|e| e.to_string())?;
    // SAFETY: a null handle means the whole program; the name is a C string.
    let found = unsafe { dlsym(std::ptr::null_mut(), c_name.as_ptr()) };
    if found.is_null() {
        return Err(format!("this QEMU has no function {name}: QEMU 10 is needed"));
    }
    Ok(found)
}

/// The emulator around the board.
struct Machine {
    qemu: Qemu,
    interrupts: Pointer,
    timer: Pointer,
}

// SAFETY: QEMU calls back with its big lock held, from one thread at a time.
unsafe impl Send for Machine {}

/// Time skipped while the program polled, ns: the virtual clock is ahead of the instructions by it.
static SKIPPED_NS: AtomicI64 = AtomicI64::new(0);
static COUNTED_NS: OnceLock<unsafe extern "C" fn() -> i64> = OnceLock::new();

/// The new virtual clock: time of the instructions plus skipped time, ns.
extern "C" fn virtual_clock() -> i64 {
    // SAFETY: the function has no precondition.
    let counted_ns = COUNTED_NS.get().map_or(0, |count| unsafe { count() });
    counted_ns + SKIPPED_NS.load(Ordering::Relaxed)
}

/// Replaces QEMU's clock in the accelerator's function table by the clock above.
fn replace_clock(qemu: &Qemu) -> Result<(), String> {
    COUNTED_NS.get_or_init(|| qemu.icount_get);
    // SAFETY: the table is QEMU's, not constant, and longer than the part read; no other thread
    // runs yet.
    let table = unsafe { std::slice::from_raw_parts_mut((qemu.cpus_get_accel)(), TABLE_LEN) };
    let clock = table.iter_mut().find(|entry| **entry == qemu.icount_get as Pointer);
    let clock = clock.ok_or("this QEMU keeps its clock elsewhere: QEMU 10 is needed")?;
    *clock = virtual_clock as Pointer;
    Ok(())
}

static WORLD: OnceLock<Mutex<(Machine, Board)>> = OnceLock::new();

fn world() -> MutexGuard<'static, (Machine, Board)> {
    let world = WORLD.get().expect("callbacks come after the start");
    world.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

impl Memory for Machine {
    fn read(&mut self, address: u32, bytes: &mut [u8]) {
        let (place, length) = (bytes.as_mut_ptr().cast(), bytes.len() as u64);
        // SAFETY: QEMU writes this number of bytes there.
        unsafe { (self.qemu.cpu_physical_memory_rw)(address.into(), place, length, false) };
    }

    fn write(&mut self, address: u32, bytes: &[u8]) {
        let (place, length) = (bytes.as_ptr().cast_mut().cast(), bytes.len() as u64);
        // SAFETY: QEMU reads this number of bytes there and changes none.
        unsafe { (self.qemu.cpu_physical_memory_rw)(address.into(), place, length, true) };
    }
}

impl Emulator for Machine {
    fn now_ns(&self) -> u64 {
        // SAFETY: the function has no precondition.
        unsafe { (self.qemu.qemu_clock_get_ns)(VIRTUAL_CLOCK) }.max(0) as u64
    }

    fn set_interrupt(&mut self, number: u32, up: bool) {
        // SAFETY: the interrupt controller was found at the start and has 96 inputs.
        unsafe {
            let line = (self.qemu.qdev_get_gpio_in)(self.interrupts, number as c_int);
            (self.qemu.qemu_set_irq)(line, c_int::from(up));
        }
    }

    fn skip_to(&mut self, when_ns: u64) {
        // SAFETY: only reads; all kinds of timers.
        let due_ns = unsafe { (self.qemu.qemu_clock_deadline_ns_all)(VIRTUAL_CLOCK, -1) };
        let wanted_ns = when_ns.saturating_sub(self.now_ns());
        let skipped_ns = u64::try_from(due_ns).map_or(wanted_ns, |due_ns| wanted_ns.min(due_ns));
        SKIPPED_NS.fetch_add(skipped_ns as i64, Ordering::Relaxed);
        // SAFETY: only notifies the processor that its next interruption comes earlier.
        unsafe { (self.qemu.cpu_exit)((self.qemu.qemu_get_cpu)(0)) };
    }

    fn wake_at(&mut self, when_ns: u64) {
        // SAFETY: the timer was initialised at the start.
        unsafe { (self.qemu.timer_mod)(self.timer, when_ns as i64) };
    }

    fn move_stack(&mut self, to: u32) {
        const STACK_POINTER: c_int = 13;
        let bytes = to.to_le_bytes();
        // SAFETY: four bytes are read; the processor stands still during a timer's callback.
        unsafe {
            let cpu = (self.qemu.qemu_get_cpu)(0);
            (self.qemu.arm_cpu_gdb_write_register)(cpu, bytes.as_ptr(), STACK_POINTER);
        }
    }

    fn restart(&mut self) {
        // SAFETY: only requests the reset.
        unsafe { (self.qemu.qemu_system_reset_request)(GUEST_RESET) };
    }

    fn finish(&mut self) {
        // SAFETY: only requests the shutdown.
        unsafe { (self.qemu.qemu_system_shutdown_request)(HOST_QUIT) };
    }
}

extern "C" fn on_read(base: Pointer, offset: u64, value: *mut u64, size: u32, _: u64) -> u32 {
    let (machine, board) = &mut *world();
    let Some(read) = board.read(machine, base as usize as u32, offset as u32, size) else {
        return BUS_ERROR;
    };
    // SAFETY: QEMU passes a place for the value.
    unsafe { *value = read.into() };
    OK
}

extern "C" fn on_write(base: Pointer, offset: u64, value: u64, size: u32, _: u64) -> u32 {
    let (machine, board) = &mut *world();
    let written = board.write(machine, base as usize as u32, offset as u32, (size, value as u32));
    if written { OK } else { BUS_ERROR }
}

extern "C" fn on_timer(_: Pointer) {
    let (machine, board) = &mut *world();
    board.wake(machine);
}

extern "C" fn on_reset(_: Pointer) {
    let (machine, board) = &mut *world();
    let now_ns = machine.now_ns();
    board.restarted(now_ns);
    board.wake(machine);
}

/// Memory that QEMU keeps for ever.
fn leaked(length: usize) -> Pointer {
    Box::leak(vec![0_u128; length / 16].into_boxed_slice()).as_mut_ptr().cast()
}

/// Called when the processor exists: maps the peripherals over the machine's own.
extern "C" fn on_start(_: u64, _: u32) {
    if let Err(error) = start() {
        eprintln!("board model: {error}");
        std::process::exit(2);
    }
}

fn start() -> Result<(), String> {
    let qemu = Qemu::find()?;
    let text = std::fs::read(SETUP_FILE).map_err(|e| format!("{SETUP_FILE}: {e}"))?;
    let setup = serde_json::from_slice(&text).map_err(|e| format!("{SETUP_FILE}: {e}"))?;
    let board = Board::new(setup).map_err(|e| e.to_string())?;
    let path: &CStr = c"/machine/soc/armv7m";
    // SAFETY: the path is a C string; an unknown path is allowed.
    let interrupts = unsafe { (qemu.object_resolve_path)(path.as_ptr(), std::ptr::null_mut()) };
    if interrupts.is_null() {
        return Err("this machine has no interrupt controller where b-l475e-iot01a has it".into());
    }
    replace_clock(&qemu)?;
    let timer = leaked(TIMER_LEN);
    let machine = Machine { qemu, interrupts, timer };
    if WORLD.set(Mutex::new((machine, board))).is_err() {
        return Err("started twice".into());
    }
    for base in BASES {
        let region = leaked(REGION_LEN);
        let opaque = base as usize as Pointer;
        // SAFETY: region, functions and name live for ever; the callbacks use the base address as a
        // number only.
        unsafe {
            let system = (qemu.get_system_memory)();
            let name = c"board-model".as_ptr();
            let none = std::ptr::null_mut();
            (qemu.memory_region_init_io)(region, none, &FUNCTIONS, opaque, name, REGION_SIZE);
            (qemu.memory_region_add_subregion_overlap)(system, base.into(), region, 1);
        }
    }
    let none = std::ptr::null_mut();
    // SAFETY: the timer has room and lives for ever; both callbacks ignore their argument.
    unsafe {
        (qemu.timer_init_full)(timer, none, VIRTUAL_CLOCK, 1, 0, on_timer, none);
        (qemu.timer_mod)(timer, 1);
        (qemu.qemu_register_reset)(on_reset, none);
    }
    Ok(())
}

/// Entry point that QEMU calls after loading the plugin.
#[unsafe(no_mangle)]
pub extern "C" fn qemu_plugin_install(
    id: u64,
    _info: *const c_void,
    _count: c_int,
    _arguments: *mut *mut c_char,
) -> c_int {
    match Qemu::find() {
        Ok(qemu) => {
            // SAFETY: the id is QEMU's own.
            unsafe { (qemu.qemu_plugin_register_vcpu_init_cb)(id, on_start) };
            0
        }
        Err(error) => {
            eprintln!("board model: {error}");
            1
        }
    }
}
