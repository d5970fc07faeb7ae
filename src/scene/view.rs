//! What the screen shows in place of the picture, or over it.

/// What is shown of the pixels' first samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum View {
    /// The picture itself.
    #[default]
    Picture,
    /// The normals that light is computed with, towards the eye, world axes.
    Normals,
    /// The texture coordinates shown, after the method moved them.
    Uv,
    /// What the height map says there.
    Height,
    /// How far under the base the place shown lies, over the amplitude.
    Depth,
    /// Steps of the search along the view ray.
    Steps,
    /// Samples that the pixel has.
    Samples,
    /// Rays, look-ups and steps.
    Cost,
    /// The picture; over it, normals that no surface seen from here could have.
    InvalidNormals,
    /// The picture; over it, samples that are no numbers.
    NonFinite,
    /// The picture; over it, searches that took every step they may.
    StepsAtTheCap,
    /// The picture; over it, pixels at which a textbook's ray–triangle test sees something else.
    Leaks,
    /// The picture; over it, pixels that a textbook's shadow rays shadow or light wrongly.
    FalseShadows,
}

/// How a view is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewKind {
    /// As it is.
    Picture,
    /// Red, green and blue each stand for a number.
    Channels,
    /// In false colours.
    Scale,
    /// As loud pixels over the picture.
    Marks,
}

impl View {
    /// Every view, in the order of menus and of the key that goes through them.
    pub const ALL: [Self; 13] = [
        Self::Picture,
        Self::Normals,
        Self::Uv,
        Self::Height,
        Self::Depth,
        Self::Steps,
        Self::Samples,
        Self::Cost,
        Self::InvalidNormals,
        Self::NonFinite,
        Self::StepsAtTheCap,
        Self::Leaks,
        Self::FalseShadows,
    ];

    /// Name in scene files, on the command line and in menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Normals => "normals",
            Self::Uv => "uv",
            Self::Height => "height",
            Self::Depth => "depth",
            Self::Steps => "steps",
            Self::Samples => "samples",
            Self::Cost => "cost",
            Self::InvalidNormals => "invalid-normals",
            Self::NonFinite => "non-finite",
            Self::StepsAtTheCap => "steps-at-the-cap",
            Self::Leaks => "leaks",
            Self::FalseShadows => "false-shadows",
        }
    }

    /// The view of that [`Self::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|view| view.name() == name)
    }

    /// What its colours say, with the unit, for legends and help.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Picture => "the picture",
            Self::Normals => "normal used for shading, world axes",
            Self::Uv => "texture coordinate shown, whole numbers left out",
            Self::Height => "height map at the place shown, stored value",
            Self::Depth => "depth under the base, amplitudes",
            Self::Steps => "steps of the search along the view ray",
            Self::Samples => "samples per pixel",
            Self::Cost => "rays, look-ups and steps of the first sample",
            Self::InvalidNormals => {
                "normals turned away from the eye or under the surface's own horizon"
            }
            Self::NonFinite => "samples that are not finite",
            Self::StepsAtTheCap => "searches that took every step they may",
            Self::Leaks => "camera rays that the chosen kernel leads elsewhere",
            Self::FalseShadows => "shadows wrong by the chosen kernel and offset",
        }
    }

    /// How it is shown.
    #[must_use]
    pub const fn kind(self) -> ViewKind {
        match self {
            Self::Picture => ViewKind::Picture,
            Self::Normals | Self::Uv => ViewKind::Channels,
            Self::Height | Self::Depth | Self::Steps | Self::Samples | Self::Cost => {
                ViewKind::Scale
            }
            Self::InvalidNormals
            | Self::NonFinite
            | Self::StepsAtTheCap
            | Self::Leaks
            | Self::FalseShadows => ViewKind::Marks,
        }
    }

    /// Whether nothing of the picture is left to see.
    #[must_use]
    pub const fn covers_picture(self) -> bool {
        matches!(self.kind(), ViewKind::Channels | ViewKind::Scale)
    }

    /// The view after this one.
    #[must_use]
    pub fn next(self) -> Self {
        self.turned(1)
    }

    /// The view before this one.
    #[must_use]
    pub fn previous(self) -> Self {
        self.turned(Self::ALL.len() - 1)
    }

    fn turned(self, by: usize) -> Self {
        let place = Self::ALL.iter().position(|view| *view == self);
        Self::ALL[(place.unwrap_or(0) + by) % Self::ALL.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::View;

    #[test]
    fn names_come_back_and_the_key_reaches_every_view() {
        let mut view = View::default();
        for expected in View::ALL {
            assert_eq!(view, expected);
            assert_eq!(View::from_name(view.name()), Some(view));
            assert_eq!(view.next().previous(), view);
            view = view.next();
        }
        assert_eq!(view, View::Picture);
        assert_eq!(View::from_name("no such view"), None);
    }
}
