//! STM32F405: USART1 on PA9 (TX) and PA10 (RX), 168 MHz from crystal or internal oscillator.
//!
//! The boot loader and QEMU's `netduinoplus2` use USART1 too. Sections and tables: ST's RM0090.

use super::{BAUD, Clocks, number};
use crate::ring::Ring;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::{NVIC, SCB, SYST, syst::SystClkSource};
use stm32_metapac::{DBGMCU, FLASH, GPIOA, IWDG, Interrupt, RCC, USART1, flash, gpio, iwdg, rcc};

pub const NAME: &str = "stm32f405";
/// 90 ms at 115200 baud.
pub static RECEIVED: Ring<1024> = Ring::new();

const HSI_HZ: u32 = 16_000_000;
const HSE_HZ: u32 = number(env!("STAYA_HSE_HZ"));
const PLL_HZ: u32 = 168_000_000;
const TX_PIN: usize = 9;
const RX_PIN: usize = 10;
/// Reads of a status bit before an oscillator counts as missing: tens of milliseconds.
const PATIENCE: u32 = 50_000;
/// More than one byte's time at 9600 baud.
const SEND_PATIENCE: u32 = 200_000;
/// 24 bits.
const SYSTICK_TOP: u32 = 0x00FF_FFFF;
static WRAPS: AtomicU32 = AtomicU32::new(0);

pub fn start() -> Clocks {
    let clock_hz = clocks();
    usart(if clock_hz == PLL_HZ { PLL_HZ / 2 } else { HSI_HZ });
    // SAFETY: nothing else takes the core's peripherals; it runs once, at the start.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(SYSTICK_TOP);
    core.SYST.clear_current();
    core.SYST.enable_counter();
    core.SYST.enable_interrupt();
    Clocks {
        clock_hz,
        // The emulator's SysTick always runs at 168 MHz.
        tick_hz: if is_emulated() { PLL_HZ } else { clock_hz },
    }
}

/// The device code is 0x413 on every STM32F405; QEMU has no debug unit and reads 0.
pub fn is_emulated() -> bool {
    DBGMCU.idcode().read().0 == 0
}

/// 168 MHz from either oscillator, else 16 MHz. Returns the clock, hertz.
fn clocks() -> u32 {
    RCC.cr().modify(|cr| cr.set_hseon(true));
    let crystal = comes(|| RCC.cr().read().hserdy());
    let (source, source_hz) = if crystal {
        (rcc::vals::Pllsrc::HSE, HSE_HZ)
    } else {
        RCC.cr().modify(|cr| cr.set_hseon(false));
        (rcc::vals::Pllsrc::HSI, HSI_HZ)
    };
    RCC.pllcfgr().write(|pll| {
        pll.set_pllsrc(source);
        // 1 MHz in, 336 MHz inside, 168 MHz out; 48 MHz for USB (section 7.3.2).
        pll.set_pllm(rcc::vals::Pllm::from_bits((source_hz / 1_000_000) as u8));
        pll.set_plln(rcc::vals::Plln::from_bits(336));
        pll.set_pllp(rcc::vals::Pllp::DIV2);
        pll.set_pllq(rcc::vals::Pllq::DIV7);
    });
    RCC.cr().modify(|cr| cr.set_pllon(true));
    if !comes(|| RCC.cr().read().pllrdy()) {
        RCC.cr().modify(|cr| cr.set_pllon(false));
        return HSI_HZ;
    }
    // Flash is slower: it needs five wait states at 3.3 V (table 10), set before the switch.
    FLASH.acr().modify(|acr| {
        acr.set_latency(flash::vals::Latency::WS5);
        acr.set_prften(true);
        acr.set_icen(true);
        acr.set_dcen(true);
    });
    RCC.cfgr().modify(|cfgr| {
        cfgr.set_hpre(rcc::vals::Hpre::DIV1);
        cfgr.set_ppre1(rcc::vals::Ppre::DIV4); // 42 MHz at most
        cfgr.set_ppre2(rcc::vals::Ppre::DIV2); // 84 MHz at most
        cfgr.set_sw(rcc::vals::Sw::PLL1_P);
    });
    if comes(|| RCC.cfgr().read().sws() == rcc::vals::Sw::PLL1_P) { PLL_HZ } else { HSI_HZ }
}

/// Polls a bounded number of times; whether the condition came true.
fn comes(mut is_so: impl FnMut() -> bool) -> bool {
    (0..PATIENCE).any(|_| is_so())
}

