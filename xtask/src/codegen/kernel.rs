//! Kernels and their symbols.

use std::fmt;

use super::catalogue::{MACHINE, METHODS, SYSTEMS};

/// A kernel of a block, as `ensemble/kernel.rs` makes them.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kernel {
    pub(super) instructions: Instructions,
    /// `f32` or `f64`.
    pub(super) float: String,
    /// By its name on the command line, or its type if it has none.
    pub(super) system: String,
    /// By its name on the command line, or its type if it has none.
    pub(super) method: String,
    /// Whether it goes through many blocks with few steps each (`Pass`), or takes many steps with one
    /// (`Advance`).
    pub(super) pass: bool,
    /// Lanes.
    pub(super) width: usize,
}

/// Instruction set of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Instructions {
    Avx2,
    Avx512,
}

impl Instructions {
    pub(super) const ALL: [Instructions; 2] = [Instructions::Avx2, Instructions::Avx512];

    /// Those for which a function is compiled, by the names of the types in its symbol.
    fn of(shim: &str) -> Option<Instructions> {
        match () {
            () if shim.contains("::V4") => Some(Instructions::Avx512),
            () if shim.contains("::V3") => Some(Instructions::Avx2),
            () => None,
        }
    }

    /// The letter of its widest registers.
    pub(super) fn register(self) -> char {
        match self {
            Instructions::Avx2 => 'y',
            Instructions::Avx512 => 'z',
        }
    }
}

impl fmt::Display for Instructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Instructions::Avx2 => "avx2",
            Instructions::Avx512 => "avx512",
        })
    }
}

impl Kernel {
    /// Returns the name in the table.
    pub(super) fn kind(&self) -> &'static str {
        if self.pass { "pass" } else { "advance" }
    }

    /// The loops over lanes of the block machine.
    fn of_machine((shim, arguments): (&str, &str)) -> Option<Kernel> {
        let [float] = arguments_of(arguments)?.try_into().ok()?;
        let instructions = Instructions::of(shim)?;
        let [system, method] = MACHINE.map(str::to_owned);
        // Its loops load and store, as those of a pass do.
        let (pass, width) = (true, 16);
        Some(Kernel { instructions, float: float.to_owned(), system, method, pass, width })
    }

    /// The kernel of this symbol, if it is one for AVX2 or AVX-512.
    pub(super) fn of(symbol: &str) -> Option<Kernel> {
        let demangled = format!("{:#}", rustc_demangle::try_demangle(symbol).ok()?);
        let of = |name: &str| demangled.split_once(name);
        if let Some(parts) = of("::runs::Runs<") {
            return Kernel::of_machine(parts);
        }
        let (pass, (shim, arguments)) = match of("::Advance<") {
            Some(parts) => (false, parts),
            None => (true, of("::Pass<")?),
        };
        let instructions = Instructions::of(shim)?;
        // The order of the parameters of both.
        let [float, method, _, _, system, _, width] = arguments_of(arguments)?.try_into().ok()?;
        let system = system.split('<').next().unwrap_or_default();
        Some(Kernel {
            instructions,
            float: float.to_owned(),
            system: called(&without_paths(system), &SYSTEMS),
            method: called(&without_paths(method), &METHODS),
            pass,
            width: width.trim_end_matches("usize").parse().ok()?,
        })
    }
}

/// The generic arguments up to the `>` that closes them.
fn arguments_of(text: &str) -> Option<Vec<&str>> {
    let (mut depth, mut start) = (0_usize, 0);
    let mut arguments = Vec::new();
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if depth > 0 => depth -= 1,
            ',' | '>' if depth == 0 => {
                arguments.push(text[start..at].trim());
                start = at + 1;
                if c == '>' {
                    return Some(arguments);
                }
            }
            _ => {}
        }
    }
    None
}

/// A type without the modules that it lies in.
pub(super) fn without_paths(name: &str) -> String {
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut short = String::new();
    for piece in name.split_inclusive(|c| !is_name(c)) {
        short.push_str(piece.rsplit("::").next().unwrap_or_default());
    }
    short.replace("usize", "")
}

/// The name by which the type is called.
fn called(kind: &str, names: &[(&str, &str)]) -> String {
    let name = names.iter().find(|(known, _)| *known == kind);
    name.map_or(kind, |(_, name)| name).to_owned()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The symbol of Yoshida's method on an oscillator, with AVX-512 on 64 lanes.
    pub(in crate::codegen) const SYMBOL: &str = "_RINvNvMs2_NtNtCs9I3Sfxch5Hm_4pulp3x862v4NtB8_2V4\
        9vectorize12imp_fastcallINtNvXs0_B8_BC_NtBc_4Simd9vectorize4ImplINtNtNtCslgnf09HP9XC_\
        9libration8ensemble6kernel7AdvancedINtNtNtB1T_10integrator11composition11Composition\
        NtNtB2L_15velocity_verlet14VelocityVerletKj3_EINtNtB1R_6assign3AllINtNtNtB1T_6system\
        10oscillator10OscillatordEEIB4e_dEB4x_Kj1_Kj40_EEEB1T_";

    /// The same in passes of 32 lanes.
    const PASS: &str = "_RINvNvMs2_NtNtCs9I3Sfxch5Hm_4pulp3x862v4NtB8_2V4\
        9vectorize3impINtNvXs0_B8_BC_NtBc_4Simd9vectorize4ImplINtNtNtCslgnf09HP9XC_\
        9libration8ensemble6kernel4PassdINtNtNtB1J_10integrator11composition11Composition\
        NtNtB2y_15velocity_verlet14VelocityVerletKj3_EINtNtB1H_6assign3AllINtNtNtB1J_6system\
        10oscillator10OscillatordEEIB41_dEB4k_Kj1_Kj20_EEEB1J_";

    #[test]
    fn a_symbol_tells_the_kernel() {
        let kernel = Kernel {
            instructions: Instructions::Avx512,
            float: "f64".to_owned(),
            system: "oscillator".to_owned(),
            method: "yoshida4".to_owned(),
            pass: false,
            width: 64,
        };
        assert_eq!(Kernel::of(SYMBOL), Some(kernel.clone()));
        assert_eq!(Kernel::of(PASS), Some(Kernel { pass: true, width: 32, ..kernel }));
    }

    #[test]
    fn other_functions_are_no_kernels() {
        assert_eq!(Kernel::of("_RNvCs1234_7mycrate3foo"), None);
        assert_eq!(Kernel::of("memcpy"), None);
    }

    #[test]
    fn a_type_that_nobody_listed_keeps_its_name() {
        assert_eq!(called(&without_paths("my::own::Step<other::Inner, 7usize>"), &METHODS), {
            "Step<Inner, 7>"
        });
    }
}
