//! Common parts of the firmware programs: start-up, tick counter, UART, stack depth, logs, faults.
//!
//! One library for three parts, selected by the target triple:
//!
//! | part | triple | emulated by QEMU as |
//! | --- | --- | --- |
//! | STM32F405 (Cortex-M4F) | `thumbv7em-none-eabihf` | `netduinoplus2` |
//! | nRF51 of the micro:bit (Cortex-M0) | `thumbv6m-none-eabi` | `microbit` |
//! | RISC-V without an FPU | `riscv32imac-unknown-none-elf` | `virt` |
//!
//! `cargo xtask firmware` builds the programs. Built for the host, each program only prints this.
#![cfg_attr(not(test), no_std)]

pub mod ring;

// For the macros; cortex-m-rt's macro needs that crate in the caller's dependencies.
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
#[cfg(target_os = "none")]
pub mod swarms;

/// Makes `$run`, a `fn() -> !`, the part's program after reset. On the host, the program prints how
/// to build it, and `$run` may be missing.
#[macro_export]
macro_rules! entry {
    ($run:path) => {
        // SAFETY: `main` is called once stack and statics are set up; the name is unique.
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

/// Defines a complete firmware for a robot with the user-defined guidance law `$law`, which
/// `staya hil` and its library step over the part's serial line.
///
/// The law is a `LinkedLaw` of `staya_link::own` in the number format that the firmware is built
/// for (`lockstep::Number`; `Q16` on the nRF51). On Arm the crate needs the dependency
/// `cortex-m-rt` (with its feature `device`). Name and version are those of the calling package. It
/// links only if no panic is reachable, except in debug builds.
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

/// Like `lockstep!`, for any robot with a `const fn new()`, frames of at most `$content` bytes of
/// content, and the name `$firmware`.
#[doc(hidden)]
#[macro_export]
macro_rules! lockstep_as {
    ($robot:ty, $content:expr, $firmware:expr) => {
        $crate::entry!(staya_program::run);
        // The linker proves that no panic is reachable. A debug build contains its debug checks.
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

            // SAFETY: no other section has this name; the linker script keeps it out of the image.
            #[unsafe(link_section = ".staya")]
            #[used]
            static NOTE: $crate::lockstep::Note = $crate::lockstep::note(FIRMWARE);

            /// Too large for the stack. The description of the part follows at runtime.
            static mut SESSION: $crate::link::session::Session<$robot, { $content }> =
                $crate::link::session::Session::unnamed(<$robot>::new());

            pub fn run() -> ! {
                // SAFETY: the only use of the static, and it runs once.
                let session = unsafe { &mut *core::ptr::addr_of_mut!(SESSION) };
                $crate::lockstep::run(session, FIRMWARE)
            }
        }
    };
}

/// Reports panics and processor exceptions as faults over the link, then resets the part.
#[macro_export]
macro_rules! faults_go_over_the_link {
    () => {
        $crate::on_fault!($crate::fault::over_the_link);
    };
}

/// Reports processor exceptions as faults over the link, then resets the part.
#[macro_export]
macro_rules! exceptions_go_over_the_link {
    () => {
        $crate::on_exception!($crate::fault::over_the_link);
    };
}

/// Prints panics and processor exceptions, then ends the emulator with code 101 or stops a board.
#[macro_export]
macro_rules! faults_are_printed {
    () => {
        $crate::on_fault!($crate::fault::printed);
    };
}

/// Makes linking fail if a panic is reachable: the panic handler calls an undefined function.
#[macro_export]
macro_rules! panics_do_not_link {
    () => {
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            unsafe extern "C" {
                fn staya_panic_is_reachable() -> !;
            }
            // SAFETY: never executed, because a program with this call does not link.
            unsafe { staya_panic_is_reachable() }
        }
    };
}

/// Passes panics and exceptions to `$report`, a `fn(impl Display) -> !`.
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

/// Passes exceptions to `$report`, a `fn(impl Display) -> !`.
#[doc(hidden)]
#[macro_export]
macro_rules! on_exception {
    ($report:path) => {
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        #[cortex_m_rt::exception]
        unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
            $report($crate::fault::trap(frame.pc()))
        }

        // SAFETY: name and argument are those of riscv-rt's default exception handler.
        #[cfg(all(target_os = "none", target_arch = "riscv32"))]
        #[unsafe(export_name = "ExceptionHandler")]
        extern "C" fn exception(_: &$crate::riscv_rt::TrapFrame) -> ! {
            $report($crate::fault::trap($crate::riscv::register::mepc::read() as u32))
        }
    };
}
