//! Methods with the parameters that trade speed for accuracy.

use serde::{Deserialize, Serialize};

use crate::surface::mapping::{MappingSettings, Method};

/// One method with its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Variant {
    /// The method.
    pub method: Method,
    /// Layers, cone steps or iterations, as the method has it; `None` where it takes none.
    pub steps: Option<u32>,
    /// Whether its relief shadows itself. Only searches can.
    pub self_shadow: bool,
}

/// Steps of one method in the two sizes of a sweep.
struct Ladder {
    full: &'static [u32],
    quick: &'static [u32],
}

/// Layers of the searches that sample at equal distances.
const LAYERS: Ladder = Ladder {
    full: &[4, 8, 16, 32, 64, 128, 256],
    quick: &[8, 32],
};
/// Cone steps.
const CONE_STEPS: Ladder = Ladder {
    full: &[4, 8, 16, 32, 64],
    quick: &[16],
};
/// Iterations.
const ITERATIONS: Ladder = Ladder {
    full: &[1, 2, 4, 8, 16],
    quick: &[4],
};
/// Steps at which a search is also measured without its relief's own shadows.
const WITHOUT_SHADOW: u32 = 32;

impl Variant {
    /// All variants of a method, the fewest steps first.
    #[must_use]
    pub fn of(method: Method, quick: bool) -> Vec<Self> {
        let plain = |steps| Self {
            method,
            steps,
            self_shadow: method.searches(),
        };
        let Some(ladder) = ladder(method) else {
            return with_bare(vec![plain(None)]);
        };
        let steps = if quick { ladder.quick } else { ladder.full };
        with_bare(steps.iter().map(|&n| plain(Some(n))).collect())
    }

    /// The same variant in the settings of a scene: everything on that the method needs.
    #[must_use]
    pub fn applied(&self, mapping: &MappingSettings) -> MappingSettings {
        let mut mapping = *mapping;
        mapping.use_parallax = true;
        mapping.use_height = true;
        mapping.use_normal = true;
        // The truth has no border to end at.
        mapping.cut_at_border = false;
        self.choose(&mut mapping);
        mapping
    }

    /// Makes settings show this variant, their switches left as they are.
    pub fn choose(&self, mapping: &mut MappingSettings) {
        mapping.method = self.method;
        if self.method.searches() {
            mapping.search.self_shadow = self.self_shadow;
        }
        if let Some(steps) = self.steps {
            match self.method {
                Method::Iterative => mapping.search.iterations = steps,
                _ => mapping.search.layers = steps,
            }
            // Facing the surface a quarter will do, as the scenes' 8 of 32 have it.
            mapping.search.min_layers = (steps / 4).max(1);
        }
    }

    /// What the settings of a scene make of a method: its variant at this moment.
    #[must_use]
    pub fn current(method: Method, mapping: &MappingSettings) -> Self {
        let search = &mapping.search;
        Self {
            method,
            steps: ladder(method).map(|_| match method {
                Method::Iterative => search.iterations,
                _ => search.layers,
            }),
            self_shadow: method.searches() && search.self_shadow,
        }
    }

    /// Short and unique: `relief 32`, `exact without own shadow`.
    #[must_use]
    pub fn label(&self) -> String {
        let steps = self.steps.map(|n| format!(" {n}")).unwrap_or_default();
        let bare = if self.method.searches() && !self.self_shadow {
            " without own shadow"
        } else {
            ""
        };
        format!("{}{steps}{bare}", self.method.name())
    }

    /// Whether it is the one variant of its method that stands for it where each method is shown once.
    #[must_use]
    pub fn is_usual(&self) -> bool {
        let usual = match self.method {
            Method::Iterative => 4,
            Method::RelaxedCone => 16,
            _ => 32,
        };
        !self.is_bare() && self.steps.is_none_or(|n| n == usual)
    }

    /// Whether it is a search whose relief does not shadow itself.
    #[must_use]
    pub const fn is_bare(&self) -> bool {
        self.method.searches() && !self.self_shadow
    }
}

const fn ladder(method: Method) -> Option<&'static Ladder> {
    match method {
        Method::Iterative => Some(&ITERATIONS),
        Method::Steep | Method::Occlusion | Method::Relief => Some(&LAYERS),
        Method::RelaxedCone => Some(&CONE_STEPS),
        _ => None,
    }
}

/// Adds to a search the variant whose relief does not shadow itself.
fn with_bare(mut variants: Vec<Variant>) -> Vec<Variant> {
    let usual =
        |v: &&Variant| v.method.searches() && matches!(v.steps, None | Some(WITHOUT_SHADOW));
    let bare = variants.iter().find(usual).map(|&v| Variant {
        self_shadow: false,
        ..v
    });
    variants.extend(bare);
    variants
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn labels_tell_all_variants_apart() {
        for quick in [false, true] {
            let all: Vec<Variant> = Method::ALL
                .into_iter()
                .flat_map(|m| Variant::of(m, quick))
                .collect();
            let labels: HashSet<String> = all.iter().map(Variant::label).collect();
            assert_eq!(labels.len(), all.len());
            let methods: HashSet<Method> = all.iter().map(|v| v.method).collect();
            assert_eq!(methods.len(), Method::ALL.len(), "a method is missing");
        }
    }

    #[test]
    fn a_variant_survives_the_settings() {
        for method in Method::ALL {
            for variant in Variant::of(method, false) {
                let mapping = variant.applied(&MappingSettings::default());
                assert_eq!(Variant::current(method, &mapping), variant);
            }
        }
    }

    #[test]
    fn each_method_has_one_usual_variant() {
        for (method, quick) in Method::ALL
            .into_iter()
            .flat_map(|m| [(m, false), (m, true)])
        {
            let usual = Variant::of(method, quick)
                .iter()
                .filter(|v| v.is_usual())
                .count();
            assert_eq!(usual, 1, "{method:?}");
        }
    }

    #[test]
    fn only_searches_are_measured_without_own_shadow() {
        for method in Method::ALL {
            let bare = Variant::of(method, false).iter().any(Variant::is_bare);
            let expected = matches!(
                method,
                Method::Steep
                    | Method::Occlusion
                    | Method::Relief
                    | Method::RelaxedCone
                    | Method::Exact
            );
            assert_eq!(bare, expected, "{method:?}");
        }
    }
}
