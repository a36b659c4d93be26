//! Under what conditions results were taken.

use crate::Error;
use halflight_results::Environment;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::read_to_string;
use std::str::FromStr;
use std::time::{SystemTime, UNIX_EPOCH};

/// A machine and its state when results were taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// What the results are about: the adapter, or the processor where none took part.
    pub device: String,
    /// What is known of the adapter: driver, kind, clock, limits. None where none took part.
    pub adapter: Option<String>,
    /// The machine and the build.
    pub environment: Environment,
    /// Vector extensions that the processor's kernels may use.
    pub features: Vec<String>,
    /// The governor of the processor's clock, where the system tells it.
    pub governor: Option<String>,
    /// The processor's clocks when the run began, lowest and highest of its cores, MHz.
    pub clock: Option<[f64; 2]>,
    /// Processes that were ready to run, averaged over the minute before: others' work beside ours.
    pub load: Option<f64>,
    /// What else is to be known, by whoever took them.
    pub note: String,
    /// The command.
    pub command: String,
    /// Seconds since 1970-01-01 UTC when the run ended.
    pub taken: u64,
    /// What the processor (`cpu`) and the adapter (`gpu`) can do at best.
    pub peaks: BTreeMap<String, Peak>,
}

/// The most that a device can do: a fact of the device, not of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peak {
    /// Operations of `f32` a second; a fused multiply-add counts two.
    pub flops: f64,
    /// Bytes a second from and to the device's memory.
    pub bytes: f64,
}

/// `gpu=67e12,3.35e12`: of the processor or the adapter, operations and bytes a second.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PeakOf {
    pub(crate) side: String,
    pub(crate) peak: Peak,
}

impl FromStr for PeakOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || "expected cpu=FLOPS,BYTES or gpu=FLOPS,BYTES, both a second, such as gpu=67e12,3.35e12".to_owned();
        let (side, peak) = text.split_once('=').filter(|(side, _)| ["cpu", "gpu"].contains(side)).ok_or_else(wrong)?;
        let (flops, bytes) = peak.split_once(',').ok_or_else(wrong)?;
        let number = |text: &str| text.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0).ok_or_else(wrong);
        Ok(Self { side: side.to_owned(), peak: Peak { flops: number(flops)?, bytes: number(bytes)? } })
    }
}

/// This machine's conditions now, with what is known of an adapter that takes part.
pub fn conditions(adapter: Option<(String, String)>) -> Conditions {
    let environment = crate::environment();
    let (name, adapter) = adapter.unzip();
    Conditions {
        device: name.unwrap_or_else(|| environment.cpu.clone()),
        adapter,
        features: crate::cpu_features().into_iter().map(str::to_owned).collect(),
        governor: line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
        clock: clocks(&read_to_string("/proc/cpuinfo").unwrap_or_default()),
        load: line("/proc/loadavg").and_then(|line| line.split(' ').next()?.parse().ok()),
        environment,
        ..Conditions::default()
    }
}

impl Conditions {
    /// The name of its file: small letters, digits and dashes.
    ///
    /// # Errors
    /// The device's name has none.
    pub fn file_name(&self) -> Result<String, Error> {
        let plain: String =
            self.device.to_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
        let words: Vec<&str> = plain.split('-').filter(|word| !word.is_empty()).collect();
        match words.as_slice() {
            [] => Err(Error::Other(format!("device {:?}: expected a name with letters or digits", self.device))),
            words => Ok(format!("{}.jsonl", words.join("-"))),
        }
    }

    /// The time now, as [`Conditions::taken`].
    pub(crate) fn now() -> u64 {
        SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs())
    }
}

fn line(path: &str) -> Option<String> {
    Some(read_to_string(path).ok()?.trim().to_owned()).filter(|line| !line.is_empty())
}

/// The lowest and highest clock of `/proc/cpuinfo`, MHz.
fn clocks(info: &str) -> Option<[f64; 2]> {
    let values = info.lines().filter_map(|line| line.strip_prefix("cpu MHz")?.split_once(':')?.1.trim().parse().ok());
    values.fold(None, |ends, value: f64| {
        Some(ends.map_or([value; 2], |[low, high]: [f64; 2]| [low.min(value), high.max(value)]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_of_a_side_and_positive() {
        let peak = PeakOf { side: "gpu".into(), peak: Peak { flops: 67e12, bytes: 3.35e12 } };
        assert_eq!("gpu=67e12,3.35e12".parse(), Ok(peak));
        for bad in ["67e12,3e12", "tpu=1,2", "gpu=1", "gpu=0,1", "gpu=1,inf", "gpu=NaN,1", "gpu=-1,1", ""] {
            assert!(bad.parse::<PeakOf>().unwrap_err().contains("gpu=67e12"), "{bad}");
        }
    }

    #[test]
    fn files_are_called_by_the_device() {
        let named = |device: &str| Conditions { device: device.into(), ..Conditions::default() }.file_name();
        assert_eq!(named("NVIDIA H100 80GB HBM3").unwrap(), "nvidia-h100-80gb-hbm3.jsonl");
        assert_eq!(named("../llvmpipe (LLVM 15.0.6, 256 bits)").unwrap(), "llvmpipe-llvm-15-0-6-256-bits.jsonl");
        assert!(named("../").is_err());
    }

    #[test]
    fn clocks_are_those_of_all_cores() {
        assert_eq!(clocks("cpu MHz\t\t: 2700.5\nflags : x\ncpu MHz\t\t: 1200.0\n"), Some([1200.0, 2700.5]));
        assert_eq!(clocks("flags : x\n"), None);
    }
}
