//! Prints `case number hash steps` for each case and kind of number: the table that every target must give.

fn main() {
    staya_cases::every(|name, number, summary| {
        println!("{name} {number} {:016x} {}", summary.hash, summary.steps);
    });
}
