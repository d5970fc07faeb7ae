//! What was loaded for a material and as what, changed on the spot.

use std::path::PathBuf;

use egui::{CollapsingHeader, RichText, Ui};

use super::{Action, PanelContext};
use crate::scene::Scene;
use crate::shading::Material;
use crate::texture::{Channel, FileAxis, MapRole, MapSlot, NormalSpace, Wrap};
use crate::viewer::dialogs::Purpose;
use crate::viewer::theme;
use crate::viewer::widgets::{
    Caption, Number, choice_ui, named_button_ui, number_ui, pair_ui, row_ui, text_ui,
};

pub(super) fn slots_ui(ui: &mut Ui, panel: &mut PanelContext<'_>, material: usize) {
    let scene = &panel.doc.scene;
    let Some(own) = panel.doc.settings.materials.get_mut(material) else {
        return;
    };
    if own.maps.is_empty() {
        ui.weak("No maps. Drop a picture on the window, or:");
    }
    let amplitude = panel.doc.settings.mapping.amplitude;
    let (mut removed, mut replaced) = (None, None);
    let counts = used_roles(own);
    for (i, slot) in own.maps.iter_mut().enumerate() {
        ui.push_id(("map", i), |ui| {
            let mut editor = SlotEditor {
                name: format!("Map {}", i + 1),
                hidden: counts.get(i).copied().unwrap_or(false),
                slot,
            };
            match editor.show_ui(ui, scene) {
                Some(SlotAction::Remove) => removed = Some(i),
                Some(SlotAction::Replace) => replaced = Some(i),
                None => {}
            }
            // Only what is read as normals has an amplitude baked in.
            if is_baked(slot.role) && slot.baked_amplitude.is_none() {
                let own = amplitude.unwrap_or(own.default_amplitude);
                slot.baked_amplitude = Some(own);
            }
        });
    }
    if let Some(i) = removed {
        own.maps.remove(i);
    }
    if let Some(i) = replaced {
        panel
            .actions
            .push(Action::Ask(Purpose::Picture(material, Some(i))));
    }
    add_ui(ui, panel, material);
}

/// Per slot, whether an earlier enabled slot of the same role hides it.
fn used_roles(material: &Material) -> Vec<bool> {
    let first = |slot: &MapSlot| {
        material
            .map(slot.role)
            .is_some_and(|m| std::ptr::eq(m, slot))
    };
    let maps = material.maps.iter();
    maps.map(|slot| slot.enabled && !first(slot)).collect()
}

const fn is_baked(role: MapRole) -> bool {
    matches!(role, MapRole::Normal | MapRole::Slope)
}

fn add_ui(ui: &mut Ui, panel: &mut PanelContext<'_>, material: usize) {
    let hint = "Path of a picture";
    text_ui(ui, "Picture path", hint, &mut panel.state.picture_path);
    ui.horizontal(|ui| {
        let path = panel.state.picture_path.trim();
        let add = ui.add_enabled(!path.is_empty(), egui::Button::new("Add picture"));
        if add.clicked() {
            let path = PathBuf::from(path);
            panel.actions.push(Action::AddPicture(material, None, path));
        }
        if ui.button("Choose picture…").clicked() {
            let purpose = Purpose::Picture(material, None);
            panel.actions.push(Action::Ask(purpose));
        }
    });
}

enum SlotAction {
    Remove,
    Replace,
}

struct SlotEditor<'a> {
    /// "Map 1": begins every control's name.
    name: String,
    /// Another slot of this role goes first.
    hidden: bool,
    slot: &'a mut MapSlot,
}

