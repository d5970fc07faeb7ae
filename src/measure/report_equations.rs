//! The report's equations, literally and in double precision: what the fast code is tested against.
//!
//! Nothing here is tuned or shared with the renderer. Where the report's print is wrong or silent, the
//! function gives the corrected form and says what was corrected. Vectors may have any length unless a
//! function asks for a unit; the report divides by lengths, and so does this.

use glam::{DVec2, DVec3};

/// The report's canvas and viewport (§2.3.2), in the camera's frame: x right, y up, z forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewport {
    /// Width and height `V_w`, `V_h` of the window in space, in the unit of `distance`. Pixels are square
    /// only where `V_w / V_h = C_w / C_h`.
    pub size: DVec2,
    /// Distance `d` from the camera to the window.
    pub distance: f64,
    /// Pixels `C_w`, `C_h` of the canvas.
    pub pixels: DVec2,
}

impl Viewport {
    /// The window one unit away that shows `vfov` radians vertically on square pixels.
    #[must_use]
    pub fn from_vfov(vfov: f64, width: u32, height: u32) -> Self {
        let pixels = DVec2::new(f64::from(width), f64::from(height));
        let size_y = 2.0 * (vfov * 0.5).tan();
        Self {
            size: DVec2::new(size_y * pixels.x / pixels.y, size_y),
            distance: 1.0,
            pixels,
        }
    }

    /// Canvas coordinates of a place on the picture: `column` and `row` in pixels from the upper left
    /// corner, so that the centre of pixel (i, j) is at (i + ½, j + ½).
    ///
    /// The report counts `C_x`, `C_y` from the middle with y up, without saying so; pictures count from
    /// the upper left corner.
    #[must_use]
    pub fn canvas_from_picture(&self, column: f64, row: f64) -> DVec2 {
        DVec2::new(column - self.pixels.x * 0.5, self.pixels.y * 0.5 - row)
    }

    /// Eq. 2.1: the window point of a canvas point, in the camera's frame.
    #[must_use]
    pub fn window_from_canvas(&self, canvas: DVec2) -> DVec3 {
        DVec3::new(
            canvas.x * self.size.x / self.pixels.x,
            canvas.y * self.size.y / self.pixels.y,
            self.distance,
        )
    }
}

/// Eq. 2.2: the direction through a window point, `D = R·V`.
///
/// Corrected: `V` of 2.1 is relative to the camera, so the print's `V − O` holds only for a camera at
/// the origin that looks along z. `axes` are the columns of the rotation: right, up, forward.
#[must_use]
pub fn ray_direction(window: DVec3, axes: [DVec3; 3]) -> DVec3 {
    axes[0] * window.x + axes[1] * window.y + axes[2] * window.z
}

/// Eq. 2.3: the point at parameter `t ≥ 0`. A distance only if `dir` is a unit vector.
#[must_use]
pub fn point_on_ray(origin: DVec3, dir: DVec3, t: f64) -> DVec3 {
    origin + dir * t
}

/// Newell's face normal, unnormalised: twice the area long, counter-clockwise side.
///
/// The report's `N` of 2.4 and 2.8 is the face's normal and not a vertex normal `vn`; it does not say
/// how to get it.
#[must_use]
pub fn face_normal(polygon: &[DVec3]) -> DVec3 {
    let next = polygon.iter().cycle().skip(1);
    polygon
        .iter()
        .zip(next)
        .map(|(a, b)| (*a - *b).cross(*a + *b))
        .sum::<DVec3>()
        * 0.5
}

/// Eq. 2.4: `t_L = N·P_L / N·D` with `P_L` from the ray's origin to a vertex of the face.
///
/// Added: `None` where the ray is parallel to the plane or starts beyond it.
#[must_use]
pub fn plane_parameter(origin: DVec3, dir: DVec3, vertex: DVec3, normal: DVec3) -> Option<f64> {
    let t = normal.dot(vertex - origin) / normal.dot(dir);
    (t.is_finite() && t >= 0.0).then_some(t)
}

/// Eq. 2.6–2.8: whether a point of the plane lies inside a convex polygon that winds around `normal`.
///
/// `E₁`, `E₂` run from the point to the ends of each edge, the last edge returning to the first vertex.
/// Corrected: 2.8 repeats 2.7 by misprint; it is `D_P = (E₁ × E₂)·N`. A point on an edge is inside.
/// Concave polygons lose area; they have to be triangulated before.
#[must_use]
pub fn inside_convex(point: DVec3, polygon: &[DVec3], normal: DVec3) -> bool {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).all(|(a, b)| {
        let (e1, e2) = (*a - point, *b - point);
        let n_edge = e1.cross(e2);
        n_edge.dot(normal) >= 0.0
    })
}

