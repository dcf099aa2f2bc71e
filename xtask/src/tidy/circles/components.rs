//! Strongly connected components of a graph.

/// The sets of nodes of which each leads to every other, by Tarjan's algorithm (SIAM J. Comput. 1, 1972, §4).
///
/// Node `i` leads to the nodes `graph[i]`. Each set is in ascending order.
pub(super) fn components(graph: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let unvisited = vec![None; graph.len()];
    let on_stack = vec![false; graph.len()];
    let mut search =
        Search { graph, indices: unvisited, on_stack, stack: Vec::new(), count: 0, found: vec![] };
    for node in 0..graph.len() {
        if search.indices[node].is_none() {
            search.visit(node);
        }
    }
    search.found
}

struct Search<'a> {
    graph: &'a [Vec<usize>],
    /// When each node was visited.
    indices: Vec<Option<usize>>,
    on_stack: Vec<bool>,
    /// The visited nodes whose component is not yet complete.
    stack: Vec<usize>,
    count: usize,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    /// Returns the least index that `node` leads to on the stack.
    fn visit(&mut self, node: usize) -> usize {
        let index = self.count;
        self.count += 1;
        self.indices[node] = Some(index);
        self.on_stack[node] = true;
        self.stack.push(node);
        let mut lowest = index;
        for &next in &self.graph[node] {
            match self.indices[next] {
                None => lowest = lowest.min(self.visit(next)),
                Some(other) if self.on_stack[next] => lowest = lowest.min(other),
                Some(_) => {}
            }
        }
        if lowest == index {
            self.complete(node);
        }
        lowest
    }

    /// Takes the component that begins with `root` off the stack.
    fn complete(&mut self, root: usize) {
        let start = self.stack.iter().rposition(|&node| node == root).unwrap_or_default();
        let mut component = self.stack.split_off(start);
        for &node in &component {
            self.on_stack[node] = false;
        }
        component.sort_unstable();
        self.found.push(component);
    }
}

#[cfg(test)]
mod tests {
    use super::components;

    #[test]
    fn two_circles_that_meet_are_one_component() {
        let graph = [vec![1], vec![2, 3], vec![0], vec![4], vec![3], vec![0]];
        let mut found = components(&graph);
        found.sort();
        assert_eq!(found, [vec![0, 1, 2], vec![3, 4], vec![5]]);
    }
}
