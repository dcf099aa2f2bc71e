use super::*;

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
