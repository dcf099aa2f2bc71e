//! What the source report claims, and what is true of it.

use libration_report::notation::number;
use libration_report::page::Chapter;
use libration_report::record::{Claim, ClaimVerdict, Finding, Relation};
use libration_report::report::scroll;
use libration_report::text::{escape, prose};
use libration_study::{Unjudged, order};

use crate::results::Results;
use crate::unjudged::tried;
use crate::untried::{UNTRIED, Untried};

/// How many findings of a claim are shown; the others are folded away.
const SHOWN: usize = 3;

/// All verdicts in the order of the score. The last one is shown only if there is one: a claim is
/// never left undecided unless something is wrong.
const VERDICTS: [ClaimVerdict; 5] = [
    ClaimVerdict::Confirmed,
    ClaimVerdict::Conditional,
    ClaimVerdict::Refuted,
    ClaimVerdict::NotReproducible,
    ClaimVerdict::Undecided,
];

/// Whether any study tried a claim: then the ledger says what came of it.
pub(crate) fn exists(results: &Results, chapters: &[Chapter]) -> bool {
    claims(chapters).next().is_some() || in_vain(results).next().is_some()
}

/// The claims that a study of this run tries, but that this configuration leaves without evidence.
fn in_vain(results: &Results) -> impl Iterator<Item = &Unjudged> {
    results.unjudged.iter().filter(|claim| claim.missing.is_none())
}

/// How many claims have which verdict: the head of the report.
pub(crate) fn score(results: &Results, chapters: &[Chapter]) -> String {
    if !exists(results, chapters) {
        return String::new();
    }
    let count = |v| claims(chapters).filter(|(_, claim)| claim.verdict == v).count();
    let boxes: String = VERDICTS
        .into_iter()
        .filter(|&v| v != ClaimVerdict::Undecided || count(v) > 0)
        .map(|v| {
            let (class, name) = words(v);
            format!(
                "<div><strong>{}</strong><span class=\"v {class}\">{name}</span></div>",
                count(v)
            )
        })
        .collect();
    let all = match claims(chapters).count() {
        0 => "No claim of the source report was judged".to_owned(),
        1 => "One claim of the source report was tried".to_owned(),
        n => format!("{n} claims of the source report were tried"),
    };
    let rest = match in_vain(results).count() {
        0 => String::new(),
        n => format!(", {n} cannot be judged with this configuration"),
    };
    format!(
        "<div class=\"four\">{boxes}</div>\n\
         <p class=\"sub\">{all}{rest}: <a href=\"#ledger\">the ledger</a> says what came of each.</p>\n"
    )
}

/// The table of all claims that were judged, in the order of their numbers.
pub(crate) fn render(results: &Results, chapters: &[Chapter]) -> String {
    if !exists(results, chapters) {
        return String::new();
    }
    let mut claims: Vec<(&Chapter, &Claim)> = claims(chapters).collect();
    claims.sort_by_key(|(_, claim)| order(&claim.id));
    let row = |(chapter, claim)| row(chapter, claim, &figures(chapters, claim));
    let rows: String = claims.into_iter().map(row).collect();
    format!(
        "<section>\n<h2 id=\"ledger\">The ledger</h2>\n<p class=\"q\">Which claims of the source \
         report stand?</p>\n<p>Each verdict is computed from the findings named below it, at the \
         setting of this run.</p>\n{}<table class=\"ledger\"><thead><tr><th>claim</th><th>the \
         source says</th><th>what was run, and what came out</th><th>verdict</th></tr></thead><tbody>{rows}\
         </tbody></table></div>\n{}{}</section>\n",
        scroll("The ledger"),
        unjudged(results),
        untried()
    )
}

