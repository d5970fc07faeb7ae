//! `--set key=value`: any key of the scene file, for any kind of input.

use std::path::{Path, PathBuf};

use toml::Value;

use super::apply::apply;
use super::fault::nearest;
use super::parse::parse;
use super::write::{SceneView, scene_text};
use crate::scene::{LoadWarning, LoadedScene};

/// A `--set` that cannot be done.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("--set {assignment}: {message}")]
pub struct OverrideError {
    /// `key=value` as given; all of them where only the result is wrong.
    pub assignment: String,
    /// What is wrong, with the key.
    pub message: String,
}

/// Sets keys of a loaded scene as if its scene file said so.
///
/// A key is the path through the file: `camera.vfov_deg`, `light.0.intensity`, `shading.background`. Lights and
/// materials go by number, by name (`material.brick.ks`; `material."a.b".ks` for names with dots) or all at
/// once (`material.*.kd`), maps by number or role (`material.brick.map.height.gain`). A value is TOML, or a
/// bare word for a string. Paths are relative to the working folder. What is doubtful joins the warnings.
///
/// `loaded.scene` must not be shared yet, as pictures may be added to it.
///
/// # Errors
/// [`OverrideError`] naming the key, if it does not exist or does not take the value.
pub fn apply_overrides(
    loaded: &mut LoadedScene,
    overrides: &[(String, String)],
) -> Result<(), OverrideError> {
    if overrides.is_empty() {
        return Ok(());
    }
    let base = Path::new("");
    let fail = |message: String| OverrideError {
        assignment: shown(overrides),
        message,
    };
    // The file form is the one place that knows every key and its meaning.
    let text = scene_text(&SceneView::from(&*loaded), base).map_err(|e| fail(e.to_string()))?;
    let mut tree: Value = toml::from_str::<toml::Table>(&text)
        .map(Value::Table)
        .map_err(|e| fail(e.message().to_owned()))?;
    for (key, value) in overrides {
        set(&mut tree, key, &value_of(value)).map_err(|message| OverrideError {
            assignment: format!("{key}={value}"),
            message,
        })?;
    }
    let text = toml::to_string(&tree).map_err(|e| fail(e.to_string()))?;
    let document = parse(&text).map_err(|fault| fail(fault.message))?;
    let doubts = apply(&document, loaded, base).map_err(|fault| fail(fault.message))?;
    loaded
        .warnings
        .extend(doubts.into_iter().map(|doubt| LoadWarning {
            file: PathBuf::from("--set"),
            line: None,
            message: doubt.message,
        }));
    Ok(())
}

fn shown(overrides: &[(String, String)]) -> String {
    let all: Vec<String> = overrides.iter().map(|(k, v)| format!("{k}={v}")).collect();
    all.join(" --set ")
}

/// TOML if it is, a string if not: nobody quotes `mapping.method=bump` twice.
fn value_of(text: &str) -> Value {
    let word = || Value::String(text.to_owned());
    if text.contains(['\n', '\r']) {
        return word();
    }
    let parsed = toml::from_str::<toml::Table>(&format!("value = {text}"));
    parsed
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(word)
}

fn set(tree: &mut Value, key: &str, value: &Value) -> Result<(), String> {
    let segments = segments(key)?;
    match segments[0].as_str() {
        "model" | "built_in" => return Err("what is rendered is said by INPUT".to_owned()),
        "normalize" => {
            return Err("a model is normalised while it is read; use --no-normalize".to_owned());
        }
        _ => set_in(tree, &segments, value),
    }
    .map_err(|why| format!("`{key}`: {why}"))
}

/// Splits at dots outside double quotes.
fn segments(key: &str) -> Result<Vec<String>, String> {
    let mut segments = vec![String::new()];
    let mut quoted = false;
    for c in key.trim().chars() {
        match (c, segments.last_mut()) {
            ('"', _) => quoted = !quoted,
            ('.', _) if !quoted => segments.push(String::new()),
            (c, Some(last)) => last.push(c),
            (_, None) => {}
        }
    }
    if quoted {
        return Err(format!("`{key}`: a quote is not closed"));
    }
    if segments.len() == 1 && segments[0].is_empty() {
        return Err("the key is empty".to_owned());
    }
    Ok(segments)
}

