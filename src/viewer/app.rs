//! The frame loop: collect what the threads brought, take input, draw, send what changed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::{LayerId, Rect, ViewportCommand, ViewportId};

use super::commands::{self, Command};
use super::dialogs::{Dialogs, PICTURES, Purpose};
use super::document::Document;
use super::loader::{AddedPicture, Loaded, Loader};
use super::meter::Meter;
use super::pacing::Pacing;
use super::panels::{self, Action, PanelContext, Place, UiState};
use super::picking::Projection;
use super::preferences::Preferences;
use super::status::{self, Progress, Status};
use super::still::Still;
use super::story::{Story, story_ui};
use super::toasts::Toasts;
use super::viewport::{self, Framebuffer, Side, ViewportClick};
use super::worker::{FirstPass, FrameStats, Refinement, RenderNote, RenderRequest, RenderWorker};
use super::{ViewOptions, compare_view, legend, light_markers, loading, theme, windows};
use crate::measure::feel::{Feel, FeelLog};
use crate::render::{Progressive, Snapshot};
use crate::scene::built_in::SCENES;
use crate::scene::file::{SceneView, write_scene};
use crate::scene::{LoadError, LoadedScene};
use crate::surface::mapping::Method;
use crate::texture::{MapRole, MapSlot};

/// Stops per key press.
const EXPOSURE_STEP: f32 = 1.0 / 3.0;

/// The window's program.
pub struct ViewerApp {
    worker: RenderWorker,
    loader: Loader,
    dialogs: Dialogs,
    doc: Option<Document>,
    state: UiState,
    preferences: Preferences,
    framebuffer: Framebuffer,
    toasts: Toasts,
    pacing: Pacing,
    still_panel: Still,
    shown: Meter,
    passes: Meter,
    sent: Option<RenderRequest>,
    size: [u32; 2],
    fallback: bool,
    title: String,
    feel: FeelLog,
}

