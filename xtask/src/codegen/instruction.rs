//! One instruction, in the syntax that compilers print: operands from source to destination.

/// An instruction of x86-64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Instruction<'a> {
    name: &'a str,
    operands: &'a str,
}

/// On how many numbers arithmetic is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arithmetic {
    /// One.
    Scalar,
    /// All that are in the register.
    Packed,
}

/// Floating-point operations without prefix and type.
const OPERATIONS: [&str; 7] = ["add", "sub", "mul", "div", "sqrt", "min", "max"];

impl<'a> Instruction<'a> {
    /// Reads a line that is neither label nor directive.
    pub(super) fn new(line: &'a str) -> Self {
        let (name, operands) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        Instruction { name, operands: operands.trim() }
    }

    /// Whether it computes with floats, and with how many.
    pub(super) fn arithmetic(self) -> Option<Arithmetic> {
        let name = self.name.strip_prefix('v').unwrap_or(self.name);
        let (operation, kind) = name.split_at_checked(name.len().checked_sub(2)?)?;
        let fused = operation.starts_with("fm") || operation.starts_with("fnm");
        if !OPERATIONS.contains(&operation) && !fused {
            return None;
        }
        match kind {
            "ss" | "sd" => Some(Arithmetic::Scalar),
            "ps" | "pd" => Some(Arithmetic::Packed),
            _ => None,
        }
    }

    /// The letter of the widest vector registers that it names: `x`, `y` or `z`.
    pub(super) fn register(self) -> Option<char> {
        let registers = [("%zmm", 'z'), ("%ymm", 'y'), ("%xmm", 'x')];
        registers.into_iter().find(|(name, _)| self.operands.contains(name)).map(|(_, r)| r)
    }

    /// Whether it leaves for another function.
    pub(super) fn is_call(self) -> bool {
        self.name.starts_with("call")
    }

    /// The label that it may go on at.
    pub(super) fn jump(self) -> Option<&'a str> {
        self.name.starts_with('j').then_some(self.operands)
    }

    /// The place on the stack that it writes, if that is the same each time: a spilled register. An
    /// array is written at an index that changes.
    pub(super) fn spills_to(self) -> Option<&'a str> {
        let place = self.fixed_place()?;
        (self.name.contains("mov") && self.operands.ends_with(place)).then_some(place)
    }

    /// The place on the stack that it reads, if that is the same each time.
    pub(super) fn reloads(self) -> Option<&'a str> {
        if self.spills_to().is_some() { None } else { self.fixed_place() }
    }

    /// An operand such as `-64(%rsp)`, without an index.
    fn fixed_place(self) -> Option<&'a str> {
        let base = ["(%rsp)", "(%rbp)"].into_iter().find_map(|base| self.operands.find(base))?;
        let start = self.operands[..base].rfind([' ', ',']).map_or(0, |at| at + 1);
        Some(&self.operands[start..base + "(%rsp)".len()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arithmetic(line: &str) -> Option<Arithmetic> {
        Instruction::new(line).arithmetic()
    }

    #[test]
    fn arithmetic_is_told_from_the_rest() {
        for packed in [
            "vmulpd\t%zmm1, %zmm2, %zmm3",
            "vsqrtps\t(%rax), %ymm3",
            "vfmadd213pd\t%zmm1, %zmm2, %zmm3",
            "addpd\t%xmm1, %xmm2",
        ] {
            assert_eq!(arithmetic(packed), Some(Arithmetic::Packed), "{packed}");
        }
        for scalar in ["vsubsd\t%xmm1, %xmm2, %xmm3", "divss\t%xmm1, %xmm2"] {
            assert_eq!(arithmetic(scalar), Some(Arithmetic::Scalar), "{scalar}");
        }
        for other in ["addq\t$8, %rax", "vmovapd\t%zmm1, %zmm2", "vpaddq\t%zmm1, %zmm2, %zmm3"] {
            assert_eq!(arithmetic(other), None, "{other}");
        }
        assert_eq!(arithmetic("retq"), None);
    }

    #[test]
    fn the_widest_register_counts() {
        let register = |line| Instruction::new(line).register();
        assert_eq!(register("vbroadcastsd\t%xmm1, %zmm2"), Some('z'));
        assert_eq!(register("vpand\t%ymm1, %ymm2, %ymm3"), Some('y'));
        assert_eq!(register("vpextrq\t$1, %xmm2, %rax"), Some('x'));
        assert_eq!(register("addq\t$8, %rax"), None);
    }

    #[test]
    fn a_spill_is_a_store_to_a_fixed_place() {
        let spill = Instruction::new("vmovaps\t%zmm1, 64(%rsp)");
        assert_eq!((spill.spills_to(), spill.reloads()), (Some("64(%rsp)"), None));
        let reload = Instruction::new("vmovaps\t64(%rsp), %zmm1");
        assert_eq!((reload.spills_to(), reload.reloads()), (None, Some("64(%rsp)")));
        let operand = Instruction::new("vmulpd\t-8(%rbp){1to8}, %zmm2, %zmm3");
        assert_eq!((operand.spills_to(), operand.reloads()), (None, Some("-8(%rbp)")));
    }

    #[test]
    fn an_array_on_the_stack_is_no_spill() {
        let plane = Instruction::new("vmovaps\t%zmm1, 64(%rsp,%rax,4)");
        assert_eq!((plane.spills_to(), plane.reloads()), (None, None));
    }
}
