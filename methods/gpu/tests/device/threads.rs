//! One device and many threads.

use std::sync::Arc;

use halflight_contract::Backend;

use super::*;

/// Many at once ask for the device and use it: they get the same one, and each its own results.
#[test]
fn threads_share_a_device() {
    let backend = Backend::Gpu(100);
    let shared = gpu().share(backend);
    let work = |thread: usize| {
        for round in 0..30 {
            let gpu = Gpu::shared(backend).expect("is open");
            assert!(Arc::ptr_eq(&gpu, &shared));
            let mut told = Told::default();
            let given: Vec<f32> = (0..100 * (thread + 1) + round).map(|i| (i + thread) as f32).collect();
            let mut from = Resident::new("values");
            from.upload(&gpu, &mut told, &given).expect("fits");
            let doubled = double(&gpu, &from, given.len(), &mut told).expect("runs");
            assert!(doubled.iter().zip(&given).all(|(to, from)| *to == 2.0 * from), "thread {thread}");
            assert_eq!(told.passes.len(), 1, "each its own time");
        }
    };
    std::thread::scope(|scope| (0..8).for_each(|thread| drop(scope.spawn(move || work(thread)))));
}

/// A device that goes while others use it: all of them are told, nobody waits forever, and who asks again gets a new one.
#[test]
fn a_device_lost_under_way_is_opened_again_as_it_was() {
    let mut adapter = gpu().adapter().clone();
    adapter.max_binding = 1 << 16;
    let backend = Backend::Gpu(101);
    let shared = Gpu::open_as(0, adapter.clone()).expect("opens").share(backend);
    let until_lost = || {
        let gpu = Gpu::shared(backend).expect("is open");
        let mut from = Resident::new("values");
        loop {
            let done =
                from.upload(&gpu, &mut NoMeter, &[1.0f32; 999]).and_then(|()| double(&gpu, &from, 999, &mut NoMeter));
            match done {
                Ok(doubled) => assert_eq!(doubled, [2.0; 999]),
                Err(error) => return error,
            }
        }
    };
    std::thread::scope(|scope| {
        let users: Vec<_> = (0..4).map(|_| scope.spawn(until_lost)).collect();
        std::thread::sleep(std::time::Duration::from_millis(50));
        shared.give_up();
        for user in users {
            let error = user.join().expect("does not panic");
            assert!(matches!(error, GpuError::Lost { .. }), "{error}");
            assert!(error.to_string().contains(&adapter.name), "{error}");
        }
    });
    let again = Gpu::shared(backend).expect("opens again");
    assert!(!Arc::ptr_eq(&again, &shared));
    assert_eq!(again.adapter(), &adapter);
    let mut from = Resident::new("values");
    from.upload(&again, &mut NoMeter, &[1.0f32]).expect("fits");
    assert_eq!(double(&again, &from, 1, &mut NoMeter).expect("runs"), [2.0]);
}

#[test]
fn a_lost_device_says_so_ever_after() {
    let gpu = gpu();
    let mut from = Resident::new("values");
    from.upload(&gpu, &mut NoMeter, &[1.0f32]).expect("fits");
    gpu.give_up();
    for _ in 0..2 {
        let lost = double(&gpu, &from, 1, &mut NoMeter).unwrap_err();
        assert!(matches!(lost, GpuError::Lost { .. }), "{lost}");
    }
    assert!(matches!(from.upload(&gpu, &mut NoMeter, &[1.0f32]), Err(GpuError::Lost { .. })));
}
