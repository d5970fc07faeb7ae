//! Messages over the picture: notes that go by themselves, errors that stay until dismissed.

use egui::{Align2, Area, Id, Order, RichText, Vec2};

use super::theme;
use super::widgets::named_button_ui;

/// How long a note stays, seconds.
const NOTE_SECS: f64 = 5.0;
/// The oldest messages go first.
const MOST: usize = 6;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Note,
    Error,
}

#[derive(Debug)]
struct Toast {
    kind: Kind,
    text: String,
    /// Set when first drawn.
    until: Option<f64>,
}

/// The messages on show.
#[derive(Debug, Default)]
pub struct Toasts {
    shown: Vec<Toast>,
}

impl Toasts {
    /// Something worth knowing.
    pub fn note(&mut self, text: impl Into<String>) {
        self.push(Kind::Note, text.into());
    }

    /// Something went wrong.
    pub fn error(&mut self, text: impl Into<String>) {
        self.push(Kind::Error, text.into());
    }

    /// Texts on show, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.shown.iter().map(|toast| toast.text.as_str())
    }

    fn push(&mut self, kind: Kind, text: String) {
        self.shown.retain(|toast| toast.text != text);
        self.shown.push(Toast {
            kind,
            text,
            until: None,
        });
        if self.shown.len() > MOST {
            self.shown.remove(0);
        }
    }

    /// Draws them above the status line.
    pub fn show_ui(&mut self, ctx: &egui::Context, bottom: f32) {
        let now = ctx.input(|i| i.time);
        for toast in self.shown.iter_mut().filter(|t| t.kind == Kind::Note) {
            let until = *toast.until.get_or_insert(now + NOTE_SECS);
            if until > now {
                ctx.request_repaint_after_secs((until - now) as f32);
            }
        }
        self.shown
            .retain(|toast| toast.until.is_none_or(|t| t > now));
        if self.shown.is_empty() {
            return;
        }
        let mut dismissed = None;
        Area::new(Id::unique("messages"))
            .anchor(Align2::LEFT_BOTTOM, Vec2::new(12.0, -bottom - 10.0))
            .order(Order::Foreground)
            .show(ctx, |ui| {
                for (i, toast) in self.shown.iter().enumerate() {
                    if toast_ui(ui, toast) {
                        dismissed = Some(i);
                    }
                }
            });
        if let Some(i) = dismissed {
            self.shown.remove(i);
        }
    }
}

/// One message; returns whether it was dismissed.
fn toast_ui(ui: &mut egui::Ui, toast: &Toast) -> bool {
    let (title, color) = match toast.kind {
        Kind::Note => ("Note", theme::ACCENT),
        Kind::Error => ("Error", theme::ERROR),
    };
    let frame = theme::glass().inner_margin(egui::Margin::symmetric(10, 7));
    frame
        .show(ui, |ui| {
            ui.set_max_width(460.0);
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(title).strong().color(color));
                ui.vertical(|ui| {
                    ui.set_max_width(350.0);
                    ui.add(egui::Label::new(&toast.text).wrap().selectable(true));
                });
                let name = format!("Dismiss: {}", toast.text);
                named_button_ui(ui, "×", &name).clicked()
            })
            .inner
        })
        .inner
}
