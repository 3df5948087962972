//! Three-vectors and rotations over any number type.

use crate::model::Number;

/// A vector in three dimensions.
pub(super) type Vec3<T> = [T; 3];
/// A 3 x 3 matrix, row by row.
pub(super) type Mat3<T> = [[T; 3]; 3];

#[inline(always)]
pub(super) fn add<T: Number>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn sub<T: Number>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn scale<T: Number>(k: T, a: Vec3<T>) -> Vec3<T> {
    [k * a[0], k * a[1], k * a[2]]
}

#[inline(always)]
pub(super) fn dot<T: Number>(a: Vec3<T>, b: Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross<T: Number>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// m a
#[inline(always)]
pub(super) fn apply<T: Number>(m: &Mat3<T>, a: Vec3<T>) -> Vec3<T> {
    [dot(m[0], a), dot(m[1], a), dot(m[2], a)]
}

/// mT a
#[inline(always)]
pub(super) fn apply_transposed<T: Number>(m: &Mat3<T>, a: Vec3<T>) -> Vec3<T> {
    add(add(scale(a[0], m[0]), scale(a[1], m[1])), scale(a[2], m[2]))
}

/// a b
#[inline(always)]
pub(super) fn multiply<T: Number>(a: &Mat3<T>, b: &Mat3<T>) -> Mat3<T> {
    [apply_transposed(b, a[0]), apply_transposed(b, a[1]), apply_transposed(b, a[2])]
}
