//! Numbers that carry their derivatives through formulas.

use std::ops::{Add, Div, Mul, Sub};

/// Numbers, with or without a derivative.
pub trait Number:
    Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn root(self) -> Self;
}

impl Number for f64 {
    fn root(self) -> f64 {
        self.sqrt()
    }
}

/// A number and its derivative: of the same kind along one direction, or a vector along several.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dual<T, R> {
    pub value: T,
    pub rate: R,
}

impl<T, R: Default> Dual<T, R> {
    /// A number that does not change.
    pub fn still(value: T) -> Dual<T, R> {
        Dual { value, rate: R::default() }
    }
}

impl<T: Add<Output = T>, R: Add<Output = R>> Add for Dual<T, R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, rate: self.rate + other.rate }
    }
}

impl<T: Sub<Output = T>, R: Sub<Output = R>> Sub for Dual<T, R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Dual { value: self.value - other.value, rate: self.rate - other.rate }
    }
}

impl<T: Copy + Mul<Output = T>, R: Add<Output = R> + Mul<T, Output = R>> Mul for Dual<T, R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Dual { value: self.value * other.value, rate: self.rate * other.value + other.rate * self.value }
    }
}

impl<T: Copy + Div<Output = T>, R: Sub<Output = R> + Mul<T, Output = R> + Div<T, Output = R>> Div for Dual<T, R> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual { value, rate: (self.rate - other.rate * value) / other.value }
    }
}

impl<R: Mul<f64, Output = R>> Mul<Dual<f64, R>> for f64 {
    type Output = Dual<f64, R>;
    fn mul(self, other: Dual<f64, R>) -> Dual<f64, R> {
        Dual { value: self * other.value, rate: other.rate * self }
    }
}

impl<T: Number> Number for Dual<T, T> {
    fn root(self) -> Self {
        let value = self.value.root();
        Dual { value, rate: self.rate / (value + value) }
    }
}
