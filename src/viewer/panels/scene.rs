//! Opening and saving, and what was doubtful about the open scene.

use std::path::PathBuf;

use egui::{RichText, Ui};

use super::{Action, PanelContext};
use crate::scene::built_in::SCENES;
use crate::viewer::commands::Command;
use crate::viewer::dialogs::Purpose;
use crate::viewer::theme;
use crate::viewer::widgets::text_ui;

pub(super) fn scene_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        ui.menu_button("Built-in scenes", |ui| built_in_ui(ui, panel.actions));
        ui.add_enabled_ui(!panel.preferences.recent.is_empty(), |ui| {
            ui.menu_button("Recent", |ui| recent_ui(ui, panel));
        });
    });
    ui.horizontal(|ui| {
        if ui.button("Open…").clicked() {
            panel.actions.push(Action::Run(Command::Open));
        }
        if ui.button("Save scene…").clicked() {
            panel.actions.push(Action::Ask(Purpose::SaveScene));
        }
        if ui.button("Save picture…").clicked() {
            panel.actions.push(Action::Ask(Purpose::SavePicture));
        }
    });
    path_ui(ui, panel);
    facts_ui(ui, panel);
    warnings_ui(ui, panel);
}

fn built_in_ui(ui: &mut Ui, actions: &mut Vec<Action>) {
    for scene in &SCENES {
        if ui
            .button(scene.label)
            .on_hover_text(scene.summary)
            .clicked()
        {
            actions.push(Action::Open(scene.name.into()));
            ui.close();
        }
    }
}

fn recent_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    for path in &panel.preferences.recent {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let button = ui.button(name.to_string_lossy());
        if button.on_hover_text(path.display().to_string()).clicked() {
            panel.actions.push(Action::Open(path.clone()));
            ui.close();
        }
    }
}

/// Works where no file dialog does.
fn path_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let hint = "A path: .obj .toml, or .png .exr to save";
    let entered = text_ui(ui, "Path", hint, &mut panel.state.path).lost_focus()
        && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let path = PathBuf::from(panel.state.path.trim());
    let ending = path.extension().map(|e| e.to_ascii_lowercase());
    let ending = ending.as_deref().and_then(|e| e.to_str());
    let picture = matches!(ending, Some("png" | "exr"));
    let scene = ending == Some("toml");
    ui.horizontal(|ui| {
        let given = !path.as_os_str().is_empty();
        let open = ui.add_enabled(given && !picture, egui::Button::new("Open path"));
        if open.clicked() || (entered && given && !picture) {
            panel.actions.push(Action::Open(path.clone()));
        }
        if ui
            .add_enabled(picture || scene, egui::Button::new("Save to path"))
            .on_disabled_hover_text("Needs .toml for the scene, .png or .exr for the picture")
            .clicked()
        {
            panel.actions.push(if picture {
                Action::SavePicture(path)
            } else {
                Action::SaveScene(path)
            });
        }
    });
}

fn facts_ui(ui: &mut Ui, panel: &PanelContext<'_>) {
    let facts = &panel.doc.scene.facts;
    let extent = panel.doc.extent();
    let text = format!(
        "{} triangles, {} vertices, extent {extent:.4}",
        facts.triangles, facts.vertices
    );
    ui.label(RichText::new(text).small().color(theme::WEAK));
}

fn warnings_ui(ui: &mut Ui, panel: &PanelContext<'_>) {
    let warnings = &panel.doc.warnings;
    if warnings.is_empty() {
        return;
    }
    let plural = if warnings.len() == 1 { "" } else { "s" };
    let title = format!("{} note{plural} about the files", warnings.len());
    egui::CollapsingHeader::new(RichText::new(title).color(theme::ACCENT))
        .id_salt("notes")
        .show(ui, |ui| {
            egui::ScrollArea::vertical()
                .id_salt("notes")
                .max_height(150.0)
                .show(ui, |ui| {
                    for warning in warnings {
                        let file = warning.file.file_name().unwrap_or_default();
                        let line = warning.line.map_or_else(String::new, |l| format!(":{l}"));
                        let place = format!("{}{line}", file.to_string_lossy());
                        let text = RichText::new(format!("{place}  {}", warning.message)).small();
                        ui.add(egui::Label::new(text).wrap().selectable(true))
                            .on_hover_text(warning.to_string());
                    }
                });
        });
}
