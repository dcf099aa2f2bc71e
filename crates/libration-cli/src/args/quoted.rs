//! Words of command lines.

/// The words as a line for a shell.
pub(crate) fn quoted(words: Vec<String>) -> String {
    let plain =
        |word: &str| word.chars().all(|c| c.is_ascii_alphanumeric() || "_-+=:,./@%".contains(c));
    let quoted = words.into_iter().map(|word| match plain(&word) && !word.is_empty() {
        true => word,
        // No argument of a process has a NUL in it.
        false => shlex::try_quote(&word).map(Into::into).unwrap_or_default(),
    });
    quoted.collect::<Vec<String>>().join(" ")
}
