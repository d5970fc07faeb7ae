//! A pixel's cut through the relief as a drawing: the picture that explains a method.

use super::drawing::{Anchor, Drawing, Shape};
use crate::render::{LightProfile, MethodProfile, ReliefProfile};

/// Points that the table on the right takes.
const TABLE: f32 = 330.0;
const MARGIN: f32 = 16.0;
/// Room for the title.
const HEAD: f32 = 46.0;

const PAPER: [u8; 3] = [27, 28, 31];
const INK: [u8; 3] = [222, 222, 224];
const FAINT: [u8; 3] = [132, 134, 140];
const STONE: [u8; 3] = [72, 66, 62];
const EDGE: [u8; 3] = [196, 178, 160];
const RAY: [u8; 3] = [240, 228, 66];
const TRUTH: [u8; 3] = [255, 255, 255];

/// Told apart with any kind of colour vision, after Okabe & Ito; in the order of the methods, again from the
/// start when used up.
const COLORS: [[u8; 3]; 7] = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [213, 94, 0],
    [0, 114, 178],
    [170, 170, 170],
];

/// Draws a cut on a sheet of the given size in points, at least 640 × 320.
///
/// On the left the relief with the base polygon, the view ray, the ways to the lights and where each method lands, the
/// chosen one's samples on the ray; on the right what each costs and how far it is off, and which lights are shadowed.
/// Heights are drawn to the scale of lengths unless the ray is so flat that nothing would be seen; then the title says by
/// how much they are stretched.
#[must_use]
pub fn draw_profile(profile: &ReliefProfile, size: [f32; 2]) -> Drawing {
    let size = [size[0].max(640.0), size[1].max(320.0)];
    let sheet = Sheet::new(profile, size);
    let mut shapes = Vec::new();
    sheet.relief(profile, &mut shapes);
    sheet.lights(profile, &mut shapes);
    sheet.view_ray(profile, &mut shapes);
    sheet.methods(profile, &mut shapes);
    sheet.title(profile, &mut shapes);
    table(profile, size, &mut shapes);
    Drawing {
        size,
        paper: PAPER,
        shapes,
    }
}

/// From the cut to the sheet.
struct Sheet {
    left: f32,
    right: f32,
    top: f32,
    bottom: f32,
    x0: f64,
    z0: f64,
    scale: f64,
    stretch: f64,
}

impl Sheet {
    fn new(profile: &ReliefProfile, [width, height]: [f32; 2]) -> Self {
        let (left, right) = (MARGIN, width - TABLE - MARGIN);
        let (top, bottom) = (HEAD, height - MARGIN);
        let xs = profile.relief.iter().map(|p| p[0]);
        let (first, last) = xs.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let (first, last) = if last > first {
            (first, last)
        } else {
            (-1.0, 1.0)
        };
        let [low, high] = profile.range;
        let thickness = (high.max(0.0) - low.min(0.0)).max(1e-12 * (last - first));
        let room = f64::from(bottom - top);
        let wide = f64::from(right - left) / (last - first);
        // The relief takes a third of the height at least, two thirds at the most.
        let scale = wide.min(room * 0.66 / thickness);
        let stretch = (room * 0.33 / (thickness * scale)).max(1.0);
        let middle = (high.max(0.0) + low.min(0.0)) * 0.5;
        Self {
            left,
            right,
            top,
            bottom,
            x0: (first + last) * 0.5,
            z0: middle,
            scale,
            stretch,
        }
    }

    fn at(&self, [x, z]: [f64; 2]) -> [f32; 2] {
        let middle = [
            f64::from(self.left + self.right) * 0.5,
            f64::from(self.top + self.bottom) * 0.5,
        ];
        [
            (middle[0] + (x - self.x0) * self.scale) as f32,
            (middle[1] - (z - self.z0) * self.scale * self.stretch) as f32,
        ]
    }

    /// The line from a place along a direction of the sheet, to the edge of the plot.
    fn to_edge(&self, from: [f32; 2], dir: [f32; 2]) -> [f32; 2] {
        let reach = |from: f32, dir: f32, low: f32, high: f32| {
            if dir > 0.0 {
                (high - from) / dir
            } else if dir < 0.0 {
                (low - from) / dir
            } else {
                f32::INFINITY
            }
        };
        let t = reach(from[0], dir[0], self.left, self.right).min(reach(
            from[1],
            dir[1],
            self.top,
            self.bottom,
        ));
        let t = if t.is_finite() { t.max(0.0) } else { 0.0 };
        [from[0] + dir[0] * t, from[1] + dir[1] * t]
    }

