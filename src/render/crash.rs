//! Which pixel a panic came from: the picture once more, tile by tile, until it panics again.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::film::{Film, lock};
use super::sites::place_of;
use super::stages::Scratch;
use super::{Frame, Snapshot, probe};

/// The first pixel, in the order of work, whose first sample panics; `None` if no such panic can be repeated.
///
/// Renders up to a whole sample of the picture on this thread. Meant for after a panic: each one that it
/// provokes goes through the panic hook like the first.
#[must_use]
pub fn crashing_pixel(snapshot: &Snapshot) -> Option<[u32; 2]> {
    // What the closures leave broken is dropped here.
    catch_unwind(AssertUnwindSafe(|| search(snapshot))).ok()?
}

fn search(snapshot: &Snapshot) -> Option<[u32; 2]> {
    let frame = Frame::new(snapshot);
    let film = Film::new(snapshot.size, 1);
    let panics = |work: &mut dyn FnMut()| catch_unwind(AssertUnwindSafe(work)).is_err();
    for &index in &film.order {
        let mut tile = lock(&film.tiles[index]);
        let mut scratch = Scratch::default();
        if !panics(&mut || {
            tile.sample(&frame, None, &mut scratch, &mut ());
        }) {
            continue;
        }
        let ([x0, y0], [columns, rows]) = (tile.pixels.corner, tile.size);
        let mut pixels: Vec<_> = (0..rows)
            .flat_map(|y| (0..columns).map(move |x| [x, y]))
            .collect();
        // In the order in which a tile works: the first that panics stopped it.
        pixels.sort_by_key(|&[x, y]| place_of(x, y));
        let pixels = pixels.into_iter().map(|[x, y]| [x0 + x, y0 + y]);
        return pixels.into_iter().find(|&pixel| {
            panics(&mut || {
                let _ = probe(snapshot, pixel);
            })
        });
    }
    None
}
