// Counts beyond all lists.
// Provides: hold
// Binds: counters

// More items than any list holds, and half of what a counter holds: invocations may still add before one of them has put it back.
const BEYOND: u32 = 0x80000000u;

// Keeps a counter that was at `count` from beginning again at 0, which would look as if all had fitted.
fn hold(counter: u32, count: u32) {
    if count >= BEYOND {
        atomicStore(&counters[counter], BEYOND);
    }
}
