//! Chapters of the report.

use super::first_screen;
use crate::figure::{self, Figure};
use crate::notation::number;
use crate::page::{Bar, Block, Chapter, Highlight, Page};
use crate::record::{Agreement, Cell, Finding, Quantity, Table};
use crate::text::{escape, plain, render_html};

/// Renders a chapter: question, evidence, what to do and all findings. The moved figure is on the first screen.
pub(super) fn render(chapter: &Chapter, command: &str, moved: Option<&Figure>) -> String {
    let (record, page) = (&chapter.record, &chapter.page);
    let name = escape(&record.name);
    let own_block = |own: &Block| match own {
        Block::Figure(own) if moved.is_some_and(|moved| moved.id == own.id) => {
            first_screen::link_to_figure(own)
        }
        own => block(own),
    };
    let blocks: String = page.blocks.iter().map(own_block).collect();
    let data: Vec<String> = record
        .series
        .iter()
        .map(|series| format!("<code>data/{name}-{}.parquet</code>", escape(&series.name)))
        .collect();
    let shown = match data.as_slice() {
        [] => String::new(),
        [only] => format!(" · data: {only}"),
        [first, .., last] => format!(" · data: {first} … {last}"),
    };
    format!(
        "<section>\n<h2 id=\"{name}\">{title}</h2>\n<p class=\"q\">{question}</p>\n{opening}{blocks}{actions}\
         {findings}<p class=\"sub\">Recompute this chapter alone: <code>{command} \
         {name}</code>{one}{shown}</p>\n</section>\n",
        command = escape(command),
        one = record.findings.first().map_or_else(String::new, |first| format!(
            "; one finding alone: <code>{} --only {}</code>",
            escape(command),
            escape(&first.id)
        )),
        title = render_html(&page.title),
        question = render_html(&record.question),
        opening = opening(page),
        actions = actions(page),
        findings = findings(&record.findings),
    )
}

/// The sentence and the key numbers of a chapter.
fn opening(page: &Page) -> String {
    let sentence = match page.headline.as_str() {
        "" => String::new(),
        headline => format!("<p><b>{}</b></p>\n", render_html(headline)),
    };
    sentence + &highlights(page)
}

/// The key numbers of a page or a chapter; empty without any.
pub(super) fn highlights(page: &Page) -> String {
    let number = |own: &Highlight| {
        let (value, text) = (render_html(&own.value), render_html(&own.text));
        format!("<div><strong>{value}</strong><span>{text}</span></div>")
    };
    let numbers: String = page.highlights.iter().take(4).map(number).collect();
    match numbers.as_str() {
        "" => String::new(),
        numbers => format!("<div class=\"four\">{numbers}</div>\n"),
    }
}

/// The used parts of limits of a page, as bars; empty without any.
pub(super) fn bars(page: &Page) -> String {
    let bar = |own: &Bar| {
        let kind = if own.part >= 1.0 { " class=\"over\"" } else { "" };
        format!(
            "<div{kind}><dt>{}</dt><dd><span><i style=\"width:{:.1}%\"></i></span>{}</dd></div>",
            render_html(&own.name),
            100.0 * own.part.clamp(0.0, 1.0),
            render_html(&own.text)
        )
    };
    match page.bars.iter().map(bar).collect::<String>().as_str() {
        "" => String::new(),
        bars => format!("<dl class=\"bars\">{bars}</dl>\n"),
    }
}

/// What a reader should do; empty without any.
pub(super) fn actions(page: &Page) -> String {
    action_list(page.actions.iter())
}

/// Actions with their heading; empty without any.
pub(super) fn action_list<'a>(actions: impl Iterator<Item = &'a String>) -> String {
    let action = |text: &String| format!("<li>{}</li>", whole_options(&render_html(text)));
    match actions.map(action).collect::<String>().as_str() {
        "" => String::new(),
        actions => format!("<div class=\"do\"><b>What to do</b><ul>{actions}</ul></div>\n"),
    }
}

