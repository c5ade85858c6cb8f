//! The part of a ruled face below a plane: which of the three cases it is, and its moments.
//!
//! A bilinear height over the unit square is zero along a hyperbola. The part where it is not positive is a corner, a
//! strip, or the complement of corners, and its moments are those of [`crate::hyperbola`].

use crate::hyperbola;

/// Moments `K_nm` of a part of a face.
pub(crate) struct FaceMoments {
    pub(crate) k00: f64,
    pub(crate) k10: f64,
    pub(crate) k01: f64,
    pub(crate) k11: f64,
}

/// Moments of a whole face.
pub(crate) const WHOLE_FACE: FaceMoments = FaceMoments { k00: 1.0, k10: 0.5, k01: 0.5, k11: 0.25 };

/// Adds up the pieces that the part of a face is made of.
pub(crate) trait FaceSum {
    /// Adds the whole face.
    fn whole(&mut self);
    /// Adds, with a sign, a piece whose moments are counted from a corner.
    fn part(&mut self, corner: usize, sign: f64, moments: &FaceMoments);
}

/// Adds up the part of a face with heights `s <= 0`, given also as bits.
#[inline]
pub(crate) fn face_part(mask: u8, s: [f64; 4], sum: &mut impl FaceSum) {
    match mask {
        0b0000 => {}
        0b1111 => sum.whole(),
        0b0001 | 0b0010 | 0b0100 | 0b1000 => {
            let i = mask.trailing_zeros() as usize;
            sum.part(i, 1.0, &corner_moments(s, i));
        }
        0b0011 | 0b0110 | 0b1100 | 0b1001 => {
            let i = if mask == 0b1001 { 3 } else { mask.trailing_zeros() as usize };
            sum.part(i, 1.0, &strip_moments(s, i));
        }
        0b1110 | 0b1101 | 0b1011 | 0b0111 => {
            let i = (!mask).trailing_zeros() as usize;
            sum.whole();
            sum.part(i, -1.0, &corner_moments(s, i));
        }
        _ => {
            // Two opposite corners: they meet across the saddle, or they do not.
            let i = mask.trailing_zeros() as usize;
            let joined = s[i] * s[i + 2] > s[i + 1] * s[(i + 3) & 3];
            let (corner, sign) = if joined { (i + 1, -1.0) } else { (i, 1.0) };
            if joined {
                sum.whole();
            }
            for corner in [corner, (corner + 2) & 3] {
                sum.part(corner, sign, &corner_moments(s, corner));
            }
        }
    }
}

/// The region at corner `i`, whose height has the other sign than those of its neighbours: `u + v + w u v <= 1` in
/// `u = alpha / a`, `v = beta / b` with `a = s1/(s1-s2)`, `b = s1/(s1-s4)`,
/// `1 + w = (s2 s4 - s1 s3) / ((s2-s1)(s4-s1))`.
fn corner_moments(s: [f64; 4], i: usize) -> FaceMoments {
    let [s1, s2, s3, s4] = rotated(s, i);
    let (to2, to4) = (s2 - s1, s4 - s1);
    let (a, b) = (-s1 / to2, -s1 / to4);
    // The product underflows only where the face lies in the plane to beyond rounding, and adds nothing.
    let denominator = (to2 * to4).max(f64::MIN_POSITIVE);
    let saddle = (s2 * s4 - s1 * s3).max(0.0);
    let m = hyperbola::moments(saddle, denominator, -s1 * ((s3 - s4) - to2));
    let ab = a * b;
    FaceMoments { k00: ab * m.m00, k10: ab * a * m.m10, k01: ab * b * m.m10, k11: ab * ab * m.m11 }
}

/// The strip at the edge from corner `i` to the next, under `beta = bR + (bL - bR) g(alpha)`,
/// `g = (1 - alpha) / (1 + w alpha)`, `1 + w = (s3-s2)/(s4-s1)`, `bL = s1/(s1-s4)`, `bR = s2/(s2-s3)`.
fn strip_moments(s: [f64; 4], i: usize) -> FaceMoments {
    let [s1, s2, s3, s4] = rotated(s, i);
    let (to3, to4) = (s3 - s2, s4 - s1);
    let (left, right) = (-s1 / to4, -s2 / to3);
    let step = left - right;
    let m = hyperbola::moments(to3, to4, (s3 - s4) - (s2 - s1));
    FaceMoments {
        k00: right + step * m.m00,
        k10: 0.5 * right + step * m.m10,
        k01: 0.5 * right * right + step * (right * m.m00 + step * m.m10),
        k11: 0.25 * right * right + step * (right * m.m10 + step * m.m11),
    }
}

fn rotated(s: [f64; 4], i: usize) -> [f64; 4] {
    [s[i], s[(i + 1) & 3], s[(i + 2) & 3], s[(i + 3) & 3]]
}
