//! The report: one self-contained page, rendered from records.

mod chapter;

use crate::figure;
use crate::page::{Chapter, Page};
use crate::text::{escape, plain, prose};

const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = include_str!("../../assets/report.js");

/// What stands around the chapters of a report.
#[derive(Clone, Debug)]
pub struct Cover {
    /// What was run, in a line of prose.
    pub setting: String,
    /// Where it was run, in a line of prose.
    pub machine: String,
    /// Whether the run had ended when the report was written.
    pub complete: bool,
    /// HTML at the head of the report, above the answers; empty if there is none.
    pub score: String,
    /// HTML of a section between answers and chapters; empty if there is none.
    pub ledger: String,
}

/// The report: the cover, and the chapters in turn.
pub fn render(cover: &Cover, chapters: &[Chapter]) -> String {
    let headline = headline(chapters);
    let mut links = String::from("<a href=\"#top\">The answer</a>");
    if !cover.ledger.is_empty() {
        links += "<a href=\"#ledger\">The ledger</a>";
    }
    let mut body = String::new();
    for chapter in chapters {
        let (name, title) = (escape(&chapter.record.name), prose(&chapter.page.title));
        links += &format!("<a href=\"#{name}\">{title}</a>");
        body += &chapter::render(chapter);
    }
    links += "<a href=\"#machine\">This machine</a>";
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b>{links}</nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{setting}</p>\n{alarm}{score}{answers}{numbers}{ledger}{body}\
         {machine}</main>\n{scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&headline)),
        title = prose(&headline),
        setting = prose(&cover.setting),
        alarm = alarm(cover, chapters),
        score = cover.score,
        answers = answers(chapters),
        numbers = numbers(chapters),
        ledger = cover.ledger,
        machine = machine(cover),
        scripts = figure::scripts(),
    )
}

/// A page by itself, which says its answer first.
pub fn sheet(page: &Page, sub: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b><a href=\"#top\">The answer</a></nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{sub}</p>\n<p class=\"lead\">{answer}</p>\n{blocks}</main>\n\
         {scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&page.title)),
        title = prose(&page.title),
        sub = prose(sub),
        answer = prose(&page.answer),
        blocks = page.blocks.iter().map(chapter::block).collect::<String>(),
        scripts = figure::scripts(),
    )
}

/// What the report says in one sentence. Later studies rest on earlier ones, so the last that has
/// a sentence for the head of the page leads.
fn headline(chapters: &[Chapter]) -> String {
    let headlines = chapters.iter().rev().map(|c| c.page.headline.clone());
    headlines.filter(|h| !h.is_empty()).chain(["Libration".to_owned()]).take(1).collect()
}

/// What a reader must know stands before everything else: that studies are missing, and findings that
/// contradict theory.
fn alarm(cover: &Cover, chapters: &[Chapter]) -> String {
    let incomplete = match cover.complete {
        true => String::new(),
        false => {
            "<div class=\"alarm\"><b>This report is incomplete:</b> the run had not ended when \
                  it was written.</div>\n"
                .into()
        }
    };
    incomplete + &disagreements(chapters)
}

fn disagreements(chapters: &[Chapter]) -> String {
    let broken: Vec<String> = chapters
        .iter()
        .flat_map(|chapter| chapter.record.disagreements())
        .map(|f| format!("<li><a href=\"#{0}\">{0}</a></li>", escape(&f.id)))
        .collect();
    if broken.is_empty() {
        return String::new();
    }
    format!(
        "<div class=\"alarm\"><b>Measurement and theory disagree:</b><ul>{}</ul></div>\n",
        broken.concat()
    )
}

fn answers(chapters: &[Chapter]) -> String {
    let answers = chapters.iter().rev().filter(|c| !c.page.answer.is_empty());
    answers
        .enumerate()
        .map(|(i, c)| {
            let class = if i == 0 { " class=\"lead\"" } else { "" };
            let (question, answer) = (prose(&c.record.question), prose(&c.page.answer));
            format!("<p{class}><span class=\"asked\">{question}</span> {answer}</p>\n")
        })
        .collect()
}

/// The most telling numbers of the chapters.
fn numbers(chapters: &[Chapter]) -> String {
    let boxes: String = chapters
        .iter()
        .rev()
        .flat_map(|c| &c.page.highlights)
        .take(4)
        .map(|h| {
            let (value, text) = (prose(&h.value), prose(&h.text));
            format!("<div><strong>{value}</strong><span>{text}</span></div>")
        })
        .collect();
    format!("<div class=\"four\">{boxes}</div>\n")
}

/// Opens what scrolls sideways where it is too wide: the keys reach it, and it has a name.
pub fn scroll(name: &str) -> String {
    format!("<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"{}\">", escape(name))
}

fn machine(cover: &Cover) -> String {
    let text = prose(&cover.machine);
    format!("<h2 id=\"machine\">This machine</h2>\n<p class=\"sub\">{text}</p>\n")
}