pub(super) fn block(block: &Block) -> String {
    match block {
        Block::Heading(heading) => format!("<h3>{}</h3>\n", render_html(heading)),
        Block::Paragraph(paragraph) => format!("<p>{}</p>\n", render_html(paragraph)),
        Block::Note(note) => format!("<p class=\"note\">{}</p>\n", render_html(note)),
        Block::Code(code) => self::code(code),
        Block::Figure(figure) => figure::embed(figure),
        Block::Table { table, digits } => self::table(table, *digits),
    }
}

/// Keeps options of commands whole, such as `--dt`, within which browsers break lines.
fn whole_options(html: &str) -> String {
    let word = |word: &str| match word.strip_prefix("--") {
        Some(_) => {
            let end = word.find('<').unwrap_or(word.len());
            format!("<span class=\"option\">{}</span>{}", &word[..end], &word[end..])
        }
        None => word.to_owned(),
    };
    html.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Renders lines of code. Browsers break lines at hyphens too, and so within `1e-3`: each word is kept whole.
fn code(code: &str) -> String {
    let word = |word: &str| format!("<span>{}</span>", escape(word));
    let line = |line: &str| line.split(' ').map(word).collect::<Vec<_>>().join(" ");
    let lines: Vec<String> = code.trim_end().lines().map(line).collect();
    format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", lines.join("\n"))
}

/// Characters of a cell above which its column breaks lines.
const LONG: usize = 28;

/// Columns from which a table with sentences becomes a list on narrow screens.
const MANY: usize = 5;

/// Renders a table. A column with a number is aligned as numbers, and one with long text breaks lines.
fn table(table: &Table, digits: usize) -> String {
    let is_number = |cell: &Cell| match cell {
        Cell::Number(quantity) => !matches!(quantity, Quantity::Intervals(..)),
        Cell::Text(_) => false,
    };
    let is_long = |cell: &Cell| cell.typeset(digits).chars().count() > LONG;
    let some = |i: usize, of: &dyn Fn(&Cell) -> bool| table.rows.iter().any(|row| of(&row[i]));
    let classes: Vec<&str> = (0..table.columns.len())
        .map(|i| match (some(i, &is_number), some(i, &is_long)) {
            (true, _) => "num",
            (false, true) => "prose",
            (false, false) => "formula",
        })
        .collect();
    let listed = classes.contains(&"prose") && classes.len() >= MANY;
    let head: String = table
        .columns
        .iter()
        .zip(&classes)
        .map(|(c, class)| format!("<th class=\"{class}\">{}</th>", render_html(c)))
        .collect();
    let labels: Vec<String> = match listed {
        true => {
            table.columns.iter().map(|c| format!(" data-label=\"{}\"", escape(&plain(c)))).collect()
        }
        false => vec![String::new(); classes.len()],
    };
    let cell = |(i, cell): (usize, &Cell)| {
        let (class, label) = (classes[i], &labels[i]);
        // One element, so that superscripts stay in their line of a list.
        let text = render_html(&cell.typeset(digits));
        let text = if listed { format!("<span>{text}</span>") } else { text };
        format!("<td class=\"{class}\"{label}>{text}</td>")
    };
    let rows: String = table
        .rows
        .iter()
        .map(|row| format!("<tr>{}</tr>", row.iter().enumerate().map(cell).collect::<String>()))
        .collect();
    let kind = if listed { " class=\"listed\"" } else { "" };
    format!(
        "{}<table{kind}><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>\n",
        super::scroll_container(&format!("Table: {}", table.name))
    )
}

/// Renders all findings, collapsed.
fn findings(findings: &[Finding]) -> String {
    let agree = findings.iter().filter(|f| f.verdict == Agreement::Agrees).count();
    let predicted = findings.iter().filter(|f| f.predicted.is_some()).count();
    let small = match findings.iter().filter(|f| f.agrees_with_zero()).count() {
        0 => String::new(),
        small => format!("; {small} of them are smaller than their tolerance"),
    };
    let rows: String = findings.iter().map(finding).collect();
    format!(
        "<details><summary>All findings: {agree} of {predicted} predictions agree with \
         measurement{small}</summary>{}<table><thead><tr><th>finding</th>\
         <th class=\"num\">predicted</th><th class=\"num\">measured</th><th class=\"num\">tolerance\
         </th><th>verdict</th></tr></thead><tbody>{rows}</tbody></table></div></details>\n",
        super::scroll_container("All findings")
    )
}

fn finding(finding: &Finding) -> String {
    let (class, verdict) = match finding.verdict {
        Agreement::Agrees if finding.agrees_with_zero() => ("open", "agrees, but 0 would too"),
        Agreement::Agrees => ("ok", "agrees"),
        Agreement::Disagrees => ("bad", "disagrees"),
        Agreement::Measured if finding.undecided.is_some() => ("open", "not judged"),
        Agreement::Measured => ("plain", "measured"),
    };
    let undecided = finding
        .undecided
        .as_ref()
        .map(|why| format!(" (not judged: {})", render_html(&why.to_string())));
    let unit = match finding.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {}", escape(unit)),
    };
    let value =
        |x: Option<f64>| x.map_or_else(|| "—".into(), |x| render_html(&number(x, 8)) + &unit);
    format!(
        "<tr id=\"{id}\"><td>{text}{undecided}<br><span class=\"id\">{id}</span></td>\
         <td class=\"num\">{predicted}</td><td class=\"num\">{measured}</td>\
         <td class=\"num\" title=\"{reason}\">{tolerance}</td>\
         <td><span class=\"v {class}\">{verdict}</span></td></tr>",
        id = escape(&finding.id),
        text = render_html(&finding.text),
        undecided = undecided.unwrap_or_default(),
        predicted = value(finding.predicted),
        measured = value(Some(finding.measured)),
        reason = escape(&finding.tolerance.tolerance_reason),
        tolerance =
            finding.tolerance.tolerance.map_or_else(|| "—".into(), |t| render_html(&number(t, 2))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_breaks_lines_and_numbers_do_not() {
        let mut own = Table::new("x", &["name", "value", "method"]);
        own.push(["a".into(), Cell::from(1.5), "exact: the spectral radius passes 1".into()]);
        let html = table(&own, 4);
        for wanted in
            ["<td class=\"formula\">a<", "<td class=\"num\">1.5<", "<td class=\"prose\">exact"]
        {
            assert!(html.contains(wanted), "{wanted}: {html}");
        }
        assert!(!html.contains("listed") && !html.contains("data-label"), "three columns fit");
    }

    #[test]
    fn a_wide_table_with_sentences_has_the_head_of_its_column_in_each_cell() {
        let mut own = Table::new("x", &["a", "b", "c", "10^-3", "method"]);
        own.push(
            [1.0, 2.0, 3.0, 4.0]
                .map(Cell::from)
                .into_iter()
                .chain(["m".repeat(29).as_str().into()]),
        );
        let html = table(&own, 4);
        assert!(html.contains("<table class=\"listed\">"), "{html}");
        assert!(
            html.contains("<td class=\"num\" data-label=\"10⁻³\"><span>4</span></td>"),
            "{html}"
        );
    }

    #[test]
    fn options_of_actions_stay_whole_and_keep_their_text() {
        let html = action_list([&"Run `a-b --dt 0.01 --open`.".to_owned()].into_iter());
        let wanted = "<code>a-b <span class=\"option\">--dt</span> 0.01 <span class=\"option\">--open</span></code>.";
        assert!(html.contains(wanted), "{html}");
    }

    #[test]
    fn code_keeps_each_word_whole_and_its_lines() {
        assert_eq!(
            code("a = [1e-3, <2]\nb"),
            "<pre tabindex=\"0\"><code><span>a</span> <span>=</span> <span>[1e-3,</span> <span>&lt;2]</span>\n<span>b</span></code></pre>\n"
        );
    }
}
