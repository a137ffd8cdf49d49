//! The command line of a command, read as its usage line says.

/// The options and names of a command line.
#[derive(Debug, Default, PartialEq)]
pub struct Options<'a> {
    /// Options with their values; a flag has an empty one.
    values: Vec<(&'a str, &'a str)>,
    /// Arguments that are not options.
    pub names: Vec<&'a str>,
}

impl<'a> Options<'a> {
    /// Reads arguments by a usage line such as `soak [--debug] [--minutes N] [flood|key...]`: a
    /// flag, an option with a value (`N`: a number above 0), and names: `NAME` for one of any kind,
    /// several where dots follow, those of a list where the line has a list.
    pub fn read(usage: &str, arguments: &[&'a str]) -> Result<Self, String> {
        let words: Vec<&str> = usage.split_whitespace().skip(1).collect();
        let names = words.iter().enumerate().find(|(at, word)| {
            let is_value = at.checked_sub(1).is_some_and(|before| is_open(words[before]));
            !word.contains("--") && !is_value
        });
        let names = names.map(|(_, word)| word.trim_matches(['[', ']']));
        let mut options = Self::default();
        let mut arguments = arguments.iter().copied();
        while let Some(argument) = arguments.next() {
            let bare = |word: &&str| word.trim_matches(['[', ']']) == argument;
            if let Some(at) = words.iter().position(|word| word.contains("--") && bare(word)) {
                let wanted = words.get(at + 1).filter(|_| is_open(words[at])).map(|word| word.trim_end_matches(']'));
                let value = match wanted {
                    Some(wanted) => arguments.next().ok_or_else(|| format!("{argument} needs a value: {wanted}"))?,
                    None => "",
                };
                let is_number = value.parse().is_ok_and(|n: f64| n > 0.0 && n.is_finite());
                if wanted == Some("N") && !is_number {
                    return Err(format!("{argument} needs a number above 0, not `{value}`"));
                }
                options.values.push((argument, value));
            } else {
                let names = names.filter(|_| !argument.starts_with('-'));
                let names = names.ok_or_else(|| format!("cannot understand `{argument}`"))?;
                let list = names.trim_end_matches('.');
                if names == list && !options.names.is_empty() {
                    return Err(format!("one name is enough: what is `{argument}`?"));
                }
                if list != "NAME" && !list.split('|').any(|name| name == argument) {
                    return Err(format!("`{argument}` is none of {list}"));
                }
                options.names.push(argument);
            }
        }
        Ok(options)
    }

    /// Whether an option is there.
    pub fn has(&self, option: &str) -> bool {
        self.value(option).is_some()
    }

    /// The value of an option.
    pub fn value(&self, option: &str) -> Option<&'a str> {
        self.all(option).next()
    }

    /// The values of an option that can be given several times.
    pub fn all(&self, option: &str) -> impl Iterator<Item = &'a str> {
        self.values.iter().filter(move |(name, _)| *name == option).map(|(_, value)| *value)
    }

    /// These options with their values, as on a command line.
    pub fn all_of(&self, options: &[&str]) -> impl Iterator<Item = &'a str> {
        self.values.iter().filter(|(option, _)| options.contains(option)).flat_map(|&(option, value)| [option, value])
    }

    /// The first name.
    pub fn name(&self) -> Option<&'a str> {
        self.names.first().copied()
    }
}

/// Whether a word of a usage line is an option whose value follows.
fn is_open(word: &str) -> bool {
    word.starts_with("[--") && !word.ends_with(']')
}

#[cfg(test)]
mod tests {
    use super::*;

    const USAGE: &str = "soak [--debug] [--minutes N] [--json FILE] [flood|key...]";

    #[test]
    fn options_values_and_names_are_read() {
        let options = Options::read(USAGE, &["--minutes", "0.5", "flood", "--json", "a.json", "key"]).expect("sound");
        assert_eq!((options.value("--minutes"), options.value("--json")), (Some("0.5"), Some("a.json")));
        assert_eq!((options.names.as_slice(), options.has("--debug")), (["flood", "key"].as_slice(), false));
        assert!(Options::read(USAGE, &["--debug"]).is_ok_and(|options| options.has("--debug")));
        assert_eq!(Options::read("bench [NAME]", &["orca"]).map(|options| options.name()), Ok(Some("orca")));
        assert_eq!(Options::read("check", &[]), Ok(Options::default()));
    }

    #[test]
    fn what_the_usage_line_does_not_have_is_refused() {
        for wrong in [&["--minutes"][..], &["--minutes", "0"], &["--minutes", "x"], &["--json"], &["--all"], &["flod"]]
        {
            assert!(Options::read(USAGE, wrong).is_err(), "{wrong:?}");
        }
        assert!(Options::read("bench [NAME]", &["orca", "flock"]).is_err());
        assert!(Options::read("check", &["orca"]).is_err());
    }
}
