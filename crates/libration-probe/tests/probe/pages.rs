//! Pages of audits, as a reader sees them.

use libration_probe::{Description, Subject, error_in_words};
use libration_report::verdict::Outcome;

use crate::simulators::{Simulator, pendulum, pendulum_subject};

/// Whether a text has a number such as `6.4e-1`.
fn has_exponent(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes
        .windows(3)
        .any(|w| w[0].is_ascii_digit() && w[1] == b'e' && (w[2] == b'-' || w[2].is_ascii_digit()))
}

#[test]
fn a_finding_says_what_to_change_and_the_page_has_one_notation_of_numbers() {
    let mut long = pendulum_subject();
    // ω dt = 2.1, beyond the limit of 2.
    long.dt = 0.7;
    let euler = Simulator::new(|x, _, dt| vec![x[0] + dt * x[1], x[1] - dt * 9.0 * x[0]]);
    let exact = Simulator::new(|x, _, dt| {
        let (s, c) = (3.0 * dt).sin_cos();
        vec![c * x[0] + s / 3.0 * x[1], -3.0 * s * x[0] + c * x[1]]
    });
    let reports = [
        (Simulator::new(pendulum).audit(&long), "use a step of at most 0.666"),
        (euler.audit(&pendulum_subject()), "the mode of x2, x1 grows"),
        (exact.audit(&pendulum_subject()), "the step is exact, and has no order"),
        (
            Simulator::new(pendulum).audit(&pendulum_subject()),
            "The step might be up to 66.7 times as long, 0.6667 s",
        ),
    ];
    for (report, part) in &reports {
        let page = libration_probe::page(report);
        let main = page.split_once("<main").unwrap().1.split_once("</main>").unwrap().0;
        // Without data, figures and the live section, whose scripts have numbers of their own.
        let behind = |part: &str, end: &str| part.rsplit(end).next().unwrap_or(part).to_owned();
        let text: String =
            main.split("<section id=\"live\"").map(|part| behind(part, "</section>")).collect();
        let text: String = text.split("<figure").map(|part| behind(part, "</figure>")).collect();
        assert!(text.contains(part), "{part}: {text}");
        assert!(!has_exponent(&text), "{text}");
        assert!(report.findings.iter().all(|finding| !finding.help.is_empty()));
    }
    assert!(reports[0].0.findings[0].help.contains("2 substeps"), "{:?}", reports[0].0.findings);
    assert_eq!(reports[0].0.answer.matches("the longest stable step").count(), 1);
}

#[test]
fn the_first_screen_has_the_verdict_the_numbers_and_a_command() {
    let mut report = Simulator::new(pendulum).audit(&pendulum_subject());
    report.repeat_command = "libration probe --command ./p --state 0,0 --dt 0.01".into();
    let page = libration_probe::page(&report);
    let first = page.split_once("<main").unwrap().1.split_once("<section").unwrap().0;
    for part in [
        "has no fault</h1>",
        "in exact steps of the system",
        "longest stable step; dt = 0.01 s",
        "order of convergence; that of symplectic Euler",
        "--save-plant</span> plant.toml",
    ] {
        assert!(first.contains(part), "{part}: {first}");
    }
}

/// The words under the title of a page.
fn sub_line(page: &str) -> &str {
    let found = page.lines().find(|line| line.contains("libration probe") && line.contains("dt ="));
    found.unwrap_or_else(|| panic!("no line with dt"))
}

#[test]
fn a_page_and_the_results_have_the_versions_of_the_simulator_and_of_libration() {
    let described = |more: &str| {
        let text =
            format!(r#"{{"title": "p", "state": [0.5, 0], "action": [0], "dt": 0.01{more}}}"#);
        Description::parse(&text).unwrap().subject().unwrap()
    };
    let own = env!("CARGO_PKG_VERSION");
    let subject = described(r#", "version": "MuJoCo 4.0.0""#);
    let report = Simulator::new(pendulum).audit(&subject);
    assert_eq!(report.version.as_deref(), Some("MuJoCo 4.0.0"));
    let page = libration_probe::page(&report);
    let line = sub_line(&page);
    assert!(line.contains("MuJoCo 4.0.0") && line.contains(own), "{line}");
    assert!(line.contains(" steps ·"), "{line}");
    for more in ["", r#", "version": """#] {
        let mut report = Simulator::new(pendulum).audit(&described(more));
        assert_eq!((report.version.as_deref(), report.libration_version), (None, own));
        report.calls = 1;
        let page = libration_probe::page(&report);
        assert!(sub_line(&page).contains("1 step ·"), "{}", sub_line(&page));
    }
}

#[test]
fn an_error_that_exceeds_its_result_is_unknown() {
    assert_eq!(error_in_words(2e-9), "2·10⁻⁹");
    assert_eq!([4.7e307, 1.01, f64::NAN, f64::INFINITY].map(error_in_words), ["unknown"; 4]);
    let mut report = Simulator::new(pendulum).audit(&pendulum_subject());
    report.jacobian_error = 4.7e307;
    report.confirmation.as_mut().unwrap().error = 1e300;
    report.recognition.as_mut().unwrap().by_results.allowed = 1.3e34;
    let page = libration_probe::page(&report);
    for part in [
        "relative error of the matrices is unknown",
        "does not follow them",
        "the rates explain distances of unknown size",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("10³⁴") && !page.contains("10³⁰"));
}

#[test]
fn the_page_of_an_unknown_verdict_has_no_live_section_and_denies_no_integrator() {
    // The matrices of this force at its corner are those of a free mass, of which a live section says that it is stable.
    let corner = |x: &[f64], u: &[f64], dt: f64| {
        let v = x[1] + dt * (u[0] - 10.0 * x[0].abs());
        vec![x[0] + dt * v, v]
    };
    let at = |q: f64| Subject::new("corner", vec![q, 0.0], vec![0.0], 0.01);
    let report = Simulator::new(corner).audit(&at(0.0));
    assert_eq!(report.verdict.outcome, Outcome::Unknown, "{}", report.answer);
    let page = libration_probe::page(&report);
    assert!(!page.contains("id=\"live\"") && page.contains("The page has no live section"));
    let by_matrix = page.split("errors explain distances of unknown size").nth(1).unwrap();
    let table = by_matrix.split("</table>").next().unwrap();
    assert!(table.contains(">unknown<") && !table.contains(">no<"), "{table}");
    // A known verdict has both.
    let page = libration_probe::page(&Simulator::new(pendulum).audit(&pendulum_subject()));
    assert!(page.contains("id=\"live\"") && page.contains(">no<"));
}
