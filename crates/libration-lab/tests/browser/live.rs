//! The live section: the engine in the page, used with a pointer and with keys.

use libration::live::{Answer, answer};
use libration_settings::live_settings;
use serde_json::json;

use crate::page::{Page, WIDTHS, visit};

pub(crate) const SECTION: &str = "document.getElementById('live')";

/// Brings the section into the window and waits for its engine.
pub(crate) fn begin(page: &mut Page) {
    page.bring(SECTION);
    assert!(page.comes_true(&format!("{SECTION}.dataset.state === 'ready'")));
    drawn(page);
}

/// Waits until the figures show the setting, with what takes longer than a frame.
pub(crate) fn drawn(page: &mut Page) {
    let done = format!(
        "(() => {{ const live = {SECTION}.live; return !live.working && live.limitsOf === [...live.setting].map((x) => x.join('=')).join('\\n'); }})()"
    );
    assert!(page.comes_true(&done));
}

pub(crate) fn part(name: &str) -> String {
    format!("{SECTION}.querySelector('[data-live={name}]')")
}

pub(crate) fn verdict(page: &mut Page) -> String {
    drawn(page);
    page.eval(&format!("{}.textContent", part("verdict"))).as_str().unwrap().to_owned()
}

/// The entry of the setting.
pub(crate) fn entry(page: &mut Page, key: &str) -> f64 {
    page.number(&format!("Number({SECTION}.live.setting.get('{key}'))"))
}

