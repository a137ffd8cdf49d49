use super::*;

#[test]
fn sizes_are_as_documented() {
    std::println!(
        "route {} formation {} workspace {}",
        size_of::<RouteAgent>(),
        size_of::<FormationAgent>(),
        size_of::<GridWorkspace<CELLS>>()
    );
}
