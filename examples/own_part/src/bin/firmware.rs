//! Firmware with this law for an STM32F405, an nRF51 or a RISC-V part:
//! `cargo xtask firmware --crate examples/own_part`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::lockstep!(patrol::Patrol);
