use super::*;
use crate::geometry::mesh::{NO_COLOR, NO_NORMAL};
use glam::Vec3;

/// A square and a triangle beside it in two primitives of a geometry, placed by two nodes of which the second is below the first.
fn text(primitives: &str, nodes: &str) -> String {
    format!(
        r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>
  <emission><color>0 2 0 1</color></emission><diffuse><color sid="d">0.5 0.25 1.5 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="red wall"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="plate"><mesh>
  <source id="p"><float_array id="pa" count="15">0 0 0 1 0 0 1 1 0 0 1 0 2 0 -5e-1</float_array>
    <technique_common><accessor source="#pa" count="5" stride="3"/></technique_common></source>
  <source id="n"><float_array id="na" count="6">0 0 2 0 0 0</float_array>
    <technique_common><accessor source="#na" count="2" stride="3"/></technique_common></source>
  <source id="c"><float_array id="ca" count="8">1 0 0 1 0 0.5 0 1</float_array>
    <technique_common><accessor source="#ca" count="2" stride="4"/></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  {primitives}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##
    )
}

const POLYLIST: &str = r##"<polylist material="a" count="2">
  <input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>
  <vcount>4 3</vcount><p>0 0 1 0 2 1 3 0 1 0 4 0 2 0</p></polylist>"##;

const NODE: &str = r##"<node id="x" name="box"><translate>3133805.225747891 0 0</translate>
  <instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="a" target="#m"/>
  </technique_common></bind_material></instance_geometry></node>"##;

fn read(text: &str) -> Result<Mesh> {
    parse(text.as_bytes(), "a.dae", Limits::default())
}

#[test]
fn polygons_become_fans_with_normals_and_materials() {
    let mesh = read(&text(POLYLIST, NODE)).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 4, 2]]);
    assert_eq!(mesh.positions[4], DVec3::new(3133805.225747891 + 2.0, 0.0, -0.5));
    assert_eq!(mesh.corner_normals, [[0, 0, NO_NORMAL], [0, NO_NORMAL, 0], [0; 3]]);
    assert_eq!(mesh.normals[0], Vec3::Z);
    let material = &mesh.materials[mesh.material_of[0] as usize];
    let look = (material.name.as_str(), material.diffuse, material.emissive);
    assert_eq!(look, ("red wall", [0.5, 0.25, 1.0], [0.0, 2.0, 0.0]));
    assert_eq!(mesh.parts, [Part { name: "box".into(), triangles: 3 }]);
    assert!(mesh.missing.is_empty());
}

#[test]
fn nodes_place_each_other_in_order() {
    let nodes = r##"<node name="a"><rotate>0 0 1 90</rotate><scale>2 1 1</scale><instance_geometry url="#g"/>
      <node name="b"><matrix>1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1</matrix><instance_geometry url="#g"/></node></node>
      <node><instance_node url="#x"/></node><node name="c" id="x"><instance_geometry url="#g"/></node>"##;
    let mesh = read(&text(POLYLIST, nodes)).unwrap();
    let names: Vec<&str> = mesh.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c", "c"]);
    // scaled, then turned; sin and cos of 90 degrees are right to an ulp
    let corner = |node: usize| mesh.positions[5 * node + 1];
    assert!((corner(0) - DVec3::new(0.0, 2.0, 0.0)).length() < 1e-15);
    assert!((corner(1) - DVec3::new(-6.0, 12.0, 7.0)).length() < 1e-14);
    assert_eq!(corner(2), DVec3::X);
}

#[test]
fn other_primitives_colours_and_what_is_left_out() {
    let primitives = r##"<lines count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1</p></lines>
      <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
      <tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="COLOR" source="#c" offset="1"/>
        <p>0 0 1 0 3 1 2 1</p></tristrips>
      <polygons count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p><p>1 4 2</p></polygons>"##;
    let text = text(primitives, r##"<node><instance_geometry url="#g"/></node>"##);
    let mesh =
        read(&text.replace(
            "<library_effects>",
            "<asset><unit meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset><library_effects>",
        ))
        .unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3], [3, 1, 2], [0, 1, 2], [0, 2, 3], [1, 4, 2]]);
    assert_eq!(mesh.corner_colors[..4], [[NO_COLOR; 3], [0, 0, 1], [1, 0, 1], [NO_COLOR; 3]]);
    assert_eq!(mesh.colors, [[1.0, 0.0, 0.0], [0.0, 0.5, 0.0]]);
    let left_out: Vec<&str> = mesh.missing.iter().map(|missing| missing.what.as_str()).collect();
    assert_eq!(left_out, ["lines of a.dae", "unit and axis of a.dae"]);
    assert!(mesh.missing[1].why.contains("\"0.01\" m and \"Z_UP\""));
}

#[test]
fn text_may_be_utf_16() {
    let whole = text(POLYLIST, NODE);
    let marked: Vec<u16> = "\u{feff}".encode_utf16().chain(whole.encode_utf16()).collect();
    let [little, big] =
        [u16::to_le_bytes, u16::to_be_bytes].map(|bytes| marked.iter().copied().flat_map(bytes).collect::<Vec<u8>>());
    for bytes in [little, big] {
        assert_eq!(parse(&bytes, "a.dae", Limits::default()).unwrap(), read(&whole).unwrap());
    }
}

#[test]
fn what_is_wrong_is_said_in_a_line() {
    let whole = text(POLYLIST, NODE);
    for (from, to, part) in [
        ("<COLLADA", "<COLLADO", "is no COLLADA"),
        ("url=\"#g\"", "url=\"#h\"", "names \"#h\", which the file does not have"),
        ("<vcount>4 3", "<vcount>4 4", "vcount names more corners"),
        ("0 0 1 0 2 1", "0 0 1 0 2 2", "geometry \"g\": index 2 of 2 values"),
        ("0 0 1 0 2 1", "0 0 1 0 -2 1", "an index is no whole number"),
        ("2 0 -5e-1<", "2 0 nan<", "vertex 4 is not finite"),
        (
            "<instance_geometry url=\"#g\">",
            "<instance_node url=\"#x\"/><instance_geometry url=\"#g\">",
            "nodes must not place each other",
        ),
        ("<float_array id=\"pa\"", "<int_array id=\"pa\"", "is no COLLADA"),
        ("<vertices id=\"v\">", "<vertices id=\"v\"/\n", "is no COLLADA"),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = read(&whole.replace(from, to)).unwrap_err().to_string();
        assert!(error.starts_with("a.dae: ") && error.contains(part) && !error.contains('\n'), "{error}, not {part}");
    }
    assert!(read(&text(POLYLIST, "")).unwrap_err().to_string().contains("has no triangles"));
}
