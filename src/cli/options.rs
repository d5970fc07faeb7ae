//! Arguments after checking, as commands take them.

use std::path::{Path, PathBuf};

use super::ViewRequest;
use super::args::{InspectArgs, LoadArgs, ProbeArgs, RenderArgs, SceneArgs, ViewArgs};
use super::error::CliError;
use crate::scene::View;
use crate::scene::load::LoadOptions;
use crate::surface::mapping::Method;

/// A scene and what to change about it.
#[derive(Debug)]
pub(super) struct SceneOptions {
    /// Model, scene file or built-in name.
    pub input: PathBuf,
    /// How to read it.
    pub load: LoadOptions,
    /// Picture size, pixels.
    pub size: Option<[u32; 2]>,
    /// Method instead of the scene's.
    pub method: Option<Method>,
    /// Keys to set, in order.
    pub overrides: Vec<(String, String)>,
}

/// What a picture file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PictureFormat {
    /// 8 bits, sRGB, exposed: the window's picture.
    Png,
    /// Linear floats without exposure.
    Exr,
}

/// `render`.
#[derive(Debug)]
pub(super) struct RenderOptions {
    /// What to render.
    pub scene: SceneOptions,
    /// Where to.
    pub output: PathBuf,
    /// As what.
    pub format: PictureFormat,
    /// Samples per pixel instead of the scene's.
    pub samples: Option<u32>,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// View instead of the scene's.
    pub view: Option<View>,
    /// Stops instead of the scene's.
    pub exposure_ev: Option<f32>,
}

/// `inspect`.
#[derive(Debug)]
pub(super) struct InspectOptions {
    /// Model, scene file or built-in name.
    pub input: PathBuf,
    /// How to read it.
    pub load: LoadOptions,
    /// JSON instead of text.
    pub json: bool,
}

/// `probe`.
#[derive(Debug)]
pub(super) struct ProbeOptions {
    /// What to look at.
    pub scene: SceneOptions,
    /// Column and row.
    pub pixel: [u32; 2],
    /// Where to draw the cut instead.
    pub svg: Option<PathBuf>,
    /// JSON instead of text.
    pub json: bool,
}

impl ViewArgs {
    /// What the window is to show.
    pub fn into_request(self) -> ViewRequest {
        ViewRequest {
            input: self.input,
            threads: usize::from(self.threads),
            normalize: !self.load.no_normalize,
        }
    }
}

impl LoadArgs {
    /// Nothing can be wrong.
    pub fn check(&self) -> LoadOptions {
        LoadOptions {
            normalize: !self.no_normalize,
            ..LoadOptions::default()
        }
    }
}

impl SceneArgs {
    fn check(self) -> SceneOptions {
        SceneOptions {
            load: self.load.check(),
            input: self.input,
            size: self.size,
            method: self.method,
            overrides: self.set,
        }
    }
}

impl RenderArgs {
    /// Refuses outputs that could not be written, before anything is rendered.
    pub fn check(self) -> Result<RenderOptions, CliError> {
        let format = format_of(&self.output)?;
        let is_view = self.view.is_some_and(|view| view != View::Picture);
        if is_view && format == PictureFormat::Exr {
            return Err(CliError::Arguments("--view: a view is written as .png"));
        }
        Ok(RenderOptions {
            scene: self.scene.check(),
            format,
            output: check_place(self.output)?,
            samples: self.samples,
            threads: usize::from(self.threads),
            view: self.view,
            exposure_ev: self.exposure,
        })
    }
}

impl InspectArgs {
    /// Nothing can be wrong.
    pub fn check(self) -> InspectOptions {
        InspectOptions {
            load: self.load.check(),
            input: self.input,
            json: self.json,
        }
    }
}

impl ProbeArgs {
    /// Nothing can be wrong yet: the picture's size is known only with the scene.
    pub fn check(self) -> ProbeOptions {
        ProbeOptions {
            scene: self.scene.check(),
            pixel: self.pixel,
            svg: self.svg,
            json: self.json,
        }
    }
}

fn format_of(output: &Path) -> Result<PictureFormat, CliError> {
    let ending = output.extension().and_then(|e| e.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("png") => Ok(PictureFormat::Png),
        Some("exr") => Ok(PictureFormat::Exr),
        _ => Err(CliError::UnknownFormat(output.to_owned())),
    }
}

/// Refuses a place where no file can be written.
pub(super) fn check_place(output: PathBuf) -> Result<PathBuf, CliError> {
    let folder = output.parent().filter(|p| *p != Path::new(""));
    let message = match folder {
        _ if output.is_dir() => Some("is a folder".to_owned()),
        Some(folder) if !folder.is_dir() => {
            Some(format!("there is no folder {}", folder.display()))
        }
        _ => None,
    };
    match message {
        Some(message) => Err(CliError::NoPlace {
            path: output,
            message,
        }),
        None => Ok(output),
    }
}
