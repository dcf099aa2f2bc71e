//! Answers that fit a screen: the verdict, the numbers that decide, and what to do. `--verbose` prints the whole text.

mod advice;
mod comparison;
mod linear_advice;
mod linear_plant;
mod linear_steps;
mod loop_limits;
mod motion;
mod next_step;
mod step;
mod step_loop;
mod temperature;

pub(super) use advice::of_advice;
pub(super) use comparison::of_comparison;
pub(super) use linear_advice::of_linear_advice;
pub(super) use linear_plant::of_plant;
pub(super) use motion::energy_change;
pub(super) use step::{along_motion, named, no_phase_error, of_analysis};
pub(super) use temperature::of_temperatures;

use libration_report::printable::printable;

use super::digits::significant;
use super::repeat_command::with_option;
use crate::args::AdviseArgs;

/// Largest number of characters of a line.
const COLUMNS: usize = 100;

/// Characters of the names of rows.
const NAME: usize = 20;

/// The text of an answer.
struct Summary {
    text: String,
}

impl Summary {
    fn new(verdict: &str) -> Self {
        let mut summary = Summary { text: String::new() };
        summary.sentence(&in_decimals(verdict));
        summary
    }

    fn line_count(&self) -> usize {
        self.text.lines().count()
    }

    fn blank(&mut self) {
        self.text.push('\n');
    }

    fn sentence(&mut self, text: &str) {
        self.wrap("", text, 0);
    }

    fn warnings(&mut self, warnings: &[String]) {
        for warning in warnings {
            self.wrap("", &in_decimals(&format!("warning: {warning}")), 2);
        }
    }

    /// Says how many rows a table leaves out.
    fn rest(&mut self, more: usize) {
        if more > 0 {
            self.sentence(&format!("and {more} more"));
        }
    }

    fn row(&mut self, name: &str, value: &str) {
        self.wrap(&format!("{name:<NAME$} "), value, NAME + 1);
    }

    /// Appends rows under heads. A line that is too long ends with `…`.
    fn table(&mut self, columns: &[Column], rows: &[Vec<String>]) {
        let heads = || columns.iter().map(|column| column.head.to_owned()).collect::<Vec<_>>();
        let widths: Vec<usize> = (0..columns.len())
            .map(|i| rows.iter().map(|row| &row[i]).chain([&heads()[i]]).map(width).max())
            // A format has room for widths of 16 bits only.
            .map(|wide| wide.unwrap_or_default().min(COLUMNS))
            .collect();
        for row in [heads()].iter().chain(rows) {
            let cells = columns.iter().zip(row).zip(&widths).map(|((column, cell), wide)| {
                if column.left { format!("{cell:<wide$}") } else { format!("{cell:>wide$}") }
            });
            let line = cells.collect::<Vec<_>>().join("  ");
            self.text += &shortened(printable(line.trim_end()).as_ref(), COLUMNS);
            self.text.push('\n');
        }
    }

    /// Appends a command and its purpose. A long command continues on the next line, as a shell reads it.
    fn command(&mut self, purpose: &str, command: &str) {
        self.blank();
        self.wrap("", &format!("{purpose}:"), 0);
        let mut line = " ".to_owned();
        for word in shell_options(command) {
            if width(&line) + 1 + width(&word) + 2 > COLUMNS && !line.trim().is_empty() {
                self.text += &format!("{line} \\\n");
                line = "     ".to_owned();
            }
            line += &format!(" {word}");
        }
        self.text += &format!("{line}\n");
    }

    /// The text, with a last line on what `--verbose` adds.
    fn finish(mut self, more: &str) -> String {
        self.wrap("", &format!("--verbose adds {more}."), 2);
        self.text
    }

