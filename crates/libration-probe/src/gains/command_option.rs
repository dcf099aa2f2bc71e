//! Options of commands.
//!
//! It uses nothing of the crate: the tests of `tests/probe` compile it alone, in place of the whole crate once more.

/// Whether a text is a command of a terminal.
pub(super) fn is_command(text: &str) -> bool {
    text.starts_with("libration ") && !text.contains(['`', '\n'])
}

/// A command with the value of an option, in place of the given one; none if it is no command of a terminal.
pub(super) fn with_option(command: &str, option: &str, value: &str) -> Option<String> {
    if !is_command(command) {
        return None;
    }
    let mut words = command.split(' ');
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        match word.strip_prefix(option) {
            // The value is a number or a name, without spaces.
            Some("") => drop(words.next()),
            Some(rest) if rest.starts_with('=') => {}
            _ => kept.push(word),
        }
    }
    kept.extend([option, value]);
    Some(kept.join(" "))
}

/// A command with a flag; none if it has it, or is no command of a terminal.
pub(super) fn with_flag(command: &str, flag: &str) -> Option<String> {
    let has = command.split(' ').any(|word| word == flag);
    (is_command(command) && !has).then(|| format!("{command} {flag}"))
}

#[cfg(test)]
mod tests {
    use super::{with_flag, with_option};

    #[test]
    fn an_option_takes_the_place_of_the_given_one() {
        let with = |command: &str| with_option(command, "--substeps", "4");
        for command in
            ["libration gains --substeps 2 --dt 1", "libration gains --substeps=2 --dt 1"]
        {
            assert_eq!(with(command).as_deref(), Some("libration gains --dt 1 --substeps 4"));
        }
        assert_eq!(with("libration.gains(model)"), None);
        let settled = with_flag("libration gains --dt 1", "--settle");
        assert_eq!(settled.as_deref(), Some("libration gains --dt 1 --settle"));
        assert_eq!(with_flag("libration gains --settle", "--settle"), None);
    }
}