impl ViewerApp {
    /// Starts the threads and begins to load.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn new(
        creation: &eframe::CreationContext<'_>,
        options: ViewOptions,
    ) -> std::io::Result<Self> {
        let mut app = Self::empty(creation, &options)?;
        app.open(options.input.unwrap_or_else(first_scene));
        Ok(app)
    }

    /// The window before anything is opened in it.
    pub(super) fn empty(
        creation: &eframe::CreationContext<'_>,
        options: &ViewOptions,
    ) -> std::io::Result<Self> {
        let ctx = &creation.egui_ctx;
        theme::apply(ctx);
        let factory = Box::new(|threads| {
            let renderer = Progressive::new(threads)?;
            Ok(Box::new(renderer) as _)
        });
        Ok(Self {
            worker: RenderWorker::spawn(factory, wake(ctx))?,
            loader: Loader::new(options.normalize, wake(ctx)),
            dialogs: Dialogs::new(wake(ctx)),
            doc: None,
            state: UiState {
                threads: options.threads,
                ..UiState::default()
            },
            preferences: Preferences::load(creation.storage),
            framebuffer: Framebuffer::default(),
            toasts: Toasts::default(),
            pacing: Pacing::new(creation.gl.as_deref()),
            still_panel: Still::default(),
            shown: Meter::default(),
            passes: Meter::default(),
            sent: None,
            size: [1, 1],
            fallback: false,
            title: String::new(),
            feel: FeelLog::default(),
        })
    }

    /// The open scene, if the first load is done.
    #[must_use]
    pub const fn document(&self) -> Option<&Document> {
        self.doc.as_ref()
    }

    /// The window's own state.
    #[must_use]
    pub const fn state(&self) -> &UiState {
        &self.state
    }

    /// Whether the panel is shown.
    #[must_use]
    pub const fn panel_shown(&self) -> bool {
        self.preferences.panel
    }

    /// Texts of the messages on show.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.toasts.texts()
    }

    /// How far the shown picture is.
    #[must_use]
    pub const fn progress(&self) -> Progress {
        let stats = self.framebuffer.stats();
        Progress::of(stats, self.worker.generation(), self.state.paused)
    }

    /// Whether something is being loaded.
    #[must_use]
    pub fn is_loading(&self) -> bool {
        self.loader.is_loading()
    }

    /// Columns and rows of the picture.
    #[must_use]
    pub const fn picture_size(&self) -> [u32; 2] {
        self.size
    }

    /// What the camera's last movement felt like.
    #[must_use]
    pub fn feel(&self) -> Option<Feel> {
        self.feel.feel()
    }

    /// The shown picture.
    #[must_use]
    pub fn image(&self) -> Option<&egui::ColorImage> {
        self.framebuffer.image(Side::A)
    }

    /// The second picture, or the errors, while two methods are compared.
    #[must_use]
    pub fn other_image(&self) -> Option<&egui::ColorImage> {
        self.framebuffer.image(Side::B)
    }

    /// What is known about the shown frame.
    #[must_use]
    pub const fn stats(&self) -> &FrameStats {
        self.framebuffer.stats()
    }

    fn open(&mut self, input: PathBuf) {
        let opened = self.loader.open(input);
        self.report(opened.map_err(|error| format!("Could not start loading: {error}")));
    }

    /// Puts the built-in scene elsewhere.
    fn place(&mut self, place: Place) {
        let opened = self
            .loader
            .open_as(place.name.clone().into(), place.normalize);
        self.report(opened.map_err(|error| format!("Could not start loading: {error}")));
        self.state.place = Some(place);
    }

    fn report(&mut self, result: Result<(), String>) {
        if let Err(text) = result {
            self.toasts.error(text);
        }
    }

    /// Takes over what threads and dialogs have finished.
    fn collect(&mut self, ctx: &egui::Context) {
        while let Some(loaded) = self.loader.poll() {
            match loaded {
                Loaded::Scene(path, result) => self.finish_load(&path, *result),
                Loaded::Picture(path, result) => self.finish_picture(&path, result),
            }
        }
        if let Some((purpose, file)) = self.dialogs.poll() {
            match file {
                Some(path) => self.use_file(purpose, path),
                None => self
                    .toasts
                    .note("Nothing was chosen. Paths can also be typed in the panel."),
            }
        }
        for note in self.worker.take_notes() {
            match note {
                RenderNote::Error(text) => self.toasts.error(text),
                RenderNote::Saved(text) => self.toasts.note(text),
            }
        }
        self.take_frame(ctx);
    }

    fn take_frame(&mut self, ctx: &egui::Context) {
        if let Some(frame) = self.worker.take_frame() {
            let FrameStats {
                generation, stride, ..
            } = frame.stats;
            self.framebuffer
                .show(ctx, frame, &self.worker, self.pacing.filter());
            self.feel.show(generation, stride, self.pacing.now_secs());
        }
    }

    /// Shows a scene with default preferences.
    pub(super) fn adopt(&mut self, loaded: LoadedScene) {
        self.preferences = Preferences::default();
        self.feel = FeelLog::default();
        self.take_scene(loaded);
    }

    fn take_scene(&mut self, loaded: LoadedScene) {
        self.state.material = 0;
        self.state.story = None;
        self.title = format!("{} – Reliefscope", loaded.scene.name);
        self.doc = Some(Document::new(loaded));
    }

    fn finish_load(&mut self, input: &Path, result: Result<LoadedScene, LoadError>) {
        let place = self.state.place.take();
        match result {
            Ok(loaded) => {
                for warning in &loaded.warnings {
                    eprintln!("{warning}");
                }
                if let n @ 1.. = loaded.warnings.len() {
                    self.toasts.note(format!(
                        "{}: {n} notes, see the Scene section",
                        loaded.scene.name
                    ));
                }
                if input.is_file() {
                    self.preferences.note_opened(input);
                }
                let is_placed = place.is_some_and(|place| Path::new(&place.name) == input);
                match self.doc.take().filter(|_| is_placed) {
                    Some(before) => self.doc = Some(before.put_to(loaded)),
                    None => self.take_scene(loaded),
                }
            }
            Err(LoadError::Cancelled) => self.toasts.note("Loading was cancelled."),
            Err(error) => {
                eprintln!("{error}");
                self.toasts.error(error.to_string());
            }
        }
        self.fill_empty_window();
    }

    /// A first input that failed leaves an empty window; once, the built-in scene fills it.
    fn fill_empty_window(&mut self) {
        if self.doc.is_none() && !self.fallback {
            self.fallback = true;
            self.open(first_scene());
        }
    }

    fn finish_picture(&mut self, path: &Path, result: Result<AddedPicture, String>) {
        let added = match result {
            Ok(added) => added,
            Err(error) => {
                self.toasts.error(format!("{}: {error}", path.display()));
                return;
            }
        };
        let Some(doc) = &mut self.doc else { return };
        if !Arc::ptr_eq(&doc.scene, &added.before) {
            let text = format!("{}: the scene changed meanwhile", path.display());
            self.toasts.error(text);
            return;
        }
        let common = doc.settings.mapping.amplitude;
        let Some(material) = doc.settings.materials.get_mut(added.material) else {
            return;
        };
        let image = added.image;
        if let Some(slot) = added.slot.and_then(|i| material.maps.get_mut(i)) {
            slot.image = image;
            slot.note = "chosen in the window".into();
        } else {
            let role = free_role(&material.maps, path);
            let mut slot = MapSlot::new(image, role);
            slot.note = format!("added in the window as {}", role.name());
            slot.baked_amplitude = Some(common.unwrap_or(material.default_amplitude));
            material.maps.push(slot);
        }
        if material.default_amplitude <= 0.0 {
            material.default_amplitude = doc
                .scene
                .facts
                .bounds
                .map_or(0.02, |[min, max]| (max - min).max_element() * 0.02);
        }
        doc.scene = added.scene;
    }

    fn use_file(&mut self, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open => self.open(path),
            Purpose::SaveScene => self.save_scene(&with_ending(path, "toml")),
            Purpose::SavePicture => self.worker.save_picture(with_ending(path, "png")),
            Purpose::Picture(material, slot) => self.add_picture(path, material, slot),
        }
    }

    fn add_picture(&mut self, path: PathBuf, material: usize, slot: Option<usize>) {
        let Some(doc) = &self.doc else { return };
        let begun = self.loader.add_picture(&doc.scene, path, (material, slot));
        self.report(begun.map_err(|error| format!("Could not start loading: {error}")));
    }

    fn save_scene(&mut self, path: &Path) {
        let Some(doc) = &self.doc else { return };
        let view = SceneView {
            scene: &doc.scene,
            settings: &doc.settings,
            display: &doc.display,
            size: Some(self.size),
        };
        match write_scene(path, &view) {
            Ok(()) => {
                self.preferences.note_opened(path);
                self.toasts.note(format!("Saved {}", path.display()));
            }
            Err(error) => self.toasts.error(format!("Could not save: {error}")),
        }
    }

    fn ask(&mut self, purpose: Purpose) {
        let name = self.doc.as_ref().map_or("scene", |doc| &doc.scene.name);
        let name = match purpose {
            Purpose::SaveScene => format!("{}.toml", file_stem(name)),
            _ => format!("{}.png", file_stem(name)),
        };
        let asked = self.dialogs.ask(purpose, &name);
        self.report(asked.map_err(|error| format!("No file dialog: {error}")));
    }

    fn act(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Run(command) => self.run(ctx, command),
            Action::Open(path) => self.open(path),
            Action::Place(place) => self.place(place),
            Action::SaveScene(path) => self.save_scene(&path),
            Action::SavePicture(path) => self.worker.save_picture(path),
            Action::AddPicture(material, slot, path) => self.add_picture(path, material, slot),
            Action::Ask(purpose) => self.ask(purpose),
        }
    }

    fn run(&mut self, ctx: &egui::Context, command: Command) {
        match command {
            Command::Open => self.ask(Purpose::Open),
            Command::SaveScene => match self.doc.as_ref().and_then(Document::scene_file).cloned() {
                Some(path) => self.save_scene(&path),
                None => self.ask(Purpose::SaveScene),
            },
            Command::SavePicture => self.save_numbered(),
            Command::TogglePanel => self.preferences.panel = !self.preferences.panel,
            Command::TogglePause => self.state.paused = !self.state.paused,
            Command::ToggleProbe => self.state.probe = !self.state.probe,
            Command::ToggleHelp => self.state.help = !self.state.help,
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            _ => self.edit(command),
        }
    }

    /// Commands that change the document.
    fn edit(&mut self, command: Command) {
        let Some(doc) = &mut self.doc else { return };
        let [min, max] = doc.bounds();
        let exposure = &mut doc.display.exposure_ev;
        let brighter = |stops: f32| stops.clamp(-panels::MOST_STOPS, panels::MOST_STOPS);
        match command {
            Command::FrameModel => {
                doc.settings.camera = doc.settings.camera.framed(min, max);
            }
            Command::ExposureUp => *exposure = brighter(*exposure + EXPOSURE_STEP),
            Command::ExposureDown => *exposure = brighter(*exposure - EXPOSURE_STEP),
            Command::NextView => doc.display.view = doc.display.view.next(),
            Command::PreviousView => doc.display.view = doc.display.view.previous(),
            Command::ToggleCompare => {
                let on = !doc.comparison.on;
                doc.comparison.turn(on, doc.settings.mapping.method);
            }
            Command::ToggleError => doc.comparison.toggle_error(doc.settings.mapping.method),
            Command::Select(method) => doc.settings.mapping.method = method,
            Command::Undo => note_unless(doc.undo(), &mut self.toasts, "Nothing to undo."),
            Command::Redo => note_unless(doc.redo(), &mut self.toasts, "Nothing to redo."),
            _ => {}
        }
    }

    /// Writes the picture into the working folder under a name that is free.
    fn save_numbered(&mut self) {
        let Some(doc) = &self.doc else { return };
        let folder = std::env::current_dir().unwrap_or_default();
        let method = doc.settings.mapping.method.name();
        let stem = format!("{}-{method}", file_stem(&doc.scene.name));
        let mut names = (1..10_000).map(|n| folder.join(format!("{stem}-{n:03}.png")));
        if let Some(path) = names.find(|path| !path.exists()) {
            self.worker.save_picture(path);
        }
    }

    fn take_drops(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            let path = file.path().to_owned();
            let ending = path
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or_default();
            let is_picture = PICTURES.contains(&&*ending.to_ascii_lowercase());
            if is_picture && self.doc.is_some() {
                self.add_picture(path, self.state.material, None);
            } else {
                self.open(path);
            }
        }
    }

    /// Where A and B are drawn.
    fn panes(&self, window: Rect) -> [Rect; 2] {
        let Some(doc) = &self.doc else {
            return [window; 2];
        };
        doc.comparison.panes(window, self.free(window))
    }

    /// The part of the window that panel and status line leave.
    fn free(&self, window: Rect) -> Rect {
        let mut free = window;
        free.max.y -= status::HEIGHT;
        if self.preferences.panel {
            free.max.x -= panels::covered_width(window);
        }
        free
    }

    /// What the mouse does in the picture; while two are compared it paints them and says so.
    fn viewport_ui(&mut self, ui: &egui::Ui, window: Rect, panes: [Rect; 2]) -> bool {
        let response = viewport::sense_ui(ui, window);
        let free = self.free(window);
        let Some(doc) = &mut self.doc else {
            return false;
        };
        let method = doc.settings.mapping.method.info().label;
        let comparison = &mut doc.comparison;
        let are_painted =
            compare_view::pictures_ui(ui, (panes, free), &self.framebuffer, comparison, method);
        let pointer = ui.input(|input| input.pointer.interact_pos());
        let in_b = pointer.is_some_and(|pos| panes[1].contains(pos));
        let rect = if in_b { panes[1] } else { panes[0] };
        let camera = &mut doc.settings.camera;
        let mut click = viewport::navigate(ui, &response, rect, &doc.scene, camera);
        if self.state.probe && response.clicked() {
            click = response.interact_pointer_pos().map(ViewportClick::Probe);
        }
        if self.state.probe {
            response.on_hover_cursor(egui::CursorIcon::Crosshair);
        }
        if self.preferences.panel {
            let lights = &mut doc.settings.lights;
            light_markers::markers_ui(ui, panes[0], &doc.settings.camera, lights);
        }
        if let Some(ViewportClick::Probe(pos)) = click {
            let snapshot = Snapshot {
                scene: Arc::clone(&doc.scene),
                settings: Arc::new(doc.settings.clone()),
                size: self.size,
            };
            let pixel = Projection::new(&doc.settings.camera, rect).pixel(pos, self.size);
            self.state.story = Story::of(&snapshot, pixel);
        }
        are_painted
    }

    /// Returns the panel's layer and what it hides, if it is shown.
    fn panel_ui(&mut self, ctx: &egui::Context, window: Rect) -> Option<(LayerId, Rect)> {
        let mut actions = Vec::new();
        let mut place = None;
        self.state.stats = *self.framebuffer.stats();
        if let Some(doc) = self.doc.as_mut().filter(|_| self.preferences.panel) {
            let mut panel = PanelContext {
                doc,
                state: &mut self.state,
                preferences: &mut self.preferences,
                actions: &mut actions,
            };
            place = Some(panels::panel_ui(ctx, window, status::HEIGHT, &mut panel));
        }
        self.state.trade.end_frame();
        for action in actions {
            self.act(ctx, action);
        }
        place
    }

    fn status_ui(&mut self, ctx: &egui::Context, window: Rect) {
        let now = ctx.input(|input| input.time);
        let stats = *self.framebuffer.stats();
        self.shown.note(now, self.framebuffer.frames());
        self.passes.note(now, stats.passes);
        let rate = self.shown.rate(now);
        if rate > 0.0 {
            // So that the figure falls to zero when nothing moves any more.
            ctx.request_repaint_after(Duration::from_millis(500));
        }
        let doc = self.doc.as_ref();
        let method = doc.map_or_else(String::new, |doc| {
            let label = |method: Method| method.info().label;
            let name = label(doc.settings.mapping.method);
            let other = doc.comparison.request().map(|other| label(other.method));
            other.map_or(name.into(), |other| format!("{name} | {other}"))
        });
        let status = Status {
            stats: &stats,
            progress: self.progress(),
            shown_per_sec: rate,
            passes_per_sec: self.passes.rate(now),
            size: self.size,
            triangles: doc.map_or(0, |doc| doc.scene.facts.triangles),
            method: &method,
            exposure_ev: doc.map_or(0.0, |doc| doc.display.exposure_ev),
            feel: self.feel.feel(),
        };
        status::status_ui(ctx, window, &status);
    }

    fn loading_ui(&mut self, ctx: &egui::Context) {
        let loading = self.loader.progress();
        if loading.is_some() {
            ctx.request_repaint_after(Duration::from_millis(60));
        }
        if loading::loading_ui(ctx, loading.as_ref(), self.doc.is_none()) {
            self.loader.cancel();
            self.toasts.note("Loading was cancelled.");
            self.fill_empty_window();
        }
    }

    fn overlays_ui(&mut self, ctx: &egui::Context, window: Rect) {
        if let Some(doc) = &self.doc {
            legend::legend_ui(ctx, self.framebuffer.stats(), &doc.comparison);
        }
        windows::help_ui(ctx, &mut self.state.help);
        story_ui(ctx, &mut self.state.story);
        self.toasts.show_ui(ctx, status::HEIGHT);
        self.loading_ui(ctx);
        windows::drop_hint_ui(ctx, window);
    }

    /// Takes an edit back that made a number which is none: it differs from itself, so that what is shown would never
    /// be what was asked for.
    fn take_nan_back(&mut self) {
        let Some(doc) = &mut self.doc else { return };
        if !doc.has_nan() {
            return;
        }
        let sent = self.sent.as_ref().map(|sent| &sent.snapshot);
        let sent = sent.filter(|sent| Arc::ptr_eq(&sent.scene, &doc.scene));
        doc.settings = sent.map_or_else(|| doc.original.clone(), |sent| (*sent.settings).clone());
        if doc.has_nan() {
            doc.settings = doc.original.clone();
        }
        doc.display = self
            .sent
            .as_ref()
            .map_or_else(Default::default, |sent| sent.display);
        let text = "An edit was taken back: it made a number that is none.";
        self.toasts.error(text.to_owned());
    }

    /// Compares with what the worker has, and sends it what changed.
    fn submit(&mut self) {
        let Some(doc) = &self.doc else { return };
        let settings = self.sent.as_ref().map(|sent| &sent.snapshot.settings);
        let settings = match settings.filter(|sent| ***sent == doc.settings) {
            Some(sent) => Arc::clone(sent),
            None => Arc::new(doc.settings.clone()),
        };
        let request = RenderRequest {
            snapshot: Snapshot {
                scene: Arc::clone(&doc.scene),
                settings,
                size: self.size,
            },
            display: doc.display,
            first_pass: if self.preferences.preview {
                FirstPass::Adaptive
            } else {
                FirstPass::FullResolution
            },
            refinement: if self.state.paused {
                Refinement::Paused
            } else {
                Refinement::Running
            },
            threads: self.state.threads,
            compare: doc.comparison.request(),
        };
        if self
            .sent
            .as_ref()
            .is_none_or(|sent| !sent.is_same(&request))
        {
            let camera = |r: &RenderRequest| r.snapshot.settings.camera;
            let has_moved = self.sent.as_ref().map(camera) != Some(camera(&request));
            let millis = self.pacing.first_pass_millis();
            self.worker.set_first_pass_millis(millis);
            let generation = self.worker.submit(request.clone());
            if has_moved {
                self.feel.ask(generation, self.pacing.began_secs());
            }
            self.sent = Some(request);
        }
    }
}

