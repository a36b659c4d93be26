//! What cannot be read is one line.

use halflight_oiio::{File, OiioError};

use crate::tools::copies;

#[test]
fn broken_files_and_large_ones() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let message = |name: &str, bytes: &[u8], most: usize| match File::open(&at(name, bytes), most) {
        Ok(mut file) => file.read(0..1).expect_err("a broken file").to_string(),
        Err(error) => error.to_string(),
    };
    for (name, bytes) in
        [("a.exr", &b"nothing"[..]), ("a.tif", b"II*\0"), ("a.dpx", b""), ("a.tga", b"\0"), ("a.xyz", b"?")]
    {
        let line = message(name, bytes, 100);
        assert!(!line.is_empty() && !line.contains('\n'), "{line}");
    }
    let grey = b"P5\n4 3\n255\nabcdefghijkl";
    assert_eq!(File::open(&at("a.pgm", grey), 12).unwrap().channels.len(), 1);
    assert!(message("a.pgm", grey, 11).contains("1 to 11 texels, found 4 x 3 x 1"));
    assert!(message("a.pgm", b"P5\n400000 300000\n255\nabc", 1 << 25).contains("400000"));
    let mut file = File::open(&at("a.pgm", grey), 12).unwrap();
    for wanted in [0..0, 0..2, 1..2] {
        assert!(matches!(file.read(wanted), Err(OiioError::Channels { found: 1, .. })));
    }
    let cut = message("a.pgm", &grey[..grey.len() - 5], 12);
    assert!(!cut.contains('\n'), "{cut}");
    assert!(matches!(File::open(folder.path().join("none.tif").as_path(), 1), Err(OiioError::Refused(_))));
}

#[test]
fn no_cut_brings_the_library_down() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("colours.ppm");
    let mut bytes = b"P6\n32 24\n255\n".to_vec();
    bytes.extend((0..32 * 24 * 3).map(|i: u32| (i * i % 251) as u8));
    std::fs::write(&path, bytes).unwrap();
    let names = ["a.exr", "a.tif", "a.tga", "a.dpx", "a.sgi", "a.bmp", "a.hdr", "a.ppm", "a.tx"];
    let Some(files) = copies(&path, &names.map(|name| (vec![], name))) else { return };
    for copied in files {
        let whole = std::fs::read(&copied).unwrap();
        for cut in 0..50 {
            std::fs::write(&copied, &whole[..cut * whole.len() / 50]).unwrap();
            if let Ok(mut file) = File::open(&copied, 1 << 20) {
                match file.read(0..file.channels.len().min(3)) {
                    Ok(values) => assert!(values.len() <= 3 * 32 * 24),
                    Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
                }
            }
        }
    }
}
