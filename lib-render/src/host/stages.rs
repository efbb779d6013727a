//! What a thread of the device of streams spends its time on: the parts of the paper's Figure 2.

use std::time::Duration;

use super::clock::thread_time;

/// A part of the work. Sorting, compaction and what goes to the film is in none.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stage {
    /// New paths, with their first ray.
    Generate,
    /// Tracing rays from the camera.
    Camera,
    /// Tracing rays that a surface scattered.
    Secondary,
    /// Tracing rays to lights.
    Shadow,
    /// Path vertices on surfaces: emission, shadow ray, next ray.
    Shade,
    /// Paths that leave the scene.
    Miss,
}

impl Stage {
    /// All of them.
    pub const ALL: [Stage; 6] =
        [Stage::Generate, Stage::Camera, Stage::Secondary, Stage::Shadow, Stage::Shade, Stage::Miss];
}

/// What a stage took.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Spent {
    /// Time that the thread ran for.
    pub time: Duration,
    /// Rows that it was run over: paths, rays or vertices; of shadow rays those that were not asked for too.
    pub rows: u64,
}

/// What each stage took, and all of it together.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Stages {
    spent: [Spent; Stage::ALL.len()],
    /// Time that the thread ran for, whatever it did.
    pub total: Duration,
}

impl Stages {
    /// What a stage took.
    pub fn of(&self, stage: Stage) -> Spent {
        self.spent[stage as usize]
    }

    /// Adds what another render took.
    pub fn add(&mut self, other: &Stages) {
        for (spent, more) in self.spent.iter_mut().zip(other.spent) {
            spent.time += more.time;
            spent.rows += more.rows;
        }
        self.total += other.total;
    }

    /// Time in no stage: sorting, compaction, the film.
    pub fn rest(&self) -> Duration {
        self.total.saturating_sub(self.spent.iter().map(|s| s.time).sum())
    }
}

/// Takes the time of each stage, where somebody asks for it.
pub(super) struct Clock<'s>(Option<&'s mut Stages>);

impl<'s> Clock<'s> {
    /// A clock that adds to these stages, or one that stands still.
    pub(super) fn new(stages: Option<&'s mut Stages>) -> Clock<'s> {
        Clock(stages)
    }

    /// Does some work and charges a stage with it.
    pub(super) fn stage<T>(&mut self, stage: Stage, rows: u32, work: impl FnOnce() -> T) -> T {
        let Some(stages) = &mut self.0 else { return work() };
        let start = thread_time();
        let result = work();
        let spent = &mut stages.spent[stage as usize];
        spent.time += thread_time().saturating_sub(start);
        spent.rows += u64::from(rows);
        result
    }

    /// Does all of the work.
    pub(super) fn total<T>(mut self, work: impl FnOnce(&mut Clock) -> T) -> T {
        let start = thread_time();
        let result = work(&mut self);
        if let Some(stages) = self.0 {
            stages.total += thread_time().saturating_sub(start);
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Works for so long.
    fn busy(time: Duration) {
        let end = thread_time() + time;
        while thread_time() < end {}
    }

    #[test]
    fn time_goes_to_the_stage_that_took_it() {
        let (short, mut stages) = (Duration::from_micros(300), Stages::default());
        Clock::new(Some(&mut stages)).total(|clock| {
            clock.stage(Stage::Shade, 7, || busy(short));
            clock.stage(Stage::Shade, 5, || ());
            busy(2 * short);
        });
        let shade = stages.of(Stage::Shade);
        assert_eq!((shade.rows, stages.of(Stage::Miss)), (12, Spent::default()));
        assert!(shade.time >= short && stages.rest() >= 2 * short, "{stages:?}");
        assert_eq!(stages.rest() + shade.time, stages.total);
    }
}
