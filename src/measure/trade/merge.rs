//! Shards of one sweep put together again.

use super::{Cell, Record};

/// Why records do not make one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// Nothing was given.
    #[error("nothing to merge")]
    Nothing,
    /// Records of different sweeps.
    #[error("the parts are of different sweeps: {0} differs")]
    Different(&'static str),
    /// The same program measured the same and came to another result.
    #[error("two parts measured {0} and found different errors")]
    Contradiction(String),
}

/// Puts the parts of a sweep together, in whatever order they come. What is in two parts counts once. Partial if
/// cells are still missing.
///
/// # Errors
/// [`MergeError`].
pub fn merge(parts: Vec<Record>) -> Result<Record, MergeError> {
    let mut parts = parts.into_iter();
    let mut whole = parts.next().ok_or(MergeError::Nothing)?;
    for part in parts {
        add(&mut whole, part)?;
    }
    let order: Vec<String> = whole.plan.variants().iter().map(|v| v.label()).collect();
    let place = |label: &str| order.iter().position(|known| known == label);
    whole
        .cells
        .sort_by_key(|c| (c.view, place(&c.variant.label()), std::cmp::Reverse(c.bits)));
    whole.views.sort_by_key(|v| v.index);
    whole.pictures.sort_by_key(|p| (p.view, place(&p.label)));
    whole.partial = is_partial(&whole);
    if !whole.partial {
        whole.shard = None;
    }
    Ok(whole)
}

fn add(whole: &mut Record, part: Record) -> Result<(), MergeError> {
    let differs = |what, same: bool| {
        if same {
            Ok(())
        } else {
            Err(MergeError::Different(what))
        }
    };
    differs("the format of the files", whole.format == part.format)?;
    differs("what was measured", whole.subject == part.subject)?;
    differs("the plan", whole.plan == part.plan)?;
    differs("the truth", whole.truth == part.truth)?;
    for cell in part.cells {
        let known = whole.cells.iter().find(|known| is_same_place(known, &cell));
        match known {
            None => whole.cells.push(cell),
            Some(known) if without_times(known) == without_times(&cell) => {}
            Some(_) => {
                let name = format!("{} at {}°", cell.variant.label(), cell.angle_deg);
                return Err(MergeError::Contradiction(name));
            }
        }
    }
    for view in part.views {
        if !whole.views.iter().any(|known| known.index == view.index) {
            whole.views.push(view);
        }
    }
    for machine in part.machines {
        if !whole.machines.contains(&machine) {
            whole.machines.push(machine);
        }
    }
    for picture in part.pictures {
        let is_known = |known: &super::record::Thumbnail| {
            known.view == picture.view && known.label == picture.label
        };
        if !whole.pictures.iter().any(is_known) {
            whole.pictures.push(picture);
        }
    }
    Ok(())
}

fn is_same_place(a: &Cell, b: &Cell) -> bool {
    (a.view, a.bits, a.variant) == (b.view, b.bits, b.variant)
}

fn without_times(cell: &Cell) -> Cell {
    Cell {
        cost: cell.cost.without_times(),
        ..cell.clone()
    }
}

/// Whether some view lacks a column that another has, or is missing altogether.
fn is_partial(record: &Record) -> bool {
    let mut columns: Vec<_> = record.cells.iter().map(|c| (c.bits, c.variant)).collect();
    columns.sort_by_key(|(bits, variant)| (*bits, variant.label()));
    columns.dedup();
    record.cells.is_empty() || record.cells.len() < columns.len() * record.plan.views().len()
}
