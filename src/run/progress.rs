//! Who is told how far a run has come.

/// Listens to a run. Every method may be called from another thread than the one that started the run.
pub trait Progress: Send {
    /// Something that is not a step starts, such as making the mesh.
    fn stage(&mut self, what: &str);

    /// The steps start.
    fn begin(&mut self, steps: usize);

    /// `done` steps are done.
    fn step(&mut self, done: usize, time: f64, mixed_cells: usize);

    /// The steps are over, or the run failed.
    fn end(&mut self);
}

/// Nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&mut self, _: &str) {}

    fn begin(&mut self, _: usize) {}

    fn step(&mut self, _: usize, _: f64, _: usize) {}

    fn end(&mut self) {}
}
