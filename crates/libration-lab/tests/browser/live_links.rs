//! Links to settings of the live section, and what a reader copies.

use libration_settings::equations::EquationSystem;
use libration_settings::live_settings;
use serde_json::json;

use crate::live::{SECTION, begin, drawn, entry, part, verdict};
use crate::page::{WIDTHS, visit};

#[test]
fn a_link_brings_no_code_into_what_a_reader_copies() {
    visit(WIDTHS[0], |page| {
        begin(page);
        for (key, value) in [
            ("integrator", "velocity-verlet; touch gone #"),
            ("seed", "0; touch gone"),
            ("dt", "0.1 $(touch gone)"),
            ("system", "x\"\"\"+str(1)+\"\"\""),
            ("system", "END\ntouch gone\n$(touch gone) `touch gone`"),
            ("start.q\ntouch gone\n", "1"),
        ] {
            let entries = [["system", "x"], ["coordinates", "q"], ["acceleration.q", "-q"]];
            let link: Vec<[&str; 2]> = [[key, value]].into_iter().chain(entries).collect();
            page.eval(&format!("location.hash = '#live&' + new URLSearchParams({})", json!(link)));
            page.frame();
            let texts = page.eval(&format!("{SECTION}.live.texts(true)"));
            let [command, python] = ["command", "python"].map(|name| texts[name].as_str().unwrap());
            // Text of a reader stands between quotes, in a document that the shell does not read.
            let file = command.split("END'\n").nth(1).unwrap().split("\nEND\n").next().unwrap();
            let outside = command.replace(file, "");
            assert!(!outside.contains("touch gone"), "{command}");
            assert!(!python.contains("\"\"\"+str"), "{python}");
            assert!(
                file.lines().all(|line| !line.contains("touch") || line.starts_with("name = \"")),
                "{file}"
            );
        }
    });
}

#[test]
fn a_link_with_part_of_a_setting_has_defaults_and_nonsense_is_named() {
    visit(WIDTHS[0], |page| {
        page.eval(
            "location.hash = '#live&system=x&coordinates=q&acceleration.q=-q&start.q=1&dt=abc'",
        );
        begin(page);
        let error = page.eval(&format!("{}.textContent", part("error")));
        assert_eq!(error, "Error: dt = abc; expected a number");
        assert_eq!([entry(page, "dt"), entry(page, "horizon")], [0.01, 10.0]);
        assert!(verdict(page).starts_with("Stable"));
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
