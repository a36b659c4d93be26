//! What this process cannot be brought into, in processes of their own.

use std::process::Command;

use halflight_contract::Backend;
use halflight_gpu::find;

use super::*;

/// Runs an ignored test of this module by itself, with a shell's preparation.
fn alone(test: &str, preparation: &str) {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("{preparation}; exec \"$0\" \"$@\"")]).arg(std::env::current_exe().expect("runs"));
    shell.args(["--exact", &format!("trouble::{test}"), "--ignored", "--nocapture"]);
    let output = shell.output().expect("there is a shell");
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

#[test]
fn without_a_driver_there_is_no_adapter() {
    alone("no_adapter", "export VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere");
}

#[test]
#[ignore = "needs an environment: see above"]
fn no_adapter() {
    assert_eq!(adapters().count(), 0);
    for wanted in [None, Some("0"), Some("llvmpipe")] {
        assert_eq!(find(wanted), Err(GpuError::NoAdapter));
    }
    for gpu in [Gpu::open(0), Gpu::shared(Backend::GPU).map(|_| panic!("there is none"))] {
        let error = gpu.err().expect("there is none").to_string();
        assert!(error.contains("no graphics adapter") && error.contains("mesa-vulkan-drivers"), "{error}");
    }
}

#[test]
fn memory_runs_out_with_an_error() {
    alone("out_of_memory", "ulimit -v 4000000");
}

#[test]
#[ignore = "needs a limit: see above"]
fn out_of_memory() {
    let gpu = gpu();
    let mut held = Vec::new();
    let error = loop {
        let mut buffer = Resident::new("one more");
        match buffer.reserve(&gpu, 128 << 20) {
            Ok(()) => held.push(buffer),
            Err(error) => break error,
        }
    };
    println!("{} buffers, then {error}", held.len());
    assert!(matches!(error, GpuError::OutOfMemory { .. }), "{error}");
    let said = error.to_string();
    assert!(said.contains(&gpu.adapter().name) && said.contains("one more, 134217728 bytes"), "{said}");
    // Nothing else is lost.
    held.truncate(1);
    let mut from = Resident::new("values");
    from.upload(&gpu, &mut NoMeter, &[1.0f32]).expect("fits");
    assert_eq!(double(&gpu, &from, 1, &mut NoMeter).expect("runs"), [2.0]);
}
