//! Command lines made of the words of this process.

use crate::args::quoted;

/// Options of a system.
pub(super) const SYSTEM: [&str; 5] = ["--system", "--force", "--set", "--q", "--v"];

/// Returns the command line that repeats this request, without the options of its output.
pub(super) fn command_line() -> String {
    quoted(repeated())
}

/// Returns the same command line with a value of an option, in place of the given one.
pub(super) fn with_option(option: &str, value: &str) -> String {
    quoted(without(repeated(), option).chain([option.to_owned(), value.to_owned()]).collect())
}

/// Returns the same command line with a value of an option that may begin with a minus.
pub(super) fn with_joined_option(option: &str, value: &str) -> String {
    quoted(without(repeated(), option).chain([format!("{option}={value}")]).collect())
}

/// Returns the same command line with a flag.
pub(super) fn with_flag(flag: &str) -> String {
    let others = repeated().into_iter().filter(|word| word != flag);
    quoted(others.chain([flag.to_owned()]).collect())
}

/// Returns a command line of another subcommand: of the options those that are given, with their values, and `more` words.
pub(super) fn of_subcommand(name: &str, options: &[&str], more: &[&str]) -> String {
    let mut words = ["libration", name].map(str::to_owned).to_vec();
    let mut given = repeated().into_iter();
    while let Some(word) = given.next() {
        let option = word.split('=').next().unwrap_or_default().to_owned();
        if options.contains(&&*option) {
            let value = if option == word { given.next() } else { None };
            words.extend([word].into_iter().chain(value));
        }
    }
    words.extend(more.iter().map(ToString::to_string));
    quoted(words)
}

fn repeated() -> Vec<String> {
    let given = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let flags = ["--json", "--verbose", "-v"];
    let all = without(given.collect(), "--page").filter(|word| !flags.contains(&&**word));
    ["libration".to_owned()].into_iter().chain(all).collect()
}

/// The words without an option and its value.
fn without(words: Vec<String>, option: &str) -> impl Iterator<Item = String> {
    let (option, joined) = (option.to_owned(), format!("{option}="));
    let mut is_value = false;
    words.into_iter().filter(move |word| {
        let is_left_out = is_value || *word == option || word.starts_with(&joined);
        is_value = !is_value && *word == option;
        !is_left_out
    })
}
