//! What a run writes: the contract of `results.json`, and a page that needs nothing but itself.

use std::collections::HashSet;
use std::fs;

use libration_lab::STUDIES;
use serde_json::Value;

use crate::default_run::file;

pub(crate) fn results() -> Value {
    serde_json::from_str(&fs::read_to_string(file("results.json")).unwrap()).unwrap()
}

fn page() -> String {
    fs::read_to_string(file("report.html")).unwrap()
}

/// The values of an attribute wherever it stands in `html`, scripts left out.
pub(crate) fn attributes<'a>(html: &'a str, name: &str) -> Vec<&'a str> {
    let mark = format!(" {name}=\"");
    html.split(&mark).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// The page without the insides of its scripts.
pub(crate) fn markup() -> String {
    let page = page();
    let mut pieces = page.split("<script");
    let first = pieces.next().unwrap().to_owned();
    pieces.fold(first, |mut kept, piece| {
        let (head, rest) = piece.split_once('>').unwrap();
        kept.push_str(&format!("<script{head}>"));
        kept.push_str(rest.split_once("</script>").unwrap().1);
        kept
    })
}

#[test]
fn results_keep_their_contract() {
    let results = results();
    assert_eq!(results["schema"], "libration.results/1");
    assert_eq!(results["complete"], true);
    for key in ["machine", "config"] {
        assert!(results[key].is_object(), "{key}");
    }
    assert!(results["seconds"].as_f64().unwrap() > 0.0);
    for study in results["studies"].as_array().unwrap() {
        assert!(study["question"].as_str().unwrap().ends_with('?'));
        let mut ids = HashSet::new();
        for finding in study["findings"].as_array().unwrap() {
            ids.insert(finding["id"].as_str().unwrap());
            let verdict = finding["verdict"].as_str().unwrap();
            assert!(["agrees", "disagrees", "measured"].contains(&verdict), "{verdict}");
            assert!(finding["measured"].is_f64() && finding["unit"].is_string(), "{finding}");
        }
        for claim in study["claims"].as_array().unwrap() {
            for id in claim["findings"].as_array().unwrap() {
                assert!(ids.contains(id.as_str().unwrap()), "{claim}");
            }
            assert!(!claim["because"].as_str().unwrap().is_empty());
        }
        for table in study["tables"].as_array().unwrap() {
            let width = table["columns"].as_array().unwrap().len();
            assert!(
                table["rows"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .all(|r| r.as_array().unwrap().len() == width)
            );
        }
        for figure in study["figures"].as_array().unwrap() {
            let svg = fs::read_to_string(file(figure["file"].as_str().unwrap())).unwrap();
            roxmltree::Document::parse(&svg).unwrap();
            assert!(
                markup().contains(&format!("data-figure=\"{}\"", figure["id"].as_str().unwrap()))
            );
        }
    }
}

/// The keys of all objects in `value`, those of the configuration left out.
fn keys(value: &Value, found: &mut HashSet<String>) {
    match value {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            if key != "config" {
                keys(value, found);
            }
        }),
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_of_the_results_is_documented() {
    let document = include_str!("../../../../docs/results.md");
    let mut found = HashSet::new();
    keys(&results(), &mut found);
    for key in found {
        assert!(document.contains(&format!("`{key}`")), "`{key}` is not in docs/results.md");
    }
}

/// Tables with text that may look like numbers: polynomials, some of which are constant.
const IN_WORDS: [&str; 1] = ["update matrices"];

#[test]
fn every_number_of_a_table_is_a_number_of_the_file() {
    for study in results()["studies"].as_array().unwrap() {
        let tables = study["tables"].as_array().unwrap().iter();
        let in_words = |table: &&Value| IN_WORDS.contains(&table["name"].as_str().unwrap());
        for table in tables.filter(|table| !in_words(table)) {
            let rows = table["rows"].as_array().unwrap();
            for cell in rows.iter().flat_map(|row| row.as_array().unwrap()) {
                let Some(text) = cell.as_str() else { continue };
                assert!(
                    text.contains(char::is_alphabetic),
                    "{}: “{text}” is no word",
                    table["name"]
                );
                let typeset = text.contains("·10") || text.contains('\u{202f}');
                assert!(!typeset, "{}: “{text}” is set in type", table["name"]);
            }
        }
    }
}

#[test]
fn the_page_asks_for_nothing_from_anywhere() {
    let page = markup();
    for name in ["src", "href", "srcset", "data", "action"] {
        for value in attributes(&page, name) {
            let own = value.starts_with('#') || value.starts_with("data:image/png;base64,");
            assert!(own, "{name}=\"{value:.80}\"");
        }
    }
    assert!(!page.contains("@import"));
    assert!(page.split("url(").skip(1).all(|rest| rest.starts_with('#')));
}

#[test]
fn the_page_is_smaller_than_three_megabytes() {
    let page = page();
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
}

#[test]
fn every_link_of_the_page_has_its_target_and_every_id_is_unique() {
    let page = markup();
    let ids = attributes(&page, "id");
    let unique: HashSet<_> = ids.iter().collect();
    assert_eq!(unique.len(), ids.len(), "an id is given twice");
    let links = attributes(&page, "href");
    for target in links.iter().filter_map(|link| link.strip_prefix('#')) {
        assert!(unique.contains(&target), "{target} leads nowhere");
    }
}

#[test]
fn every_claim_and_every_finding_of_the_results_is_on_the_page() {
    let (results, page) = (results(), markup());
    let ids: HashSet<_> = attributes(&page, "id").into_iter().collect();
    for study in results["studies"].as_array().unwrap() {
        for item in ["findings", "claims"].iter().flat_map(|k| study[*k].as_array().unwrap()) {
            assert!(ids.contains(item["id"].as_str().unwrap()), "{}", item["id"]);
        }
    }
}

#[test]
fn the_section_of_claims_opens_with_their_score() {
    let (results, page) = (results(), markup());
    let head = page.split("<h2 id=\"ledger\"").nth(1).unwrap().split("<table").next().unwrap();
    let studies = results["studies"].as_array().unwrap();
    let claims: Vec<&Value> =
        studies.iter().flat_map(|s| s["claims"].as_array().unwrap()).collect();
    let mut counted = 0;
    for verdict in ["confirmed", "conditional", "refuted", "not reproducible"] {
        let name = verdict.replace(' ', "-");
        let count = claims.iter().filter(|c| c["verdict"] == name.as_str()).count();
        let before = head.split(&format!("\">{verdict}</span>")).next().unwrap();
        let shown = before.rsplit("<strong>").next().unwrap().split('<').next().unwrap();
        assert_eq!(shown, count.to_string(), "{verdict}");
        counted += count;
    }
    assert_eq!(counted, claims.len());
    assert!(head.contains(&format!("{counted} claims")));
}

#[test]
fn an_entry_of_the_ledger_shows_its_section_its_condition_and_every_finding() {
    let (results, page) = (results(), markup());
    for study in results["studies"].as_array().unwrap() {
        for claim in study["claims"].as_array().unwrap() {
            let text = |key: &str| claim[key].as_str().unwrap_or_default();
            let row = page.split(&format!("<tr id=\"{}\">", text("id"))).nth(1).unwrap();
            let row = row.split("</tr>").next().unwrap();
            assert!(row.contains(&format!("§ {}<", text("source"))), "{row}");
            assert_eq!(row.contains("class=\"if\""), claim["condition"].is_string(), "{row}");
            for id in claim["findings"].as_array().unwrap() {
                assert!(
                    row.contains(&format!("href=\"#{}\"", id.as_str().unwrap())),
                    "{id}: {row}"
                );
            }
        }
    }
}

/// Claims whose evidence no figure shows: the oscillator itself, a single orbit, defects that are
/// zero, equality to the bit, arrays that are counted, products, addresses, and angles that stand in a table.
const UNSEEN: [&str; 17] = [
    "C04", "C06", "C11", "C26", "C44", "C48", "C50", "C58", "C58a", "C59", "C59a", "C59b", "C59c",
    "C65", "C66", "C69", "C71",
];

#[test]
fn an_entry_of_the_ledger_leads_to_the_figures_that_show_its_evidence() {
    let (results, page) = (results(), markup());
    let mut figures = HashSet::new();
    let mut numbers = HashSet::new();
    for figure in page.split("<figure ").skip(1) {
        figures.insert(figure.split("id=\"").nth(1).unwrap().split('"').next().unwrap());
        let head = figure.split("<figcaption><b>").nth(1).unwrap();
        numbers.extend(head.strip_prefix("Figure ").and_then(|rest| rest.split(' ').next()));
    }
    for claim in STUDIES.studies.iter().flat_map(|study| study.source_claims()) {
        for name in claim.figures {
            let there = figures.contains(name) || numbers.contains(name);
            assert!(there, "{} names the figure {name}, which the page lacks", claim.id);
        }
    }
    for claim in
        results["studies"].as_array().unwrap().iter().flat_map(|s| s["claims"].as_array().unwrap())
    {
        let id = claim["id"].as_str().unwrap();
        let row = page.split(&format!("<tr id=\"{id}\">")).nth(1).unwrap();
        let row = row.split("</tr>").next().unwrap();
        let linked = attributes(row, "href").into_iter().filter_map(|link| link.strip_prefix('#'));
        let shown = linked.filter(|target| figures.contains(target)).count();
        assert_eq!(shown > 0, !UNSEEN.contains(&id), "{id}: {row}");
    }
}

#[test]
fn every_series_is_a_parquet_file() {
    let files: Vec<_> = fs::read_dir(file("data")).unwrap().map(Result::unwrap).collect();
    assert!(files.len() >= 20, "{} files", files.len());
    for file in files {
        let bytes = fs::read(file.path()).unwrap();
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"), "{:?}", file.path());
    }
}
