//! Tangent frames and normalisation that cannot produce NaN.

use glam::Vec3;

/// `v / |v|`, or `fallback` where the length is zero, not finite or under- or overflows.
#[must_use]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return fallback;
    }
    // Scaling first keeps the squared length inside the range of f32 for lengths of 10^±30.
    let scaled = if (1e-15..1e15).contains(&largest) {
        v
    } else {
        v / largest
    };
    let length = scaled.length();
    if length > 0.0 {
        scaled / length
    } else {
        fallback
    }
}

/// Two unit vectors that make a right-handed orthonormal basis with the unit vector `n`.
///
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
#[must_use]
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

/// Orthonormal tangent frame of a surface point: tangent along `+u`, bitangent towards `+v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentFrame {
    /// Unit tangent, perpendicular to `normal`.
    pub tangent: Vec3,
    /// Unit bitangent, `handedness · normal × tangent`.
    pub bitangent: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// `+1`, or `−1` where the texture is mirrored.
    pub handedness: f32,
}

impl TangentFrame {
    /// Frame at a unit `normal` from the position derivatives by texture coordinate.
    ///
    /// `None` where `dp_du` has no part perpendicular to the normal, or u and v are collinear.
    #[must_use]
    pub fn from_derivatives(normal: Vec3, dp_du: Vec3, dp_dv: Vec3) -> Option<Self> {
        let tangent = normalize_or(dp_du - normal * normal.dot(dp_du), Vec3::ZERO);
        let side = normal.cross(tangent);
        let along = side.dot(dp_dv);
        if tangent == Vec3::ZERO || !(along.abs() > 0.0) {
            return None;
        }
        let handedness = 1.0_f32.copysign(along);
        Some(Self {
            tangent,
            bitangent: side * handedness,
            normal,
            handedness,
        })
    }

    /// A tangent-space vector in world space.
    #[must_use]
    pub fn world_from_tangent(&self, m: Vec3) -> Vec3 {
        self.tangent * m.x + self.bitangent * m.y + self.normal * m.z
    }
}