    fn relief(&self, profile: &ReliefProfile, shapes: &mut Vec<Shape>) {
        let inside = |p: &[f32; 2]| p[0] >= self.left && p[0] <= self.right;
        let line: Vec<_> = profile.relief.iter().map(|&p| self.at(p)).collect();
        let line: Vec<_> = line.into_iter().filter(inside).collect();
        if let (Some(&first), Some(&last)) = (line.first(), line.last()) {
            let mut area = line.clone();
            area.extend([[last[0], self.bottom], [first[0], self.bottom]]);
            shapes.push(Shape::Area {
                points: area,
                color: STONE,
            });
        }
        shapes.push(Shape::Line {
            points: line,
            width: 1.6,
            color: EDGE,
            dashed: false,
        });
        let base = self.at([self.x0, 0.0])[1];
        shapes.push(Shape::Line {
            points: vec![[self.left, base], [self.right, base]],
            width: 1.0,
            color: FAINT,
            dashed: true,
        });
        shapes.push(text(
            [self.right, base - 4.0],
            Anchor::End,
            10.0,
            FAINT,
            "base polygon",
        ));
    }

    fn view_ray(&self, profile: &ReliefProfile, shapes: &mut Vec<Shape>) {
        let (top, truth) = (self.at(profile.ray[0]), self.at(profile.truth));
        let back = [top[0] - truth[0], top[1] - truth[1]];
        let length = back[0].hypot(back[1]);
        // A truth at the very top leaves only the angle to go by.
        let dir = if length > 0.5 {
            [back[0] / length, back[1] / length]
        } else {
            let angle = profile.angle_deg.to_radians();
            let z = angle.cos() * self.stretch;
            [-angle.sin() as f32, -z as f32]
        };
        shapes.push(Shape::Line {
            points: vec![self.to_edge(truth, dir), truth],
            width: 1.8,
            color: RAY,
            dashed: false,
        });
        let bottom = self.at(profile.ray[1]);
        shapes.push(Shape::Line {
            points: vec![truth, bottom],
            width: 1.0,
            color: RAY,
            dashed: true,
        });
    }

    fn lights(&self, profile: &ReliefProfile, shapes: &mut Vec<Shape>) {
        let from = self.at(profile.truth);
        // How many names stand at the left end of the plot and at the right.
        let mut rows = [0_u8; 2];
        for light in facing(profile) {
            let dir = [light.dir[0] as f32, (-light.dir[1] * self.stretch) as f32];
            let end = self.to_edge(from, dir);
            let (color, dashed) = light_ink(light);
            shapes.push(Shape::Line {
                points: vec![from, end],
                width: 1.0,
                color,
                dashed,
            });
            // Within the plot, beside the end of the line.
            let right = end[0] > from[0];
            let row = &mut rows[usize::from(right)];
            shapes.push(text(
                [
                    end[0] + if right { -8.0 } else { 8.0 },
                    (end[1] + 4.0 + 12.0 * f32::from(*row)).min(self.bottom),
                ],
                if right { Anchor::End } else { Anchor::Start },
                10.0,
                color,
                &light.name,
            ));
            *row += 1;
        }
    }

    fn methods(&self, profile: &ReliefProfile, shapes: &mut Vec<Shape>) {
        for (method, color) in colored(profile) {
            if method.method == profile.method {
                shapes.extend(method.samples.iter().map(|&p| Shape::Dot {
                    at: self.at(p),
                    radius: 2.4,
                    color,
                }));
            }
        }
        shapes.push(Shape::Dot {
            at: self.at(profile.truth),
            radius: 7.0,
            color: TRUTH,
        });
        for (method, color) in colored(profile).filter(|(m, _)| moves(m)) {
            let chosen = method.method == profile.method;
            shapes.push(Shape::Dot {
                at: self.at(method.place),
                radius: if chosen { 5.5 } else { 3.5 },
                color,
            });
        }
    }

