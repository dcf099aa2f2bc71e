//! The table of the claims of the source report with their verdicts.

use libration_report::notation::number;
use libration_report::page::Chapter;
use libration_report::record::{Claim, ClaimVerdict, Finding, Relation};
use libration_report::report::scroll_container;
use libration_report::text::{escape, render_html};
use libration_study::{UnjudgedClaim, order};

use crate::claims_without_study::{CLAIMS_WITHOUT_STUDY, ClaimWithoutStudy};
use crate::results::Results;
use crate::unjudged_claims::all_claims;

/// Number of visible findings of a claim; the others are collapsed.
const SHOWN: usize = 3;

/// All verdicts in the order of the summary. The last one appears only if a claim has it, which
/// indicates a mistake.
const VERDICTS: [ClaimVerdict; 5] = [
    ClaimVerdict::Confirmed,
    ClaimVerdict::Conditional,
    ClaimVerdict::Refuted,
    ClaimVerdict::NotReproducible,
    ClaimVerdict::Undecided,
];

/// Whether the report has a table of claims.
pub(crate) fn exists(results: &Results, chapters: &[Chapter]) -> bool {
    claims(chapters).next().is_some() || without_evidence(results).next().is_some()
}

/// Claims of the studies of this run without evidence in this configuration.
fn without_evidence(results: &Results) -> impl Iterator<Item = &UnjudgedClaim> {
    results.unjudged.iter().filter(|claim| claim.missing.is_none())
}

/// Returns the number of claims of each verdict.
fn score(results: &Results, chapters: &[Chapter]) -> String {
    let count = |v| claims(chapters).filter(|(_, claim)| claim.verdict == v).count();
    let boxes: String = VERDICTS
        .into_iter()
        .filter(|&v| v != ClaimVerdict::Undecided || count(v) > 0)
        .map(|v| {
            let (class, name) = (class(v), v.name());
            format!(
                "<div><strong>{}</strong><span class=\"v {class}\">{name}</span></div>",
                count(v)
            )
        })
        .collect();
    let all = match claims(chapters).count() {
        0 => "No claim of the source report was judged".to_owned(),
        1 => "One claim of the source report was judged".to_owned(),
        n => format!("{n} claims of the source report were judged"),
    };
    let rest = match without_evidence(results).count() {
        0 => String::new(),
        n => format!(", {n} cannot be judged with this configuration"),
    };
    format!("<div class=\"four\">{boxes}</div>\n<p class=\"sub\">{all}{rest}.</p>\n")
}

/// Returns the table of all claims with a verdict, in the order of their numbers.
pub(crate) fn render(results: &Results, chapters: &[Chapter]) -> String {
    if !exists(results, chapters) {
        return String::new();
    }
    let mut claims: Vec<(&Chapter, &Claim)> = claims(chapters).collect();
    claims.sort_by_key(|(_, claim)| order(&claim.id));
    let row = |(chapter, claim)| row(chapter, claim, &figures(chapters, claim));
    let rows: String = claims.into_iter().map(row).collect();
    format!(
        "<section>\n<h2 id=\"ledger\">Claims of the source report</h2>\n<p class=\"q\">Which claims of the source \
         report are true?</p>\n{}<p>Each verdict follows from the findings of the row, with the \
         settings of this run. The source is the report whose claims and figures the studies reproduce; \
         § numbers are its sections.</p>\n{}<table class=\"ledger\"><thead><tr><th>claim</th><th>statement \
         of the source</th><th>findings</th><th>verdict</th></tr></thead><tbody>{rows}\
         </tbody></table></div>\n{}{}</section>\n",
        score(results, chapters),
        scroll_container("Claims of the source report"),
        unjudged(results),
        claims_without_study()
    )
}

/// Returns the claims without a verdict by reason, and the studies that were not run.
fn unjudged(results: &Results) -> String {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for claim in without_evidence(results) {
        match reasons.iter_mut().find(|(because, _)| *because == claim.because) {
            Some((_, ids)) => ids.push(claim.id),
            None => reasons.push((&claim.because, vec![claim.id])),
        }
    }
    let entry = |(because, ids): &(&str, Vec<&str>)| {
        let ids: Vec<String> =
            ids.iter().map(|id| format!("<span id=\"{id}\">{id}</span>")).collect();
        format!("<li><b>{}</b>: {}.</li>", ids.join(", "), render_html(because))
    };
    let entries: String = reasons.iter().map(entry).collect();
    let listed = match entries.as_str() {
        "" => String::new(),
        _ => format!("<h3>Not judged with this configuration</h3>\n<ul>{entries}</ul>\n"),
    };
    let mut missing: Vec<&str> = results.unjudged.iter().filter_map(|c| c.missing).collect();
    let count = missing.len();
    missing.sort_unstable();
    missing.dedup();
    if missing.is_empty() {
        return listed;
    }
    let names: Vec<String> = missing.iter().map(|name| format!("`{name}`")).collect();
    let others = format!(
        "Only some studies were run; the {count} claims of {} are not in this table.",
        names.join(", ")
    );
    format!("{listed}<p class=\"sub\">{}</p>\n", render_html(&others))
}

