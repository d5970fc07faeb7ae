//! From map statements to slots: which picture means what, in which order, and why.

use super::compare::compare;
use super::map_statement::{ImfChannel, MapKind, MapOptions, MapStatement};
use super::recognise::{Look, describe_heights, describe_picture, look_of};
use crate::texture::{Channel, MapImage, MapRole, MapSlot, RawImage, Wrap};

/// A statement whose picture was found and decoded.
pub(super) struct PlacedMap<'a> {
    /// What the library says.
    pub statement: &'a MapStatement,
    /// Index of its picture.
    pub image: usize,
}

/// Slots of a material and what follows from them.
#[derive(Debug, Default)]
pub(super) struct SlotSet {
    /// By role; of several with one role only the first is enabled.
    pub slots: Vec<MapSlot>,
    /// `-bm` of the height map that counts, if given: world units, at least 0.
    pub amplitude: Option<f64>,
    /// Remarks with the line of their statement.
    pub remarks: Vec<(usize, String)>,
}

struct Candidate {
    slot: MapSlot,
    /// Lower ranks go first among slots of one role.
    rank: u8,
    line: usize,
    amplitude: Option<f64>,
    remarks: Vec<String>,
}

impl Candidate {
    /// Takes in a statement that says the same again: the stronger of both counts, of equals the later.
    fn merge(&mut self, again: Self) {
        if again.rank <= self.rank {
            self.amplitude = again.amplitude.or(self.amplitude);
            self.rank = again.rank;
            self.line = again.line;
            self.slot.note = again.slot.note;
        } else {
            self.amplitude = self.amplitude.or(again.amplitude);
        }
    }
}

