//! The law as firmware for an STM32F405 or a RISC-V, stepped over a serial line.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::lockstep!(my_swarm::MyLaw);
