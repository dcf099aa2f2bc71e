//! The HTML report, a self-contained page rendered from records.

mod chapter;

use crate::figure;
use crate::live::{self, LIVE_ID, LiveSetting};
use crate::page::{Block, Chapter, Page};
use crate::text::{escape, plain, render_html};

const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = include_str!("../../assets/report.js");

/// The parts of a report around its chapters.
#[derive(Clone, Debug)]
pub struct Cover {
    /// The headline; that of a chapter if it is empty.
    pub headline: String,
    /// The command of the run, without names of studies.
    pub command: String,
    /// The run, in a line of text.
    pub setting: String,
    /// The machine, in a line of text.
    pub machine: String,
    /// Whether the run had ended when the report was written.
    pub complete: bool,
    /// HTML at the head of the report, above the answers; empty if there is none.
    pub score: String,
    /// The settings of the [live section](crate::live); without any there is none.
    pub live: Vec<LiveSetting>,
    /// HTML of a section between answers and chapters; empty if there is none.
    pub ledger: String,
    /// HTML of a section with the heading [`SCOPE_ID`] after the chapters; empty if there is none.
    pub scope: String,
}

/// The identifier of the section of studies that were left out.
pub const SCOPE_ID: &str = "scope";

/// Renders the report: the cover and the chapters.
pub fn render(cover: &Cover, chapters: &[Chapter]) -> String {
    let headline = match cover.headline.as_str() {
        "" => headline(chapters),
        own => own.to_owned(),
    };
    let mut links = String::from("<a href=\"#top\">The answer</a>");
    links += &live_link(&cover.live);
    if !cover.score.is_empty() {
        links += "<a href=\"#ledger\">Claims</a>";
    }
    let mut body = String::new();
    for chapter in chapters {
        let (name, title) = (escape(&chapter.record.name), render_html(&chapter.page.title));
        links += &format!("<a href=\"#{name}\">{title}</a>");
        body += &chapter::render(chapter, &cover.command);
    }
    if !cover.scope.is_empty() {
        links += &format!("<a href=\"#{SCOPE_ID}\">Other studies</a>");
    }
    links += "<a href=\"#machine\">This machine</a>";
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b>{links}</nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{setting}</p>\n{alarm}{score}{answers}{numbers}{live}{ledger}{body}\
         {scope}{machine}</main>\n{scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&headline)),
        title = render_html(&headline),
        setting = render_html(&cover.setting),
        alarm = alarm(cover, chapters),
        score = cover.score,
        answers = answers(chapters),
        numbers = numbers(chapters),
        live = live::section(&cover.live),
        ledger = cover.ledger,
        scope = cover.scope,
        machine = machine(cover),
        scripts = figure::scripts(),
    )
}

/// Renders a single page, with its answer first.
pub fn render_page(page: &Page, sub: &str) -> String {
    let mut links = String::from("<a href=\"#top\">The answer</a>");
    links += &live_link(&page.live);
    let mut blocks = String::new();
    for (i, block) in page.blocks.iter().enumerate() {
        blocks += &match block {
            Block::Heading(heading) => {
                let heading = render_html(heading);
                links += &format!("<a href=\"#part-{i}\">{heading}</a>");
                format!("<h3 id=\"part-{i}\">{heading}</h3>\n")
            }
            block => chapter::block(block),
        };
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b>{links}</nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{sub}</p>\n<p class=\"lead\">{answer}</p>\n{live}{blocks}</main>\n\
         {scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&page.title)),
        title = render_html(&page.title),
        sub = render_html(sub),
        answer = render_html(&page.answer),
        live = live::section(&page.live),
        scripts = figure::scripts(),
    )
}

fn live_link(settings: &[LiveSetting]) -> String {
    if settings.is_empty() {
        return String::new();
    }
    format!("<a href=\"#{LIVE_ID}\">What happens if …?</a>")
}

/// The headline of the report. Later studies build on earlier ones, so it is the last headline of a
/// chapter.
fn headline(chapters: &[Chapter]) -> String {
    let headlines = chapters.iter().rev().map(|c| c.page.headline.clone());
    headlines.filter(|h| !h.is_empty()).chain(["Libration".to_owned()]).take(1).collect()
}

/// Renders the warnings at the head of the report: missing studies, and findings that contradict theory.
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
            let (question, answer) = (render_html(&c.record.question), render_html(&c.page.answer));
            format!("<p{class}><span class=\"asked\">{question}</span> {answer}</p>\n")
        })
        .collect()
}

/// Renders the key numbers of the chapters.
fn numbers(chapters: &[Chapter]) -> String {
    let boxes: String = chapters
        .iter()
        .rev()
        .flat_map(|c| &c.page.highlights)
        .take(4)
        .map(|h| {
            let (value, text) = (render_html(&h.value), render_html(&h.text));
            format!("<div><strong>{value}</strong><span>{text}</span></div>")
        })
        .collect();
    format!("<div class=\"four\">{boxes}</div>\n")
}

/// The opening tag of a container that scrolls wide content, with a name and keyboard focus.
pub fn scroll_container(name: &str) -> String {
    format!("<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"{}\">", escape(name))
}

fn machine(cover: &Cover) -> String {
    let text = render_html(&cover.machine);
    format!("<h2 id=\"machine\">This machine</h2>\n<p class=\"sub\">{text}</p>\n")
}

#[cfg(test)]
mod tests;