/// A hash of the bits of times, states and commands (FNV-1a).
fn hash(answer: &Answer) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for (name, numbers) in &answer.columns {
        if ["time", "x.", "command."].iter().any(|own| name.starts_with(own)) {
            for byte in numbers.iter().flat_map(|x| x.to_le_bytes()) {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    hash.to_string()
}

const HASH: &str = "(answer) => {
    let hash = 0xcbf29ce484222325n;
    for (const name of Object.keys(answer)) {
        if (!/^(time|x\\.|command\\.)/.test(name)) continue;
        const column = answer[name];
        for (const byte of new Uint8Array(column.buffer, column.byteOffset, column.byteLength)) {
            hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
        }
    }
    return String(hash);
}";

#[test]
fn states_in_the_page_have_the_bits_of_the_native_engine() {
    let mut settings: Vec<String> = Vec::new();
    for example in live_settings::examples() {
        for integrator in ["velocity-verlet", "rk4", "dormand-prince-8", "gauss-legendre-4"] {
            settings.push(format!("{example}integrator={integrator}\n"));
        }
        if example.system == "pendulum" || example.system == "oscillator" {
            let timing =
                "gain=30,8\nperiod=0.03\nlatency=0.05\njitter=0.2\nskew=0.01\nloss=0.1\nseed=7\n";
            settings.push(format!("{example}{timing}"));
        }
    }
    let native: Vec<String> =
        settings.iter().map(|setting| hash(&answer(&format!("view\n{setting}")))).collect();
    let distinct: std::collections::BTreeSet<&String> = native.iter().collect();
    assert!(distinct.len() > 50, "{}", distinct.len());
    visit(WIDTHS[0], |page| {
        begin(page);
        let found = page.texts(&format!(
            "Promise.all({}.map(async (setting) => ({HASH})(await {SECTION}.live.engine.ask(`view\\n${{setting}}`))))",
            json!(settings)
        ));
        for ((setting, native), found) in settings.iter().zip(&native).zip(&found) {
            assert_eq!(native, found, "compile the engine anew with `cargo xtask live`: {setting}");
        }
    });
}

#[test]
fn dragging_the_point_of_the_map_across_the_limit_turns_the_verdict() {
    visit(WIDTHS[0], |page| {
        begin(page);
        assert!(verdict(page).starts_with("Stable"));
        let before = entry(page, "dt");
        let middle = page.bring(&part("map"));
        let end = (middle.0 + 140.0, middle.1);
        page.drag(middle, end);
        assert!(verdict(page).starts_with("Unstable"), "{}", verdict(page));
        assert!(entry(page, "dt") > 3.0 * before);
        let shown =
            page.eval(&format!("{SECTION}.live.rows.find((row) => row.key === 'dt').text.value"));
        assert_eq!(shown.as_str().unwrap().parse::<f64>().unwrap(), entry(page, "dt"));
        let link = page.eval("location.hash");
        assert!(link.as_str().unwrap().starts_with("#live&"), "{link}");
    });
}

#[test]
fn dragging_in_the_phase_portrait_moves_the_start() {
    visit(WIDTHS[1], |page| {
        begin(page);
        let middle = page.bring(&part("phase"));
        page.drag(middle, (middle.0 + 40.0, middle.1 - 30.0));
        drawn(page);
        let [q, v] = ["start.q", "start.q\\'"].map(|key| entry(page, key));
        assert!(q > 0.05 && v > 0.3, "{q} {v}");
        let first = page.number(&format!("{SECTION}.live.view['x.q'][0]"));
        assert_eq!(first, q);
    });
}

#[test]
fn keys_move_a_slider_and_texts_take_units() {
    visit(WIDTHS[0], |page| {
        begin(page);
        let row = format!("{SECTION}.live.rows.find((row) => row.key === 'dt')");
        let before = entry(page, "dt");
        page.eval(&format!("{row}.slider.focus()"));
        for _ in 0..5 {
            page.press("ArrowRight");
        }
        drawn(page);
        assert!(entry(page, "dt") > before);
        page.eval(&format!("{row}.text.focus(), {row}.text.select()"));
        for key in ["2", "0", "m", "s"] {
            page.press(key);
        }
        drawn(page);
        assert_eq!(entry(page, "dt"), 0.02);
        page.eval(&format!("{row}.text.select()"));
        page.press("x");
        let invalid = page.eval(&format!("{row}.text.getAttribute('aria-invalid')"));
        assert_eq!((invalid.as_str(), entry(page, "dt")), (Some("true"), 0.02));
        let problem = page.eval(&format!("{row}.problem.textContent"));
        assert!(problem.as_str().unwrap().contains("expected seconds such as"), "{problem}");
        // The border has the colour of errors.
        let has_color = format!(
            "getComputedStyle({row}.text).borderTopColor === getComputedStyle({row}.problem).color"
        );
        assert_eq!(page.eval(&has_color), true);
    });
}

#[test]
fn equations_that_a_reader_types_move_and_wrong_ones_are_named() {
    visit(WIDTHS[0], |page| {
        begin(page);
        let write = |page: &mut Page, text: &str| {
            let field = part("equations");
            page.eval(&format!(
                "{field}.value = {}, {field}.dispatchEvent(new Event('input'))",
                json!(text)
            ));
        };
        let says = |page: &mut Page, text: &str| {
            let shown = format!("{}.textContent === {}", part("error"), json!(text));
            assert!(page.comes_true(&shown), "{text}");
        };
        let begins = |page: &mut Page, x: f64| {
            assert!(page.comes_true(&format!("{SECTION}.live.view?.['x.x']?.[0] === {x}")));
        };
        let base = "system=mine\ncoordinates=x\nacceleration.x=-";
        write(page, &format!("{base}k*x^3\nparameter.k=4\nstart.x=2"));
        begins(page, 2.0);
        for (text, error) in [
            (format!("{base}r*x^3\nstart.x=2"), "Error: acceleration.x: unknown name `r`"),
            (format!("{base}x\nstart.x=two"), "Error: start.x = two; expected a number"),
            (format!("{base}x\nacceleration.x=-2*x"), "Error: `acceleration.x` is given twice"),
            ("[system]".to_owned(), "Error: unknown key `[system]`"),
        ] {
            write(page, &text);
            says(page, error);
            // The error stays, no answer of an earlier setting does, and there is nothing to copy.
            page.frame();
            says(page, error);
            assert_eq!(page.eval(&format!("{}.textContent", part("verdict"))), "");
            assert_eq!(page.eval(&format!("{}.disabled", part("copy-command"))), true);
        }
        write(page, &format!("{base}x\nstart.x=3"));
        says(page, "");
        begins(page, 3.0);
    });
}

#[test]
fn growth_by_nature_is_neither_good_nor_bad_and_labels_and_times_are_whole() {
    visit(WIDTHS[0], |page| {
        begin(page);
        let unstable = "system=bearing\ncoordinates=x\nacceleration.x=1e4*x-x^3*1e9\nstart.x=1e-5";
        let field = part("equations");
        page.eval(&format!(
            "{field}.value = {}, {field}.dispatchEvent(new Event('input'))",
            json!(unstable)
        ));
        assert!(page.comes_true(&format!("{SECTION}.live.view?.['x.x']?.[0] === 1e-5")));
        assert!(verdict(page).starts_with("Unstable by nature"), "{}", verdict(page));
        let class = page.eval(&format!("{}.className", part("verdict")));
        assert_eq!(class, "live-verdict neutral");
        let curve = format!("{SECTION}.live.plots.curve");
        let begins = page.number(&format!("{curve}.x.range[0]"));
        let ends = page.number(&format!("{curve}.x.range[1] / {SECTION}.live.view.horizon[0]"));
        assert_eq!((begins, ends), (0.0, 1.0));
        let widest = page.number(&format!(
            "Math.max(...{curve}.y.ticks().map((x) => {curve}.context.measureText((x || 0).toExponential(2)).width))"
        ));
        assert!(page.number(&format!("{curve}.box.left")) >= widest, "{widest}");
    });
}

#[test]
fn an_engine_that_does_not_answer_is_named() {
    visit(WIDTHS[0], |page| {
        begin(page);
        let message = page.eval(&format!(
            "(async () => {{ const live = {SECTION}.live; const {{ prototype }} = live.engine.constructor; const {{ ask }} = prototype;
               prototype.ask = async () => ({{ error: 'no answer' }});
               try {{ await live.begin(); return ''; }} catch (error) {{ return error.message; }} finally {{ prototype.ask = ask; }} }})()"
        ));
        assert_eq!(message, "no answer");
    });
}