/// Turns the maps of one material into slots.
///
/// Of several statements for one role the later wins, but `map_Bump` goes before `disp` for heights and
/// `norm` before `map_Bump` for normals. Losers stay in the list, switched off. Exact repeats vanish.
pub(super) fn slots_of(maps: &[PlacedMap<'_>], images: &[MapImage]) -> SlotSet {
    let albedo = maps
        .iter()
        .rfind(|m| m.statement.kind == MapKind::Albedo)
        .map(|m| m.image);
    let mut candidates: Vec<Candidate> = Vec::new();
    for map in maps {
        let image = &images[map.image];
        let candidate = match map.statement.kind {
            MapKind::Albedo => plain(map, MapRole::Albedo, image),
            MapKind::Opacity | MapKind::Transparency => {
                opacity(map, image, albedo == Some(map.image))
            }
            MapKind::Bump | MapKind::Norm | MapKind::Disp => relief(map, image),
        };
        let repeats = |c: &&mut Candidate| same_use(&c.slot, &candidate.slot);
        match candidates.iter_mut().find(repeats) {
            Some(known) => known.merge(candidate),
            None => candidates.push(candidate),
        }
    }
    let mut set = SlotSet::default();
    for Candidate { line, remarks, .. } in &mut candidates {
        let told = remarks.drain(..).map(|message| (*line, message));
        set.remarks.extend(told);
    }
    candidates.sort_by_key(|c| (c.slot.role as u8, c.rank, std::cmp::Reverse(c.line)));
    let normal_line = candidates
        .iter()
        .find(|c| c.slot.role == MapRole::Normal)
        .map_or(0, |c| c.line);
    enable_winners(candidates, &mut set);
    orient_green(&mut set, images, normal_line);
    set
}

fn enable_winners(candidates: Vec<Candidate>, set: &mut SlotSet) {
    let mut last_role = None;
    for mut candidate in candidates {
        let role = candidate.slot.role;
        if !candidate.slot.enabled {
            // Off for a reason of its own; it takes nobody's place.
            set.slots.push(candidate.slot);
            continue;
        }
        if last_role == Some(role) {
            candidate.slot.enabled = false;
            candidate.slot.note += "; off: another map comes first";
            let name = role.name();
            let message = format!("a second {name} map for one material is switched off");
            set.remarks.push((candidate.line, message));
        } else if role == MapRole::Height {
            set.amplitude = candidate.amplitude;
        }
        last_role = Some(role);
        set.slots.push(candidate.slot);
    }
}

/// Two slots that look at the same picture in the same way for the same purpose.
fn same_use(a: &MapSlot, b: &MapSlot) -> bool {
    let without_note = |slot: &MapSlot| MapSlot {
        note: String::new(),
        ..slot.clone()
    };
    without_note(a) == without_note(b)
}

fn plain(map: &PlacedMap<'_>, role: MapRole, image: &MapImage) -> Candidate {
    let MapStatement {
        line,
        keyword,
        options,
        ..
    } = map.statement;
    let mut slot = MapSlot::new(map.image, role);
    apply(options, &mut slot);
    slot.note = format!("{keyword}; {}", describe_picture(&image.raw));
    Candidate {
        slot,
        rank: 0,
        line: *line,
        amplitude: None,
        remarks: Vec::new(),
    }
}

fn apply(options: &MapOptions, slot: &mut MapSlot) {
    slot.wrap = if options.clamp {
        Wrap::Clamp
    } else {
        Wrap::Repeat
    };
    slot.uv_scale = options.scale;
    slot.uv_offset = options.offset;
    slot.gain = options.gain;
    slot.bias = options.bias;
    slot.channel = match options.channel {
        None | Some(ImfChannel::Luma) => Channel::Luma,
        Some(ImfChannel::Matte) => Channel::Alpha,
        Some(ImfChannel::Color(0)) => Channel::R,
        Some(ImfChannel::Color(1)) => Channel::G,
        Some(ImfChannel::Color(_)) => Channel::B,
    };
}

fn opacity(map: &PlacedMap<'_>, image: &MapImage, is_albedo: bool) -> Candidate {
    let mut candidate = plain(map, MapRole::Opacity, image);
    let MapStatement {
        keyword,
        kind,
        options,
        ..
    } = map.statement;
    let slot = &mut candidate.slot;
    slot.invert = *kind == MapKind::Transparency;
    // A cut-out is either a mask or the alpha beside a colour.
    if options.channel.is_none() && cut_out_by_alpha(&image.raw, is_albedo) {
        slot.channel = Channel::Alpha;
        slot.note += "; its alpha";
    }
    match hole_share(image, slot) {
        0.0 => {
            slot.enabled = false;
            slot.note += "; off: no holes in it";
        }
        1.0 => {
            let message = format!("{keyword} makes the whole material invisible");
            candidate.remarks.push(message);
        }
        _ => {}
    }
    candidate
}

/// Whether opacity sits in the alpha channel: there is one that varies, and the colours are constant or
/// serve as the albedo.
fn cut_out_by_alpha(raw: &RawImage, is_albedo: bool) -> bool {
    let Some(alpha) = raw.alpha_channel() else {
        return false;
    };
    let is_constant = |channel: u8| {
        let first = raw.fraction(0, 0, channel);
        let pixels = (0..raw.height).flat_map(|y| (0..raw.width).map(move |x| (x, y)));
        pixels
            .into_iter()
            .all(|(x, y)| raw.fraction(x, y, channel) == first)
    };
    !is_constant(alpha) && (is_albedo || (0..alpha).all(is_constant))
}

/// Share of texels below one half: exactly 0 or 1 where all or none are solid.
fn hole_share(image: &MapImage, slot: &MapSlot) -> f64 {
    let map = image.height(slot.channel);
    let texels = f64::from(map.width()) * f64::from(map.height());
    let is_hole = |x, y| {
        let stored = map.texel(x, y) * slot.gain + slot.bias;
        let opacity = if slot.invert { 1.0 - stored } else { stored };
        opacity < 0.5
    };
    let holes = (0..map.height())
        .map(|y| (0..map.width()).filter(|&x| is_hole(x, y)).count())
        .sum::<usize>();
    holes as f64 / texels
}

/// What a map of relief is, why, and what is odd about that.
fn recognise(kind: MapKind, look: Look) -> (MapRole, &'static str, Option<&'static str>) {
    match (kind, look) {
        (MapKind::Norm, Look::Grey) => (
            MapRole::Height,
            "grey, so heights",
            Some("is grey; read as heights, not as normals"),
        ),
        (MapKind::Norm, Look::Normals) => (MapRole::Normal, "normals", None),
        (MapKind::Norm, Look::Color) => (
            MapRole::Normal,
            "normals, though it does not look so",
            Some("does not look like a normal map; read as one all the same"),
        ),
        (_, Look::Normals) => (
            MapRole::Normal,
            "looks like a normal map",
            Some("looks like a normal map; read as one, not as heights"),
        ),
        (_, Look::Color) => (
            MapRole::Height,
            "luma of a colour picture as heights",
            Some("is a colour picture; its luma is read as heights"),
        ),
        (_, Look::Grey) => (MapRole::Height, "heights", None),
    }
}

/// A map of relief: heights or normals, by what the picture looks like.
fn relief(map: &PlacedMap<'_>, image: &MapImage) -> Candidate {
    let MapStatement { keyword, kind, .. } = map.statement;
    let (role, why, odd) = recognise(*kind, look_of(&image.raw));
    let mut candidate = plain(map, role, image);
    candidate.rank = match (role, kind) {
        (MapRole::Height, MapKind::Bump) | (MapRole::Normal, MapKind::Norm) => 0,
        (_, MapKind::Bump) => 1,
        _ => 2,
    };
    let told = odd.map(|odd| format!("{keyword}: {} {odd}", image.name));
    candidate.remarks.extend(told);
    let slot = &mut candidate.slot;
    let described = if role == MapRole::Height {
        describe_heights(image, slot)
    } else {
        describe_picture(&image.raw)
    };
    slot.note = format!("{keyword}: {why}; {described}");
    if let Some(strength) = map.statement.options.strength {
        candidate.amplitude = strengthen(slot, strength);
    }
    candidate
}

/// What `-bm` means: for heights the amplitude in world units (negative turns the relief inside out), for
/// normals a factor on their slopes.
fn strengthen(slot: &mut MapSlot, strength: f32) -> Option<f64> {
    let size = strength.abs();
    if slot.role == MapRole::Height {
        slot.note += &format!("; -bm {strength}: amplitude {size} world units");
        if strength < 0.0 {
            slot.invert = !slot.invert;
            slot.note += ", inside out";
        }
        return Some(f64::from(size));
    }
    slot.note += &format!("; -bm {strength}: slopes times {size}");
    if size == 0.0 {
        slot.enabled = false;
        slot.note += ", so off";
    } else {
        slot.strength = size;
    }
    None
}

/// Where heights and normals of one relief are both there, tells which way green grows.
fn orient_green(set: &mut SlotSet, images: &[MapImage], line: usize) {
    let first = |role| set.slots.iter().position(|s| s.role == role && s.enabled);
    let (Some(height), Some(normal)) = (first(MapRole::Height), first(MapRole::Normal)) else {
        return;
    };
    let pair = [height, normal].map(|i| (&set.slots[i], &images[set.slots[i].image]));
    let Some(comparison) = compare(pair[0], pair[1]) else {
        return;
    };
    let (heights, normals) = (pair[0].1.name.clone(), pair[1].1.name.clone());
    let slot = &mut set.slots[normal];
    if !comparison.is_telling() {
        slot.note += &format!("; does not match the heights of {heights}");
        return;
    }
    if comparison.green_is_flipped() {
        slot.flip_green = true;
        let found = format!(
            "green grows downwards (correlation {:.2} with the heights of {heights})",
            comparison.along_v
        );
        slot.note += &format!("; {found}");
        set.remarks
            .push((line, format!("{normals}: {found}; flipped")));
    }
    if comparison.is_inside_out() {
        let message = format!(
            "{heights} and {normals} tell opposite reliefs (correlation {:.2}): one has white for low",
            comparison.along_u
        );
        set.remarks.push((line, message));
    }
}
