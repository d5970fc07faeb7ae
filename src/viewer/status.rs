//! The status line: how fast, how far, by which method. It never passes an unconverged picture for a
//! converged one.

use egui::{Align2, Area, Color32, Id, Order, Rect, RichText, Ui};

use super::theme;
use super::worker::FrameStats;
use crate::measure::feel::Feel;
use crate::scene::ViewKind;

/// Height of the line, points.
pub const HEIGHT: f32 = 30.0;

/// How far the shown picture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Nothing has been shown yet.
    Waiting,
    /// The shown picture answers an older request than the last one.
    Outdated,
    /// One pixel in `stride`² was rendered.
    Preview(u32),
    /// So many samples of so many.
    Refining(u32, u32),
    /// The same, and it rests.
    Paused(u32, u32),
    /// Every pixel has all its samples.
    Converged(u32),
}

impl Progress {
    /// Of a shown frame, when `generation` was asked for last.
    #[must_use]
    pub const fn of(stats: &FrameStats, generation: u64, paused: bool) -> Self {
        if stats.stride == 0 {
            Self::Waiting
        } else if stats.generation != generation {
            Self::Outdated
        } else if stats.stride > 1 {
            Self::Preview(stats.stride)
        } else if stats.converged {
            Self::Converged(stats.samples)
        } else if paused {
            Self::Paused(stats.samples, stats.samples_wanted)
        } else {
            Self::Refining(stats.samples, stats.samples_wanted)
        }
    }

    /// As the line says it.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Self::Waiting => "waiting".into(),
            Self::Outdated => "updating".into(),
            Self::Preview(stride) => format!("preview 1/{stride}"),
            Self::Refining(samples, wanted) => format!("refining {samples}/{wanted}"),
            Self::Paused(samples, wanted) => format!("paused {samples}/{wanted}"),
            Self::Converged(samples) => format!("converged {samples}/{samples}"),
        }
    }

    const fn color(self) -> Color32 {
        match self {
            Self::Converged(_) => theme::GOOD,
            _ => theme::ACCENT,
        }
    }
}

/// What the line shows.
#[derive(Debug)]
pub struct Status<'a> {
    /// Of the shown frame.
    pub stats: &'a FrameStats,
    /// How far it is.
    pub progress: Progress,
    /// New pictures on the screen per second.
    pub shown_per_sec: f64,
    /// Passes and previews rendered per second.
    pub passes_per_sec: f64,
    /// Size of the framebuffer.
    pub size: [u32; 2],
    /// Triangles of the model.
    pub triangles: usize,
    /// Label of the method.
    pub method: &'a str,
    /// Stops.
    pub exposure_ev: f32,
    /// What the camera's last movement felt like.
    pub feel: Option<Feel>,
}

/// Draws the line along the bottom.
pub fn status_ui(ctx: &egui::Context, window: Rect, status: &Status<'_>) {
    let frame = egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(16, 17, 19, 232))
        .inner_margin(egui::Margin::symmetric(12, 0));
    Area::new(Id::unique("status"))
        .anchor(Align2::LEFT_BOTTOM, egui::Vec2::ZERO)
        .order(Order::Middle)
        .constrain(false)
        .show(ctx, |ui| {
            frame.show(ui, |ui| {
                ui.set_width(window.width() - 24.0);
                ui.set_height(HEIGHT);
                ui.horizontal_centered(|ui| line_ui(ui, status));
            });
        });
}

