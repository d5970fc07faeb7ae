//! The settings panel in the top right corner. Every section edits the document in place; what needs the
//! app (files, dialogs) goes into a list of actions.

mod compare;
mod cost;
mod display;
mod extremes;
mod lights;
mod map_slot;
mod materials;
mod method;
mod render;
mod scene;
mod shading;
mod trade;

use std::path::PathBuf;

use egui::{
    Align2, Area, CollapsingHeader, Id, LayerId, Order, Rect, RichText, ScrollArea, Ui, Vec2,
};

use super::commands::{self, Command, CommandInfo, Group};
use super::dialogs::Purpose;
use super::document::Document;
use super::preferences::Preferences;
use super::theme;

pub(super) use display::MOST_STOPS;
pub use extremes::Place;

/// Width of the panel's content, points; less in windows that it would fill.
const WIDTH: f32 = 316.0;
/// Distance from the window's edge, points.
const MARGIN: f32 = 10.0;

/// The panel hides nothing nearer to its edge than this: its corners are round. Points.
const CORNER: f32 = 8.0;

/// What the window shows besides the document.
#[derive(Debug, Default)]
pub struct UiState {
    /// Row of the material list.
    pub material: usize,
    /// The typed path of the scene section.
    pub path: String,
    /// The typed path of a picture for the selected material.
    pub picture_path: String,
    /// Clicks tell a pixel's story.
    pub probe: bool,
    /// Keys and mouse are shown.
    pub help: bool,
    /// Refinement rests.
    pub paused: bool,
    /// Worker threads asked for, 0 for one per core.
    pub threads: usize,
    /// What is known about the picture on show.
    pub stats: crate::viewer::worker::FrameStats,
    /// What accuracy costs here.
    pub trade: crate::viewer::trade::TradeMeter,
    /// Where the scene is being put.
    pub place: Option<Place>,
    /// The pixel's story on show.
    pub story: Option<crate::viewer::story::Story>,
}

/// Something that a section cannot do by itself.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// As by key.
    Run(Command),
    /// Open a file or a built-in scene.
    Open(PathBuf),
    /// Put the built-in scene elsewhere.
    Place(Place),
    /// Write a scene file.
    SaveScene(PathBuf),
    /// Write the picture.
    SavePicture(PathBuf),
    /// Put a picture on a material: its index, the slot to replace, the file.
    AddPicture(usize, Option<usize>, PathBuf),
    /// Ask for a file.
    Ask(Purpose),
}

/// What sections work on.
pub struct PanelContext<'a> {
    /// The open scene.
    pub doc: &'a mut Document,
    /// The window's own state.
    pub state: &'a mut UiState,
    /// Remembered.
    pub preferences: &'a mut Preferences,
    /// Filled by the sections.
    pub actions: &'a mut Vec<Action>,
}

fn content_width(window: Rect) -> f32 {
    WIDTH.min(window.width() * 0.55 - 2.0 * MARGIN).max(160.0)
}

/// Points that the panel takes of the window's right side.
pub fn covered_width(window: Rect) -> f32 {
    let frame = theme::sheet().total_margin().sum().x;
    content_width(window) + frame + 2.0 * MARGIN
}

/// Draws the panel into the window's rectangle, above `bottom` points of status line; returns its layer and the
/// part of the window that it hides.
pub fn panel_ui(
    ctx: &egui::Context,
    window: Rect,
    bottom: f32,
    panel: &mut PanelContext<'_>,
) -> (LayerId, Rect) {
    let width = content_width(window);
    let height = (window.height() - bottom - 2.0 * MARGIN - 22.0).max(80.0);
    let area = Area::new(Id::unique("panel"))
        .anchor(Align2::RIGHT_TOP, Vec2::new(-MARGIN, MARGIN))
        .order(Order::Middle)
        .constrain(false)
        // It hides what is under it from the first frame on.
        .fade_in(false)
        .show(ctx, |ui| {
            theme::sheet().show(ui, |ui| {
                ui.set_width(width);
                // The area would keep the height that its content had in the picture before.
                ui.set_max_height(height);
                header_ui(ui, panel);
                ui.add_space(2.0);
                ScrollArea::vertical()
                    .max_height(height - 30.0)
                    .auto_shrink([false, true])
                    .show(ui, |ui| sections_ui(ui, panel));
            });
        });
    (area.response.layer_id, area.response.rect.shrink(CORNER))
}

fn header_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        ui.menu_button("Menu", |ui| {
            // All of it can be reached in a low window, too.
            let room = ui.ctx().content_rect().height() - 2.0 * MARGIN;
            let menu = ScrollArea::vertical()
                .max_height(room)
                .min_scrolled_height(room);
            menu.show(ui, |ui| menu_ui(ui, panel));
        });
        let name = RichText::new(&panel.doc.scene.name).strong();
        ui.add(egui::Label::new(name).truncate());
    });
}

fn menu_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let table = commands::table();
    for (i, group) in Group::ALL.into_iter().enumerate() {
        let rows = table.iter().filter(|row| row.group == group);
        if i > 0 {
            ui.separator();
        }
        match group {
            Group::Method => {
                ui.menu_button(group.label(), |ui| commands_ui(ui, panel, rows));
            }
            _ => commands_ui(ui, panel, rows),
        }
    }
}

/// Commands in a menu.
fn commands_ui<'a>(
    ui: &mut Ui,
    panel: &mut PanelContext<'_>,
    rows: impl Iterator<Item = &'a CommandInfo>,
) {
    for row in rows {
        let keys = commands::keys_text(ui.ctx(), row);
        let mark = if is_on(panel, row.command) {
            "• "
        } else {
            ""
        };
        let text = format!("{mark}{}", row.label);
        if ui
            .add(egui::Button::new(text).shortcut_text(keys))
            .clicked()
        {
            panel.actions.push(Action::Run(row.command));
            ui.close();
        }
    }
}

/// Whether a command that switches something is switched on.
fn is_on(panel: &PanelContext<'_>, command: Command) -> bool {
    match command {
        Command::Select(method) => panel.doc.settings.mapping.method == method,
        Command::TogglePause => panel.state.paused,
        Command::ToggleProbe => panel.state.probe,
        Command::ToggleHelp => panel.state.help,
        Command::ToggleCompare => panel.doc.comparison.on,
        Command::ToggleError => panel
            .doc
            .comparison
            .request()
            .is_some_and(|c| c.error.is_some()),
        _ => false,
    }
}

fn sections_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    type Section = (&'static str, bool, fn(&mut Ui, &mut PanelContext<'_>));
    const SECTIONS: [Section; 11] = [
        ("Method", true, method::method_ui),
        ("Compare", false, compare::compare_ui),
        ("Trade", false, trade::trade_ui),
        ("Scene", true, scene::scene_ui),
        ("Lights", false, lights::lights_ui),
        ("Materials", false, materials::materials_ui),
        ("Shading", false, shading::shading_ui),
        ("Render", false, render::render_ui),
        ("Display", false, display::display_ui),
        ("Extremes", false, extremes::extremes_ui),
        ("Cost", false, cost::cost_ui),
    ];
    for (title, open, section_ui) in SECTIONS {
        CollapsingHeader::new(RichText::new(title).strong())
            .id_salt(title)
            .default_open(open)
            .show_unindented(ui, |ui| {
                ui.add_space(2.0);
                section_ui(ui, panel);
                ui.add_space(6.0);
            });
        ui.add(egui::Separator::default().spacing(3.0));
    }
}