/// Eq. 2.4–2.8 together: the parameter where a ray meets a convex polygon, from either side.
#[must_use]
pub fn intersect_convex(origin: DVec3, dir: DVec3, polygon: &[DVec3]) -> Option<f64> {
    let normal = face_normal(polygon);
    let t = plane_parameter(origin, dir, *polygon.first()?, normal)?;
    inside_convex(point_on_ray(origin, dir, t), polygon, normal).then_some(t)
}

/// Eq. 2.9: the share `I/A = cos(N, L)` of a beam that a tilted surface gets; 0 from behind.
///
/// `light` points from the surface to the light.
#[must_use]
pub fn diffuse_share(normal: DVec3, light: DVec3) -> f64 {
    cosine(normal, light).max(0.0)
}

/// Eq. 2.11 and 2.12: `R = 2N(N·L) − L`, the light's direction mirrored at the unit normal.
#[must_use]
pub fn reflect(normal: DVec3, light: DVec3) -> DVec3 {
    normal * (2.0 * normal.dot(light)) - light
}

/// Eq. 2.13: `cos(R, V)^s` at a unit normal.
///
/// Corrected: the cosine is clamped to `[0, 1]` before the power (a negative base has no power), and the
/// share is 0 where the light is behind the surface, or highlights would show on its dark side.
#[must_use]
pub fn specular_share(normal: DVec3, light: DVec3, view: DVec3, shininess: f64) -> f64 {
    if normal.dot(light) <= 0.0 {
        return 0.0;
    }
    cosine(reflect(normal, light), view)
        .clamp(0.0, 1.0)
        .powf(shininess)
}

/// One light of eq. 2.10–2.14.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportLight {
    /// `I_i`: irradiance on a facing surface, of one colour channel.
    pub intensity: f64,
    /// `L_i`: from the surface to the light, any length.
    pub direction: DVec3,
    /// Whether nothing stands between (§2.3.8).
    pub visible: bool,
}

/// What a point of the surface does with light, one colour channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportSurface {
    /// Unit normal used to shade.
    pub normal: DVec3,
    /// To the camera, any length.
    pub view: DVec3,
    /// Diffuse coefficient; the report has none, so 1 is its letter.
    pub k_d: f64,
    /// Specular coefficient; the report has none, so 1 is its letter and 0 marks a matte surface.
    pub k_s: f64,
    /// `s ≥ 0`.
    pub shininess: f64,
}

/// Eq. 2.10: ambient and diffuse light, `I_A + Σ I_i·cos(N, L_i)`.
///
/// Corrected: `L` is per light, cosines are clamped, hidden lights do not count, and the coefficient
/// `k_d` weighs the ambient light as well.
#[must_use]
pub fn diffuse(surface: &ReportSurface, ambient: f64, lights: &[ReportLight]) -> f64 {
    let share = |l: &ReportLight| l.intensity * diffuse_share(surface.normal, l.direction);
    let direct: f64 = lights.iter().filter(|l| l.visible).map(share).sum();
    surface.k_d * (ambient + direct)
}

/// Eq. 2.14: ambient, diffuse and specular light, corrected as 2.10 and 2.13.
#[must_use]
pub fn full_light(surface: &ReportSurface, ambient: f64, lights: &[ReportLight]) -> f64 {
    let ReportSurface {
        normal,
        view,
        shininess,
        ..
    } = *surface;
    let share =
        |l: &ReportLight| l.intensity * specular_share(normal, l.direction, view, shininess);
    let highlight: f64 = lights.iter().filter(|l| l.visible).map(share).sum();
    diffuse(surface, ambient, lights) + surface.k_s * highlight
}

/// Eq. 2.15: central differences `(h_x, h_y)` at texel (x, y), in height per texel.
///
/// x runs to the right and y in the direction in which `height`'s second argument grows. The caller's
/// `height` decides what lies beyond the border.
pub fn central_differences(height: impl Fn(i64, i64) -> f64, x: i64, y: i64) -> DVec2 {
    DVec2::new(
        (height(x + 1, y) - height(x - 1, y)) / 2.0,
        (height(x, y + 1) - height(x, y - 1)) / 2.0,
    )
}

/// Eq. 2.16: the tangent-space normal `(−h_x, −h_y, 1)`, unnormalised.
///
/// Corrected: the print lacks the comma between the first two. The 1 says that heights are counted in
/// texels; a stored height 1 that stands `A` world units high on texels `w` wide counts as `A / w`.
#[must_use]
pub fn normal_from_slopes(slopes: DVec2) -> DVec3 {
    DVec3::new(-slopes.x, -slopes.y, 1.0)
}

