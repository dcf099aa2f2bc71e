//! Chapters of the report.

use crate::figure;
use crate::notation::number;
use crate::page::{Block, Chapter};
use crate::record::{Cell, Finding, Quantity, Table, Verdict};
use crate::text::{escape, render_html};

/// Renders a chapter: question, evidence and all findings.
pub(super) fn render(chapter: &Chapter) -> String {
    let (record, page) = (&chapter.record, &chapter.page);
    let name = escape(&record.name);
    let blocks: String = page.blocks.iter().map(block).collect();
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
        "<section>\n<h2 id=\"{name}\">{title}</h2>\n<p class=\"q\">{question}</p>\n{blocks}\
         {findings}<p class=\"sub\">Recompute this chapter alone: <code>libration lab \
         {name}</code>{shown}</p>\n</section>\n",
        title = render_html(&page.title),
        question = render_html(&record.question),
        findings = findings(&record.findings),
    )
}

pub(super) fn block(block: &Block) -> String {
    match block {
        Block::Heading(heading) => format!("<h3>{}</h3>\n", render_html(heading)),
        Block::Paragraph(paragraph) => format!("<p>{}</p>\n", render_html(paragraph)),
        Block::Note(note) => format!("<p class=\"note\">{}</p>\n", render_html(note)),
        Block::Figure(figure) => figure::embed(figure),
        Block::Table { table, digits } => self::table(table, *digits),
    }
}

/// Renders a table. A column with a number is aligned as numbers.
fn table(table: &Table, digits: usize) -> String {
    let is_number = |cell: &Cell| match cell {
        Cell::Number(quantity) => !matches!(quantity, Quantity::Intervals(..)),
        Cell::Text(_) => false,
    };
    let numeric: Vec<bool> =
        (0..table.columns.len()).map(|i| table.rows.iter().any(|row| is_number(&row[i]))).collect();
    let class = |i: usize| if numeric[i] { " class=\"num\"" } else { " class=\"formula\"" };
    let head: String = table
        .columns
        .iter()
        .enumerate()
        .map(|(i, c)| format!("<th{}>{}</th>", class(i), render_html(c)))
        .collect();
    let cell = |(i, cell): (usize, &Cell)| {
        format!("<td{}>{}</td>", class(i), render_html(&cell.typeset(digits)))
    };
    let rows: String = table
        .rows
        .iter()
        .map(|row| format!("<tr>{}</tr>", row.iter().enumerate().map(cell).collect::<String>()))
        .collect();
    format!(
        "{}<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>\n",
        super::scroll_container(&format!("Table: {}", table.name))
    )
}

/// Renders all findings, collapsed.
fn findings(findings: &[Finding]) -> String {
    let agree = findings.iter().filter(|f| f.verdict == Verdict::Agrees).count();
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
        Verdict::Agrees if finding.agrees_with_zero() => ("open", "agrees, but 0 would too"),
        Verdict::Agrees => ("ok", "agrees"),
        Verdict::Disagrees => ("bad", "disagrees"),
        Verdict::Measured if finding.undecided.is_some() => ("open", "not judged"),
        Verdict::Measured => ("plain", "measured"),
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
