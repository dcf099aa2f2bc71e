//! The live section of a page: a system that the reader changes while the engine runs in the page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::figure;
use crate::text::{POLICY, escape, render_html};

/// The engine, which `cargo xtask live` compiles from `libration-live`, as zlib data.
const ENGINE: &[u8] = include_bytes!("../assets/live/engine.wasm.zlib");
const STYLE: &str = include_str!("../assets/live/live.css");
const PAGE_STYLE: &str = include_str!("../assets/report.css");

/// The scripts, which share one scope.
const SCRIPTS: [&str; 6] = [
    include_str!("../assets/live/engine.js"),
    include_str!("../assets/live/commands.js"),
    include_str!("../assets/live/plot.js"),
    include_str!("../assets/live/controls.js"),
    include_str!("../assets/live/figures.js"),
    include_str!("../assets/live/live.js"),
];

/// The identifier of the section; links with `#live&KEY=VALUE…` have a setting.
pub const LIVE_ID: &str = "live";

/// A setting that a reader may begin with.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveSetting {
    /// The name in the list of systems.
    pub title: String,
    /// Lines `key=value`: the text of a `libration::live::Setting`.
    pub text: String,
}

/// The section with its scripts, which load nothing from the network; empty without settings. It begins with the first setting.
pub fn section(settings: &[LiveSetting]) -> String {
    if settings.is_empty() {
        return String::new();
    }
    let entries: Vec<serde_json::Value> = settings
        .iter()
        .map(|own| serde_json::json!({"title": own.title, "text": own.text}))
        .collect();
    let options: String = settings
        .iter()
        .enumerate()
        .map(|(i, own)| format!("<option value=\"{i}\">{}</option>", escape(&own.title)))
        .collect();
    format!(
        "<section id=\"{LIVE_ID}\" class=\"live-section\" aria-labelledby=\"live-title\">\
         <style>{STYLE}</style>\n\
         <h2 id=\"live-title\">What happens if …?</h2>\n\
         <p class=\"sub\">Change anything: the engine runs in this page. Drag the start in the phase portrait and the point in the map.</p>\n\
         <noscript><p class=\"note\">This section requires JavaScript.</p></noscript>\n\
         <p class=\"live-verdict\" data-live=\"verdict\" role=\"status\"></p>\n\
         <p class=\"live-error\" data-live=\"error\" role=\"alert\"></p>\n\
         <div class=\"live-grid\"><div class=\"live-figures\">{figures}</div>\n\
         <form class=\"live-controls\" autocomplete=\"off\" onsubmit=\"return false\">\
         <fieldset><legend>System</legend><label for=\"live-system\">Example</label>\
         <select id=\"live-system\" data-live=\"system\"><option value=\"-1\">own equations</option>{options}</select>\
         <details><summary>Equations</summary><label for=\"live-equations\">One entry per line, such as <code>acceleration.q=-k*q</code></label>\
         <textarea id=\"live-equations\" data-live=\"equations\" spellcheck=\"false\" wrap=\"off\"></textarea></details></fieldset>\
         <div data-live=\"numbers-form\"></div></form>\n\
         <div class=\"live-results\"><table class=\"live-numbers\"><thead><tr><th>quantity</th><th class=\"num\">predicted</th><th class=\"num\">measured</th></tr></thead>\
         <tbody data-live=\"numbers\"></tbody></table>\
         <div class=\"live-copy\"><button type=\"button\" data-live=\"copy-command\">Copy as command</button>\
         <button type=\"button\" data-live=\"copy-python\">Copy as Python</button>\
         <button type=\"button\" data-live=\"copy-link\">Copy link</button>\
         <span class=\"live-copied\" data-live=\"copied\" role=\"status\"></span></div>\
         <details><summary>Commands: what this page computes, in a terminal and in Python</summary>\
         <pre class=\"live-code\" tabindex=\"0\" role=\"group\" aria-label=\"Commands\"><code data-live=\"command-code\"></code></pre>\
         <pre class=\"live-code\" tabindex=\"0\" role=\"group\" aria-label=\"Python\"><code data-live=\"python-code\"></code></pre></details>\
         </div></div>\n\
         <script type=\"application/json\" id=\"live-settings\">{settings}</script>\n\
         <script type=\"application/octet-stream+base64\" id=\"live-engine\">{engine}</script>\n\
         <script>(() => {{\n\"use strict\";\n{scripts}}})();</script></section>\n",
        figures = figures(),
        // No `<` reaches the parser of the page, so no element can end or begin in the data.
        settings = serde_json::Value::from(entries).to_string().replace('<', "\\u003c"),
        engine = STANDARD.encode(ENGINE),
        scripts = SCRIPTS.concat(),
    )
}

fn figures() -> String {
    let select = |name: &str, label: &str| {
        format!("<select data-live=\"{name}\" aria-label=\"{label}\"></select>")
    };
    [
        ("phase", " drag", format!("<b>Phase portrait</b> of {}; gray: the reference.", select("columns", "Columns of the phase portrait"))),
        ("curve", "", "<b>Over time.</b> <span data-live=\"curve-caption\"></span>".to_owned()),
        ("circle", "", "<b>Unit circle.</b> <span data-live=\"circle-caption\"></span>".to_owned()),
        (
            "map",
            " drag",
            format!(
                "<b>Map of stability</b> over {} and {}: blue stable, orange unstable, blank not computed.",
                select("x-axis", "Horizontal axis of the map"),
                select("y-axis", "Vertical axis of the map")
            ),
        ),
    ]
    .map(|(name, class, caption)| {
        format!(
            "<figure><canvas class=\"live-canvas{class}\" data-live=\"{name}\" role=\"img\" aria-label=\"{name}\"></canvas>\
             <figcaption>{caption}</figcaption></figure>"
        )
    })
    .concat()
}

/// A page that is the section alone.
pub fn page(settings: &[LiveSetting], sub: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{POLICY}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Libration</title>\n<style>{colors}{PAGE_STYLE}\
         body{{display:block;max-width:1240px}}main{{max-width:none;padding:28px 0 64px}}.live-section h2{{margin-top:18px}}</style></head><body>\n\
         <main id=\"top\">\n<h1>Libration</h1>\n<p class=\"sub\">{sub}</p>\n{section}</main>\n</body></html>\n",
        colors = figure::STYLESHEET,
        sub = render_html(sub),
        section = section(settings),
    )
}
