//! What the firmware's programs share: start-up, clock ticks, the UART, the stack's depth, logs, faults.
//!
//! One library for three parts, chosen by the target triple:
//!
//! | part | triple | emulated by QEMU as |
//! | --- | --- | --- |
//! | STM32F405 (Cortex-M4F) | `thumbv7em-none-eabihf` | `netduinoplus2` |
//! | nRF51 of the micro:bit (Cortex-M0) | `thumbv6m-none-eabi` | `microbit` |
//! | RISC-V without an FPU | `riscv32imac-unknown-none-elf` | `virt` |
//!
//! `cargo xtask firmware` builds them. Built for the host, each program only says so.
#![cfg_attr(not(test), no_std)]

pub mod ring;

// For the macros, wherever they are used; cortex-m-rt's own macro asks for the crate itself there.
#[doc(hidden)]
#[cfg(target_os = "none")]
pub use staya_link as link;
#[doc(hidden)]
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
pub use {riscv, riscv_rt};

#[cfg(target_os = "none")]
mod boots;
#[cfg(target_os = "none")]
pub mod fault;
#[cfg(target_os = "none")]
pub mod lockstep;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod part;
#[cfg(target_os = "none")]
pub mod runtime;
#[cfg(target_os = "none")]
pub mod stack;

/// Makes `$run`, a `fn() -> !`, what the part runs after reset. On the host the program gets a
/// `main` that says how it is built for a part, and `$run` need not be there.
#[macro_export]
macro_rules! entry {
    ($run:path) => {
        // SAFETY: `main` is the one symbol that cortex-m-rt and riscv-rt call after they have set
        // up the stack and the statics; no other function of the program has this name.
        #[cfg(target_os = "none")]
        #[unsafe(export_name = "main")]
        extern "C" fn start_of_program() -> ! {
            $run()
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            eprintln!(concat!(env!("CARGO_BIN_NAME"), " is firmware for microcontrollers: `cargo xtask firmware`, in Staya's repository, builds it for the parts."));
            std::process::exit(2);
        }
    };
}

/// A whole firmware whose robot goes by a guidance law of one's own, `$law`: `staya hil` and its library step it over the part's serial
/// line. On Arm the crate needs `cortex-m-rt` (with its feature `device`) among its dependencies. The law is a `LinkedLaw` of `staya_link::own` in the part's numbers (`f32`, on the nRF51 `Q16`). The firmware calls
/// itself by name and version of the package that it is written in, and links only if no panic is reachable, unless it is built for
/// debugging.
///
/// ```text
/// #![cfg_attr(target_os = "none", no_std, no_main)]
/// staya_firmware::lockstep!(my_crate::MyLaw);
/// ```
#[macro_export]
macro_rules! lockstep {
    ($law:ty) => {
        $crate::lockstep_as!(
            $crate::lockstep::Own<$law>,
            $crate::lockstep::OWN_CONTENT,
            concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"))
        );
    };
}

/// The same for any robot that has a `const fn new()`, with frames of at most `$content` bytes, under this name.
#[doc(hidden)]
#[macro_export]
macro_rules! lockstep_as {
    ($robot:ty, $content:expr, $firmware:expr) => {
        $crate::entry!(staya_program::run);
        // What is flashed has no panic, which the linker has seen: start-up, interrupts, logs and exceptions included. Built for
        // debugging it has those of the checks that are on then.
        #[cfg(debug_assertions)]
        $crate::faults_go_over_the_link!();
        #[cfg(not(debug_assertions))]
        $crate::panics_do_not_link!();
        #[cfg(not(debug_assertions))]
        $crate::exceptions_go_over_the_link!();

        #[cfg(target_os = "none")]
        mod staya_program {
            #[allow(unused_imports, reason = "the robot may be named by a whole path")]
            use super::*;

            const FIRMWARE: &str = $firmware;

            // SAFETY: no other section has this name; the linker script takes it out of what is loaded.
            #[unsafe(link_section = ".staya")]
            #[used]
            static NOTE: $crate::lockstep::Note = $crate::lockstep::note(FIRMWARE);

            /// Too large for a stack, so made where it stays; what the part is, is known only later.
            static mut SESSION: $crate::link::session::Session<$robot, { $content }> =
                $crate::link::session::Session::unnamed(<$robot>::new());

            pub fn run() -> ! {
                // SAFETY: the only place that names it, which runs once.
                let session = unsafe { &mut *core::ptr::addr_of_mut!(SESSION) };
                $crate::lockstep::run(session, FIRMWARE)
            }
        }
    };
}

/// A panic and an exception of the processor are said over the link as a fault, then the part
/// starts anew.
#[macro_export]
macro_rules! faults_go_over_the_link {
    () => {
        $crate::on_fault!($crate::fault::over_the_link);
    };
}

/// An exception of the processor is said over the link as a fault, then the part starts anew.
#[macro_export]
macro_rules! exceptions_go_over_the_link {
    () => {
        $crate::on_exception!($crate::fault::over_the_link);
    };
}

/// A panic and an exception of the processor are printed, and end the emulator with exit code 101.
/// On a board they are printed over RTT, and the part stops.
#[macro_export]
macro_rules! faults_are_printed {
    () => {
        $crate::on_fault!($crate::fault::printed);
    };
}

/// No panic is left: the panic handler calls a function that exists nowhere, which the linker notices unless the optimiser has
/// thrown the handler out.
#[macro_export]
macro_rules! panics_do_not_link {
    () => {
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            unsafe extern "C" {
                /// Defined nowhere.
                fn staya_panic_is_reachable() -> !;
            }
            // SAFETY: never called: a program in which this call is left does not link.
            unsafe { staya_panic_is_reachable() }
        }
    };
}

/// Gives panics and exceptions to `$report`, a `fn(impl Display) -> !`.
#[doc(hidden)]
#[macro_export]
macro_rules! on_fault {
    ($report:path) => {
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
            $report($crate::fault::Panic(info))
        }

        $crate::on_exception!($report);
    };
}

/// Gives exceptions to `$report`, a `fn(impl Display) -> !`.
#[doc(hidden)]
#[macro_export]
macro_rules! on_exception {
    ($report:path) => {
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        #[cortex_m_rt::exception]
        unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
            $report($crate::fault::trap(frame.pc()))
        }

        // SAFETY: the name and the argument that riscv-rt gives to what handles every exception
        // that has no handler of its own.
        #[cfg(all(target_os = "none", target_arch = "riscv32"))]
        #[unsafe(export_name = "ExceptionHandler")]
        extern "C" fn exception(_: &$crate::riscv_rt::TrapFrame) -> ! {
            $report($crate::fault::trap($crate::riscv::register::mepc::read() as u32))
        }
    };
}