impl eframe::App for ViewerApp {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.pacing.begin();
        self.collect(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        if !self.title.is_empty() {
            let title = std::mem::take(&mut self.title);
            ctx.send_viewport_cmd(ViewportCommand::Title(title));
        }
        let window = ui.max_rect();
        self.take_drops(&ctx);
        for command in commands::pressed(&ctx) {
            self.run(&ctx, command);
        }
        // Painted last, so that it can be the picture of this very frame's camera.
        let picture = ui.painter().add(egui::Shape::Noop);
        let panes = self.panes(window);
        self.size = viewport::framebuffer_size(&ctx, panes[0]);
        let are_painted = self.viewport_ui(ui, window, panes);
        let panel = self.panel_ui(&ctx, window);
        self.take_nan_back();
        self.submit();
        let is_outdated = self.framebuffer.stats().generation != self.worker.generation();
        self.pacing.wait(&self.worker, is_outdated);
        self.take_frame(&ctx);
        if !are_painted {
            let hidden = panel.map(|(_, hidden)| hidden);
            self.framebuffer.paint_in(ui, picture, window, hidden);
        }
        self.status_ui(&ctx, window);
        self.overlays_ui(&ctx, window);
        match panel.filter(|_| self.pacing.is_software()) {
            Some((layer, hidden)) => self.still_panel.settle(&ctx, layer, hidden, is_outdated),
            // Pixels that were asked for would come without it.
            None => self.still_panel = Still::default(),
        }
        let now = ctx.input(|input| input.time);
        if self.doc.as_mut().is_some_and(|doc| doc.remember(now)) {
            ctx.request_repaint_after(Duration::from_millis(450));
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.preferences.store(storage);
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::BACKDROP.to_normalized_gamma_f32()
    }
}

/// Wakes the window from another thread. A plain `request_repaint` would draw twice.
fn wake(ctx: &egui::Context) -> impl Fn() + Send + Sync + 'static {
    let ctx = ctx.clone();
    move || ctx.request_repaint_after_for(Duration::from_nanos(1), ViewportId::ROOT)
}