#[test]
fn a_setting_that_takes_long_leaves_the_page_awake() {
    visit(WIDTHS[0], |page| {
        begin(page);
        let quadrotor = live_settings::examples()
            .into_iter()
            .find(|own| own.definitions.inputs.len() == 2)
            .unwrap()
            .to_string();
        let gain = "gain=1,1,1,1,1,1;1,1,1,1,1,1\nperiod=0.02\nlatency=0.03\njitter=0.3\n";
        page.eval(&format!(
            "location.hash = '#live&' + new URLSearchParams({}.trim().split('\\n').map((line) => line.split(/=(.*)/s).slice(0, 2)))",
            json!(format!("{quadrotor}{gain}"))
        ));
        let frames = page.number(
            "(async () => { const end = performance.now() + 500; let count = 0; while (performance.now() < end) { await new Promise(requestAnimationFrame); count++; } return count; })()",
        );
        assert!(frames > 5.0, "{frames}");
        // An answer that does not come is given up.
        let done = format!(
            "{SECTION}.live.view || {}.textContent.includes('takes too long')",
            part("error")
        );
        assert!(page.comes_true(&done));
    });
}

#[test]
fn a_loop_that_a_reader_switches_on_is_designed_and_latency_makes_it_unstable() {
    visit(WIDTHS[0], |page| {
        begin(page);
        page.eval("document.getElementById('live-loop').click()");
        assert!(page.comes_true(&format!("{SECTION}.live.setting.has('gain')")));
        assert!(verdict(page).starts_with("Stable"), "{}", verdict(page));
        let limit = page.number(&format!("{SECTION}.live.limits['latency.to'][0]"));
        for (factor, expected) in [(0.95, "Stable"), (1.05, "Unstable")] {
            page.eval(&format!("{SECTION}.live.set('latency', {})", factor * limit));
            assert!(verdict(page).starts_with(expected), "{}", verdict(page));
        }
    });
}

#[test]
fn every_control_has_a_name_and_nothing_is_wider_than_a_phone() {
    visit(WIDTHS[1], |page| {
        begin(page);
        page.eval("document.getElementById('live-loop').click()");
        assert!(page.comes_true(&format!("{SECTION}.live.setting.has('gain')")));
        drawn(page);
        let nameless = page.texts(&format!(
            "[...{SECTION}.querySelectorAll('input, select, textarea, button, canvas')].filter((own) =>
               !(own.labels && own.labels.length) && !own.getAttribute('aria-label') && !own.textContent.trim()).map((own) => own.outerHTML)"
        ));
        assert!(nameless.is_empty(), "{nameless:#?}");
        assert!(page.number("document.documentElement.scrollWidth") <= 390.0);
        let small = page.texts(&format!(
            "[...{SECTION}.querySelectorAll('input[type=range], button')].filter((own) => own.offsetHeight > 0 && own.offsetHeight < 24).map((own) => own.outerHTML)"
        ));
        assert!(small.is_empty(), "{small:#?}");
    });
}
