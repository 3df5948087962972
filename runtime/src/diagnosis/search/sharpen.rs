//! Shapes of the accepted laws at the least squares of all motion.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rules::SHARPENING_SWEEPS;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::tuning::Tuning;

impl ExtendedModel<'_> {
    /// Moves the shape of every law to where all laws together leave least, if that is less by more than noise.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub fn sharpen(&mut self) -> Result<(), SingularDesign> {
        for _ in 0..SHARPENING_SWEEPS {
            let mut moved = false;
            for k in 0..self.terms.len() {
                if self.terms[k].shape.is_empty() {
                    continue;
                }
                let mut tuning = Tuning::within(self, k)?;
                let before = tuning.squares();
                tuning.run();
                // Along a valley that is flat within its noise a shape is as good anywhere, and stays where it was found.
                let noise = self.terms[k].inflation * self.terms[k].inflation;
                if before - tuning.squares() > noise {
                    self.terms[k].shape = tuning.shape().to_vec();
                    self.refit()?;
                    moved = true;
                }
            }
            if !moved {
                break;
            }
        }
        Ok(())
    }
}
