//! The same cube through every mesh format and transform.

use glam::{Quat, Vec3};
use halflight_scenes::{Mesh, Shape};

use crate::folder::{CUBE_QUADS, Folder, cube_corner};

/// Corners of all triangles, moved to the origin.
fn corners(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    let offset = Vec3::new(-1.5, 0.0, 1.0);
    (0..mesh.triangles.len()).map(|index| mesh.corners(index).map(|corner| corner - offset)).collect()
}

fn expected() -> Vec<[Vec3; 3]> {
    let fan = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    CUBE_QUADS.into_iter().flat_map(fan).map(|t| t.map(|i| Vec3::from(cube_corner(i)))).collect()
}

fn check(folder: &Folder, file: &str) {
    let mesh = folder.mesh(file, "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(corners(&mesh), expected(), "{file}");
    assert_eq!(mesh.normals.len(), mesh.positions.len());
    for index in 0..12 {
        let outward = corners(&mesh)[index].iter().sum::<Vec3>();
        assert!(mesh.face_normal(index).dot(outward) > 0.0);
        for vertex in mesh.triangles[index] {
            assert!((mesh.normals[vertex as usize].length() - 1.0).abs() < 1e-6);
            assert!(mesh.normals[vertex as usize].dot(mesh.face_normal(index)) > 0.5, "{file}");
        }
    }
}

fn off() -> String {
    let mut text = String::from("OFF # a cube\n\n8 6 0\n");
    (0..8).map(cube_corner).for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    CUBE_QUADS.iter().for_each(|[a, b, c, d]| text += &format!("4 {a} {b} {c} {d} 0.5 0.5 0.5\n"));
    text
}

fn obj(corner: impl Fn(u32) -> String) -> String {
    let mut text = String::from("# a cube\nmtllib none.mtl\no cube\n");
    (0..8).map(cube_corner).for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    text += "vt 0 0\nvt 1 1\nusemtl none\ns off\n";
    (0..8).map(cube_corner).for_each(|[x, y, z]| text += &format!("vn {x} {y} {z}\n"));
    CUBE_QUADS.iter().for_each(|quad| text += &format!("f {}\n", quad.map(&corner).join(" ")));
    text
}

fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 8\nproperty double x\nproperty uchar red\n\
         property float y\nproperty list uchar short extra\nproperty float z\nelement face 6\n\
         property list uint ushort vertex_index\nproperty char flag\nelement edge 1\nproperty int a\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    // Least significant byte first, turned round for big endian.
    let mut put = |value: &[u8]| {
        let mut value = value.to_vec();
        if big {
            value.reverse();
        }
        bytes.extend(value);
    };
    for [x, y, z] in (0..8).map(cube_corner) {
        put(&f64::from(x).to_le_bytes());
        put(&[200]);
        put(&y.to_le_bytes());
        put(&[2]);
        put(&7i16.to_le_bytes());
        put(&(-7i16).to_le_bytes());
        put(&z.to_le_bytes());
    }
    for quad in CUBE_QUADS {
        put(&4u32.to_le_bytes());
        quad.iter().for_each(|i| put(&(*i as u16).to_le_bytes()));
        put(&[255]);
    }
    put(&(-1i32).to_le_bytes());
    bytes
}

#[test]
fn every_mesh_format_gives_the_same_cube() {
    let folder = Folder::new();
    check(&folder, "cube.ply");
    folder.write("cube.off", off());
    check(&folder, "cube.off");
    folder.write("one_line.off", off().replace("OFF # a cube\n\n", "OFF "));
    check(&folder, "one_line.off");
    folder.write("little.ply", binary_ply(false));
    check(&folder, "little.ply");
    folder.write("big.PLY", binary_ply(true));
    check(&folder, "big.PLY");
    type Corner = fn(u32) -> String;
    let styles: [(&str, Corner); 4] = [
        ("plain.obj", |i| format!("{}", i + 1)),
        ("negative.obj", |i| format!("{}", i as i32 - 8)),
        ("normals.obj", |i| format!("{0}//{0}", i + 1)),
        ("full.obj", |i| format!("{0}/{1}/{0}", i + 1, i % 2 + 1)),
    ];
    for (name, corner) in styles {
        folder.write(name, obj(corner));
        check(&folder, name);
    }
}

