//! What the source report claims, and what is true of it.

use crate::page::Chapter;
use crate::record::{Claim, ClaimVerdict};
use crate::text::{escape, prose};

/// The table of all claims that were judged, in the order of their numbers.
pub(super) fn render(chapters: &[Chapter]) -> String {
    let mut claims: Vec<&Claim> = chapters.iter().flat_map(|c| &c.record.claims).collect();
    if claims.is_empty() {
        return String::new();
    }
    claims.sort_by(|a, b| a.id.cmp(&b.id));
    let rows: String = claims.into_iter().map(row).collect();
    format!(
        "<section>\n<h2 id=\"ledger\">The ledger</h2>\n<p class=\"q\">Which claims of the source \
         report stand?</p>\n<p>Each verdict is computed from the findings named below it, at the \
         setting of this run.</p>\n<div class=\"scroll\" tabindex=\"0\"><table class=\"ledger\"><thead><tr>\
         <th>claim</th><th>the source says</th><th>we find</th><th>verdict</th></tr></thead><tbody>\
         {rows}</tbody></table></div>\n</section>\n"
    )
}

fn row(claim: &Claim) -> String {
    let (class, verdict) = match claim.verdict {
        ClaimVerdict::Confirmed => ("ok", "confirmed"),
        ClaimVerdict::Conditional => ("cond", "conditional"),
        ClaimVerdict::Refuted => ("bad", "refuted"),
        ClaimVerdict::NotReproducible => ("open", "not reproducible"),
        ClaimVerdict::Undecided => ("bad", "undecided"),
    };
    let findings: Vec<String> = claim
        .findings
        .iter()
        .map(|id| format!("<a class=\"id\" href=\"#{0}\">{0}</a>", escape(id)))
        .collect();
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td>{source}: {says}</td><td>{because}.<br>{findings}</td>\
         <td><span class=\"v {class}\">{verdict}</span></td></tr>",
        id = escape(&claim.id),
        source = escape(&claim.source),
        says = prose(&claim.text),
        because = prose(&claim.because),
        findings = findings.join(" "),
    )
}
