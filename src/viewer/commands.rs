//! The one table of commands that feeds the keys, the menu and the help.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::surface::mapping::Method;

/// Something the user can ask for by key or menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Choose a model or scene file.
    Open,
    /// Write the scene file.
    SaveScene,
    /// Write the picture into the working folder.
    SavePicture,
    /// Take the last edit back.
    Undo,
    /// Do it again.
    Redo,
    /// Show the whole model.
    FrameModel,
    /// Hide or show panel and markers.
    TogglePanel,
    /// Stop or go on refining.
    TogglePause,
    /// Clicks tell a pixel's story instead of orbiting.
    ToggleProbe,
    /// Show a second method beside the first, or stop it.
    ToggleCompare,
    /// Show how far the two are apart, or the second picture.
    ToggleError,
    /// Show normals, texture coordinates, steps and so on in place of the picture.
    NextView,
    /// The same the other way round.
    PreviousView,
    /// A third of a stop brighter.
    ExposureUp,
    /// A third of a stop darker.
    ExposureDown,
    /// Show or hide keys and mouse.
    ToggleHelp,
    /// Change the way of perturbing the surface.
    Select(Method),
    /// Close the window.
    Quit,
}

/// Where a command stands in menu and help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// Files.
    File,
    /// Undo and redo.
    Edit,
    /// Camera, picture, panel.
    View,
    /// The number keys.
    Method,
}

impl Group {
    /// Every group in the order of menu and help.
    pub const ALL: [Self; 4] = [Self::File, Self::Edit, Self::View, Self::Method];

    /// Heading.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Method => "Method",
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone)]
pub struct CommandInfo {
    /// What it does.
    pub command: Command,
    /// Where it stands.
    pub group: Group,
    /// Name in menu and help.
    pub label: &'static str,
    /// Keys, the one to show first.
    pub shortcuts: Vec<KeyboardShortcut>,
}

const fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}
const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}
const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}
const CTRL_SHIFT_Z: KeyboardShortcut =
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);

/// Every command with its keys, in the order of menu and help.
#[must_use]
pub fn table() -> Vec<CommandInfo> {
    use Command as C;
    use Group as G;
    let row = |command, group, label, keys: &[KeyboardShortcut]| CommandInfo {
        command,
        group,
        label,
        shortcuts: keys.to_vec(),
    };
    let mut rows = vec![
        row(C::Open, G::File, "Open…", &[ctrl(Key::O)]),
        row(C::SaveScene, G::File, "Save scene…", &[ctrl(Key::S)]),
        row(C::SavePicture, G::File, "Save picture", &[plain(Key::F12)]),
        row(C::Quit, G::File, "Quit", &[ctrl(Key::Q)]),
        row(C::Undo, G::Edit, "Undo", &[ctrl(Key::Z)]),
        row(C::Redo, G::Edit, "Redo", &[CTRL_SHIFT_Z, ctrl(Key::Y)]),
        row(C::FrameModel, G::View, "Frame the model", &[plain(Key::F)]),
        row(
            C::TogglePanel,
            G::View,
            "Hide or show the panel",
            &[plain(Key::H)],
        ),
        row(C::TogglePause, G::View, "Pause refining", &[plain(Key::P)]),
        row(C::ToggleProbe, G::View, "Probe pixels", &[plain(Key::I)]),
        row(
            C::ToggleCompare,
            G::View,
            "Compare two methods",
            &[plain(Key::C)],
        ),
        row(
            C::ToggleError,
            G::View,
            "Error in false colours",
            &[plain(Key::X)],
        ),
        row(C::NextView, G::View, "Next view", &[plain(Key::V)]),
        row(C::PreviousView, G::View, "Previous view", &[shift(Key::V)]),
        row(C::ExposureUp, G::View, "Brighter", &[plain(Key::E)]),
        row(C::ExposureDown, G::View, "Darker", &[shift(Key::E)]),
        row(
            C::ToggleHelp,
            G::View,
            "Keys and mouse",
            &[plain(Key::F1), plain(Key::Questionmark)],
        ),
    ];
    rows.extend(Method::ALL.into_iter().map(|method| {
        let info = method.info();
        let key = Key::from_name(&info.key.to_string());
        CommandInfo {
            command: C::Select(method),
            group: G::Method,
            label: info.label,
            shortcuts: key.map(plain).into_iter().collect(),
        }
    }));
    rows
}

/// What the mouse does in the picture, for the help.
pub const MOUSE: [(&str, &str); 10] = [
    ("Left drag", "Orbit"),
    ("Middle drag, Shift+left drag", "Pan"),
    ("Wheel", "Zoom to the cursor"),
    ("Double-click", "Set the pivot"),
    ("Alt+click", "Tell the pixel's story"),
    ("Drag a light", "Move it across the picture"),
    ("Ctrl or Shift+drag a light", "Move it towards you or away"),
    ("Drag the line", "Wipe between two methods"),
    ("Hold B", "Show the second method alone"),
    ("Drop a file", "Open it, or put a picture on the material"),
];

/// Takes the commands of this frame's key presses out of the input.
///
/// While a text field has the focus only shortcuts with Ctrl count; the field needs the rest.
pub fn pressed(ctx: &egui::Context) -> Vec<Command> {
    let typing = ctx.text_edit_focused();
    let mut keys: Vec<(KeyboardShortcut, Command)> = table()
        .iter()
        .flat_map(|row| row.shortcuts.iter().map(|&key| (key, row.command)))
        .filter(|(key, _)| !typing || (key.modifiers.command && !edits_text(key)))
        .collect();
    // A shortcut also matches with Shift held, so the ones that ask for Shift go first.
    keys.sort_by_key(|(key, _)| !key.modifiers.shift);
    ctx.input_mut(|input| {
        let hit = |(key, command): &(KeyboardShortcut, Command)| {
            input.consume_shortcut(key).then_some(*command)
        };
        keys.iter().filter_map(hit).collect()
    })
}

/// Text fields have their own undo.
fn edits_text(key: &KeyboardShortcut) -> bool {
    matches!(key.logical_key, Key::Z | Key::Y)
}

/// The keys of a row as text: "Ctrl+Shift+Z, Ctrl+Y".
#[must_use]
pub fn keys_text(ctx: &egui::Context, row: &CommandInfo) -> String {
    let texts: Vec<_> = row
        .shortcuts
        .iter()
        .map(|key| match key.logical_key {
            Key::Questionmark => "?".to_owned(),
            _ => ctx.format_shortcut(key),
        })
        .collect();
    texts.join(", ")
}
