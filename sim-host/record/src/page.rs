//! A page with a recording inside: one HTML file that needs no server and no network.
//!
//! Its modules import each other by `staya/NAME.js`; here these names stand for `data:` URLs in an import map.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use std::fmt::Write as _;

/// The page's files, by name.
pub const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/web.rs"));
/// The page itself.
const INDEX: &str = "index.html";

/// A file of the page, as a server sends it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name in the address; empty for the page itself.
    pub name: &'static str,
    /// Its media type.
    pub kind: &'static str,
    /// Its contents; in HTML, `NONCE` stands for a number that is drawn for each answer.
    pub text: String,
}

/// A page that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PageError {
    /// A file of the page is not there.
    #[error("this program was built without the page's {0}; build it from a whole copy of the sources")]
    File(&'static str),
    /// The page has no place for a part.
    #[error("the page has no mark <!-- staya:{0} -->; build the program from a whole copy of the sources")]
    Mark(&'static str),
}

/// A file of the page.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The page with a recording inside. O(bytes).
///
/// # Errors
/// The program was built without the page.
pub fn with_recording(recording: &[u8]) -> Result<String, PageError> {
    let index = file(INDEX).ok_or(PageError::File(INDEX))?;
    assemble(index, &inside(FILES, recording))
}

/// What the marks of the page stand for, each with its name.
type Parts = [(&'static str, String); 4];

/// Everything in one file.
fn inside(files: &[(&str, &str)], recording: &[u8]) -> Parts {
    let of_kind = |end: &'static str| files.iter().filter(move |(name, _)| name.ends_with(end));
    let style = of_kind(".css").fold(String::from("<style>"), |style, (_, text)| style + "\n" + text) + "</style>";
    let map = import_map(files, |_, text| format!("data:text/javascript;base64,{}", BASE64_STANDARD.encode(text)));
    let mut data = String::with_capacity(recording.len() * 4 / 3 + 128);
    data.push_str("<script type=\"application/octet-stream;base64\" id=\"recording\">");
    BASE64_STANDARD.encode_string(recording, &mut data);
    data.push_str("</script>");
    [
        ("importmap", format!("<script type=\"importmap\">{map}</script>")),
        ("style", style),
        ("recording", data),
        ("entry", "<script type=\"module\">import \"staya/main.js\";</script>".to_owned()),
    ]
}

/// Each file by itself, from a server that puts a number of its own into what stands in the page.
fn beside(files: &[(&str, &str)]) -> Parts {
    let map = import_map(files, |name, _| format!("/{name}"));
    let links = files.iter().filter(|(name, _)| name.ends_with(".css"));
    [
        ("importmap", format!("<script type=\"importmap\" nonce=\"NONCE\">{map}</script>")),
        ("style", links.map(|(name, _)| format!("<link rel=\"stylesheet\" href=\"/{name}\">")).collect()),
        ("recording", String::new()),
        ("entry", "<script type=\"module\" nonce=\"NONCE\">import \"staya/main.js\";</script>".to_owned()),
    ]
}

/// Where modules are by the names that they import each other by. Neither base64 nor names can end a script.
fn import_map(files: &[(&str, &str)], place: impl Fn(&str, &str) -> String) -> serde_json::Value {
    let modules = files.iter().filter(|(name, _)| name.ends_with(".js"));
    let imports = modules.map(|(name, text)| (format!("staya/{name}"), place(name, text).into()));
    serde_json::json!({ "imports": imports.collect::<serde_json::Map<_, _>>() })
}

/// The files of the page for a server.
///
/// # Errors
/// The program was built without the page.
pub fn served() -> Result<Vec<File>, PageError> {
    let index = file(INDEX).ok_or(PageError::File(INDEX))?;
    let page = File { name: "", kind: "text/html", text: assemble(index, &beside(FILES))? };
    let others = FILES.iter().filter(|(name, _)| *name != INDEX).map(|&(name, text)| File {
        name,
        kind: if name.ends_with(".css") { "text/css" } else { "text/javascript" },
        text: text.to_owned(),
    });
    Ok(std::iter::once(page).chain(others).collect())
}

/// Puts the parts where the marks are.
fn assemble(index: &str, parts: &Parts) -> Result<String, PageError> {
    let (mut page, mut rest) = (String::new(), index);
    while let Some((before, mark, behind)) = next_mark(rest) {
        page.push_str(before);
        match parts.iter().find(|(name, _)| *name == mark) {
            Some((_, part)) => page.push_str(part),
            None => drop(write!(page, "<!-- staya:{mark} -->")),
        }
        rest = behind;
    }
    page.push_str(rest);
    match parts.iter().find(|(name, _)| !index.contains(&format!("<!-- staya:{name} -->"))) {
        Some((name, _)) => Err(PageError::Mark(name)),
        None => Ok(page),
    }
}

/// What is before the next mark, its name, and what is behind it.
fn next_mark(text: &str) -> Option<(&str, &str, &str)> {
    let (before, from) = text.split_once("<!-- staya:")?;
    let (name, behind) = from.split_once(" -->")?;
    Some((before, name, behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "<!doctype html><!-- staya:style --><!-- staya:importmap --><body>\
                        <!-- staya:recording --><!-- staya:other --><!-- staya:entry --></body>";

    #[test]
    fn every_part_comes_to_its_mark() {
        let files =
            [("a.css", "p { color: red }"), ("main.js", "import \"staya/b.js\";"), ("b.js", "// <!-- staya:entry -->")];
        let page = assemble(PAGE, &inside(&files, b"STAYAREC")).unwrap();
        let parts = [
            "<!doctype",
            "p { color: red }",
            "\"staya/b.js\":\"data:text/javascript;base64,",
            "<body>",
            "U1RBWUFSRUM=</script>",
            "<!-- staya:other -->",
            "import \"staya/main.js\"",
            "</body>",
        ];
        let places: Vec<_> =
            parts.iter().map(|part| page.find(part).unwrap_or_else(|| panic!("{part} in {page}"))).collect();
        assert!(places.is_sorted(), "{places:?} in {page}");
        assert!(page.contains(&BASE64_STANDARD.encode("import \"staya/b.js\";")));
    }

    #[test]
    fn a_page_without_a_place_for_a_part_is_an_error() {
        let without = PAGE.replace("<!-- staya:recording -->", "");
        assert_eq!(assemble(&without, &inside(&[], b"")), Err(PageError::Mark("recording")));
    }
}
