//! `methods` and `scenes`: what names there are.

use std::fmt::Write as _;

use super::error::CliError;
use super::{help, output};
use crate::surface::mapping::Method;

/// Lists the ways of perturbing a surface.
pub(super) fn methods() -> Result<(), CliError> {
    let mut text = String::new();
    for method in Method::ALL {
        let info = method.info();
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{name}  (key {key})\n    {summary}\n    Gets wrong: {wrong}.\n    Source: {source}.\n",
            name = info.name,
            key = info.key,
            summary = info.summary,
            wrong = info.error_class.summary(),
            source = info.source,
        );
    }
    output::answer(&text)
}

/// Lists the built-in scenes.
pub(super) fn scenes() -> Result<(), CliError> {
    output::answer(&help::scenes())
}
