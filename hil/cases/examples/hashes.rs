//! Prints the table that every target must reproduce: `case number commands bytes digest steps`.

fn main() {
    staya_cases::every(|name, number, summary| {
        println!("{name} {number} {summary}");
    });
}
