//! The threads that a run shares its work among.

/// Threads that there are not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ThreadsError {
    message: String,
    /// What would be right.
    pub help: &'static str,
}

/// A number of threads.
#[derive(Debug)]
pub struct Pool {
    #[cfg(feature = "parallel")]
    pool: rayon::ThreadPool,
}

impl Pool {
    /// As many threads as asked for, or one per processor.
    ///
    /// # Errors
    /// Threads that the system does not give; more than one in a build without the feature `parallel`.
    #[cfg(feature = "parallel")]
    pub fn new(threads: Option<u16>) -> Result<Self, ThreadsError> {
        // Zero leaves the number to rayon.
        let threads = threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| ThreadsError {
            message: format!("cannot start {threads} threads: {error}"),
            help: "ask for fewer with --threads",
        })?;
        Ok(Self { pool })
    }

    /// One thread: this build has no others.
    ///
    /// # Errors
    /// More than one thread asked for.
    #[cfg(not(feature = "parallel"))]
    pub fn new(threads: Option<u16>) -> Result<Self, ThreadsError> {
        match threads {
            None | Some(1) => Ok(Self {}),
            Some(threads) => Err(ThreadsError {
                message: format!("cannot use {threads} threads: this build of vofkit works with one"),
                help: "leave out --threads, or build with `--features parallel`",
            }),
        }
    }

    /// How many there are.
    pub fn threads(&self) -> usize {
        #[cfg(feature = "parallel")]
        return self.pool.current_num_threads();
        #[cfg(not(feature = "parallel"))]
        1
    }

    /// Does the work with these threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        #[cfg(feature = "parallel")]
        return self.pool.install(work);
        #[cfg(not(feature = "parallel"))]
        work()
    }
}