/// Eq. 2.17: the texture coordinate that the eye sees, `T + h·V_xy / V_z`.
///
/// `view` is the unit direction to the eye in tangent space, `height` in texture units with the midlevel
/// taken off. From the surface's back or edge on (`V_z ≤ 0`) nothing is shifted; close to it the shift
/// has no bound, which is the method's known fault.
#[must_use]
pub fn parallax(uv: DVec2, height: f64, view: DVec3) -> DVec2 {
    if view.z > 0.0 {
        uv + view.truncate() * (height / view.z)
    } else {
        uv
    }
}

/// Eq. 2.18: the same without the division, `T + h·V_xy`; the shift is at most `|h|`.
#[must_use]
pub fn parallax_limited(uv: DVec2, height: f64, view: DVec3) -> DVec2 {
    if view.z > 0.0 {
        uv + view.truncate() * height
    } else {
        uv
    }
}

/// Eq. 2.19–2.24: weights of A, B and C at a point of the triangle's plane.
///
/// Corrected: the print divides vectors by vectors; both are taken along the normal. Its α is the weight
/// of B, its β that of C, its γ that of A. `None` for a triangle without area.
#[must_use]
pub fn barycentrics(p: DVec3, [a, b, c]: [DVec3; 3]) -> Option<[f64; 3]> {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let alpha = normal.dot(ac.cross(ap)) / normal.dot(ac.cross(ab));
    let beta = normal.dot(ab.cross(ap)) / normal.dot(ab.cross(ac));
    let gamma = 1.0 - alpha - beta;
    (alpha.is_finite() && beta.is_finite()).then_some([gamma, alpha, beta])
}

/// Eq. 2.25: `u = γ·u_A + α·u_B + β·u_C` and v alike, from the weights of [`barycentrics`].
///
/// Corrected: the print takes only α for u and only β for v.
#[must_use]
pub fn interpolate_uv(weights: [f64; 3], uvs: [DVec2; 3]) -> DVec2 {
    uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
}