/// 8 bits, no parity, one stop bit, an interrupt per received byte.
fn usart(bus_hz: u32) {
    RCC.ahb1enr().modify(|enable| enable.set_gpioaen(true));
    RCC.apb2enr().modify(|enable| enable.set_usart1en(true));
    // A newly enabled clock needs two cycles (section 7.3.14), which the read takes.
    let _ = RCC.apb2enr().read();
    // Not a loop, in which the compiler could not prove that the registers have these fields.
    GPIOA.afr(1).modify(|afr| {
        afr.set_afr(TX_PIN - 8, 7); // AF7: USART1
        afr.set_afr(RX_PIN - 8, 7);
    });
    GPIOA.moder().modify(|moder| {
        moder.set_moder(TX_PIN, gpio::vals::Moder::ALTERNATE);
        moder.set_moder(RX_PIN, gpio::vals::Moder::ALTERNATE);
    });
    // An open input would receive noise.
    GPIOA.pupdr().modify(|pupdr| pupdr.set_pupdr(RX_PIN, gpio::vals::Pupdr::PULL_UP));
    // Oversampling by 16: the register holds the ratio in sixteenths, so bus / baud.
    USART1.brr().write(|brr| brr.0 = (bus_hz + BAUD / 2) / BAUD);
    USART1.cr1().write(|cr1| {
        cr1.set_ue(true);
        cr1.set_te(true);
        cr1.set_re(true);
        cr1.set_rxneie(true);
    });
    // SAFETY: the handler is below and shares only the ring.
    unsafe { NVIC::unmask(Interrupt::USART1) };
}

/// Reading SR, then DR, clears every flag that can have raised it.
// SAFETY: the PAC's interrupt table has this name for it; a handler without arguments.
#[unsafe(export_name = "USART1")]
extern "C" fn on_usart() {
    let status = USART1.sr().read();
    if status.ore() {
        RECEIVED.lose();
    }
    if status.rxne() || status.ore() {
        let byte = USART1.dr().read().0 as u8;
        if status.rxne() {
            RECEIVED.push(byte);
        }
    }
}

#[cortex_m_rt::exception]
fn SysTick() {
    // There is one writer, so a load and a store are enough.
    WRAPS.store(WRAPS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
}

pub fn ticks() -> u32 {
    loop {
        let wraps = WRAPS.load(Ordering::Relaxed);
        let left = SYST::get_current();
        // SysTick may have wrapped while its interrupt is still pending.
        let pending = SCB::is_pendst_pending() && left > SYSTICK_TOP / 2;
        if wraps == WRAPS.load(Ordering::Relaxed) {
            let wraps = wraps.wrapping_add(u32::from(pending));
            return (wraps << 24).wrapping_add(SYSTICK_TOP.wrapping_sub(left));
        }
    }
}

/// Reception is always enabled.
pub fn listen() {}

pub fn send(byte: u8) -> bool {
    let has_room = (0..SEND_PATIENCE).any(|_| USART1.sr().read().txe());
    if has_room {
        USART1.dr().write(|dr| dr.0 = u32::from(byte));
    }
    has_room
}

pub fn flush() {
    let _ = (0..SEND_PATIENCE).any(|_| USART1.sr().read().tc());
}

/// With interrupts masked, an interrupt after the check still ends the wait.
pub fn sleep_unless(is_due: impl FnOnce() -> bool) {
    cortex_m::interrupt::free(|_| {
        if !is_due() {
            cortex_m::asm::wfi();
        }
    });
}

/// Its own 32 kHz (17 to 47) / 64, 2048 steps: four seconds (section 21.3); pauses in the debugger.
pub fn start_watchdog() {
    DBGMCU.apb1fzr().modify(|freeze| freeze.set_iwdg(true));
    // The watchdog accepts the two values only once its oscillator runs.
    IWDG.kr().write(|kr| kr.set_key(iwdg::vals::Key::START));
    IWDG.kr().write(|kr| kr.set_key(iwdg::vals::Key::ENABLE));
    IWDG.pr().write(|pr| pr.set_pr(iwdg::vals::Pr::DIVIDE_BY64));
    IWDG.rlr().write(|rlr| rlr.set_rl(2047));
    let _ = comes(|| !IWDG.sr().read().pvu() && !IWDG.sr().read().rvu());
    feed_watchdog();
}

pub fn feed_watchdog() {
    IWDG.kr().write(|kr| kr.set_key(iwdg::vals::Key::RESET));
}

pub fn reset() -> ! {
    SCB::sys_reset()
}
