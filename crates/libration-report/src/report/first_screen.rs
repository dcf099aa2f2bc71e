//! The first screen of a report: what the run found, four numbers with their predictions, and the answers.

use super::Cover;
use crate::notation::number;
use crate::page::Chapter;
use crate::record::{Finding, Relation, Verdict};
use crate::text::{escape, render_html};

/// The most answers above the live section.
const FIRST: usize = 2;

/// The headline: how many predictions agree, behind the headline of the cover.
pub(super) fn headline(cover: &Cover, chapters: &[Chapter]) -> String {
    let [agree, predicted] = agreement(chapters);
    let verdict = match (agree, predicted) {
        (_, 0) => String::new(),
        (agree, predicted) if agree == predicted => {
            format!("all {predicted} predictions agree with their measurements")
        }
        (agree, predicted) => format!("{} of {predicted} predictions disagree", predicted - agree),
    };
    match (cover.headline.as_str(), verdict.as_str()) {
        ("", "") => "Libration".to_owned(),
        (own, "") => own.to_owned(),
        ("", verdict) => capitalised(verdict),
        (own, verdict) => format!("{own}: {verdict}"),
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The numbers of predictions that agree, and of all.
fn agreement(chapters: &[Chapter]) -> [usize; 2] {
    let findings = || chapters.iter().flat_map(|chapter| &chapter.record.findings);
    let judged = findings().filter(|finding| finding.verdict != Verdict::Measured).count();
    [findings().filter(|finding| finding.agrees()).count(), judged]
}

/// The chapters with an answer: those that the cover names first, then all others in their order.
fn answered<'c>(cover: &Cover, chapters: &'c [Chapter]) -> Vec<&'c Chapter> {
    let mut all: Vec<&Chapter> =
        chapters.iter().filter(|chapter| !chapter.page.answer.is_empty()).collect();
    let place = |chapter: &&Chapter| {
        let first = cover.first_answers.iter().position(|name| *name == chapter.record.name);
        first.unwrap_or(usize::MAX)
    };
    all.sort_by_key(place);
    all
}

/// The answers above the live section.
pub(super) fn first_answers(cover: &Cover, chapters: &[Chapter]) -> String {
    answered(cover, chapters)
        .into_iter()
        .take(FIRST)
        .map(|chapter| answer(chapter, " class=\"lead\""))
        .collect()
}

/// The others below it.
pub(super) fn other_answers(cover: &Cover, chapters: &[Chapter]) -> String {
    let others: String = answered(cover, chapters)
        .into_iter()
        .skip(FIRST)
        .map(|chapter| answer(chapter, ""))
        .collect();
    match others.as_str() {
        "" => String::new(),
        others => format!(
            "<section>\n<h2 id=\"answers\">What else did the run find?</h2>\n{others}</section>\n"
        ),
    }
}

fn answer(chapter: &Chapter, class: &str) -> String {
    let (question, answer) =
        (render_html(&chapter.record.question), render_html(&chapter.page.answer));
    let name = escape(&chapter.record.name);
    format!("<p{class}><a class=\"asked\" href=\"#{name}\">{question}</a> {answer}</p>\n")
}

/// Four numbers with their predictions: the findings that the cover names, then the first of each chapter whose prediction is neither
/// zero nor a bound.
pub(super) fn numbers(cover: &Cover, chapters: &[Chapter]) -> String {
    let findings = || chapters.iter().flat_map(|chapter| &chapter.record.findings);
    let named = cover.key_findings.iter().filter_map(|id| findings().find(|own| own.id == **id));
    let shown = |own: &&Finding| {
        own.relation == Relation::Equal && own.predicted.is_some_and(|x| x != 0.0) && own.agrees()
    };
    let others = chapters.iter().filter_map(|chapter| chapter.record.findings.iter().find(shown));
    let mut four: Vec<&Finding> = Vec::new();
    for finding in named.chain(others) {
        let study = |own: &Finding| own.id.split('.').next().unwrap_or_default().to_owned();
        if four.len() < 4 && !four.iter().any(|own| study(own) == study(finding)) {
            four.push(finding);
        }
    }
    if four.is_empty() {
        return String::new();
    }
    format!("<div class=\"four\">{}</div>\n", four.into_iter().map(key_number).collect::<String>())
}

fn key_number(finding: &Finding) -> String {
    let unit = match finding.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {}", escape(unit)),
    };
    let value = |x: f64| render_html(&number(x, 4)) + &unit;
    let predicted =
        finding.predicted.map_or_else(String::new, |x| format!("predicted {}; ", value(x)));
    format!(
        "<div><strong>{}</strong><span>{predicted}<a href=\"#{}\">{}</a></span></div>",
        value(finding.measured),
        escape(&finding.id),
        render_html(&finding.text)
    )
}