/// `cos` of the angle between two vectors; 0 if one of them has no length.
fn cosine(a: DVec3, b: DVec3) -> f64 {
    let lengths = a.length() * b.length();
    if lengths > 0.0 {
        a.dot(b) / lengths
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) {
        assert!((a - b).abs().max_element() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn the_corner_pixels_of_a_canvas_lie_half_a_pixel_inside_the_window() {
        let viewport = Viewport {
            size: DVec2::new(4.0, 2.0),
            distance: 3.0,
            pixels: DVec2::new(8.0, 4.0),
        };
        let window = |c, r| viewport.window_from_canvas(viewport.canvas_from_picture(c, r));
        close(window(0.5, 0.5), DVec3::new(-1.75, 0.75, 3.0));
        close(window(7.5, 3.5), DVec3::new(1.75, -0.75, 3.0));
        close(window(4.0, 2.0), DVec3::new(0.0, 0.0, 3.0));
    }

    #[test]
    fn a_field_of_view_reaches_the_upper_edge_of_the_picture() {
        let viewport = Viewport::from_vfov(1.0, 300, 100);
        let top = viewport.window_from_canvas(viewport.canvas_from_picture(150.0, 0.0));
        assert!((top.y.atan2(top.z) - 0.5).abs() < 1e-15);
        assert!((viewport.size.x / viewport.size.y - 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_direction_follows_the_camera_axes() {
        let axes = [DVec3::Y, DVec3::Z, DVec3::X];
        let dir = ray_direction(DVec3::new(1.0, 2.0, 3.0), axes);
        close(dir, DVec3::new(3.0, 1.0, 2.0));
        close(
            point_on_ray(DVec3::ONE, dir, 2.0),
            DVec3::new(7.0, 3.0, 5.0),
        );
    }

    #[test]
    fn a_pentagon_is_hit_inside_and_missed_outside_from_both_sides() {
        let corner = |k: u32| {
            let angle = f64::from(k) * std::f64::consts::TAU / 5.0;
            DVec3::new(angle.cos(), angle.sin(), 2.0)
        };
        let pentagon: Vec<_> = (0..5).map(corner).collect();
        let area = 2.5 * (std::f64::consts::TAU / 5.0).sin();
        close(face_normal(&pentagon), DVec3::new(0.0, 0.0, 2.0 * area));
        let at = |x, y| intersect_convex(DVec3::new(x, y, 0.0), DVec3::Z * 4.0, &pentagon);
        assert_eq!(at(0.0, 0.0), Some(0.5), "t counts directions, not distance");
        assert_eq!(at(-0.80, 0.0), Some(0.5), "the apothem is 0.809");
        assert_eq!(at(-0.82, 0.0), None);
        assert_eq!(at(0.99, 0.0), Some(0.5));
        let back = intersect_convex(DVec3::Z * 3.0, DVec3::NEG_Z, &pentagon);
        assert_eq!(back, Some(1.0));
    }

    #[test]
    fn rays_along_or_away_from_a_face_miss_it() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        assert_eq!(
            intersect_convex(DVec3::new(-1.0, 0.5, 0.0), DVec3::X, &square),
            None
        );
        assert_eq!(
            intersect_convex(DVec3::new(0.5, 0.5, 1.0), DVec3::Z, &square),
            None
        );
        assert_eq!(intersect_convex(DVec3::ZERO, DVec3::Z, &[]), None);
    }

    #[test]
    fn light_at_sixty_degrees_counts_half_and_behind_nothing() {
        let l = DVec3::new(3.0_f64.sqrt(), 0.0, 1.0) * 7.0;
        assert!((diffuse_share(DVec3::Z * 5.0, l) - 0.5).abs() < 1e-15);
        assert_eq!(diffuse_share(DVec3::Z, DVec3::NEG_Z), 0.0);
        assert_eq!(diffuse_share(DVec3::Z, DVec3::ZERO), 0.0);
    }

    #[test]
    fn a_mirrored_direction_keeps_its_length_and_changes_sides() {
        let n = DVec3::Z;
        close(
            reflect(n, DVec3::new(1.0, 2.0, 3.0)),
            DVec3::new(-1.0, -2.0, 3.0),
        );
    }

    #[test]
    fn a_highlight_falls_with_the_power_and_never_shows_behind() {
        let n = DVec3::Z;
        let v = DVec3::new(3.0_f64.sqrt(), 0.0, 1.0);
        assert!((specular_share(n, DVec3::Z, v, 3.0) - 0.125).abs() < 1e-15);
        assert!((specular_share(n, DVec3::Z, v, 0.0) - 1.0).abs() < 1e-15);
        // R·V = 1 here, and yet the light is on the other side.
        let l = DVec3::new(1.0, 0.0, -0.1);
        assert_eq!(specular_share(n, l, reflect(n, l), 2.0), 0.0);
    }

    #[test]
    fn lights_add_up_and_hidden_ones_do_not_count() {
        let surface = ReportSurface {
            normal: DVec3::Z,
            view: DVec3::Z,
            k_d: 0.5,
            k_s: 0.25,
            shininess: 2.0,
        };
        let slanted = DVec3::new(3.0_f64.sqrt(), 0.0, 1.0);
        let light = |direction, visible| ReportLight {
            intensity: 4.0,
            direction,
            visible,
        };
        let lights = [
            light(DVec3::Z, true),
            light(slanted, true),
            light(DVec3::Z, false),
        ];
        // 0.5·(0.2 + 4 + 2) + 0.25·(4 + 4·¼)
        let expected = 0.5 * 6.2 + 0.25 * 5.0;
        assert!((full_light(&surface, 0.2, &lights) - expected).abs() < 1e-12);
        assert!((diffuse(&surface, 0.2, &lights) - 3.1).abs() < 1e-12);
    }

    #[test]
    fn slopes_of_a_ramp_are_exact_and_tilt_against_it() {
        let ramp = |x: i64, y: i64| x as f64 * 0.25 - y as f64 * 0.5;
        let slopes = central_differences(ramp, 3, 4);
        assert_eq!(slopes, DVec2::new(0.25, -0.5));
        assert_eq!(normal_from_slopes(slopes), DVec3::new(-0.25, 0.5, 1.0));
    }

    #[test]
    fn parallax_divides_and_the_limited_form_does_not() {
        let uv = DVec2::new(0.5, 0.25);
        let v = DVec3::new(0.6, 0.0, 0.8);
        assert!((parallax(uv, 0.1, v) - DVec2::new(0.575, 0.25)).length() < 1e-15);
        assert!((parallax_limited(uv, 0.1, v) - DVec2::new(0.56, 0.25)).length() < 1e-15);
        assert_eq!(parallax(uv, 0.1, DVec3::new(1.0, 0.0, 0.0)), uv);
        assert_eq!(parallax_limited(uv, 0.1, DVec3::NEG_Z), uv);
    }

    #[test]
    fn each_corner_has_its_own_weight() {
        let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::new(1.0, 3.0, 1.0)];
        let p = corners[0] * 0.2 + corners[1] * 0.5 + corners[2] * 0.3;
        let weights = barycentrics(p, corners).expect("the triangle has area");
        close(DVec3::from(weights), DVec3::new(0.2, 0.5, 0.3));
        let uv = interpolate_uv(weights, [DVec2::ZERO, DVec2::X, DVec2::Y * 2.0]);
        assert!((uv - DVec2::new(0.5, 0.6)).length() < 1e-12);
        assert_eq!(barycentrics(p, [DVec3::ONE; 3]), None);
    }
}
