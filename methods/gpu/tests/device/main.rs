//! A real device, or one in software: these tests fail where there is none.

mod lesser;
mod threads;
mod trouble;

use halflight_contract::{Flow, Meter, NoMeter};
use halflight_gpu::{Access, Gpu, GpuError, Part, Pass, Resident, Revision, adapters};

const DOUBLE: &str = "
    @group(0) @binding(0) var<storage, read> given: array<f32>;
    @group(0) @binding(1) var<storage, read_write> to: array<f32>;
    @compute @workgroup_size(64)
    fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) place: u32) {
        let i = (group.y * groups.x + group.x) * 64u + place;
        if i < arrayLength(&given) { to[i] = 2.0 * given[i]; }
    }";

fn gpu() -> Gpu {
    Gpu::open(0).unwrap_or_else(|error| panic!("tests of the GPU need an adapter: {error}"))
}

/// What a meter is told.
#[derive(Default)]
struct Told {
    counters: Vec<(&'static str, u64)>,
    passes: Vec<(&'static str, u64)>,
    spans: Vec<&'static str>,
}

impl Meter for Told {
    fn begin(&mut self, span: &'static str) {
        self.spans.push(span);
    }
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        self.counters.push((counter, amount));
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
    fn gpu(&mut self, pass: &'static str, nanoseconds: u64) {
        self.passes.push((pass, nanoseconds));
    }
}

/// Doubles values in place.
const AGAIN: &str = "
    @group(0) @binding(0) var<storage, read_write> values: array<f32>;
    @compute @workgroup_size(64)
    fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x < arrayLength(&values) { values[id.x] *= 2.0; }
    }";

/// Doubles values that are uploaded to `from`.
fn double(gpu: &Gpu, from: &Resident, count: usize, meter: &mut dyn Meter) -> Result<Vec<f32>, GpuError> {
    let pipeline = gpu.pipeline("double", DOUBLE, &[Access::Read, Access::Write])?;
    let mut to = Resident::new("doubled");
    to.reserve(gpu, 4 * count as u64)?;
    let buffers = [from.whole(), to.whole()];
    gpu.run(&[Pass { name: "double", pipeline: &pipeline, buffers: &buffers, threads: count as u64 }], meter)?;
    gpu.download(&to, count, meter)
}

#[test]
fn values_go_there_and_back_and_are_uploaded_when_their_revision_changes() {
    let (gpu, mut told) = (gpu(), Told::default());
    let values: Vec<f32> = (0..100_000).map(|i| i as f32).collect();
    let mut from = Resident::new("values");
    from.sync(&gpu, Revision(1), &mut told, || values.clone()).expect("fits");
    from.sync::<f32>(&gpu, Revision(1), &mut told, || panic!("the same revision is not asked for")).expect("fits");
    let doubled = double(&gpu, &from, values.len(), &mut told).expect("runs");
    assert!(doubled.iter().zip(&values).all(|(to, from)| *to == 2.0 * from));
    assert_eq!(told.counters, [("bytes uploaded", 400_000), ("bytes downloaded", 400_000)]);
    from.sync(&gpu, Revision(2), &mut told, || vec![5.0f32; 3]).expect("fits");
    assert_eq!(double(&gpu, &from, 3, &mut told).expect("runs"), [10.0; 3]);
    assert_eq!(told.counters[2], ("bytes uploaded", 12));
}

#[test]
fn some_values_are_written_over_and_the_others_stay() {
    let (gpu, mut told) = (gpu(), Told::default());
    let mut values = Resident::new("values");
    values.upload(&gpu, &mut told, &[1.0f32, 2.0, 3.0, 4.0, 5.0]).expect("fits");
    values.write(&gpu, &mut told, 2, &[7.0f32, 8.0]).expect("fits");
    assert_eq!(told.counters, [("bytes uploaded", 20), ("bytes uploaded", 8)]);
    assert_eq!(gpu.download::<f32>(&values, 5, &mut told).expect("holds five"), [1.0, 2.0, 7.0, 8.0, 5.0]);
    let beyond = values.write(&gpu, &mut told, 4, &[1.0f32; 2]).unwrap_err();
    assert!(matches!(beyond, GpuError::Invalid { .. }), "{beyond}");
}

#[test]
fn passes_are_timed_by_the_device() {
    let (gpu, mut told) = (gpu(), Told::default());
    assert!(gpu.adapter().timestamps, "software adapters have a clock");
    let mut from = Resident::new("values");
    from.upload(&gpu, &mut told, &vec![1.0f32; 1 << 20]).expect("fits");
    double(&gpu, &from, 1 << 20, &mut told).expect("runs");
    let [("double", time)] = told.passes[..] else { panic!("{:?}", told.passes) };
    assert!((1_000..10_000_000_000).contains(&time), "4 MiB doubled in {time} ns");
}

/// More passes than one submission times, some of them of nothing, which have no time.
#[test]
fn passes_go_one_after_the_other_however_many() {
    let (gpu, mut told) = (gpu(), Told::default());
    let again = gpu.pipeline("again", AGAIN, &[Access::Write]).expect("valid");
    let mut values = Resident::new("values");
    values.upload(&gpu, &mut told, &[0.75f32; 4]).expect("fits");
    let buffers = [values.whole()];
    for count in [0, 1, 256, 257, 600] {
        told = Told::default();
        let pass =
            |i| Pass { name: "again", pipeline: &again, buffers: &buffers, threads: if i % 2 == 0 { 4 } else { 0 } };
        let passes: Vec<_> = (0..2 * count).map(pass).collect();
        values.write(&gpu, &mut NoMeter, 0, &[0.75f32; 4]).expect("fits");
        let found: Vec<f32> = gpu.run_and_read(&passes, &values, 4, &mut told).expect("runs");
        assert_eq!(found, [0.75f32 * 2f32.powi(count.min(127)) * 2f32.powi((count - 127).max(0)); 4], "{count} passes");
        assert_eq!((told.passes.len(), &told.counters[..]), (count as usize, &[("bytes downloaded", 16)][..]));
    }
}

#[test]
fn nothing_to_do_is_done() {
    let gpu = gpu();
    let mut from = Resident::new("values");
    from.upload::<f32>(&gpu, &mut NoMeter, &[]).expect("fits");
    assert!(double(&gpu, &from, 0, &mut NoMeter).expect("runs").is_empty());
}

#[test]
fn errors_say_what_went_wrong() {
    let gpu = gpu();
    let name = &gpu.adapter().name;
    let broken = gpu.pipeline("broken", "fn main() { nonsense }", &[]);
    let error = broken.err().expect("not WGSL").to_string();
    assert!(error.contains(name) && error.contains("broken") && error.contains("nonsense"), "{error}");

    let other = gpu.pipeline("double", DOUBLE, &[Access::Read]);
    assert!(matches!(other, Err(GpuError::Invalid { .. })), "a binding is missing");

    let mut huge = Resident::new("a huge buffer");
    let error = huge.reserve(&gpu, u64::MAX / 2).unwrap_err();
    assert!(matches!(error, GpuError::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("a huge buffer"), "{error}");

    let unfilled = Resident::new("never filled");
    let error = double(&gpu, &unfilled, 1, &mut NoMeter).unwrap_err().to_string();
    assert!(error.contains("never filled") && error.contains(name), "{error}");

    assert!(matches!(Gpu::open(250), Err(GpuError::Unknown { .. })));

    // None of it harmed the device.
    let mut from = Resident::new("values");
    from.upload(&gpu, &mut NoMeter, &[1.0f32]).expect("fits");
    assert_eq!(double(&gpu, &from, 1, &mut NoMeter).expect("runs"), [2.0]);
}

#[test]
fn a_pipeline_is_compiled_once() {
    let gpu = gpu();
    let [first, second] =
        [0; 2].map(|_| gpu.pipeline("double", DOUBLE, &[Access::Read, Access::Write]).expect("valid"));
    assert!(std::sync::Arc::ptr_eq(&first, &second));
}

#[test]
fn adapters_have_limits_and_software_is_marked() {
    assert!(adapters().count() > 0, "tests of the GPU need an adapter");
    for adapter in adapters() {
        assert!(adapter.max_binding >= 128 << 20 && adapter.max_groups >= 65_535, "{adapter:?}");
        assert_eq!(adapter.to_string().contains("correctness only"), adapter.name.contains("llvmpipe"), "{adapter:?}");
    }
}
