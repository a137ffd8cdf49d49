//! Robots in small worlds, with the public interface of the crate alone.

mod common;
mod holonomic;
mod robot;
