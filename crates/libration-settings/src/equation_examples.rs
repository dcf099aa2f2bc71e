//! Files of equations that come with the program.

/// A file of equations.
#[derive(Clone, Copy, Debug)]
pub struct EquationExample {
    /// The name: that of its file, with dashes.
    pub name: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

macro_rules! examples {
    ($($name:literal $file:literal)*) => {
        [$(EquationExample {
            name: $name,
            text: include_str!(concat!("../../../examples/systems/", $file, ".toml")),
        }),*]
    };
}

impl EquationExample {
    /// All of them.
    pub const ALL: [EquationExample; 9] = examples! {
        "cart-pole" "cart_pole"
        "chain" "chain"
        "dc-motor" "dc_motor"
        "double-pendulum" "double_pendulum"
        "lorenz" "lorenz"
        "magnetic-bearing" "magnetic_bearing"
        "planar-quadrotor" "planar_quadrotor"
        "three-body" "three_body"
        "van-der-pol" "van_der_pol"
    };

    /// The example of this name.
    pub fn find(name: &str) -> Option<EquationExample> {
        EquationExample::ALL.into_iter().find(|example| example.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::EquationSystem;

    #[test]
    fn every_example_is_a_system_with_a_description_and_every_file_is_an_example() {
        for EquationExample { name, text } in EquationExample::ALL {
            let system = EquationSystem::parse(text, name, &[]).unwrap();
            assert!(!system.description.is_empty(), "{name}");
        }
        let folder =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|file| {
                file.unwrap().path().file_stem().unwrap().to_string_lossy().replace('_', "-")
            })
            .collect();
        files.sort();
        assert_eq!(files, EquationExample::ALL.map(|example| example.name));
    }
}
