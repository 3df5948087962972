//! The order in which nodes are computed.

use super::expr::{Expr, Node};
use super::graph::Graph;

/// For each output, the operations to be done before it that no earlier output has done.
///
/// The order keeps live ranges short: depth first from the outputs in their order, the operand that needs more
/// values at a time first (Sethi and Ullman 1970).
pub fn schedule(graph: &Graph, outputs: &[Expr]) -> Vec<Vec<usize>> {
    let mut need = vec![0_u32; graph.len()];
    for at in graph.reachable(outputs) {
        let mut needs: Vec<u32> = graph.operands(at).map(|e| need[e.node()]).collect();
        needs.sort_unstable_by(|a, b| b.cmp(a));
        need[at] = needs.iter().enumerate().map(|(k, n)| n + k as u32).max().unwrap_or(0).max(1);
    }
    let mut done = vec![false; graph.len()];
    let mut orders = Vec::with_capacity(outputs.len());
    for output in outputs {
        let mut order = Vec::new();
        let mut stack = vec![(output.node(), false)];
        while let Some((at, ready)) = stack.pop() {
            if done[at] {
                continue;
            }
            if ready {
                done[at] = true;
                if matches!(
                    graph.node(at),
                    Node::Sum(..) | Node::Product(..) | Node::Sign(_) | Node::InverseRoot(_)
                ) {
                    order.push(at);
                }
                continue;
            }
            stack.push((at, true));
            let mut operands: Vec<usize> = graph.operands(at).map(Expr::node).collect();
            operands.sort_by_key(|&o| need[o]);
            stack.extend(operands.into_iter().map(|o| (o, false)));
        }
        orders.push(order);
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::super::Symbol;
    use super::*;

    #[test]
    fn operands_come_before_what_needs_them_and_dead_nodes_do_not_come() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Velocity(0));
        let y = g.symbol(Symbol::Velocity(1));
        let dead = g.mul(y, y);
        let a = g.mul(x, y);
        let b = g.add(a, x);
        let c = g.mul(b, a);
        let order = schedule(&g, &[c, b]);
        assert_eq!(order, vec![vec![a.node(), b.node(), c.node()], vec![]]);
        assert!(!order.concat().contains(&dead.node()));
    }
}
