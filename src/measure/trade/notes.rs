//! What a reader must know before trusting a record.

use super::{Record, ViewFacts};

/// A view in which less than one in so many rays shows a relief is told.
const FEW: usize = 20;

impl Record {
    /// What a reader must know before trusting the figures, a sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.partial {
            notes.push("This is a part: the sweep was stopped, or shards are missing.".to_owned());
        }
        if let Some(shard) = self.shard {
            notes.push(format!("This is shard {} of {}.", shard.index, shard.count));
        }
        let noisy = self.noisy_share();
        if self.is_noisy() {
            notes.push(format!(
                "The machine was noisy: {:.0} % of the times spread by more than {:.0} % of their median. Trust the counts of look-ups, steps and rays before the times.",
                noisy * 100.0,
                Self::NOISY * 100.0
            ));
        }
        let limited = self.cells.iter().filter(|c| c.limited_by_noise).count();
        if limited > 0 {
            notes.push(format!(
                "Of the pictures, {limited} of {} have a figure that is still less than ten times what the halves of their samples differ by, with up to {} samples per pixel (`--most-samples`): it is told as being below that (`<`).",
                self.cells.len(),
                self.plan.most_samples
            ));
        }
        let few = |v: &&ViewFacts| v.rays < self.plan.rays as usize / FEW;
        notes.extend(self.views.iter().filter(few).map(|view| {
            format!(
                "At {:.0}° only {} of {} view rays show a relief from its front.",
                view.angle_deg, view.rays, self.plan.rays
            )
        }));
        notes.extend(
            self.left_out
                .iter()
                .map(|what| format!("Not measured: {what}.")),
        );
        notes
    }
}
