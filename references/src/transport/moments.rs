//! Independent batches, their mean and the variance that their spread gives it.

use glam::{DVec3, Vec3};

/// How many samples to take: `batches` independent replicates of `per_batch` (a power of two) each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    pub(crate) batches: u32,
    pub(crate) per_batch: u32,
}

impl Plan {
    pub(crate) fn samples(self) -> u32 {
        self.batches * self.per_batch
    }
}

/// What an estimate found at one receiver, for albedo 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) mean: DVec3,
    /// Of the mean.
    pub(crate) variance: DVec3,
    /// Rays traced, or directions held against circles.
    pub(crate) rays: u64,
}

/// A control variate: the integral with `V = 1` is known, and what a batch finds for it tells much of that batch's error.
/// Times the share of the light that is visible this is subtracted, so that in the open and in the dark no error remains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// Any share leaves the estimate without bias that was not chosen by the same samples.
    pub(crate) share: f64,
    pub(crate) known: DVec3,
}

/// What one batch finds.
#[derive(Clone, Copy, Default)]
pub(crate) struct Batch {
    /// Of the light.
    pub(crate) visible: DVec3,
    /// Of the light whose unoccluded amount is known, with `V = 1`.
    pub(crate) open: DVec3,
}

/// The batches of one receiver.
#[derive(Default)]
pub(crate) struct Batches {
    batches: Vec<Batch>,
    rays: u64,
    /// Rays that are blocked or not, and nothing between.
    shadow_rays: u64,
    /// Sum of what these bring squared, blocked or not.
    squares: DVec3,
}

impl Batches {
    pub(crate) fn start(&mut self, batches: u32) {
        self.batches.clear();
        self.batches.resize(batches as usize, Batch::default());
        (self.rays, self.shadow_rays, self.squares) = (0, 0, DVec3::ZERO);
    }

    /// Light of known unoccluded amount along a ray that either is blocked or not.
    pub(crate) fn shadow_ray(&mut self, batch: u32, value: Vec3, blocked: bool) {
        let value = value.as_dvec3();
        self.squares += value * value;
        self.shadow_rays += 1;
        self.rays += 1;
        let batch = &mut self.batches[batch as usize];
        batch.open += value;
        if !blocked {
            batch.visible += value;
        }
    }

    /// Light whose unoccluded amount nobody knows.
    pub(crate) fn add(&mut self, batch: u32, value: Vec3) {
        self.batches[batch as usize].visible += value.as_dvec3();
    }

    /// Counts rays.
    pub(crate) fn count(&mut self, rays: usize) {
        self.rays += rays as u64;
    }

    /// The share of the light that is visible, in `[0, 1]`, as far as it is known.
    pub(crate) fn share(&self) -> f64 {
        let sum = |part: fn(&Batch) -> DVec3| self.batches.iter().map(|batch| part(batch).element_sum()).sum::<f64>();
        let (visible, open) = (sum(|batch| batch.visible), sum(|batch| batch.open));
        if open > 0.0 { (visible / open).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Mean of the batches' estimates, and the variance that their spread gives it.
    pub(crate) fn moments(&self, control: Control) -> Moments {
        let (mean, variance) = spread(self.batches.iter().map(|b| b.visible - control.share * b.open));
        let mean = mean + control.share * control.known;
        Moments { mean, variance: variance + self.grain(), rays: self.rays }
    }

    /// The variance that half a ray more or less brings. Visibility comes in whole rays and stratified batches often agree
    /// on their number, above all where it is none or all of them; that does not make it certain. By Jeffreys' prior, of `N`
    /// rays that agree about `1/2N` still go the other way. Elsewhere this is far below the batches' spread.
    fn grain(&self) -> DVec3 {
        let batches = self.batches.len() as f64;
        self.squares / (batches * batches) * (0.5 / self.shadow_rays.max(1) as f64)
    }
}

/// Mean of independent estimates, and the mean's variance.
pub(crate) fn spread(estimates: impl ExactSizeIterator<Item = DVec3> + Clone) -> (DVec3, DVec3) {
    let count = estimates.len() as f64;
    let mean = estimates.clone().sum::<DVec3>() / count;
    let squares: DVec3 = estimates.map(|estimate| (estimate - mean) * (estimate - mean)).sum();
    (mean, squares / (count * (count - 1.0)))
}
