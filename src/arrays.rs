//! Small arrays, one element after another.

/// [`MapEach::map_each`] of arrays.
pub trait MapEach<T> {
    type Mapped<U>;

    /// What `map` of the standard library does, always inlined. That one is a loop over what is left of the array, compiled for
    /// each closure, and called where optimization sees one unit at a time: too slow for the arithmetic of a ray.
    fn map_each<U>(self, f: impl FnMut(T) -> U) -> Self::Mapped<U>;
}

macro_rules! map_each {
    ($($length:literal: $($element:ident)*;)*) => {$(
        impl<T> MapEach<T> for [T; $length] {
            type Mapped<U> = [U; $length];

            #[inline(always)]
            fn map_each<U>(self, mut f: impl FnMut(T) -> U) -> [U; $length] {
                let [$($element),*] = self;
                [$(f($element)),*]
            }
        }
    )*};
}

map_each! {
    2: a b;
    3: a b c;
    4: a b c d;
}
