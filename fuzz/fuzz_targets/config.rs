//! No bytes make the parser of configurations panic or point outside the text.

#![no_main]

use libfuzzer_sys::fuzz_target;
use libration_lab::config::parse_bytes;

fuzz_target!(|bytes: &[u8]| {
    match parse_bytes(bytes, "fuzz.toml") {
        Ok(config) => assert_eq!(config.check(), Ok(())),
        Err(error) => {
            assert!(error.source_text().get(error.span()).is_some());
            assert!(error.to_string().contains("fuzz.toml:"));
            assert!(!error.render_styled().is_empty());
        }
    }
});
