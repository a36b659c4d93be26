//! What a method says of its memory.

use halflight_contract::NoMeter;

use super::{Case, Verdict, Violation, ensure};

/// After an evaluation the footprint holds at least the result, on the host or on the device.
///
/// Whether it holds all else is for a test with an allocator that counts.
pub fn footprint_counts_results(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("footprint_counts_results", || {
        let frame = &case.frames[0];
        let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
        let result = size_of_val(&case.run(&mut *prepared, frame)?[..]) as u64;
        let entries = prepared.footprint().entries;
        let held: u64 = entries.iter().map(|(_, host, device)| host + device).sum();
        ensure(held >= result, || format!("{held} bytes for a result of {result}: {entries:?}"))?;
        Ok(Verdict::Held)
    })
}