    /// Appends the words of a text behind a lead, in lines of at most [`COLUMNS`] characters if no word is longer.
    fn wrap(&mut self, lead: &str, text: &str, indent: usize) {
        let mut line = lead.to_owned();
        let mut is_empty = true;
        for word in text.split_whitespace() {
            if !is_empty && width(&line) + 1 + width(word) > COLUMNS {
                self.text += &format!("{line}\n");
                line = " ".repeat(indent);
                is_empty = true;
            }
            if !is_empty {
                line.push(' ');
            }
            line += word;
            is_empty = false;
        }
        self.text += &format!("{}\n", line.trim_end());
    }
}

/// The command that writes the page of a loop; none if this command does.
fn map_command(args: &AdviseArgs) -> Option<(&'static str, String)> {
    let purpose = "Draw the map of stability, and drag the loop";
    args.page.is_none().then(|| (purpose, with_option("--page", "loop.html")))
}

/// A column of a table.
struct Column {
    head: &'static str,
    left: bool,
}

/// A column of words.
fn words(head: &'static str) -> Column {
    Column { head, left: true }
}

/// A column of numbers.
fn numbers(head: &'static str) -> Column {
    Column { head, left: false }
}

fn width<T: AsRef<str>>(text: T) -> usize {
    text.as_ref().chars().count()
}

/// At most `most` characters of a text; the last is `…` if some are missing.
fn shortened(text: &str, most: usize) -> String {
    match width(text) > most {
        true => text.chars().take(most - 1).chain(['…']).collect(),
        false => text.to_owned(),
    }
}

/// A text whose numbers have exponents only if they are very small or large: `0.02` for `2.0000e-2`.
fn in_decimals(text: &str) -> String {
    let number = |word: &str| -> Option<String> {
        let digits = word.trim_end_matches(|c: char| !c.is_ascii_digit());
        let x: f64 = digits.split_once('e').and_then(|_| digits.parse().ok())?;
        Some(significant(x, 6) + &word[digits.len()..])
    };
    let words = text.split(' ').map(|word| number(word).unwrap_or_else(|| word.to_owned()));
    words.collect::<Vec<_>>().join(" ")
}

/// The words of a line of a shell, each option with its value.
fn shell_options(line: &str) -> Vec<String> {
    let mut options: Vec<String> = Vec::new();
    for word in shell_words(line) {
        match options.last_mut() {
            Some(option)
                if option.starts_with("--") && !option.contains(' ') && !word.starts_with("--") =>
            {
                *option += &format!(" {word}");
            }
            _ => options.push(word.to_owned()),
        }
    }
    options
}

/// The words of a line of a shell, with their quotes.
fn shell_words(line: &str) -> Vec<&str> {
    let (mut words, mut start, mut quote) = (Vec::new(), 0, None);
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (None, ' ') => {
                words.push(&line[start..at]);
                start = at + 1;
            }
            (None, '\'' | '"') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            _ => {}
        }
    }
    words.push(&line[start..]);
    words.into_iter().filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_sentences_have_no_exponent_without_need() {
        let text = "steps of 2.0000e-2 s, below 1e-6: 4.1560e-1; e-mail 1e-3";
        assert_eq!(in_decimals(text), "steps of 0.02 s, below 1e-6: 0.4156; e-mail 0.001");
    }

    #[test]
    fn lines_have_at_most_100_characters_and_no_word_is_lost() {
        let long = "a loop of many words ".repeat(30);
        let mut summary = Summary::new(&long);
        summary.warnings(std::slice::from_ref(&long));
        summary.row("cost", &long);
        summary.table(&[words("state"), numbers("size")], &[vec!["x".repeat(120), "1".into()]]);
        summary.command("simulate it", &"libration simulate --set 'a=1 b=2' ".repeat(9));
        let text = summary.finish("everything");
        assert!(text.lines().all(|line| line.chars().count() <= COLUMNS), "{text}");
        assert_eq!(text.matches("many").count(), 90);
        // No line ends within quotes.
        assert_eq!(text.matches("'a=1 b=2'").count(), 9);
        let continued = text.lines().skip_while(|line| !line.starts_with("  libration"));
        assert!(continued.take(3).all(|line| line.ends_with(" \\")), "{text}");
    }
}
