//! QEMU's machine `virt`: a 16550 UART (PC16550D) behind the platform-level interrupt controller
//! (PLIC 1.0.0). Addresses: QEMU's `hw/riscv/virt.c`.

use super::Clocks;
use crate::ring::Ring;
use riscv::register::{mie, minstret, mstatus};

pub const NAME: &str = "riscv32";
pub static RECEIVED: Ring<1024> = Ring::new();

/// `minstret` counts instructions, 1 ns each as with `-icount shift=0`.
const TICK_HZ: u32 = 1_000_000_000;
/// The most bytes taken in one interrupt.
const FIFO: usize = 16;
/// Enabled, both sides cleared, an interrupt at 14 bytes or after a pause of four byte times:
/// several times as fast in the emulator as single bytes.
const FIFO_ON: u8 = 0b1100_0111;
/// Access to the divisor in place of the data, and 8 bits per byte.
const SHOW_DIVISOR: u8 = 1 << 7;
const EIGHT_BITS: u8 = 3;
/// Seconds: the host may read slowly.
const SEND_PATIENCE: u32 = 5_000_000;

#[derive(Clone, Copy)]
struct Register<T>(usize, core::marker::PhantomData<T>);

impl<T: Copy> Register<T> {
    const fn at(address: usize) -> Self {
        Self(address, core::marker::PhantomData)
    }

    fn read(self) -> T {
        // SAFETY: only the constants below are registers: mapped, aligned and of this width.
        unsafe { (self.0 as *const T).read_volatile() }
    }

    fn write(self, value: T) {
        // SAFETY: as above.
        unsafe { (self.0 as *mut T).write_volatile(value) }
    }
}

const UART: usize = 0x1000_0000;
const UART_DATA: Register<u8> = Register::at(UART);
const UART_INTERRUPTS: Register<u8> = Register::at(UART + 1);
const UART_FIFO: Register<u8> = Register::at(UART + 2);
const UART_LINE: Register<u8> = Register::at(UART + 3);
const UART_STATUS: Register<u8> = Register::at(UART + 5);
const UART_IRQ: u32 = 10;
/// Byte received, byte lost, transmitter ready, all bytes sent.
const RECEIVED_ONE: u8 = 1;
const OVERRUN: u8 = 1 << 1;
const HAS_ROOM: u8 = 1 << 5;
const ALL_SENT: u8 = 1 << 6;

const PLIC: usize = 0x0C00_0000;
const PLIC_PRIORITY: Register<u32> = Register::at(PLIC + 4 * UART_IRQ as usize);
const PLIC_ENABLE: Register<u32> = Register::at(PLIC + 0x2000);
const PLIC_THRESHOLD: Register<u32> = Register::at(PLIC + 0x20_0000);
const PLIC_CLAIM: Register<u32> = Register::at(PLIC + 0x20_0004);

/// SiFive's test device; this value resets the machine.
const TEST: Register<u32> = Register::at(0x0010_0000);
const TEST_RESET: u32 = 0x7777;

pub fn start() -> Clocks {
    // The divisor determines only the pause after which a partly filled FIFO is delivered.
    UART_LINE.write(SHOW_DIVISOR | EIGHT_BITS);
    UART_DATA.write(1);
    UART_INTERRUPTS.write(0); // the divisor's upper half
    UART_LINE.write(EIGHT_BITS);
    UART_FIFO.write(FIFO_ON);
    UART_INTERRUPTS.write(1); // a byte was received
    PLIC_PRIORITY.write(1);
    PLIC_THRESHOLD.write(0);
    PLIC_ENABLE.write(1 << UART_IRQ);
    // SAFETY: the handler is below and shares only the ring.
    unsafe {
        mie::set_mext();
        mstatus::set_mie();
    }
    Clocks { clock_hz: TICK_HZ, tick_hz: TICK_HZ }
}

pub fn is_emulated() -> bool {
    true
}

#[riscv_rt::core_interrupt(riscv::interrupt::Interrupt::MachineExternal)]
fn uart() {
    let source = PLIC_CLAIM.read();
    for _ in 0..FIFO {
        let status = UART_STATUS.read();
        if status & OVERRUN != 0 {
            RECEIVED.lose();
        }
        if status & RECEIVED_ONE == 0 {
            break;
        }
        RECEIVED.push(UART_DATA.read());
    }
    PLIC_CLAIM.write(source);
}

pub fn ticks() -> u32 {
    minstret::read() as u32
}

/// Reception is always enabled.
pub fn listen() {}

pub fn send(byte: u8) -> bool {
    let has_room = (0..SEND_PATIENCE).any(|_| UART_STATUS.read() & HAS_ROOM != 0);
    if has_room {
        UART_DATA.write(byte);
    }
    has_room
}

pub fn flush() {
    let _ = (0..SEND_PATIENCE).any(|_| UART_STATUS.read() & ALL_SENT != 0);
}

/// With interrupts masked, an interrupt after the check still ends the wait.
pub fn sleep_unless(is_due: impl FnOnce() -> bool) {
    riscv::interrupt::free(|| {
        if !is_due() {
            riscv::asm::wfi();
        }
    });
}

/// The machine has no watchdog.
pub fn start_watchdog() {}

pub fn feed_watchdog() {}

pub fn reset() -> ! {
    TEST.write(TEST_RESET);
    loop {
        riscv::asm::wfi();
    }
}