impl SlotEditor<'_> {
    fn label(&self, what: &str) -> String {
        format!("{} {what}", self.name)
    }

    fn show_ui(&mut self, ui: &mut Ui, scene: &Scene) -> Option<SlotAction> {
        let action = ui.horizontal(|ui| self.head_ui(ui, scene)).inner;
        let mut about = scene
            .images
            .get(self.slot.image)
            .map_or_else(String::new, |image| {
                let raw = &image.raw;
                format!(
                    "{} × {}, {} channels, {} bits",
                    raw.width,
                    raw.height,
                    raw.channels,
                    raw.bits()
                )
            });
        for note in [
            self.slot.note.as_str(),
            if self.hidden {
                "not used: another map of this role is above"
            } else {
                ""
            },
        ] {
            if !note.is_empty() {
                about = format!("{about}; {note}");
            }
        }
        ui.add(egui::Label::new(RichText::new(about).small().color(theme::WEAK)).wrap());
        let label = self.label("as");
        let all = MapRole::ALL;
        choice_ui(
            ui,
            Caption::named("Used as", &label),
            &mut self.slot.role,
            &all,
            MapRole::name,
        );
        self.switches_ui(ui);
        if self.slot.role == MapRole::Normal {
            let label = self.label("space");
            let all = NormalSpace::ALL;
            let caption = Caption::named("Space", &label);
            choice_ui(ui, caption, &mut self.slot.space, &all, NormalSpace::name);
            if self.slot.space == NormalSpace::Object {
                self.axes_ui(ui);
            }
        }
        if self.slot.role == MapRole::Height {
            self.stairs_ui(ui, scene);
        }
        CollapsingHeader::new(self.label("addressing")).show(ui, |ui| self.addressing_ui(ui));
        action
    }

    fn head_ui(&mut self, ui: &mut Ui, scene: &Scene) -> Option<SlotAction> {
        let label = self.label("on");
        let on = self.slot.enabled;
        let response = ui.checkbox(&mut self.slot.enabled, "");
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &label));
        let mut action = None;
        if named_button_ui(ui, "×", &self.label("remove")).clicked() {
            action = Some(SlotAction::Remove);
        }
        if named_button_ui(ui, "…", &self.label("replace")).clicked() {
            action = Some(SlotAction::Replace);
        }
        let image = scene.images.get(self.slot.image);
        let name = image.map_or("missing picture", |image| image.name.as_str());
        let path = image.and_then(|image| image.path.as_ref());
        let response = ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
        if let Some(path) = path {
            response.on_hover_text(path.display().to_string());
        }
        action
    }

    /// Which axes of the file an object-space map tells.
    fn axes_ui(&mut self, ui: &mut Ui) {
        for (channel, caption) in ["Red tells", "Green tells", "Blue tells"]
            .into_iter()
            .enumerate()
        {
            let before = self.slot.axes.channels()[channel];
            let mut axis = before;
            let label = self.label(caption);
            let caption = Caption::named(caption, &label);
            choice_ui(ui, caption, &mut axis, &FileAxis::ALL, FileAxis::name);
            if axis != before {
                self.slot.axes = self.slot.axes.with(channel, axis);
            }
        }
    }

    /// The switches that matter in this role.
    fn switches_ui(&mut self, ui: &mut Ui) {
        let (invert, green, flip_v) = (
            self.label("invert"),
            self.label("flip green"),
            self.label("flip V"),
        );
        let scalar = matches!(self.slot.role, MapRole::Height | MapRole::Opacity);
        row_ui(ui, Caption::new(""), |ui| {
            let mut switch = |value: &mut bool, text: &str, name: &String| {
                let response = ui.checkbox(value, text);
                let on = *value;
                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, name)
                });
            };
            if scalar {
                switch(&mut self.slot.invert, "invert", &invert);
            }
            if is_baked(self.slot.role) {
                switch(&mut self.slot.flip_green, "flip green", &green);
            }
            switch(&mut self.slot.flip_v, "flip V", &flip_v);
        });
        if scalar {
            let label = self.label("channel");
            let all = Channel::ALL;
            choice_ui(
                ui,
                Caption::named("Channel", &label),
                &mut self.slot.channel,
                &all,
                Channel::name,
            );
        }
        if is_baked(self.slot.role) {
            let label = self.label("baked amplitude");
            let mut baked = self.slot.baked_amplitude.unwrap_or(0.0);
            let number = Number::within(0.0..=f64::MAX, baked.max(1e-4) / 100.0);
            number_ui(
                ui,
                Caption::named("Baked ampl.", &label),
                &number,
                &mut baked,
                None,
            );
            if self.slot.baked_amplitude.is_some_and(|b| b != baked) {
                self.slot.baked_amplitude = Some(baked);
            }
        }
    }

    /// How finely the heights are told, and the filter for maps that show it.
    fn stairs_ui(&mut self, ui: &mut Ui, scene: &Scene) {
        let Some(image) = scene.images.get(self.slot.image) else {
            return;
        };
        let levels = image.heights(self.slot.channel).levels();
        if levels.is_few() {
            let said = format!("Your map has {} levels", levels.count);
            let notice = RichText::new(said).small().color(theme::WEAK);
            ui.add(egui::Label::new(notice).wrap())
                .on_hover_text("Gentle slopes show their steps in highlights; 16 bits do not");
        }
        // Whoever switched it on can switch it off, whatever the picture is now.
        if levels.is_few() || self.slot.destair {
            let name = self.label("de-stair");
            row_ui(ui, Caption::new(""), |ui| {
                let response = ui.checkbox(&mut self.slot.destair, "de-stair (alters the data)");
                let on = self.slot.destair;
                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &name)
                });
                response
                    .on_hover_text("Smooths the steps; no height moves by more than half a level");
            });
        }
    }

    fn addressing_ui(&mut self, ui: &mut Ui) {
        let label = self.label("wrap");
        choice_ui(
            ui,
            Caption::named("Wrap", &label),
            &mut self.slot.wrap,
            &Wrap::ALL,
            Wrap::name,
        );
        let label = self.label("scale");
        pair_ui(
            ui,
            Caption::named("Scale", &label),
            0.01,
            &mut self.slot.uv_scale,
        );
        let label = self.label("offset");
        pair_ui(
            ui,
            Caption::named("Offset", &label),
            0.005,
            &mut self.slot.uv_offset,
        );
        let label = self.label("gain");
        number_ui(
            ui,
            Caption::named("Gain", &label),
            &Number::free(0.01),
            &mut self.slot.gain,
            Some(&1.0),
        );
        let label = self.label("bias");
        number_ui(
            ui,
            Caption::named("Bias", &label),
            &Number::free(0.01),
            &mut self.slot.bias,
            Some(&0.0),
        );
    }
}