fn line_ui(ui: &mut Ui, status: &Status<'_>) {
    let stats = status.stats;
    // Room for what matters most first; a narrow window cuts the end off.
    let fps = status.shown_per_sec;
    let text = if fps > 0.0 {
        format!("{fps:5.1} fps")
    } else {
        let rests = matches!(
            status.progress,
            Progress::Converged(_) | Progress::Paused(..)
        );
        format!("{:>9}", if rests { "idle" } else { "working" })
    };
    let text = RichText::new(text).monospace().size(15.0);
    ui.label(text.strong().color(Color32::WHITE))
        .on_hover_ui(|ui| {
            ui.label("New pictures on the screen per second");
            if let Some(feel) = &status.feel {
                ui.label(feel_text(feel));
            }
        });
    item_ui(
        ui,
        &format!("{:<16}", status.progress.text()),
        status.progress.color(),
        "How far the picture is",
    );
    item_ui(ui, status.method, Color32::WHITE, "Method in use");
    if let Some(error) = &stats.error {
        let unit = error.metric.unit();
        let text = format!("mean {:.4} p95 {:.4}{unit}", error.mean, error.p95);
        let hint = format!("Error of A against B: {}", error.metric.label());
        item_ui(ui, &text, theme::ACCENT, &hint);
    }
    if let Some(legend) = &stats.legend {
        let name = legend.view.name();
        let (text, color) = match legend.view.kind() {
            ViewKind::Marks => (
                format!("{} {name}", grouped(legend.marked)),
                if legend.marked > 0 {
                    theme::ERROR
                } else {
                    theme::GOOD
                },
            ),
            _ => (format!("view {name}"), theme::ACCENT),
        };
        item_ui(ui, &text, color, legend.view.meaning());
    }
    if status.exposure_ev != 0.0 {
        item_ui(
            ui,
            &format!("{:+.1} EV", status.exposure_ev),
            theme::ACCENT,
            "Exposure",
        );
    }
    if stats.counters.non_finite > 0 {
        let text = format!("{} bad samples", stats.counters.non_finite);
        item_ui(
            ui,
            &text,
            theme::ERROR,
            "Samples that were not finite and counted as black",
        );
    }
    let weak = theme::WEAK;
    let rate = rays_per_sec(stats) / 1e6;
    item_ui(
        ui,
        &format!("{:6.1} ms/pass", stats.pass_millis),
        weak,
        "Duration of the last pass",
    );
    item_ui(
        ui,
        &format!("{:5.1} passes/s", status.passes_per_sec),
        weak,
        "Passes and previews rendered per second",
    );
    item_ui(
        ui,
        &format!("{rate:6.2} Mrays/s"),
        weak,
        if stats.reshaded {
            "Rays of the last pass; camera rays came from the cache"
        } else {
            "Rays of the last pass"
        },
    );
    let [w, h] = status.size;
    let scale = format!("{w}×{h} at 1/{}", stats.stride.max(1));
    item_ui(ui, &scale, weak, "Framebuffer and resolution scale");
    item_ui(
        ui,
        &format!("{} triangles", grouped(status.triangles as u64)),
        weak,
        "Triangles in the model's file",
    );
}

/// The last movement of the camera in words.
fn feel_text(feel: &Feel) -> String {
    let full = feel.rest_to_full_ms.map_or_else(String::new, |millis| {
        format!("\nEvery pixel {millis:.0} ms after the last input")
    });
    format!(
        "Last movement, {:.1} s: {:.1} views a second\n\
         From input to picture {:.0} ms, for 95 of 100 within {:.0} ms\n\
         Resolution 1/{} at the least{full}",
        feel.seconds, feel.shown_per_sec, feel.wait_p50_ms, feel.wait_p95_ms, feel.coarsest
    )
}

fn item_ui(ui: &mut Ui, text: &str, color: Color32, hint: &str) {
    ui.add_space(5.0);
    ui.label(RichText::new(text).monospace().color(color))
        .on_hover_text(hint);
}

/// Rays of all kinds per second of the last pass.
fn rays_per_sec(stats: &FrameStats) -> f64 {
    let secs = f64::from(stats.pass_millis) * 1e-3;
    if secs > 0.0 {
        stats.pass_rays as f64 / secs
    } else {
        0.0
    }
}

/// 1234567 → "1 234 567".
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{FrameStats, Progress, grouped};

    fn stats() -> FrameStats {
        FrameStats {
            generation: 7,
            stride: 1,
            samples: 64,
            samples_wanted: 64,
            converged: true,
            ..FrameStats::default()
        }
    }

    #[test]
    fn only_a_finished_picture_of_the_last_request_is_converged() {
        assert_eq!(Progress::of(&stats(), 7, false), Progress::Converged(64));
        assert_eq!(Progress::of(&stats(), 8, false), Progress::Outdated);
        let preview = FrameStats {
            stride: 4,
            ..stats()
        };
        assert_eq!(Progress::of(&preview, 7, false), Progress::Preview(4));
        let young = FrameStats {
            samples: 3,
            converged: false,
            ..stats()
        };
        assert_eq!(Progress::of(&young, 7, false), Progress::Refining(3, 64));
        assert_eq!(Progress::of(&young, 7, true), Progress::Paused(3, 64));
        assert_eq!(
            Progress::of(&FrameStats::default(), 0, false),
            Progress::Waiting
        );
    }

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(1_234_567), "1 234 567");
    }
}
