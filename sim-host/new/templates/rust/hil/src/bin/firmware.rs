//! The law as firmware for an STM32F405 or a RISC-V that is stepped over its serial line.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::lockstep!(my_swarm::Law);