    fn title(&self, profile: &ReliefProfile, shapes: &mut Vec<Shape>) {
        let [x, y] = profile.pixel;
        let title = format!(
            "Pixel {x}, {y}: {}, seen {:.1}° from the normal",
            profile.material, profile.angle_deg
        );
        shapes.push(text(
            [self.left, MARGIN + 6.0],
            Anchor::Start,
            14.0,
            INK,
            &title,
        ));
        let depth = (profile.range[1] - profile.range[0]) / profile.texel;
        let stretched = if self.stretch > 1.005 {
            format!("; heights drawn {:.1} times too tall", self.stretch)
        } else {
            String::new()
        };
        let sampled = profile
            .methods
            .iter()
            .any(|method| method.method == profile.method && !method.samples.is_empty());
        let dots = if sampled {
            format!("; dots: samples of {}", profile.method)
        } else {
            String::new()
        };
        let below = format!("relief {depth:.1} texels deep{dots}{stretched}");
        shapes.push(text(
            [self.left, MARGIN + 22.0],
            Anchor::Start,
            11.0,
            FAINT,
            &below,
        ));
    }
}

/// Whether it looks somewhere else than at the base point.
fn moves(method: &MethodProfile) -> bool {
    method.steps > 0 || method.place[0] != 0.0
}

fn colored(profile: &ReliefProfile) -> impl Iterator<Item = (&MethodProfile, [u8; 3])> {
    profile.methods.iter().zip(COLORS.into_iter().cycle())
}

fn table(profile: &ReliefProfile, [width, height]: [f32; 2], shapes: &mut Vec<Shape>) {
    let left = width - TABLE;
    let columns = [left + 18.0, left + 178.0, left + 248.0, width - MARGIN];
    let head = ["method", "texels off", "normal off", "steps"];
    let rows = profile.methods.len() + 2 + facing(profile).count();
    let row_height = ((height - HEAD - MARGIN) / rows as f32).min(22.0);
    let mut y = HEAD;
    for (i, words) in head.into_iter().enumerate() {
        shapes.push(text([columns[i], y], anchor(i), 10.5, FAINT, words));
    }
    for (method, color) in colored(profile) {
        y += row_height;
        let ink = if method.method == profile.method {
            TRUTH
        } else {
            INK
        };
        shapes.push(Shape::Dot {
            at: [left + 6.0, y - 4.0],
            radius: 4.0,
            color,
        });
        let cells = [
            method.label.to_owned(),
            format!("{:.2}", method.uv_error_texels),
            format!("{:.1}°", method.normal_error_deg),
            method.steps.to_string(),
        ];
        for (i, words) in cells.iter().enumerate() {
            shapes.push(text([columns[i], y], anchor(i), 12.0, ink, words));
        }
    }
    y += row_height;
    shapes.push(Shape::Dot {
        at: [left + 6.0, y - 4.0],
        radius: 6.0,
        color: TRUTH,
    });
    shapes.push(text(
        [columns[0], y],
        Anchor::Start,
        12.0,
        INK,
        "the place that is really seen",
    ));
    for light in facing(profile) {
        y += row_height;
        let (color, dashed) = light_ink(light);
        shapes.push(Shape::Line {
            points: vec![[left - 1.0, y - 4.0], [left + 13.0, y - 4.0]],
            width: 1.0,
            color,
            dashed,
        });
        let state = if light.shadowed_by_relief {
            "shadowed by the relief"
        } else {
            "not shadowed by the relief"
        };
        let words = format!("{}: {state}", light.name);
        shapes.push(text([columns[0], y], Anchor::Start, 12.0, color, &words));
    }
}

/// The lights that the surface faces.
fn facing(profile: &ReliefProfile) -> impl Iterator<Item = &LightProfile> {
    profile.lights.iter().filter(|light| !light.behind)
}

/// A light's colour, and whether its line is dashed.
const fn light_ink(light: &LightProfile) -> ([u8; 3], bool) {
    if light.shadowed_by_relief {
        (FAINT, true)
    } else {
        (INK, false)
    }
}

const fn anchor(column: usize) -> Anchor {
    if column == 0 {
        Anchor::Start
    } else {
        Anchor::End
    }
}

fn text(at: [f32; 2], anchor: Anchor, size: f32, color: [u8; 3], words: &str) -> Shape {
    Shape::Text {
        at,
        anchor,
        size,
        color,
        text: words.to_owned(),
    }
}
