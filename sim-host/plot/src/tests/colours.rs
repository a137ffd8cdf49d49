use crate::colour::{Colour, PALETTE, of_group, of_mode};
use staya_controller::names::Named as _;
use staya_controller::robot::Mode;
use staya_record::page;
use staya_record::scene::ColourBy;

fn text(name: &str) -> &'static str {
    page::file(name).unwrap_or_else(|| panic!("the page has no {name}"))
}

/// The names in quotation marks after `begin`, up to `end`.
fn quoted(begin: &str, end: &str) -> Vec<&'static str> {
    let list = text("look.js").split(begin).nth(1).unwrap().split(end).next().unwrap();
    list.split('"').skip(1).step_by(2).collect()
}

/// A colour of the page's light theme.
fn in_page(name: &str) -> Colour {
    let (_, value) = text("style.css").split_once(&format!("--{name}: #")).unwrap_or_else(|| panic!("no --{name}"));
    Colour::hex(u32::from_str_radix(&value[..6], 16).unwrap())
}

#[test]
fn pictures_have_the_colours_of_the_page() {
    let numbered = quoted("const NUMBERED = [", "]");
    assert_eq!(numbered.iter().map(|name| in_page(name)).collect::<Vec<_>>(), PALETTE);
    assert_eq!(numbered.len(), ColourBy::MOST_ROBOTS);
    assert_eq!([of_group(0), of_group(8)], [PALETTE[0], PALETTE[1]]);
    for (word, mode) in Mode::NAMES {
        let name = quoted(&format!("\n  {word}: "), ",")[0];
        assert_eq!(of_mode(*mode), in_page(name), "{word} is {name}");
    }
}
