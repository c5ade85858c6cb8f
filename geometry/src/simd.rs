//! The widest vector instructions that the processor has, found once at run time.
//!
//! They are made by the compiler from plain loops, and do what plain instructions do: no result depends on them.

use std::sync::LazyLock;

use pulp::Arch;

static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);

/// Runs a function in them, as far as all that it calls is inlined.
#[inline(always)]
pub(crate) fn widest<T>(function: impl FnOnce() -> T) -> T {
    ARCH.dispatch(function)
}

/// One of two numbers: a choice that may be made of vectors, lane by lane.
#[inline(always)]
pub(crate) fn either(condition: bool, yes: f64, no: f64) -> f64 {
    if condition { yes } else { no }
}
