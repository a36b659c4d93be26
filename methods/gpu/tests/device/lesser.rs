//! Devices that are less than this machine's.

use halflight_gpu::Adapter;

use super::*;

fn lesser(change: impl FnOnce(&mut Adapter)) -> Gpu {
    let mut adapter = adapters().next().expect("tests of the GPU need an adapter").clone();
    change(&mut adapter);
    Gpu::open_as(0, adapter).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn without_a_clock_passes_go_one_by_one_in_spans() {
    let (gpu, mut told) = (lesser(|adapter| adapter.timestamps = false), Told::default());
    let again = gpu.pipeline("again", AGAIN, &[Access::Write]).expect("valid");
    let mut values = Resident::new("values");
    values.upload(&gpu, &mut told, &[1.0f32]).expect("fits");
    let buffers = [values.whole()];
    let pass = |name, threads| Pass { name, pipeline: &again, buffers: &buffers, threads };
    let passes = [pass("first", 1), pass("nothing", 0), pass("second", 1)];
    assert_eq!(gpu.run_and_read::<f32>(&passes, &values, 1, &mut told).expect("runs"), [4.0]);
    assert_eq!(told.spans, ["first", "second"]);
    assert!(told.passes.is_empty(), "{:?}", told.passes);
}

/// 10 000 values where a binding holds 1024, or 1000: parts begin at multiples of 64.
#[test]
fn work_goes_in_parts_where_a_binding_does_not_hold_it() {
    for (limit, parts) in [(4096, 10), (4000, 11), (40_000, 1), (39_999, 2)] {
        let (gpu, mut told) = (lesser(|adapter| adapter.max_binding = limit & !3), Told::default());
        let pipeline = gpu.pipeline("double", DOUBLE, &[Access::Read, Access::Write]).expect("valid");
        let given: Vec<f32> = (0..10_000).map(|i| i as f32).collect();
        let (mut from, mut to) = (Resident::new("values"), Resident::new("doubled"));
        from.upload(&gpu, &mut told, &given).expect("buffers may be larger than bindings");
        to.reserve(&gpu, 40_000).expect("fits");
        let buffers: Vec<[Part<'_>; 2]> =
            gpu.parts(10_000, 4).map(|part| [from.items(part.clone(), 4), to.items(part, 4)]).collect();
        let passes = buffers.iter().zip(gpu.parts(10_000, 4)).map(|(buffers, part)| Pass {
            name: "double",
            pipeline: &pipeline,
            buffers,
            threads: part.end - part.start,
        });
        gpu.run(&passes.collect::<Vec<_>>(), &mut told).expect("fits");
        assert_eq!(buffers.len(), parts, "a limit of {limit}");
        let doubled: Vec<f32> = gpu.download(&to, 10_000, &mut told).expect("holds them");
        assert!(doubled.iter().zip(&given).all(|(to, from)| *to == 2.0 * from));
        if parts > 1 {
            let whole = double(&gpu, &from, 10_000, &mut told).unwrap_err();
            assert!(matches!(whole, GpuError::TooLarge { bytes: 40_000, .. }), "{whole}");
            assert!(whole.to_string().contains("values takes 40000 bytes"), "{whole}");
        }
    }
}

#[test]
fn groups_lie_in_two_dimensions_where_one_does_not_hold_them() {
    let gpu = lesser(|adapter| adapter.max_groups = 3);
    let given: Vec<f32> = (0..9 * 64 - 5).map(|i| i as f32).collect();
    let mut from = Resident::new("values");
    from.upload(&gpu, &mut NoMeter, &given).expect("fits");
    let doubled = double(&gpu, &from, given.len(), &mut NoMeter).expect("three by three groups");
    assert!(doubled.iter().zip(&given).all(|(to, from)| *to == 2.0 * from));
    from.upload(&gpu, &mut NoMeter, &[1.0f32; 9 * 64 + 1]).expect("fits");
    let error = double(&gpu, &from, 9 * 64 + 1, &mut NoMeter).unwrap_err();
    assert!(matches!(error, GpuError::Invalid { .. }), "{error}");
}

#[test]
fn buffers_beyond_the_limit_are_refused_before_they_are_made() {
    let gpu = lesser(|adapter| adapter.max_buffer = 1 << 20);
    let mut buffer = Resident::new("too much");
    buffer.reserve(&gpu, 1 << 20).expect("just fits");
    let error = buffer.reserve(&gpu, (1 << 20) + 4).unwrap_err();
    assert!(matches!(error, GpuError::TooLarge { limit: 0x10_0000, .. }), "{error}");
    assert_eq!(gpu.max_binding(), 1 << 20, "no binding is larger than a buffer");
}

#[test]
fn more_than_there_is_cannot_be_opened() {
    let mut adapter = adapters().next().expect("tests of the GPU need an adapter").clone();
    adapter.max_groups = u32::MAX;
    let error = Gpu::open_as(0, adapter).err().expect("no adapter has so many");
    assert!(matches!(error, GpuError::Unusable { .. }), "{error}");
}
