//! What the source report claims, and what is true of it.

use crate::notation::number;
use crate::page::Chapter;
use crate::record::{Claim, ClaimVerdict, Finding, Relation};
use crate::text::{escape, prose};
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

/// Whether any claim was judged.
pub(super) fn exists(chapters: &[Chapter]) -> bool {
    claims(chapters).next().is_some()
}

/// How many claims have which verdict: the head of the report.
pub(super) fn score(chapters: &[Chapter]) -> String {
    if !exists(chapters) {
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
        1 => "One claim of the source report was tried".to_owned(),
        n => format!("{n} claims of the source report were tried"),
    };
    format!(
        "<div class=\"four\">{boxes}</div>\n\
         <p class=\"sub\">{all}: <a href=\"#ledger\">the ledger</a> says what came of each.</p>\n"
    )
}

/// The table of all claims that were judged, in the order of their numbers.
pub(super) fn render(chapters: &[Chapter]) -> String {
    if !exists(chapters) {
        return String::new();
    }
    let mut claims: Vec<(&Chapter, &Claim)> = claims(chapters).collect();
    // C9 stands before C10.
    claims.sort_by_key(|(_, claim)| (claim.id.len(), &claim.id));
    let rows: String = claims.into_iter().map(|(chapter, claim)| row(chapter, claim)).collect();
    format!(
        "<section>\n<h2 id=\"ledger\">The ledger</h2>\n<p class=\"q\">Which claims of the source \
         report stand?</p>\n<p>Each verdict is computed from the findings named below it, at the \
         setting of this run.</p>\n{}<table class=\"ledger\"><thead><tr><th>claim</th><th>the \
         source says</th><th>what was run, and what came out</th><th>verdict</th></tr></thead><tbody>{rows}\
         </tbody></table></div>\n{}</section>\n",
        super::scroll("The ledger"),
        untried()
    )
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

fn row(chapter: &Chapter, claim: &Claim) -> String {
    let (class, verdict) = words(claim.verdict);
    let condition = claim
        .condition
        .as_deref()
        .map(|condition| format!("<span class=\"if\">{}</span>", prose(condition)));
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td><span class=\"where\">§ {source}</span>{says}</td>\
         <td>{because}.{runs}</td><td><span class=\"v {class}\">{verdict}</span>{condition}</td></tr>",
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
