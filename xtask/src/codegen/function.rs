//! The functions of an assembly.

use super::instruction::Instruction;

/// A function with its jumps resolved.
#[derive(Debug)]
pub(super) struct Function<'a> {
    /// The mangled name.
    pub(super) symbol: &'a str,
    /// The instructions in the order in which they stand.
    pub(super) body: Vec<Instruction<'a>>,
    /// Local labels, each with the index of the instruction that follows.
    labels: Vec<(&'a str, usize)>,
}

impl Function<'_> {
    /// The index of the instruction that follows a label of this function.
    pub(super) fn at(&self, label: &str) -> Option<usize> {
        self.labels.iter().find(|(name, _)| *name == label).map(|&(_, index)| index)
    }
}

/// All functions with a mangled Rust name.
pub(super) fn read(assembly: &str) -> Vec<Function<'_>> {
    let mut functions: Vec<Function<'_>> = Vec::new();
    let mut inside = false;
    for line in assembly.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        match line.strip_suffix(':') {
            Some(label) if label.trim_start_matches('_').starts_with('R') => {
                functions.push(Function { symbol: label, body: Vec::new(), labels: Vec::new() });
                inside = true;
            }
            // Local labels begin so, with or without the dot.
            Some(label) if label.trim_start_matches('.').starts_with('L') => {
                if let Some(function) = functions.last_mut().filter(|_| inside) {
                    function.labels.push((label, function.body.len()));
                }
            }
            Some(_) => inside = false,
            None if line.is_empty() || line.starts_with('.') => {}
            None => {
                if let Some(function) = functions.last_mut().filter(|_| inside) {
                    function.body.push(Instruction::new(line));
                }
            }
        }
    }
    functions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_read_with_their_labels() {
        let functions = read(
            "\
            \t.text\n_RNvone:\n\t.cfi_startproc\n\tmovl\t$4, %ecx\n.LBB0_1:\n\tdecl\t%ecx\t# why\n\
            \tjne\t.LBB0_1\n\tretq\n\t.cfi_endproc\nanon.1:\n\t.quad\t1\n_RNvtwo:\n\tretq\n",
        );
        let symbols: Vec<&str> = functions.iter().map(|function| function.symbol).collect();
        assert_eq!(symbols, ["_RNvone", "_RNvtwo"]);
        assert_eq!(functions[0].body.len(), 4);
        assert_eq!(functions[0].body[1], Instruction::new("decl\t%ecx"));
        assert_eq!(functions[0].at(".LBB0_1"), Some(1));
        assert_eq!(functions[0].at(".LBB9_9"), None);
        assert_eq!(functions[1].body.len(), 1);
    }
}
