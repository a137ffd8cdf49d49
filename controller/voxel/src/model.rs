//! Evaluates a function from its local geometric characteristics (A. Tolok 2016, "The functional
//! voxel method in computer modelling"; Tolok et al., FVM, eqs. 16 and 17).
//!
//! Each node stores the unit vector of the plane that touches the function's graph there: cos alpha
//! x + cos beta y + cos gamma z = cos delta (eq. 16; one more at the front for three variables).
//!
//! Differences to the literature:
//!
//! - Coordinates are relative to the node, in units of half of the extent; with one origin, cos
//!   delta loses bits.
//! - Components are signed integers, so that 0 is exactly 0; none of an M-image's greys is 0.
//! - [`Model::blend`] of the surrounding planes is continuous, with errors of the square of the
//!   step; [`Model::nearest`] is the original method.

use crate::file::{FileError, HEADER_LEN, Header};
use core::array;
use serde::{Serialize, Serializer};
use staya_controller::geom::Vec2;
use staya_controller::scalar::Scalar;

/// Value and gradient of a function at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local<S, const V: usize> {
    /// The function's value, in its own units.
    pub value: S,
    /// Its derivatives.
    pub gradient: [S; V],
}

impl<S: Scalar> Local<S, 2> {
    /// Unit vector of the steepest increase (eq. 17); `None` where the function is level.
    #[must_use]
    pub fn direction(&self) -> Option<Vec2<S>> {
        let [x, y] = self.gradient;
        Vec2::new(x, y).normalized()
    }

    /// Signed distance to the border, where the function is 0, to first order; it has the
    /// function's sign. `None` where the function is level.
    #[must_use]
    pub fn distance(&self) -> Option<S> {
        let [x, y] = self.gradient;
        self.value.checked_div(Vec2::new(x, y).norm())
    }
}

/// A function of `V` variables, 2 or 3, in borrowed bytes: `&'static [u8]` in flash.
pub type Model<'a, S, const V: usize> = ModelIn<&'a [u8], S, V>;

/// As [`Model`], in bytes `B`, which a host may own or share. About 8 + 13 V bytes (`f32`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelIn<B, S, const V: usize> {
    bytes: B,
    component_len: usize,
    node_len: usize,
    /// Fixed point could not hold sums of products of whole components.
    one: S,
    unit: S,
    axes: [Axis<S>; V],
    checksum: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis<S> {
    first: S,
    per_step: S,
    last: i32,
    /// Index distance of neighbouring nodes.
    stride: usize,
    /// In half of the extent.
    scale: S,
    /// Unit of values in half of the extent.
    slope: S,
    high: S,
}

/// Digests of agents contain the model's checksum.
impl<B, S, const V: usize> Serialize for ModelIn<B, S, V> {
    fn serialize<T: Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        serializer.serialize_u32(self.checksum)
    }
}

impl<B: AsRef<[u8]>, S: Scalar, const V: usize> ModelIn<B, S, V> {
    /// Opens and checks the model in these bytes, written by `staya voxel build`: O(length).
    ///
    /// # Errors
    /// [`FileError`], for the first error found; `S` must represent all fields.
    pub fn from_bytes(bytes: B) -> Result<Self, FileError> {
        let header = Header::read(bytes.as_ref())?;
        if usize::from(header.variables) != V {
            return Err(FileError::Variables { needed: V as u8, found: header.variables });
        }
        let one = S::from_ratio(1, 1 << (u32::from(header.depth).saturating_sub(1)));
        let unit = S::from_f32(header.unit).filter(|&unit| unit > S::ZERO).ok_or(FileError::Field(40))?;
        let mut stride = 1_usize;
        let mut axes = [Axis {
            first: S::ZERO,
            per_step: S::ZERO,
            last: 0,
            stride: 0,
            scale: S::ZERO,
            slope: S::ZERO,
            high: S::ZERO,
        }; V];
        let fields = header.nodes.iter().zip(&header.first).zip(&header.step);
        for ((index, axis), ((&nodes, &first), &step)) in axes.iter_mut().enumerate().zip(fields) {
            let at = index.saturating_mul(4).saturating_add(28);
            let last = i32::from(nodes).saturating_sub(1);
            let half = 0.5 * last as f32 * step;
            let number = |number: f32| S::from_f32(number).ok_or(FileError::Field(at));
            *axis = Axis {
                first: number(first)?,
                per_step: number(1.0 / step)?,
                last,
                stride,
                scale: number(2.0 / last as f32)?,
                slope: number(header.unit / half)?,
                high: number(first + 2.0 * half)?,
            };
            stride = stride.saturating_mul(nodes.into());
        }
        Ok(Self {
            component_len: header.component_len(),
            node_len: header.components().saturating_mul(header.component_len()),
            one,
            unit,
            axes,
            checksum: crate::checksum(bytes.as_ref()),
            bytes,
        })
    }