/// Returns the claims that no study judges, collapsed.
fn claims_without_study() -> String {
    let entry = |claim: &ClaimWithoutStudy| {
        format!(
            "<li>{} (§ {}): {} Not judged: {}.</li>",
            escape(claim.id),
            escape(claim.source),
            render_html(claim.text),
            render_html(claim.because)
        )
    };
    let entries: String = CLAIMS_WITHOUT_STUDY.iter().map(entry).collect();
    let count = CLAIMS_WITHOUT_STUDY.len();
    format!(
        "<details><summary>{count} further claims without a verdict, with reasons</summary>\
         <ul>{entries}</ul></details>\n"
    )
}

fn claims(chapters: &[Chapter]) -> impl Iterator<Item = (&Chapter, &Claim)> {
    chapters.iter().flat_map(|chapter| chapter.record.claims.iter().map(move |c| (chapter, c)))
}

/// Returns the CSS class of a verdict.
fn class(verdict: ClaimVerdict) -> &'static str {
    match verdict {
        ClaimVerdict::Confirmed => "ok",
        ClaimVerdict::Conditional => "cond",
        ClaimVerdict::Refuted | ClaimVerdict::Undecided => "bad",
        ClaimVerdict::NotReproducible => "open",
    }
}

/// Returns links to the figures with the evidence of a claim.
fn figures(chapters: &[Chapter], claim: &Claim) -> String {
    let entry = all_claims().into_iter().find(|(entry, _)| entry.id == claim.id);
    let names = entry.map_or(&[][..], |(entry, _)| entry.figures);
    let links: Vec<String> = names
        .iter()
        .filter_map(|&name| {
            let mut all = chapters.iter().flat_map(|chapter| chapter.page.figures());
            // Figures that are missing with this configuration have no link.
            all.find(|figure| figure.id == name || figure.number.as_deref() == Some(name))
        })
        .map(|figure| {
            let called = match &figure.number {
                Some(number) => format!("Figure {}", escape(number)),
                None => format!("Figure “{}”", render_html(&figure.title)),
            };
            format!("<a href=\"#{}\">{called}</a>", escape(&figure.id))
        })
        .collect();
    match links.is_empty() {
        true => String::new(),
        false => format!("<p class=\"shown\">{}</p>", links.join(" · ")),
    }
}

fn row(chapter: &Chapter, claim: &Claim, figures: &str) -> String {
    let (class, verdict) = (class(claim.verdict), claim.verdict.name());
    let condition = claim
        .condition
        .as_deref()
        .map(|condition| format!("<span class=\"if\">{}</span>", render_html(condition)));
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td><span class=\"where\">§ {source}</span>{says}</td>\
         <td>{because}.{figures}{runs}</td><td><span class=\"v {class}\">{verdict}</span>{condition}</td></tr>",
        id = escape(&claim.id),
        source = escape(&claim.source),
        says = render_html(&claim.text),
        because = render_html(&claim.because),
        runs = runs(chapter, claim),
        condition = condition.unwrap_or_default(),
    )
}

/// Returns the findings of a claim.
fn runs(chapter: &Chapter, claim: &Claim) -> String {
    let evidence = claim.findings.iter().filter_map(|id| chapter.record.finding(id).ok());
    let items: Vec<String> = evidence.map(run).collect();
    let (shown, more) = items.split_at(items.len().min(SHOWN));
    let list = |items: &[String]| format!("<ul class=\"runs\">{}</ul>", items.concat());
    if more.is_empty() {
        return list(shown);
    }
    let count = more.len();
    format!("{}<details><summary>{count} more</summary>{}</details>", list(shown), list(more))
}

fn run(finding: &Finding) -> String {
    let unit = if finding.unit == "1" { String::new() } else { format!(" {}", finding.unit) };
    let value = |x: f64| render_html(&format!("{}{unit}", number(x, 4)));
    let relation = match finding.relation {
        Relation::Equal => "predicted",
        Relation::AtMost => "predicted at most",
        Relation::AtLeast => "predicted at least",
    };
    let predicted = finding.predicted.map(|x| format!(", {relation} {}", value(x)));
    format!(
        "<li><a href=\"#{id}\">{text}</a>: <b>{measured}</b>{predicted}</li>",
        id = escape(&finding.id),
        text = render_html(&finding.text),
        measured = value(finding.measured),
        predicted = predicted.unwrap_or_default(),
    )
}
