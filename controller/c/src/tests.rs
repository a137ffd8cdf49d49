//! The library through its own functions, as C calls them.

mod header;