fn set_in(tree: &mut Value, segments: &[String], value: &Value) -> Result<(), String> {
    let (first, rest) = segments.split_first().ok_or("the key is empty")?;
    match tree {
        Value::Table(table) if rest.is_empty() => {
            // A colour for a gradient, a path for a map: the value's kind may change.
            table.insert(first.clone(), value.clone());
            Ok(())
        }
        Value::Table(table) => {
            let known: Vec<String> = table.keys().cloned().collect();
            let inner = table.get_mut(first).ok_or_else(|| {
                let advice = nearest(first, known.iter().map(String::as_str))
                    .map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
                format!("there is no `{first}`{advice}")
            })?;
            set_in(inner, rest, value)
        }
        Value::Array(array) => {
            for index in elements(array, first)? {
                match rest {
                    [] => array[index] = value.clone(),
                    _ => set_in(&mut array[index], rest, value)?,
                }
            }
            Ok(())
        }
        _ => Err(format!(
            "there is nothing called `{first}` inside a plain value"
        )),
    }
}

/// Elements that a segment means: by name or role, by number, or all.
fn elements(array: &[Value], segment: &str) -> Result<Vec<usize>, String> {
    if segment == "*" {
        return Ok((0..array.len()).collect());
    }
    let label = |value: &Value| {
        let text = |key| value.get(key).and_then(Value::as_str).map(str::to_owned);
        text("name").or_else(|| text("role"))
    };
    let labels: Vec<Option<String>> = array.iter().map(label).collect();
    let named: Vec<usize> = (0..array.len())
        .filter(|&i| labels[i].as_deref() == Some(segment))
        .collect();
    if !named.is_empty() {
        return Ok(named);
    }
    match segment.parse::<usize>() {
        Ok(number) if number < array.len() => Ok(vec![number]),
        Ok(number) if array.is_empty() => {
            Err(format!("there is no number {number}: the list is empty"))
        }
        Ok(number) => Err(format!(
            "there is no number {number}: the last is {}",
            array.len() - 1
        )),
        Err(_) => {
            let known: Vec<&str> = labels.iter().flatten().map(String::as_str).collect();
            let advice = match nearest(segment, known.iter().copied()) {
                Some(name) => format!("; did you mean \"{name}\"?"),
                None if known.is_empty() => String::new(),
                None => format!("; there is {}", list(&known)),
            };
            Err(format!("there is no \"{segment}\"{advice}"))
        }
    }
}

/// The first few names.
fn list(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let quoted: Vec<String> = names
        .iter()
        .take(SHOWN)
        .map(|n| format!("\"{n}\""))
        .collect();
    let more = names.len().saturating_sub(SHOWN);
    let tail = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    format!("{}{tail}", quoted.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_split_at_dots_outside_quotes() {
        let cases: [(&str, &[&str]); 3] = [
            ("camera.eye", &["camera", "eye"]),
            ("material.\"a.b\".ks", &["material", "a.b", "ks"]),
            ("light.0.color.1", &["light", "0", "color", "1"]),
        ];
        for (key, wanted) in cases {
            assert_eq!(segments(key).expect("splits"), wanted);
        }
        assert!(segments("material.\"a.b.ks").is_err());
        assert!(segments("").is_err());
    }

    #[test]
    fn values_are_toml_or_bare_words() {
        assert_eq!(value_of("3"), Value::Integer(3));
        assert_eq!(value_of("bump"), Value::String("bump".into()));
        assert_eq!(value_of("\"bump\""), Value::String("bump".into()));
        assert_eq!(value_of("a b.png"), Value::String("a b.png".into()));
        assert_eq!(value_of("true"), Value::Boolean(true));
        assert!(value_of("[1, 2.5]").is_array());
        // Not a way to set a second key.
        assert_eq!(
            value_of("1\nother = 2"),
            Value::String("1\nother = 2".into())
        );
    }
}
