use super::*;
use crate::figure::{Axis, Figure, Mark, Panel};
use crate::record::{Finding, Record, Tolerance};

#[test]
fn a_single_page_has_a_link_to_each_of_its_headings() {
    let mut page = Page { title: "Loop".to_owned(), ..Page::default() };
    page.heading("What is `τ`?");
    page.paragraph("A dead time.");
    page.heading("How is it used?");
    let html = render_page(&page, "");
    for (link, title) in [("part-0", "What is <code>τ</code>?"), ("part-2", "How is it used?")] {
        assert!(html.contains(&format!("<a href=\"#{link}\">{title}</a>")), "{html}");
        assert!(html.contains(&format!("<h3 id=\"{link}\">{title}</h3>")), "{html}");
    }
}

#[test]
fn a_page_may_load_nothing() {
    let page = render_page(&Page::default(), "");
    for html in [page, live::page(&[], "")] {
        let (head, _) = html.split_once("</head>").unwrap();
        let (_, policy) =
            head.split_once("<meta http-equiv=\"Content-Security-Policy\" content=\"").unwrap();
        let (policy, _) = policy.split_once('"').unwrap();
        // Before anything that it could forbid.
        assert!(head.find("Content-Security-Policy") < head.find("<style>"), "{head:.300}");
        let parts: Vec<&str> = policy.split(';').map(str::trim).collect();
        assert_eq!(parts[0], "default-src 'none'");
        for source in parts.iter().flat_map(|part| part.split(' ').skip(1)) {
            let own = source.starts_with('\'') || ["blob:", "data:"].contains(&source);
            assert!(own && source != "'self'" && source != "'unsafe-eval'", "{policy}");
        }
    }
}

/// A chapter of a study with an answer, a figure `NAME-figure` and two actions.
fn chapter(name: &str, findings: &[&str]) -> Chapter {
    let mut record = Record::new(name, "Is it so?");
    for id in findings {
        let tolerance = Tolerance::absolute(0.1, "of a test");
        record.find(Finding::predicted(*id, "a number", "1", 2.0, 2.0, tolerance));
    }
    let panel = Panel::new(Axis::linear("x"), Axis::linear("y"));
    let figure = Figure::new(format!("{name}-figure"), "A line rises.");
    let mut page = Page { title: name.to_owned(), answer: "Yes.".to_owned(), ..Page::default() };
    page.figure(figure.panel(panel.mark(Mark::line([1.0, 2.0], [1.0, 2.0]))));
    page.action(format!("First of {name}."));
    page.action(format!("Second of {name}."));
    Chapter { record, page }
}

fn cover() -> Cover {
    Cover {
        headline: String::new(),
        first_answers: &["b"],
        key_findings: &[],
        command: "libration lab".to_owned(),
        setting: String::new(),
        machine: String::new(),
        complete: true,
        live: Vec::new(),
        claims: String::new(),
        system: String::new(),
        scope: String::new(),
    }
}

/// The head of a report, before its first chapter, and the chapters.
fn head_and_chapters(html: &str) -> (&str, &str) {
    html.split_once("<section>").unwrap()
}

#[test]
fn the_figure_of_the_first_answer_moves_to_the_first_screen_and_its_chapter_links_to_it() {
    let html = render(&cover(), &[chapter("a", &[]), chapter("b", &[])]);
    let (head, chapters) = head_and_chapters(&html);
    assert!(head.contains("<figure data-figure=\"b-figure\""), "{head}");
    assert_eq!(html.matches("id=\"b-figure\"").count(), 1);
    assert_eq!(html.matches("id=\"data-b-figure\"").count(), 1);
    assert!(chapters.contains("<a href=\"#b-figure\">A line rises.</a>"), "{chapters}");
    assert!(chapters.contains("<figure data-figure=\"a-figure\""), "{chapters}");
}

#[test]
fn the_moved_figure_is_lower_than_in_its_chapter() {
    let own = chapter("b", &[]);
    let figure = own.page.figures().next().unwrap();
    let height = |svg: &str| -> f64 {
        let view = svg.split("viewBox=\"").nth(1).unwrap().split('"').next().unwrap();
        view.split(' ').nth(3).unwrap().parse().unwrap()
    };
    let html = render(&cover(), std::slice::from_ref(&own));
    let moved = html.split("<figure").nth(1).unwrap();
    let [low, high] = [height(moved), height(&figure::embed(figure))];
    assert!(low < 0.6 * high && low < 300.0, "{low} of {high}");
}

#[test]
fn the_first_screen_has_the_first_action_of_three_chapters_and_chapters_keep_all() {
    let all = ["a", "b", "c", "d"].map(|name| chapter(name, &[]));
    let html = render(&cover(), &all);
    let (head, chapters) = head_and_chapters(&html);
    let list = head.split("<div class=\"do\">").nth(1).unwrap();
    let list = list.split("</div>").next().unwrap();
    let wanted = "<li>First of b.</li><li>First of a.</li><li>First of c.</li>";
    assert!(list.contains(wanted), "{list}");
    assert_eq!(list.matches("<li>").count(), 3, "{list}");
    for name in ["a", "b", "c", "d"] {
        let wanted = format!("<li>First of {name}.</li><li>Second of {name}.</li>");
        assert!(chapters.contains(&wanted), "{name}");
    }
}

#[test]
fn four_numbers_of_a_single_study_are_not_four_of_a_kind() {
    let ids =
        ["b.rk4.end-1", "b.euler.end-1", "b.rk4.end-2", "b.rk4.rate", "b.drift", "b.euler.step"];
    let html = render(&cover(), &[chapter("b", &ids)]);
    let four =
        html.split("<div class=\"four\">").nth(1).unwrap().split("</section>").next().unwrap();
    let four = four.split("</span></div></div>").next().unwrap();
    let shown: Vec<&str> =
        four.split("<a href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert_eq!(shown, ["b.rk4.end-1", "b.drift", "b.euler.step", "b.rk4.rate"]);
}