#[test]
fn texture_coordinates_and_normals_are_kept() {
    let folder = Folder::new();
    folder.write("seam.obj", obj(|i| format!("{}/{}", i + 1, i % 2 + 1)));
    let mesh = folder.mesh("seam.obj", "").unwrap();
    assert_eq!(mesh.uvs.len(), mesh.positions.len());
    folder.write("inward.obj", obj(|i| format!("{0}//{1}", i + 1, 8 - i)));
    let mesh = folder.mesh("inward.obj", "").unwrap();
    assert!(mesh.normals[0].distance(-(mesh.positions[0] - Vec3::new(-1.5, 0.0, 1.0)).normalize()) < 1e-6);
}

#[test]
fn a_texture_seam_is_no_crease() {
    // Two triangles that share an edge in space but not on the texture, folded along it.
    let folder = Folder::new();
    let text = "v 0 0 0\nv 0 1 0\nv 1 0 0.5\nv -1 0 0.5\nvt 0 0\nvt 1 1\nvt 0 1\nf 1/1 3/1 2/1\nf 1/2 2/3 4/2\n";
    folder.write("fold.obj", text);
    let mesh = folder.mesh("fold.obj", "").unwrap();
    assert_eq!(mesh.positions.len(), 6);
    let shared: Vec<Vec3> =
        (0..6).filter(|i| mesh.positions[*i] == Vec3::new(-1.5, 0.0, 1.0)).map(|i| mesh.normals[i]).collect();
    assert_eq!(shared.len(), 2);
    assert!(shared[0] == shared[1] && shared[0].x.abs() < 1e-6 && shared[0].z > 0.5, "{shared:?}");
}

#[test]
fn y_up_becomes_z_up() {
    let folder = Folder::new();
    folder.write("flag.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 2 3\n3 0 1 2\n");
    let mesh = folder.mesh("flag.off", r#", up = "y""#).unwrap();
    assert_eq!(corners(&mesh)[0], [Vec3::ZERO, Vec3::X, Vec3::new(0.0, -3.0, 2.0)]);
}

#[test]
fn scale_then_rotate_then_translate() {
    let folder = Folder::new();
    let turned = "scale = 2.0\nrotate = { axis = [0.0, 0.0, 2.0], degrees = 90.0 }\ntranslate = [-1.5";
    let scene = folder.load_with(&[("translate = [-1.5", turned)]).unwrap();
    let Shape::Mesh(mesh) = &*scene.objects[1].shape else { panic!() };
    for (index, position) in mesh.positions.iter().enumerate() {
        let rest = Vec3::from(cube_corner(index as u32));
        let wanted = Quat::from_rotation_z(90f32.to_radians()) * (rest * 2.0) + Vec3::new(-1.5, 0.0, 1.0);
        assert!(position.distance(wanted) < 1e-5);
    }
}

#[test]
fn welding_joins_open_patches() {
    let folder = Folder::new();
    let folded = "OFF\n6 2 0\n0 0 0\n0 1 0\n1 0 0.5\n0 0 0\n0 1 -0\n-1 0 0.5\n3 0 2 1\n3 3 4 5\n";
    folder.write("patches.off", folded);
    assert_eq!(folder.mesh("patches.off", "").unwrap().positions.len(), 6);
    let mesh = folder.mesh("patches.off", ", weld = true").unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
    assert!(mesh.normals[0].distance(Vec3::Z) < 1e-6);
}

#[test]
fn triangles_without_area_are_dropped_only_when_told_to_and_said_to_be() {
    let folder = Folder::new();
    folder.write("flat.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n2 0 0\n3 0 1 2\n3 0 1 3\n");
    assert!(folder.mesh("flat.off", "").unwrap_err().to_string().contains("triangle 1: expected an area above 0"));
    let told = r#"{ file = "flat.off", drop_degenerate = true }"#;
    let scene = folder.load_with(&[(r#"{ file = "cube.ply" }"#, told)]).unwrap();
    assert_eq!(scene.facts().triangles, 3);
    assert!(scene.notices.len() == 1 && scene.notices[0].contains("dropped 1 triangle"), "{:?}", scene.notices);
}
