//! Hot loops of a kernel.

use super::function::Function;
use super::instruction::Instruction;

/// The loops of a function that compute with floats, or call what may, each with all that is in it.
///
/// The outermost ones: what is computed between the loops over lanes is computed at every step, too.
/// The rest only moves data, in or out, once for all steps.
pub(super) fn loops<'f, 'a>(function: &'f Function<'a>) -> Vec<&'f [Instruction<'a>]> {
    let mut spans: Vec<(usize, usize)> = function
        .body
        .iter()
        .enumerate()
        .filter_map(|(end, instruction)| Some((function.at(instruction.jump()?)?, end)))
        .filter(|(start, end)| start <= end)
        .collect();
    spans.sort_unstable();
    let mut outermost: Vec<(usize, usize)> = Vec::new();
    for (start, end) in spans {
        match outermost.last_mut() {
            Some(last) if start <= last.1 => last.1 = last.1.max(end),
            _ => outermost.push((start, end)),
        }
    }
    outermost
        .into_iter()
        .map(|(start, end)| &function.body[start..=end])
        .filter(|body| body.iter().any(|it| it.is_call() || it.arithmetic().is_some()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::function;

    fn lengths(body: &str) -> Vec<usize> {
        let assembly = format!("_RNvkernel:\n{body}\tretq\n");
        loops(&function::read(&assembly)[0]).iter().map(|body| body.len()).collect()
    }

    #[test]
    fn a_backward_jump_closes_a_loop() {
        assert_eq!(lengths(".L1:\n\taddpd\t%xmm0, %xmm1\n\tdecq\t%rax\n\tjne\t.L1\n"), [3]);
        assert_eq!(lengths(".L1:\n\tcallq\tstep\n\tjne\t.L1\n"), [2]);
    }

    #[test]
    fn loops_within_loops_are_one() {
        let body =
            ".L1:\n\tmulsd\t%xmm0, %xmm1\n.L2:\n\taddpd\t%xmm0, %xmm1\n\tjb\t.L2\n\tjne\t.L1\n";
        assert_eq!(lengths(body), [4]);
    }

    #[test]
    fn copying_and_jumping_ahead_are_no_hot_loops() {
        assert!(lengths(".L1:\n\tmovsd\t(%rax), %xmm0\n\tjne\t.L1\n").is_empty());
        assert!(lengths("\tjne\t.L1\n\taddpd\t%xmm0, %xmm1\n.L1:\n").is_empty());
    }
}