/// The claims that were not judged, under their reason; those of studies that were not run, in a line.
fn unjudged(results: &Results) -> String {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for claim in in_vain(results) {
        match reasons.iter_mut().find(|(because, _)| *because == claim.because) {
            Some((_, ids)) => ids.push(claim.id),
            None => reasons.push((&claim.because, vec![claim.id])),
        }
    }
    let entry = |(because, ids): &(&str, Vec<&str>)| {
        let ids: Vec<String> =
            ids.iter().map(|id| format!("<span id=\"{id}\">{id}</span>")).collect();
        format!("<li><b>{}</b>: {}.</li>", ids.join(", "), prose(because))
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
        "Only some studies were run; the {count} claims that {} would try are not in this ledger.",
        names.join(", ")
    );
    format!("{listed}<p class=\"sub\">{}</p>\n", prose(&others))
}

/// The claims that no study tries, folded away.
fn untried() -> String {
    let entry = |claim: &Untried| {
        format!(
            "<li>{} (§ {}): {} Not tried: {}.</li>",
            escape(claim.id),
            escape(claim.source),
            prose(claim.text),
            prose(claim.because)
        )
    };
    let entries: String = UNTRIED.iter().map(entry).collect();
    let count = UNTRIED.len();
    format!(
        "<details><summary>{count} further claims are accounted for without a verdict</summary>\
         <ul>{entries}</ul></details>\n"
    )
}

fn claims(chapters: &[Chapter]) -> impl Iterator<Item = (&Chapter, &Claim)> {
    chapters.iter().flat_map(|chapter| chapter.record.claims.iter().map(move |c| (chapter, c)))
}

/// The class and the name of a verdict.
fn words(verdict: ClaimVerdict) -> (&'static str, &'static str) {
    match verdict {
        ClaimVerdict::Confirmed => ("ok", "confirmed"),
        ClaimVerdict::Conditional => ("cond", "conditional"),
        ClaimVerdict::Refuted => ("bad", "refuted"),
        ClaimVerdict::NotReproducible => ("open", "not reproducible"),
        ClaimVerdict::Undecided => ("bad", "undecided"),
    }
}

/// Links to the figures of this page that show the evidence of a claim.
fn figures(chapters: &[Chapter], claim: &Claim) -> String {
    let tried = tried().into_iter().find(|(tried, _)| tried.id == claim.id);
    let names = tried.map_or(&[][..], |(tried, _)| tried.figures);
    let links: Vec<String> = names
        .iter()
        .filter_map(|&name| {
            let mut all = chapters.iter().flat_map(|chapter| chapter.page.figures());
            // A figure that this configuration leaves out is not linked.
            all.find(|figure| figure.id == name || figure.number.as_deref() == Some(name))
        })
        .map(|figure| {
            let called = match &figure.number {
                Some(number) => format!("Figure {}", escape(number)),
                None => format!("Figure “{}”", prose(&figure.title)),
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
    let (class, verdict) = words(claim.verdict);
    let condition = claim
        .condition
        .as_deref()
        .map(|condition| format!("<span class=\"if\">{}</span>", prose(condition)));
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td><span class=\"where\">§ {source}</span>{says}</td>\
         <td>{because}.{figures}{runs}</td><td><span class=\"v {class}\">{verdict}</span>{condition}</td></tr>",
        id = escape(&claim.id),
        source = escape(&claim.source),
        says = prose(&claim.text),
        because = prose(&claim.because),
        runs = runs(chapter, claim),
        condition = condition.unwrap_or_default(),
    )
}

/// What was run for a claim, and what came out.
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
    let value = |x: f64| prose(&format!("{}{unit}", number(x, 4)));
    let relation = match finding.relation {
        Relation::Equal => "predicted",
        Relation::AtMost => "predicted at most",
        Relation::AtLeast => "predicted at least",
    };
    let predicted = finding.predicted.map(|x| format!(", {relation} {}", value(x)));
    format!(
        "<li><a href=\"#{id}\">{text}</a>: <b>{measured}</b>{predicted}</li>",
        id = escape(&finding.id),
        text = prose(&finding.text),
        measured = value(finding.measured),
        predicted = predicted.unwrap_or_default(),
    )
}
