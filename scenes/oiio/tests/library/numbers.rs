//! Whole numbers: correctly rounded shares of the greatest.

use std::path::Path;

use halflight_oiio::{File, Numbers};

use crate::tools::copies;

/// A PNG of every value of 8 or 16 bits.
fn grey(path: &Path, bits: u32) {
    let most = (1_u32 << bits) - 1;
    let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), 256, (most + 1) / 256);
    encoder.set_depth(if bits == 8 { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
    let values =
        (0..=most).flat_map(|value| if bits == 8 { vec![value as u8] } else { (value as u16).to_be_bytes().into() });
    encoder.write_header().unwrap().write_image_data(&values.collect::<Vec<u8>>()).unwrap();
}

#[test]
fn whole_numbers_become_shares() {
    let folder = tempfile::tempdir().unwrap();
    for bits in [8, 16] {
        let most = (1 << bits) - 1;
        let path = folder.path().join("grey.png");
        grey(&path, bits);
        let mut paths = vec![path.clone()];
        paths.extend(copies(&path, &[(vec![], "grey.tif"), (vec![], "grey.sgi")]).unwrap_or_default());
        for path in paths {
            let mut file = File::open(&path, 1 << 16).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert_eq!((file.numbers, file.channels.len()), (Numbers::Unsigned(bits), 1), "{}", path.display());
            let values = file.read(0..1).unwrap();
            let wrong = (0..=most).zip(&values).find(|(v, read)| *v as f32 / most as f32 != **read);
            assert!(wrong.is_none() && values.len() == most as usize + 1, "{}: {wrong:?}", path.display());
        }
    }
}

#[test]
fn whole_numbers_with_sign() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.png");
    grey(&path, 8);
    let Some(signed) = copies(&path, &[(vec!["-d", "int16"], "signed.tif")]) else { return };
    let mut file = File::open(&signed[0], 1 << 16).unwrap();
    assert_eq!(file.numbers, Numbers::Signed(16));
    let values = file.read(0..1).unwrap();
    let whole = |v: &f32| *v == (v * 32767.0).round() / 32767.0;
    assert!(values.iter().all(whole) && values[255] == 1.0, "{values:?}");
}
