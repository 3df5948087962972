//! Pieces of one trajectory, observed one after the other, as the trajectory.

use super::error::ObserveError;
use super::observation::{EquationFactor, Observation, TimeBlock};
use super::select::LeftOut;
use nalgebra::DMatrix;

/// Most blocks of time of one trajectory: their factors are kept in memory.
const MOST_BLOCKS: usize = 128;

impl Observation {
    /// Takes in what was observed of the next piece of a long recording. A trajectory that goes on, by its name, is
    /// continued: its factors are merged, which is exact, its blocks follow, and its counts are added. Short blocks
    /// are joined to longer ones where a trajectory would have more than 128. The rows themselves are not kept.
    ///
    /// # Errors
    /// Another model, other equations, or other extra unknowns.
    pub fn merge(&mut self, piece: Observation) -> Result<(), ObserveError> {
        self.append(piece)?;
        self.rows = None;
        // Each trajectory goes to the first of its name.
        let mut first: Vec<usize> = Vec::new();
        let place: Vec<usize> = (0..self.trajectories.len())
            .map(|k| {
                let same = |&f: &usize| self.trajectories[f] == self.trajectories[k];
                first.iter().position(same).unwrap_or_else(|| {
                    first.push(k);
                    first.len() - 1
                })
            })
            .collect();
        if first.len() == self.trajectories.len() && self.blocks.len() <= MOST_BLOCKS {
            return Ok(());
        }
        self.rates = first.iter().map(|&k| self.rates[k]).collect();
        self.bands = first.iter().map(|&k| self.bands[k]).collect();
        self.trajectories = first.iter().map(|&k| self.trajectories[k].clone()).collect();
        self.merge_groups(&place);
        self.merge_counts(&place);
        for block in &mut self.blocks {
            block.trajectory = place[block.trajectory];
            block.equations.iter_mut().for_each(|e| e.trajectory = block.trajectory);
        }
        self.blocks.sort_by_key(|b| b.trajectory);
        for trajectory in 0..self.trajectories.len() {
            if self.blocks.iter().filter(|b| b.trajectory == trajectory).count() > MOST_BLOCKS {
                self.lengthen_blocks(trajectory);
            }
        }
        Ok(())
    }

    /// Merges the factors of trajectories that go to the same place, and what noise adds to them.
    fn merge_groups(&mut self, place: &[usize]) {
        let mut groups: Vec<EquationFactor> = Vec::with_capacity(self.groups.len());
        let mut noise: Vec<DMatrix<f64>> = Vec::new();
        let added = self.noise_of_columns.take();
        for (k, mut group) in self.groups.drain(..).enumerate() {
            group.trajectory = place[group.trajectory];
            let at = join(&mut groups, group);
            if let Some(added) = added.as_ref().and_then(|all| all.get(k)) {
                match noise.get_mut(at) {
                    Some(own) => *own += added,
                    None => noise.push(added.clone()),
                }
            }
        }
        self.noise_of_columns = added.is_some().then_some(noise);
        self.groups = groups;
    }

    /// Adds the counts of trajectories that go to the same place.
    fn merge_counts(&mut self, place: &[usize]) {
        let mut counts: Vec<LeftOut> = Vec::with_capacity(self.left_out.len());
        for mut piece in self.left_out.drain(..) {
            piece.trajectory = place[piece.trajectory];
            let same = |c: &&mut LeftOut| (c.trajectory, c.equation) == (piece.trajectory, piece.equation);
            match counts.iter_mut().find(same) {
                Some(count) => {
                    count.used += piece.used;
                    count.standstill += piece.standstill;
                    count.fixed += piece.fixed;
                    count.windows += piece.windows;
                    count.edges += piece.edges;
                }
                None => counts.push(piece),
            }
        }
        self.left_out = counts;
    }

    /// Joins neighbouring blocks of a trajectory up to twice the mean length that would leave `MOST_BLOCKS`.
    fn lengthen_blocks(&mut self, trajectory: usize) {
        let rows = |b: &TimeBlock| b.equations.iter().map(|e| e.factor.rows()).sum::<usize>();
        let all: usize = self.blocks.iter().filter(|b| b.trajectory == trajectory).map(rows).sum();
        let longest = 2 * all / MOST_BLOCKS;
        let mut joined: Vec<TimeBlock> = Vec::with_capacity(self.blocks.len());
        for block in self.blocks.drain(..) {
            match joined.last_mut() {
                Some(last)
                    if block.trajectory == trajectory
                        && last.trajectory == trajectory
                        && rows(last) + rows(&block) <= longest =>
                {
                    last.time = [last.time[0].min(block.time[0]), last.time[1].max(block.time[1])];
                    for (own, more) in last.equations.iter_mut().zip(&block.equations) {
                        if more.factor.rows() > 0 {
                            own.factor.merge(&more.factor);
                        }
                    }
                }
                _ => joined.push(block),
            }
        }
        self.blocks = joined;
    }
}

/// Merges a factor into that of the same trajectory and equation, or adds it; its place.
fn join(groups: &mut Vec<EquationFactor>, group: EquationFactor) -> usize {
    let same = |g: &EquationFactor| (g.trajectory, g.equation) == (group.trajectory, group.equation);
    match groups.iter().position(same) {
        Some(place) => {
            if group.factor.rows() > 0 {
                groups[place].factor.merge(&group.factor);
            }
            groups[place].reversals.extend(group.reversals);
            place
        }
        None => {
            groups.push(group);
            groups.len() - 1
        }
    }
}
