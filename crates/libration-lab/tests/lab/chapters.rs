//! Chapters and the first screen of a report: what to do, and the figure that matters.

use std::collections::HashSet;

use libration_lab::STUDIES;

use crate::report::{attributes, markup, results};

/// The chapters of the page, by the name of their study.
fn chapters(page: &str) -> Vec<(String, &str)> {
    let studies: Vec<String> = STUDIES.studies.iter().map(|study| study.name().into()).collect();
    let sections =
        page.split("<section>").skip(1).map(|part| part.split("</section>").next().unwrap());
    let named = sections.filter_map(|part| {
        let id = part.split("<h2 id=\"").nth(1)?.split('"').next()?;
        studies.iter().find(|name| *name == id).map(|name| (name.clone(), part))
    });
    named.collect()
}

/// The list items in the boxes of what to do.
fn actions(html: &str) -> Vec<&str> {
    let boxes =
        html.split("<div class=\"do\">").skip(1).map(|rest| rest.split("</div>").next().unwrap());
    boxes
        .flat_map(|own| own.split("<li>").skip(1))
        .map(|li| li.split("</li>").next().unwrap())
        .collect()
}

#[test]
fn every_chapter_closes_with_one_to_three_actions_and_no_two_chapters_have_the_same() {
    let page = markup();
    let chapters = chapters(&page);
    assert_eq!(chapters.len(), results()["studies"].as_array().unwrap().len());
    let mut all = HashSet::new();
    for (name, chapter) in chapters {
        let own = actions(chapter);
        assert!((1..=3).contains(&own.len()), "{name}: {own:?}");
        let behind = chapter.split("<div class=\"do\">").nth(1).unwrap();
        assert!(behind.contains("All findings") && !behind.contains("<figure"), "{name}");
        for action in own {
            assert!(action.ends_with('.') && !action.contains("NaN"), "{name}: {action}");
            assert!(all.insert(action), "{name}: {action}");
        }
    }
}

#[test]
fn the_first_screen_has_one_figure_and_actions_that_stay_in_their_chapters() {
    let page = markup();
    let (head, _) = page.split_once("<section").unwrap();
    let figures = attributes(head, "data-figure");
    assert_eq!(figures.len(), 1, "{figures:?}");
    assert_eq!(page.matches(&format!("data-figure=\"{}\"", figures[0])).count(), 1);
    let chapters = chapters(&page);
    let link = format!("href=\"#{}\"", figures[0]);
    assert!(chapters.iter().any(|(_, chapter)| chapter.contains(&link)), "{link}");
    let first = actions(head);
    assert_eq!(first.len(), 3, "{first:?}");
    for action in first {
        assert!(chapters.iter().any(|(_, own)| actions(own).contains(&action)), "{action}");
    }
}