    /// The CRC-32 of the model, which distinguishes models.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        self.checksum
    }

    /// Size in flash, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes.as_ref().len()
    }

    /// The least and the greatest coordinate along each axis; the model is undefined outside.
    #[must_use]
    pub fn extent(&self) -> [[S; 2]; V] {
        self.axes.map(|axis| [axis.first, axis.high])
    }

    /// Evaluates the plane of the nearest node: the original functional voxel method. It jumps
    /// between voxels; errors decrease with the step in gradients, with its square in values.
    ///
    /// `None` outside the extent, for input that is not finite, and where the function is too steep
    /// for the depth. Work: one node.
    #[must_use]
    pub fn nearest(&self, at: [S; V]) -> Option<Local<S, V>> {
        let (mut node, mut offset) = (0_usize, [S::ZERO; V]);
        for ((axis, x), offset) in self.axes.iter().zip(at).zip(&mut offset) {
            let steps = axis.steps(x)?;
            let index = (steps + S::HALF).floor_to_i32()?.clamp(0, axis.last.max(0));
            node = axis.advance(node, index)?;
            *offset = (steps - S::from_i32(index)) * axis.scale;
        }
        let mut sum = Sum::NONE;
        self.add(&mut sum, node, S::ONE, &offset)?;
        self.local(&sum)
    }

    /// Evaluates the blended planes of the 2^V surrounding nodes: continuous, with errors of the
    /// square of the step. `None` as in [`Model::nearest`]. Work: 4 or 8 nodes.
    #[must_use]
    pub fn blend(&self, at: [S; V]) -> Option<Local<S, V>> {
        let (mut node, mut on) = (0_usize, [S::ZERO; V]);
        for ((axis, x), on) in self.axes.iter().zip(at).zip(&mut on) {
            let steps = axis.steps(x)?;
            let index = steps.floor_to_i32()?.clamp(0, axis.last.saturating_sub(1).max(0));
            node = axis.advance(node, index)?;
            *on = steps - S::from_i32(index);
        }
        let mut sum = Sum::NONE;
        for corner in 0..1_usize << V {
            let (mut weight, mut node, mut offset) = (S::ONE, node, [S::ZERO; V]);
            for (bit, ((axis, &on), offset)) in self.axes.iter().zip(&on).zip(&mut offset).enumerate() {
                let is_next = corner & (1 << bit) != 0;
                weight *= if is_next { on } else { S::ONE - on };
                *offset = if is_next { on - S::ONE } else { on } * axis.scale;
                node = node.saturating_add(if is_next { axis.stride } else { 0 });
            }
            self.add(&mut sum, node, weight, &offset)?;
        }
        self.local(&sum)
    }

    /// The components of a node, from -1 to 1: those of the variables, then that of the function
    /// and the free one. `None` if the node does not exist.
    #[must_use]
    pub fn node(&self, index: [u16; V]) -> Option<([S; V], [S; 2])> {
        let mut node = 0_usize;
        for (axis, index) in self.axes.iter().zip(index) {
            node = (i32::from(index) <= axis.last).then(|| axis.advance(node, index.into()))??;
        }
        self.components(node)
    }

    /// Adds the plane of a node, moved to the point at `offset`.
    #[inline]
    fn add(&self, sum: &mut Sum<S, V>, node: usize, weight: S, offset: &[S; V]) -> Option<()> {
        let (slopes, [own, free]) = self.components(node)?;
        let mut height = -free;
        for ((slope, &offset), sum) in slopes.into_iter().zip(offset).zip(&mut sum.slopes) {
            height += slope * offset;
            *sum += slope * weight;
        }
        sum.height += height * weight;
        // Below 0 for the graph of a function.
        sum.down -= own * weight;
        Some(())
    }

    #[inline]
    fn components(&self, node: usize) -> Option<([S; V], [S; 2])> {
        let start = node.checked_mul(self.node_len)?.checked_add(HEADER_LEN)?;
        let bytes = self.bytes.as_ref().get(start..start.checked_add(self.node_len)?)?;
        if self.component_len == 1 {
            self.read(bytes.iter().map(|&byte| i32::from(byte.cast_signed())))
        } else {
            let (pairs, _) = bytes.as_chunks::<2>();
            self.read(pairs.iter().map(|&pair| i32::from(i16::from_le_bytes(pair))))
        }
    }

    #[inline]
    fn read(&self, components: impl Iterator<Item = i32>) -> Option<([S; V], [S; 2])> {
        let mut components = components.map(|component| S::from_i32(component) * self.one);
        let slopes = array::from_fn(|_| components.next().unwrap_or(S::ZERO));
        Some((slopes, [components.next()?, components.next()?]))
    }

    #[inline]
    fn local(&self, sum: &Sum<S, V>) -> Option<Local<S, V>> {
        let per_down = S::ONE.checked_div(sum.down)?;
        let mut gradient = sum.slopes;
        for (slope, axis) in gradient.iter_mut().zip(&self.axes) {
            *slope = *slope * per_down * axis.slope;
        }
        Some(Local { value: sum.height * per_down * self.unit, gradient })
    }
}

impl<S: Scalar> Axis<S> {
    #[inline]
    fn steps(&self, x: S) -> Option<S> {
        let is_inside = x >= self.first && x <= self.high;
        is_inside.then(|| (x - self.first) * self.per_step)
    }

    #[inline]
    fn advance(&self, node: usize, index: i32) -> Option<usize> {
        Some(node.saturating_add(usize::try_from(index).ok()?.saturating_mul(self.stride)))
    }
}

struct Sum<S, const V: usize> {
    slopes: [S; V],
    height: S,
    down: S,
}

impl<S: Scalar, const V: usize> Sum<S, V> {
    const NONE: Self = Self { slopes: [S::ZERO; V], height: S::ZERO, down: S::ZERO };
}
