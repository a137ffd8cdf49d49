//! staya
fn main() {}
