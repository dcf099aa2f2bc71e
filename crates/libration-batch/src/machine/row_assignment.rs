//! Rows for the results of nodes.

use super::instruction::{Action, Instruction, Operand};
use super::lowering::{Lowering, Node, Source};

/// The rows of a program: instructions on few rows.
#[derive(Debug)]
pub(super) struct RowAssignment {
    /// Rows of which each holds a uniform value from the start, as pairs of row and value.
    pub(super) filled: Vec<(usize, usize)>,
    pub(super) instructions: Vec<Instruction>,
    /// The number of rows.
    pub(super) rows: usize,
}

/// Rows in use, with the nodes that need them last.
struct Rows<'l> {
    lowering: &'l Lowering,
    /// For each node, the last that needs its result.
    last_use: Vec<usize>,
    row_of: Vec<usize>,
    free: Vec<usize>,
    count: usize,
}

/// The last use of what is needed at the end.
const END: usize = usize::MAX;

impl RowAssignment {
    /// Instructions that begin with rows of `interface` and end with output `i` in row `targets[i]`, all of them below `interface`.
    pub(super) fn new(
        lowering: &Lowering,
        outputs: &[Source],
        targets: &[usize],
        interface: usize,
    ) -> Self {
        let nodes = &lowering.nodes;
        let mut last_use = vec![0; nodes.len()];
        let mut last_read = vec![None; interface];
        let mut note = |source: &Source, at: usize| match *source {
            Source::Node(n) => last_use[n] = at,
            Source::Input(row) => last_read[row] = Some(at),
            Source::Uniform(_) => {}
        };
        for (n, node) in nodes.iter().enumerate() {
            node.sources().iter().for_each(|source| note(source, n));
        }
        outputs.iter().for_each(|source| note(source, END));
        let row_of = vec![0; nodes.len()];
        let mut rows = Rows { lowering, last_use, row_of, free: Vec::new(), count: interface };
        let filled = rows.fill();
        // The row in which an output can stay: that of its target, once nothing reads it.
        let mut home: Vec<Option<usize>> = vec![None; nodes.len()];
        for (source, &target) in outputs.iter().zip(targets) {
            if let Source::Node(n) = *source
                && home[n].is_none()
                && last_read[target].is_none_or(|last| last <= n)
            {
                home[n] = Some(target);
            }
        }
        let mut instructions = Vec::with_capacity(nodes.len());
        for (n, node) in nodes.iter().enumerate() {
            let operands = node.operands.map(|source| rows.operand(node, source, &filled));
            rows.release(n, node, &home);
            let to = home[n].unwrap_or_else(|| rows.take());
            rows.row_of[n] = to;
            instructions.push(Instruction { action: node.action, operands, to });
        }
        instructions.extend(rows.moves(outputs, targets, &home));
        RowAssignment { filled, instructions, rows: rows.count }
    }
}

impl Rows<'_> {
    fn take(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// A row for each uniform value that an action needs as a row.
    fn fill(&mut self) -> Vec<(usize, usize)> {
        let mut filled: Vec<(usize, usize)> = Vec::new();
        let lowering = self.lowering;
        for node in lowering.nodes.iter().filter(|node| node.action.needs_rows()) {
            for source in node.sources() {
                if let Source::Uniform(u) = *source
                    && filled.iter().all(|&(_, known)| known != u)
                {
                    filled.push((self.take(), u));
                }
            }
        }
        filled
    }

    fn operand(&self, node: &Node, source: Source, filled: &[(usize, usize)]) -> Operand {
        match source {
            Source::Input(row) => Operand::Row(row),
            Source::Node(n) => Operand::Row(self.row_of[n]),
            Source::Uniform(u) => match filled.iter().find(|(_, known)| *known == u) {
                Some((row, _)) if node.action.needs_rows() => Operand::Row(*row),
                _ => Operand::Uniform(u),
            },
        }
    }

    /// Frees the rows of results that nothing needs after a node, unless they are the home of an output.
    fn release(&mut self, n: usize, node: &Node, home: &[Option<usize>]) {
        let sources = node.sources();
        for (i, source) in sources.iter().enumerate() {
            if let Source::Node(p) = *source
                && self.last_use[p] == n
                && home[p].is_none()
                && !sources[..i].contains(source)
            {
                self.free.push(self.row_of[p]);
            }
        }
    }

    /// Copies of outputs that are not in their rows yet: of inputs by way of other rows, since their own may be targets.
    fn moves(
        &mut self,
        outputs: &[Source],
        targets: &[usize],
        home: &[Option<usize>],
    ) -> Vec<Instruction> {
        let copy =
            |from: Operand, to| Instruction { action: Action::Copy, operands: [from; 4], to };
        let (mut first, mut then) = (Vec::new(), Vec::new());
        for (source, &target) in outputs.iter().zip(targets) {
            match *source {
                Source::Input(row) if row == target => {}
                Source::Input(row) => {
                    self.count += 1;
                    let aside = self.count - 1;
                    first.push(copy(Operand::Row(row), aside));
                    then.push(copy(Operand::Row(aside), target));
                }
                Source::Node(n) if home[n] == Some(target) => {}
                Source::Node(n) => then.push(copy(Operand::Row(self.row_of[n]), target)),
                Source::Uniform(u) => then.push(copy(Operand::Uniform(u), target)),
            }
        }
        first.extend(then);
        first
    }
}
