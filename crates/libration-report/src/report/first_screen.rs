//! The first screen of a report: what the run found, four numbers with their predictions, the answers, one figure, and what to do.

use std::collections::HashSet;

use super::{Cover, chapter};
use crate::figure::{self, Figure};
use crate::notation::number;
use crate::page::Chapter;
use crate::record::{Agreement, Finding, Relation};
use crate::text::{escape, render_html};

/// The most answers above the live section.
const FIRST: usize = 2;

/// The most actions above the live section.
const ACTIONS: usize = 3;

/// The width of a figure over the height of all its frames that leaves room for the rest of the screen.
const WIDTH_OVER_HEIGHT: f64 = 5.0;

/// The most names on an axis of a lowered figure.
const NAMES: usize = 6;

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
    let judged = findings().filter(|finding| finding.verdict != Agreement::Measured).count();
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

/// The figure that moves from its chapter to the first screen: the first figure of the first answered chapter with one.
pub(super) fn moved_figure<'c>(cover: &Cover, chapters: &'c [Chapter]) -> Option<&'c Figure> {
    answered(cover, chapters).into_iter().find_map(|chapter| chapter.page.figures().next())
}

/// The moved figure, low enough for the screen.
pub(super) fn lead_figure(moved: Option<&Figure>) -> String {
    moved.map_or_else(String::new, |own| figure::embed(&lowered(own)))
}

/// The figure with frames as low as the screen requires, or as they are if they are lower or have many names.
fn lowered(own: &Figure) -> Figure {
    if own.panels.iter().any(|panel| panel.y.names.len() > NAMES) {
        return own.clone();
    }
    let columns = own.columns.clamp(1, own.panels.len().max(1));
    let rows = own.panels.len().div_ceil(columns);
    let aspect = WIDTH_OVER_HEIGHT * rows as f64 / columns as f64;
    own.clone().aspect(aspect.max(own.aspect))
}

/// The line of a chapter in place of the moved figure.
pub(super) fn link_to_figure(own: &Figure) -> String {
    let link = format!("<a href=\"#{}\">{}</a>", escape(&own.id), render_html(&own.title));
    format!("<p class=\"sub\">Figure on the first screen: {link}</p>\n")
}

/// The first action of each of the first answered chapters.
pub(super) fn actions(cover: &Cover, chapters: &[Chapter]) -> String {
    let first = answered(cover, chapters).into_iter();
    chapter::action_list(first.filter_map(|own| own.page.actions.first()).take(ACTIONS))
}

/// Four numbers with their predictions: the findings that the cover names, then the first of each chapter whose prediction is neither
/// zero nor a bound; of fewer than four chapters further ones that differ most.
pub(super) fn numbers(cover: &Cover, chapters: &[Chapter]) -> String {
    let findings = || chapters.iter().flat_map(|chapter| &chapter.record.findings);
    let named = cover.key_findings.iter().filter_map(|id| findings().find(|own| own.id == **id));
    let others = chapters.iter().filter_map(|chapter| chapter.record.findings.iter().find(shown));
    let mut four: Vec<&Finding> = Vec::new();
    for finding in named.chain(others) {
        let study = |own: &Finding| own.id.split('.').next().unwrap_or_default().to_owned();
        if four.len() < 4 && !four.iter().any(|own| study(own) == study(finding)) {
            four.push(finding);
        }
    }
    let is_key = |own: &Finding| cover.key_findings.contains(&own.id.as_str());
    while four.len() < 4 {
        let rest = findings().filter(shown).filter(|own| four.iter().all(|one| one.id != own.id));
        let alike = |own: &Finding| four.iter().filter(|one| kind(one) == kind(own)).count();
        let common = |own: &Finding| four.iter().map(|one| common_parts(one, own)).sum::<usize>();
        let Some(next) = rest.min_by_key(|own| (!is_key(own), alike(own), common(own))) else {
            break;
        };
        four.push(next);
    }
    if four.is_empty() {
        return String::new();
    }
    format!("<div class=\"four\">{}</div>\n", four.into_iter().map(key_number).collect::<String>())
}

/// Whether a finding is worth a place among the four: its prediction is a number other than zero, and agrees.
fn shown(own: &&Finding) -> bool {
    let predicted = own.predicted.is_some_and(|x| x != 0.0);
    own.relation == Relation::Equal && predicted && own.agrees() && !own.agrees_with_zero()
}

/// The parts of an identifier, without numbers.
fn parts(own: &Finding) -> impl Iterator<Item = &str> {
    own.id.split(['.', '-']).filter(|part| part.parse::<f64>().is_err())
}

/// The quantity of a finding: the last part of its identifier.
fn kind(own: &Finding) -> Option<&str> {
    parts(own).last()
}

/// The number of parts that two identifiers have in common.
fn common_parts(a: &Finding, b: &Finding) -> usize {
    let own: HashSet<&str> = parts(a).collect();
    parts(b).collect::<HashSet<_>>().intersection(&own).count()
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
