// Places in lists that may overflow: the counter keeps counting.

#import shared/params.wgsl

// More items than any list holds, and half of what a counter holds: invocations may still add before one of them has put it back.
const BEYOND: u32 = 0x80000000u;

// The first of some places in a counter's list. The counter does not begin again at 0, which would look as if all had fitted.
fn take_places(counter: u32, count: u32) -> u32 {
    let first = atomicAdd(&counters[counter], count);
    if first >= BEYOND {
        atomicStore(&counters[counter], BEYOND);
    }
    return first;
}
