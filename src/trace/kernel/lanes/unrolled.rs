//! Loops over the vectors that are traced side by side, written out.

/// Does the same for each number from 1 to 3 that is below `$n`, written out: where the work is long the compiler keeps
/// the loop, and leaves what it indexes in memory and copied about.
macro_rules! each_further {
    ($u:ident < $n:ident, $work:block) => {
        if $n > 1 {
            let $u = 1;
            $work
        }
        if $n > 2 {
            let $u = 2;
            $work
        }
        if $n > 3 {
            let $u = 3;
            $work
        }
    };
}
pub(in crate::trace) use each_further;
