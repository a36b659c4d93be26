//! What there is to be seen at a time: blockers, distant light and lamps, whatever computes with them.

use std::sync::Arc;

use halflight_contract::{Footprint, Job, Meter, Params, Result, timed};
use halflight_light::{LightOf, SceneLight, ShLight};
use halflight_proxies::{PosedSpheres, Proxy, blockers, proxies};
#[cfg(feature = "gpu")]
use halflight_scenes::Revision;
use halflight_scenes::{Frame, Scene};
use halflight_sh::{apply_bands, coefficients, window};

use crate::lamps::{Lamp, Lobes, is_lamp, lamps};
use crate::params;

/// Blockers and light of a scene, carried along with its frames.
pub(crate) struct Stage<'s> {
    scene: &'s Scene,
    /// Of light and shading.
    pub(crate) order: usize,
    light: Arc<SceneLight>,
    /// The light now.
    lit: ShLight,
    /// A factor for each band of light.
    pub(crate) light_window: Vec<f32>,
    /// Whether there are lamps and they are lit.
    pub(crate) lamplit: bool,
    pub(crate) proxies: Vec<Option<Proxy>>,
    pub(crate) spheres: PosedSpheres,
    /// Another one whenever `spheres` are others.
    #[cfg(feature = "gpu")]
    pub(crate) posed: Revision,
    pub(crate) lamps: Vec<Lamp>,
    /// None if lamps light by shares, or there is none.
    pub(crate) lobes: Option<Lobes>,
}

impl<'s> Stage<'s> {
    /// Derives sphere sets and light.
    pub(crate) fn derive(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let order = job.params.int(params::ORDER.name);
        let lamplit = job.params.flag(params::LOCAL_LIGHTS.name)
            && (0..job.scene.objects.len()).any(|object| is_lamp(job.scene, object));
        let mut proxies = proxies(job, job.params.int(params::SPHERES.name), meter)?;
        if lamplit {
            // A lamp must not stand in its own light.
            proxies
                .iter_mut()
                .enumerate()
                .filter(|(object, _)| is_lamp(job.scene, *object))
                .for_each(|(_, proxy)| *proxy = None);
        }
        let light = job.derive(&LightOf { order }, meter)?;
        let light_window = match job.params.flag(params::WINDOW_LIGHT.name) {
            true => bands(order),
            false => vec![1.0; order],
        };
        let lobes = lamplit && job.params.choice(params::LAMPS.name) == "lobe";
        let lobes = lobes.then(|| timed(meter, "fit lobes", |_| Lobes::new(order, &light_window)));
        Ok(Stage {
            scene: job.scene,
            order,
            lit: light.still.clone(),
            light,
            light_window,
            lamplit,
            proxies,
            spheres: PosedSpheres::default(),
            #[cfg(feature = "gpu")]
            posed: Revision(0),
            lamps: Vec::new(),
            lobes,
        })
    }

    /// Follows what moves.
    pub(crate) fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) {
        let spheres = timed(meter, "pose spheres", |_| blockers(self.scene, frame, &self.proxies));
        #[cfg(feature = "gpu")]
        if spheres != self.spheres {
            self.posed.0 += 1;
        }
        self.spheres = spheres;
        if !self.light.turning.is_empty() {
            self.lit = timed(meter, "turn light", |_| self.light.at(frame.time).into_owned());
        }
        if self.lamplit {
            self.lamps = lamps(self.scene, frame);
        }
    }

    /// Distant light, windowed.
    pub(crate) fn windowed_light(&self) -> [Vec<f32>; 3] {
        self.lit.rgb.clone().map(|mut channel| {
            apply_bands(&self.light_window, &mut channel);
            channel
        })
    }

    /// A factor for each coefficient of visibility, if there is one to be.
    pub(crate) fn visibility_window(&self, params: &Params) -> Option<Vec<f32>> {
        params.flag(params::WINDOW_VISIBILITY.name).then(|| {
            let mut window = vec![1.0; coefficients(self.order)];
            apply_bands(&bands(self.order), &mut window);
            window
        })
    }

    /// Memory held.
    pub(crate) fn footprint(&self) -> Footprint {
        let spheres = size_of_val(self.spheres.spheres.as_slice()) + size_of_val(self.spheres.object.as_slice());
        Footprint::default()
            .host("sphere sets (shared)", self.proxies.iter().flatten().map(Proxy::bytes).sum())
            .host("posed spheres", spheres)
            .host("light (shared)", self.light.bytes())
            .host("lobes of lamps", self.lobes.as_ref().map_or(0, Lobes::bytes))
    }
}

fn bands(order: usize) -> Vec<f32> {
    window(order, 2.0 * order as f64).iter().map(|alpha| *alpha as f32).collect()
}
