//! The HTML report, a self-contained page rendered from records.

mod chapter;
mod first_screen;

use crate::figure;
use crate::live::{self, LIVE_ID, LiveSetting};
use crate::page::{Block, Chapter, Page};
use crate::text::{POLICY, escape, plain, render_html};

const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = include_str!("../../assets/report.js");

/// The parts of a report around its chapters.
#[derive(Clone, Debug)]
pub struct Cover {
    /// The subject of the headline, before the verdict on all predictions; empty for none.
    pub headline: String,
    /// The studies whose answers come first.
    pub first_answers: &'static [&'static str],
    /// The findings whose numbers come first.
    pub key_findings: &'static [&'static str],
    /// The command of the run, without names of studies.
    pub command: String,
    /// The run, in a line of text.
    pub setting: String,
    /// The machine, in a line of text.
    pub machine: String,
    /// Whether the run had ended when the report was written.
    pub complete: bool,
    /// The settings of the [live section](crate::live); without any there is none.
    pub live: Vec<LiveSetting>,
    /// HTML of the section of claims, with the heading [`CLAIMS_ID`]; empty if there is none.
    pub claims: String,
    /// HTML of a section about the system before the chapters; empty if there is none.
    pub system: String,
    /// HTML of a section with the heading [`SCOPE_ID`] after the chapters; empty if there is none.
    pub scope: String,
}

/// The identifier of the section of claims.
pub const CLAIMS_ID: &str = "ledger";

/// The identifier of the section of studies that were left out.
pub const SCOPE_ID: &str = "scope";

/// Renders the report: the cover and the chapters.
pub fn render(cover: &Cover, chapters: &[Chapter]) -> String {
    let headline = first_screen::headline(cover, chapters);
    let moved = first_screen::moved_figure(cover, chapters);
    let mut links = String::from("<a href=\"#top\">The answer</a>");
    links += &live_link(&cover.live);
    if !cover.claims.is_empty() {
        links += &format!("<a href=\"#{CLAIMS_ID}\">Claims</a>");
    }
    let mut body = String::new();
    for chapter in chapters {
        let (name, title) = (escape(&chapter.record.name), render_html(&chapter.page.title));
        links += &format!("<a href=\"#{name}\">{title}</a>");
        body += &chapter::render(chapter, &cover.command, moved);
    }
    if !cover.scope.is_empty() {
        links += &format!("<a href=\"#{SCOPE_ID}\">Other studies</a>");
    }
    links += "<a href=\"#machine\">This machine</a>";
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{POLICY}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b>{links}</nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{setting}</p>\n{alarm}{numbers}<div class=\"first\">\n{first}{figure}{actions}</div>\n{live}{others}\
         {system}{body}{claims}{scope}{machine}</main>\n{scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&headline)),
        title = render_html(&headline),
        setting = render_html(&cover.setting),
        alarm = alarm(cover, chapters),
        numbers = first_screen::numbers(cover, chapters),
        first = first_screen::first_answers(cover, chapters),
        figure = first_screen::lead_figure(moved),
        actions = first_screen::actions(cover, chapters),
        others = first_screen::other_answers(cover, chapters),
        live = live::section(&cover.live),
        system = cover.system,
        claims = cover.claims,
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
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{POLICY}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{name}</title>\n<style>{STYLE}</style></head><body>\n\
         <nav aria-label=\"Chapters\"><b>Libration</b>{links}</nav>\n<main id=\"top\">\n\
         <h1>{title}</h1>\n<p class=\"sub\">{sub}</p>\n<p class=\"lead\">{answer}</p>\n{numbers}{bars}{actions}{live}{blocks}</main>\n\
         {scripts}<script>{SCRIPT}</script>\n</body></html>\n",
        name = escape(&plain(&page.title)),
        title = render_html(&page.title),
        sub = render_html(sub),
        answer = render_html(&page.answer),
        numbers = chapter::highlights(page),
        bars = chapter::bars(page),
        actions = chapter::actions(page),
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
