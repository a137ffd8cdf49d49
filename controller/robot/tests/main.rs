//! Robots in small worlds, using only the public interface of the crate.

mod common;
mod holonomic;
mod robot;
