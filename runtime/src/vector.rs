//! Vectors and rotations of three dimensions over any [`Scalar`].
//!
//! Small on purpose: symbols and dual numbers go through the same few operations as `f64`, and a
//! product with a structural zero must reach the symbols so that they can fold it.

use handc_core::scalar::Scalar;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector of three components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<S>(pub [S; 3]);

impl<S: Scalar> Vec3<S> {
    /// The zero vector.
    #[inline]
    pub fn zero() -> Self {
        Vec3([S::zero(); 3])
    }
    /// From three components.
    #[inline]
    pub fn new(x: S, y: S, z: S) -> Self {
        Vec3([x, y, z])
    }
    /// Scalar product.
    #[inline]
    pub fn dot(self, other: Self) -> S {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }
    /// Vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Vec3([b * z - c * y, c * x - a * z, a * y - b * x])
    }
    /// Product with a scalar.
    #[inline]
    pub fn scale(self, factor: S) -> Self {
        let [x, y, z] = self.0;
        Vec3([x * factor, y * factor, z * factor])
    }
    /// Square of the length.
    #[inline]
    pub fn norm_squared(self) -> S {
        self.dot(self)
    }
    /// Whether every component is known to be zero before anything runs.
    pub fn is_known_zero(self) -> bool {
        self.0.iter().all(|x| x.is_known_zero())
    }
}

impl<S: Scalar> Add for Vec3<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Vec3([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}
impl<S: Scalar> Sub for Vec3<S> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Vec3([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}
impl<S: Scalar> Neg for Vec3<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        let [x, y, z] = self.0;
        Vec3([-x, -y, -z])
    }
}
impl<S: Scalar> AddAssign for Vec3<S> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<S: Scalar> SubAssign for Vec3<S> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// A 3×3 matrix by rows; as a rotation `parent_from_child` it takes child axes to parent axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat3<S>(pub [[S; 3]; 3]);

impl<S: Scalar> Mat3<S> {
    /// The identity.
    #[inline]
    pub fn identity() -> Self {
        let (o, l) = (S::zero(), S::one());
        Mat3([[l, o, o], [o, l, o], [o, o, l]])
    }
    /// The transpose, the inverse of a rotation.
    #[inline]
    pub fn transpose(self) -> Self {
        let m = self.0;
        Mat3([
            [m[0][0], m[1][0], m[2][0]],
            [m[0][1], m[1][1], m[2][1]],
            [m[0][2], m[1][2], m[2][2]],
        ])
    }
    /// Column `j`: the child's axis j in parent axes.
    #[inline]
    pub fn column(self, j: usize) -> Vec3<S> {
        Vec3([self.0[0][j], self.0[1][j], self.0[2][j]])
    }
    /// Product with the transpose, `selfᵀ v`.
    #[inline]
    pub fn transpose_mul(self, v: Vec3<S>) -> Vec3<S> {
        self.transpose() * v
    }
}

impl<S: Scalar> Mul<Vec3<S>> for Mat3<S> {
    type Output = Vec3<S>;
    #[inline]
    fn mul(self, v: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.0;
        Vec3([Vec3(x).dot(v), Vec3(y).dot(v), Vec3(z).dot(v)])
    }
}
impl<S: Scalar> Mul for Mat3<S> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b, c) = (self * other.column(0), self * other.column(1), self * other.column(2));
        Mat3([[a.0[0], b.0[0], c.0[0]], [a.0[1], b.0[1], c.0[1]], [a.0[2], b.0[2], c.0[2]]])
    }
}

/// A rigid transform `parent_from_child`: x_parent = R x_child + p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<S> {
    /// Child axes to parent axes.
    pub rotation: Mat3<S>,
    /// The child's origin in the parent.
    pub translation: Vec3<S>,
}

impl<S: Scalar> Transform<S> {
    /// The identity.
    pub fn identity() -> Self {
        Transform { rotation: Mat3::identity(), translation: Vec3::zero() }
    }
    /// A point of the child in the parent.
    #[inline]
    pub fn point(&self, p: Vec3<S>) -> Vec3<S> {
        self.rotation * p + self.translation
    }
    /// A point of the parent in the child.
    #[inline]
    pub fn inverse_point(&self, p: Vec3<S>) -> Vec3<S> {
        self.rotation.transpose_mul(p - self.translation)
    }
    /// The inverse transform.
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Transform { rotation, translation: -(rotation * self.translation) }
    }
}

impl<S: Scalar> Mul for Transform<S> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Transform {
            rotation: self.rotation * other.rotation,
            translation: self.point(other.translation),
        }
    }
}
