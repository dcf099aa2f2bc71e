//! The start of a program that describes itself.

use std::time::Duration;

use libration_probe::{BlackBoxError, ChildProcess};

fn started(script: &str) -> ChildProcess {
    let words = ["sh", "-c", script].map(str::to_owned);
    ChildProcess::start(&words, Vec::new(), Duration::from_millis(100)).unwrap()
}

#[test]
fn a_description_may_take_the_time_of_loading_and_an_answer_that_of_an_answer() {
    let mut child = started("sleep 0.3; echo described; sleep 5");
    assert_eq!(child.description(Duration::from_secs(20)).unwrap().trim(), "described");
    // A program that is late is no program that failed.
    let late = started("sleep 5").description(Duration::from_millis(200)).unwrap_err();
    assert!(matches!(late, BlackBoxError::NoAnswer { seconds, .. } if seconds == 0.2), "{late}");
    assert!(late.to_string().contains("gave no answer within 0.2 s"), "{late}");
    let ended = started("exit 3").description(Duration::from_secs(20)).unwrap_err();
    assert!(!matches!(ended, BlackBoxError::NoAnswer { .. }), "{ended}");
}
