//! The stylesheet of figures in pages and in standalone files.

/// The stylesheet of figures in a page: the colours of all inks, light and dark, and the classes.
pub const STYLESHEET: &str = include_str!("../../assets/figure.css");

/// The light or dark colour of a custom property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    Light,
    Dark,
}

/// The part of the stylesheet for the figure itself.
fn plot() -> &'static str {
    let part = STYLESHEET.split("/* end plot */").next().unwrap_or_default();
    part.split_once("own. */").map_or("", |(_, rules)| rules)
}

/// The colour of a custom property.
pub(super) fn color(name: &str, tone: Tone) -> Option<&'static str> {
    let head = format!("--{name}:light-dark(");
    let (_, rest) = STYLESHEET.split_once(&head)?;
    let (light, rest) = rest.split_once(',')?;
    let (dark, _) = rest.split_once(')')?;
    Some(if tone == Tone::Light { light } else { dark })
}

/// The rules of a figure with colours in place of custom properties. Marks over a raster are light in
/// both tones.
pub(super) fn resolved_stylesheet(tone: Tone) -> String {
    let mut out = String::new();
    for rule in plot().lines() {
        out.push_str(&resolve(rule, tone));
        let colored = rule.contains("var(--") && rule.starts_with(".plot .");
        if tone == Tone::Dark && colored {
            let rule = resolve(rule, Tone::Light);
            // The class may stand on the element itself or around it.
            let own = rule.replacen(".plot ", ".plot .on-picture", 1);
            let inner = rule.replacen(".plot ", ".plot .on-picture ", 1);
            out.push_str(&own);
            out.push_str(&inner);
        }
    }
    out
}

fn resolve(rule: &str, tone: Tone) -> String {
    let mut out = String::new();
    let mut rest = rule;
    while let Some((before, after)) = rest.split_once("var(--") {
        out.push_str(before);
        let (name, after) = after.split_once(')').unwrap_or((after, ""));
        out.push_str(color(name, tone).unwrap_or("#808080"));
        rest = after;
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Role;

    const INKS: [Role; 11] = [
        Role::ExplicitEuler,
        Role::SymplecticEuler,
        Role::VelocityVerlet,
        Role::Rk4,
        Role::Leapfrog,
        Role::Yoshida4,
        Role::TextbookVerlet,
        Role::Theory,
        Role::Neutral,
        Role::Good,
        Role::Bad,
    ];

    #[test]
    fn every_ink_has_two_colours_and_a_class() {
        let accents = (0..Role::ACCENTS).map(Role::Accent);
        for ink in INKS.into_iter().chain(accents) {
            let name = ink.name();
            assert!(color(&name, Tone::Light).is_some(), "{name}");
            assert_ne!(color(&name, Tone::Light), color(&name, Tone::Dark), "{name}");
            assert!(plot().contains(&format!(".ink-{name}{{color:var(--{name})}}")), "{name}");
        }
    }

    #[test]
    fn integrators_differ_in_dash() {
        let mut dashes: Vec<_> =
            INKS[..7].iter().map(|ink| format!("{:?}", ink.dashes())).collect();
        dashes.sort();
        dashes.dedup();
        assert_eq!(dashes.len(), 7);
    }

    #[test]
    fn a_file_of_its_own_has_no_custom_property() {
        assert!(!resolved_stylesheet(Tone::Light).contains("var("));
        assert!(resolved_stylesheet(Tone::Light).contains("#c8500a"));
        assert!(resolved_stylesheet(Tone::Dark).contains("#f08a4b"));
    }
}