fn first_scene() -> PathBuf {
    SCENES
        .first()
        .map_or_else(PathBuf::new, |scene| scene.name.into())
}

fn with_ending(mut path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_none() {
        path.set_extension(ending);
    }
    path
}

/// A scene's name as part of a file's name.
fn file_stem(name: &str) -> String {
    let keep = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '-'
        }
    };
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    stem.chars().map(keep).collect()
}

/// What a dropped picture most likely is: told by its name, else the first role without a map.
fn free_role(maps: &[MapSlot], path: &Path) -> MapRole {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let told = [
        (MapRole::Normal, &["normal", "_nor", "_nrm", "_ddn"][..]),
        (MapRole::Height, &["height", "bump", "disp", "depth"]),
        (MapRole::Slope, &["slope", "deriv"]),
        (MapRole::Opacity, &["opacity", "alpha", "mask"]),
        (
            MapRole::Albedo,
            &["albedo", "color", "colour", "diff", "base"],
        ),
    ];
    let by_name = told
        .iter()
        .find(|(_, words)| words.iter().any(|word| name.contains(word)));
    let free = |role: &MapRole| !maps.iter().any(|slot| slot.role == *role);
    by_name.map_or_else(
        || {
            [MapRole::Height, MapRole::Albedo, MapRole::Normal]
                .into_iter()
                .find(free)
                .unwrap_or(MapRole::Height)
        },
        |(role, _)| *role,
    )
}

/// Says why nothing happened.
fn note_unless(done: bool, toasts: &mut Toasts, why_not: &str) {
    if !done {
        toasts.note(why_not);
    }
}
