//! Prints the table that every target must reproduce: `case number hash steps`.

fn main() {
    staya_cases::every(|name, number, summary| {
        println!("{name} {number} {:016x} {}", summary.hash, summary.steps);
    });
}
