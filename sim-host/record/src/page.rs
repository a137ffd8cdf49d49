//! A page with a recording: one HTML file without server and network. Its modules import each other
//! as `staya/NAME.js`, which an import map resolves to `data:` URLs.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use std::fmt::Write as _;

/// The files of the page with their names.
pub const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/web.rs"));
const INDEX: &str = "index.html";

/// A file of the page as a server sends it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Name in the URL; empty for the page itself.
    pub name: &'static str,
    /// Its media type.
    pub kind: &'static str,
    /// Content. In HTML, `NONCE` must be replaced by a random number for each response.
    pub text: String,
}

/// Why the page cannot be assembled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PageError {
    /// A file of the page is missing.
    #[error("the page's file {0} is missing; build the program from complete sources")]
    File(&'static str),
    /// The page lacks a placeholder.
    #[error("the page lacks the placeholder <!-- staya:{0} -->; build the program from complete sources")]
    Mark(&'static str),
}

/// The content of a file of the page; `None` for an unknown name.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Assembles the page with a recording inside. O(bytes).
///
/// # Errors
/// [`PageError`]: the program was built from incomplete sources.
pub fn with_recording(recording: &[u8]) -> Result<String, PageError> {
    let index = file(INDEX).ok_or(PageError::File(INDEX))?;
    assemble(index, &inside(FILES, recording))
}

type Parts = [(&'static str, String); 4];

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

/// The server replaces `NONCE`.
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

/// Neither base64 nor the names can contain the end of a script element.
fn import_map(files: &[(&str, &str)], place: impl Fn(&str, &str) -> String) -> serde_json::Value {
    let modules = files.iter().filter(|(name, _)| name.ends_with(".js"));
    let imports = modules.map(|(name, text)| (format!("staya/{name}"), place(name, text).into()));
    serde_json::json!({ "imports": imports.collect::<serde_json::Map<_, _>>() })
}

/// The files of the page for a server.
///
/// # Errors
/// [`PageError`]: the program was built from incomplete sources.
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

/// Text before the next placeholder, its name, text after it.
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
    fn every_placeholder_is_replaced() {
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
    fn a_missing_placeholder_is_an_error() {
        let without = PAGE.replace("<!-- staya:recording -->", "");
        assert_eq!(assemble(&without, &inside(&[], b"")), Err(PageError::Mark("recording")));
    }
}
