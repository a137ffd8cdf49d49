//! Prints `case number hash steps` for each case and number format: the table that every target
//! must reproduce.

fn main() {
    staya_cases::every(|name, number, summary| {
        println!("{name} {number} {:016x} {}", summary.hash, summary.steps);
    });
}
