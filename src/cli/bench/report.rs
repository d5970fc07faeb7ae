//! A table that is told line by line while it is measured, or all at once as JSON.

use serde_json::{Map, Value, json};

use crate::cli::error::CliError;
use crate::cli::output;
use crate::measure::bench::{Machine, Spread};

/// What has been measured so far.
pub(super) struct Report {
    json: Option<Map<String, Value>>,
}

impl Report {
    /// Nothing yet.
    pub fn new(json: bool) -> Self {
        Self {
            json: json.then(Map::new),
        }
    }

    /// Names the machine, and what else holds for all lines.
    pub fn machine(&mut self, facts: Value) -> Result<(), CliError> {
        let machine = Machine::this();
        let Some(json) = &mut self.json else {
            let commit = machine.commit.map(|c| format!(", {c}"));
            let (cpu, commit) = (machine.cpu.as_deref(), commit.unwrap_or_default());
            return output::answer(&format!(
                "reliefscope {}{commit} on {}, {} cores, {}",
                machine.version,
                cpu.unwrap_or("a processor without a name"),
                machine.cores,
                machine.level
            ));
        };
        let machine = json!({
            "cpu": machine.cpu,
            "cores": machine.cores,
            "level": machine.level.to_string(),
            "version": machine.version,
            "commit": machine.commit,
        });
        for fact in [machine, facts] {
            if let Value::Object(fact) = fact {
                json.extend(fact);
            }
        }
        Ok(())
    }

    /// Begins a part. In JSON it is there even if it stays empty.
    pub fn part(&mut self, name: &'static str, heading: &str) -> Result<(), CliError> {
        match &mut self.json {
            Some(json) => {
                json.insert(name.to_owned(), json!([]));
                Ok(())
            }
            None => output::answer(&format!("\n{name}: {heading}")),
        }
    }

    /// Adds a line to a part.
    pub fn line(&mut self, part: &'static str, (text, value): Row) -> Result<(), CliError> {
        let Some(json) = &mut self.json else {
            return output::answer(&text);
        };
        if let Some(Value::Array(lines)) = json.get_mut(part) {
            lines.push(value);
        }
        Ok(())
    }

    /// Nothing follows.
    pub fn finish(self) -> Result<(), CliError> {
        match self.json {
            Some(json) => output::answer_json(&Value::Object(json)),
            None => Ok(()),
        }
    }
}

/// A line as text and as JSON.
pub(super) type Row = (String, Value);

/// A time as text, milliseconds.
pub(super) fn ms(spread: Spread) -> String {
    format!("{:.2} ({:.2}-{:.2})", spread.median, spread.min, spread.max)
}

/// A time as JSON: `name_ms` is the median; `name_ms_min` and `name_ms_max` are beside it.
pub(super) fn put_ms(json: &mut Value, name: &str, spread: Spread) {
    json[format!("{name}_ms")] = json!(spread.median);
    json[format!("{name}_ms_min")] = json!(spread.min);
    json[format!("{name}_ms_max")] = json!(spread.max);
}
