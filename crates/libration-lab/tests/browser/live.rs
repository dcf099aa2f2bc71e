//! The live section: the engine in the page, used with a pointer and with keys.

use libration::live::{Answer, answer};
use libration_settings::equations::EquationSystem;
use libration_settings::live_settings;
use serde_json::json;

use crate::page::{Page, WIDTHS, visit};

const SECTION: &str = "document.getElementById('live')";

/// Brings the section into the window and waits for its engine.
fn begin(page: &mut Page) {
    page.bring(SECTION);
    assert!(page.comes_true(&format!("{SECTION}.dataset.state === 'ready'")));
    drawn(page);
}

/// Waits until the figures show the setting, with what takes longer than a frame.
fn drawn(page: &mut Page) {
    let done = format!(
        "(() => {{ const live = {SECTION}.live; return !live.dirty && live.limitsOf === [...live.setting].map((x) => x.join('=')).join('\\n'); }})()"
    );
    assert!(page.comes_true(&done));
}

fn part(name: &str) -> String {
    format!("{SECTION}.querySelector('[data-live={name}]')")
}

fn verdict(page: &mut Page) -> String {
    drawn(page);
    page.eval(&format!("{}.textContent", part("verdict"))).as_str().unwrap().to_owned()
}

/// The entry of the setting.
fn entry(page: &mut Page, key: &str) -> f64 {
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
            "{}.map((setting) => ({HASH})({SECTION}.live.engine(`view\\n${{setting}}`)))",
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
        let error = |page: &mut Page| {
            page.eval(&format!("{}.textContent", part("error"))).as_str().unwrap().to_owned()
        };
        write(page, "system=mine\ncoordinates=x\nacceleration.x=-k*x^3\nparameter.k=4\nstart.x=2");
        drawn(page);
        assert_eq!(
            (error(page), page.number(&format!("{SECTION}.live.view['x.x'][0]"))),
            (String::new(), 2.0)
        );
        write(page, "system=mine\ncoordinates=x\nacceleration.x=-r*x^3\nstart.x=2");
        assert_eq!(error(page), "Error: acceleration.x: unknown name `r`");
        // The last setting that was right stays.
        assert_eq!(entry(page, "parameter.k"), 4.0);
    });
}

#[test]
fn a_loop_that_a_reader_switches_on_is_designed_and_latency_makes_it_unstable() {
    visit(WIDTHS[0], |page| {
        begin(page);
        page.eval("document.getElementById('live-loop').click()");
        assert!(verdict(page).starts_with("Stable"), "{}", verdict(page));
        let limit = page.number(&format!("{SECTION}.live.limits['latency.stable'][0]"));
        for (factor, expected) in [(0.95, "Stable"), (1.05, "Unstable")] {
            page.eval(&format!("{SECTION}.live.set('latency', {})", factor * limit));
            assert!(verdict(page).starts_with(expected), "{}", verdict(page));
        }
    });
}

#[test]
fn a_link_has_the_whole_setting_and_the_copied_file_is_that_of_the_system() {
    visit(WIDTHS[0], |page| {
        let chosen =
            live_settings::examples().into_iter().find(|own| own.system == "cart-pole").unwrap();
        let text = format!("{chosen}gain=-1,-30,-2,-6\nperiod=0.02\nlatency=0.01");
        let link = format!(
            "'#live&' + new URLSearchParams({}.split('\\n').map((line) => [line.slice(0, line.indexOf('=')), line.slice(line.indexOf('=') + 1)]))",
            json!(text)
        );
        page.eval(&format!("location.hash = {link}"));
        begin(page);
        assert_eq!((entry(page, "latency"), entry(page, "start.theta")), (0.01, 0.1));
        let command = page.eval(&format!("{}.textContent", part("command-code")));
        let command = command.as_str().unwrap().to_owned();
        let file = command.split("END").nth(1).unwrap().trim_start_matches('\'').trim_start();
        let system = EquationSystem::parse(file, "system.toml", &[]).unwrap();
        assert_eq!(system.definitions.accelerations, chosen.definitions.accelerations);
        assert_eq!(
            system.states.iter().map(|own| own.start).collect::<Vec<_>>(),
            [0.0, 0.1, 0.0, 0.0]
        );
        assert!(
            command.contains("--gain=\"-1,-30,-2,-6\" --period 0.02 --latency 0.01"),
            "{command}"
        );
        page.eval(&format!("{SECTION}.live.set('latency', 0.015)"));
        drawn(page);
        let link = page.eval(&format!("{SECTION}.live.setting.get('latency')"));
        assert_eq!(link, "0.015");
    });
}

#[test]
fn every_control_has_a_name_and_nothing_is_wider_than_a_phone() {
    visit(WIDTHS[1], |page| {
        begin(page);
        page.eval("document.getElementById('live-loop').click()");
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
