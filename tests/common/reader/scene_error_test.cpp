// Wrong scene files: each is an error that names the place and what would be right.

#include "common/core/error.h"
#include "tests/support/input_error.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

namespace gib::test::scene_error_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string ball = "<shape type='sphere'/>";

std::string error_of(const std::string& xml, const SceneLoadOptions& options = {}, const std::string& path = "t.xml") {
    return input_error_of([&] { parse_scene(xml, path, options); });
}

struct Row {
    std::string body;   ///< from line 2 of a scene with a sensor
    std::string place;  ///< "line:column"
    std::string message;
};

void expect_errors(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        const std::string error = error_of(scene_with(row.body));
        EXPECT_THAT(error, StartsWith("t.xml:" + row.place + ": ")) << row.body;
        EXPECT_THAT(error, HasSubstr(row.message)) << row.body;
    }
}

TEST(SceneErrors, MalformedXml) {
    EXPECT_THAT(error_of("<scene version='3.0.0'>\n  <shape type='sphere'>\n</scene>"),
                StartsWith("t.xml:3:3: malformed XML"));
    EXPECT_THAT(error_of("<scene version='3.0.0'>\n<!-- <a> -->\n<shape type='a/>b'>\n<bsdf/>\n</scene>"),
                ::testing::HasSubstr("</scene> stands where <shape> of line 3 has to be closed first"));
    EXPECT_THAT(error_of(""), StartsWith("t.xml:1:1: malformed XML"));
    EXPECT_THAT(error_of("<scene version='3.0.0'/><scene/>"), StartsWith("t.xml:1:25: malformed XML"));
    EXPECT_THAT(error_of("<scene version='3.0.0'>\n text</scene>"), HasSubstr("unexpected text in <scene>"));
    EXPECT_THAT(error_of("<scene\n version='3.0.0' version='3'/>"),
                StartsWith("t.xml:2:18: attribute 'version' is given twice"));
}

TEST(SceneErrors, RootAndVersion) {
    EXPECT_THAT(error_of("<shape type='sphere'/>"), StartsWith("t.xml:1:1: the root element must be <scene>"));
    EXPECT_THAT(error_of("<scene/>"), StartsWith("t.xml:1:1: <scene> needs the attribute 'version'"));
    EXPECT_THAT(error_of("\n<scene version='3.0.0'>" + ball + "</scene>"),
                StartsWith("t.xml:2:1: the scene has no sensor"));
    EXPECT_THAT(error_of(scene_with("")), StartsWith("t.xml:1:1: the scene is empty"));
}

TEST(SceneErrors, Parameters) {
    expect_errors(
        {{"<shape type='sphere'><float name='radius' value='$r'/></shape>", "2:43", "the parameter '$r' has no value"},
         {"<default name='' value='1'/>", "2:10", "needs a name"}});
    EXPECT_THAT(error_of(scene_with("<default name='a' value='1'/>" + ball), {{{"b", "1"}}, {}}),
                StartsWith("t.xml:1:1: there is no parameter 'b'; the file has: a"));
}

TEST(SceneErrors, Plugins) {
    expect_errors({{"<shape type='teapot'/>", "2:8",
                    "the shape 'teapot' is not supported; supported are: rectangle, cube, sphere, disk, cylinder"},
                   {"<shape/>", "2:1", "needs the attribute 'type'"},
                   {"<shape type='sphere'><bsdf type='hair'/></shape>", "2:28",
                    "the bsdf 'hair' is not supported; supported are: diffuse"},
                   {ball + "<emitter type='moon'/>", "2:32", "the emitter 'moon' is not supported"},
                   {"<shape type='sphere'><emitter type='point'/></shape>", "2:31", "supported are: area"},
                   {ball + "<emitter type='area'/>", "2:23", "must stand in a shape"},
                   {ball + "<widget type='x'/>", "2:23", "<scene> cannot hold <widget>"},
                   {ball + "<translate x='1'/>", "2:23", "<scene> cannot hold <translate>"},
                   {"<shape type='sphere'><medium name='interior' type='fog'/></shape>", "2:46",
                    "the medium 'fog' is not supported"}});
}

TEST(SceneErrors, Properties) {
    const auto sphere = [](const std::string& body) { return "<shape type='sphere'>\n" + body + "</shape>"; };
    expect_errors(
        {{sphere("<float name='radios' value='1'/>"), "3:1",
          "shape 'sphere' does not take a parameter 'radios'; it takes: <bsdf>, <emitter>"},
         {sphere("<film type='hdrfilm'/>"), "3:1", "shape 'sphere' does not take a <film>"},
         {sphere("<boolean name='face_normals' value='true'/>"), "3:1", "does not take a parameter 'face_normals'"},
         {sphere("<float name='radius' value='1'/><float name='radius' value='2'/>"), "3:33",
          "'radius' is given twice, first at line 3"},
         {sphere("<string name='radius' value='1'/>"), "3:1",
          "'radius' cannot be a <string>; it takes: <float>, <integer>"},
         {sphere("<float name='radius' value='1.0f'/>"), "3:22", "bad number '1.0f'"},
         {sphere("<float name='radius' value='1,5'/>"), "3:22", "bad number '1,5'"},
         {sphere("<float name='radius' value='nan'/>"), "3:22", "bad number 'nan'"},
         {sphere("<float name='radius' value='1e999'/>"), "3:22", "bad number '1e999'"},
         {sphere("<float name='radius' value=''/>"), "3:22", "bad number ''"},
         {sphere("<float name='radius' value='0'/>"), "3:22", "'radius' must be above 0"},
         {sphere("<integer name='radius' value='1.5'/>"), "3:24", "bad number '1.5': expected an integer"},
         {sphere("<float name='radius'/>"), "3:1", "<float> needs the attribute 'value'"},
         {sphere("<float value='1'/>"), "3:1", "<float> needs the attribute 'name'"},
         {sphere("<float name='radius' value='1' unit='mm'/>"), "3:32", "unknown attribute 'unit' of <float>"},
         {sphere("<point name='center' x='1' y='2'/>"), "3:1", "<point> needs the attribute 'z'"},
         {sphere("<point name='center' value='1 2'/>"), "3:22", "expected one or three numbers, found 2"},
         {sphere("<boolean name='flip_normals' value='yes'/>"), "3:30", "'yes' is neither true nor false"},
         {sphere("<bsdf type='diffuse'/><bsdf type='diffuse'/>"), "3:23", "only one <bsdf>"}});
}

TEST(SceneErrors, Cylinders) {
    const auto cylinder = [](const std::string& body) { return "<shape type='cylinder'>\n" + body + "</shape>"; };
    expect_errors(
        {{cylinder("<point name='p1' value='0'/>"), "3:18", "'p0' and 'p1' are the same point"},
         {cylinder("<point name='p0' value='0 0 1'/>"), "3:18", "'p0' and 'p1' are the same point"},
         {cylinder("<point name='p1' value='0 0 5e-324'/>"), "3:18", "'p0' and 'p1' are the same point"},
         {cylinder("<point name='p0' value='0 0 -1e308'/>\n<point name='p1' value='0 0 1e308'/>"), "1:1",
          "the scene is too large"},
         {cylinder("<point name='p0' value='0 1'/>"), "3:18", "one or three numbers"},
         {cylinder("<float name='radius' value='0'/>"), "3:22", "'radius' must be above 0"},
         {cylinder("<float name='radius' value='1e30'/>"), "2:1", "coordinates above"},
         {cylinder("<float name='radius' value='-1'/>"), "3:22", "'radius' must be above 0, not -1"},
         {cylinder("<float name='radius' value='nan'/>"), "3:22", "bad number 'nan'"},
         {cylinder("<rgb name='radius' value='1'/>"), "3:1", "cannot be a <rgb>; it takes: <float>, <integer>"},
         {cylinder("<point name='p1' value='0 0 inf'/>"), "3:18", "bad number 'inf'"},
         {cylinder("<point name='p1' value='0 0 1e-30'/>"), "2:1", "the cylinder is too small"},
         {cylinder("<string name='p0' value='0'/>"), "3:1", "cannot be a <string>; it takes: <point>, <vector>"},
         {cylinder("<boolean name='flip_normals' value='1'/>"), "3:30", "'1' is neither true nor false"},
         {cylinder("<float name='length' value='1'/>"), "3:1",
          "does not take a parameter 'length'; it takes: <bsdf>, <emitter>, interior, exterior, "
          "silhouette_sampling_weight, to_world, p0, "
          "p1, radius, flip_normals"}});
}

TEST(SceneErrors, Instances) {
    const std::string group = "<shape type='shapegroup' id='g'>" + ball + "</shape>\n";
    const auto in_group = [](const std::string& body) { return "<shape type='shapegroup'>\n" + body + "</shape>"; };
    const auto instance = [&](const std::string& body) {
        return group + "<shape type='instance'>\n" + body + "</shape>";
    };
    expect_errors(
        {{group + "<shape type='instance'/>", "3:1", "an instance needs a shapegroup"},
         {instance(ball), "4:1", "an instance takes a shapegroup only"},
         {instance("<ref id='h'/>"), "4:6", "there is no object with the id 'h'"},
         {instance("<ref id='g'/><ref id='g'/>"), "4:14", "only one <shape>"},
         {instance("<ref id='g'/><bsdf type='diffuse'/>"), "4:14", "does not take a <bsdf>"},
         {instance("<ref id='g'/><float name='scale' value='2'/>"), "4:14",
          "shape 'instance' does not take a parameter 'scale'; it takes: to_world, <shape>, silhouette"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='0'/></transform>"), "4:14",
          "the transform is singular"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='1e-30'/></transform>"), "3:1",
          "scales by more than 1e12"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='1e30'/></transform>"), "3:1",
          "coordinates above"},
         {in_group("<shape type='instance'/>"), "3:1", "a shapegroup cannot hold a shape 'instance'"},
         {in_group("<shape type='shapegroup'/>"), "3:1", "a shapegroup cannot hold a shape 'shapegroup'"},
         {in_group("<bsdf type='diffuse'/>"), "3:1", "shape 'shapegroup' does not take a <bsdf>; it takes: <shape>"},
         {in_group("<transform name='to_world'/>"), "3:1", "does not take a parameter 'to_world'"},
         {in_group("<shape type='sphere'>\n<emitter type='area'/></shape>"), "4:1",
          "an emitter cannot stand in a shapegroup"},
         {in_group("<shape type='teapot'/>"), "3:8", "the shape 'teapot' is not supported"},
         {group, "1:1", "the scene is empty"},
         {in_group("") + "<shape type='instance'><shape type='shapegroup'/></shape>", "1:1", "the scene is empty"}});
}

TEST(SceneErrors, Colours) {
    const auto diffuse = [](const std::string& property) {
        return "<shape type='sphere'>\n<bsdf type='diffuse'>\n" + property + "</bsdf></shape>";
    };
    const auto of_ball = [](const std::string& bsdf) { return "<shape type='sphere'>\n" + bsdf + "</shape>"; };
    expect_errors(
        {{diffuse("<rgb name='reflectance' value='0.5 1.2 0'/>"), "4:25",
          "'reflectance' must be between 0 and 1, not 1.2"},
         {diffuse("<rgb name='reflectance' value='-0.1'/>"), "4:25", "must be between 0 and 1"},
         {diffuse("<rgb name='reflectance' value='0.1 0.2'/>"), "4:25", "takes one or three numbers, found 2"},
         {diffuse("<rgb name='reflectance' value='#ff0000'/>"), "4:25", "bad number '#ff0000'"},
         {diffuse("<texture name='reflectance' type='bitmap'/>"), "4:1", "'bitmap' needs 'filename'"},
         {"<shape type='sphere'><emitter type='area'>\n<rgb name='radiance' value='1 -1 1'/></emitter></shape>", "3:22",
          "'radiance' must not be negative"},
         {of_ball("<bsdf type='dielectric'><string name='int_ior' value='butter'/></bsdf>"), "3:48",
          "there is no material 'butter'"},
         {of_ball("<bsdf type='dielectric'><float name='int_ior' value='0'/></bsdf>"), "3:47", "must be above 0"},
         {of_ball("<bsdf type='twosided'/>"), "3:1", "one or two bsdfs, found 0"},
         {of_ball("<bsdf type='twosided'><bsdf type='dielectric'/></bsdf>"), "3:23", "must not transmit light"}});
}

TEST(SceneErrors, Transforms) {
    const auto move = [](const std::string& operation, const std::string& type = "sphere") {
        return "<shape type='" + type + "'>\n<transform name='to_world'>\n" + operation + "</transform></shape>";
    };
    expect_errors({{move("<scale value='0'/>"), "3:1", "the transform is singular"},
                   {move("<scale x='0'/>", "cube"), "3:1", "the transform is singular"},
                   {move("<matrix value='1 2 3  2 4 6  0 0 1'/>", "cube"), "3:1", "the transform is singular"},
                   {move("<matrix value='1 2 3'/>"), "4:9", "9 or 16 numbers, found 3"},
                   {move("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/>"), "4:9", "last row"},
                   {move("<rotate angle='5'/>"), "4:1", "axis is zero"},
                   {move("<rotate x='1'/>"), "4:1", "needs the attribute 'angle'"},
                   {move("<lookat origin='1 1 1' target='1 1 1'/>"), "4:1", "the same point"},
                   {move("<lookat origin='0 0 0' target='0 0 1' up='0 0 2'/>"), "4:1", "parallel"},
                   {move("<float name='x' value='1'/>"), "4:1", "<transform> cannot hold <float>"},
                   {move("<scale x='2'/>"), "3:1", "must scale uniformly"},
                   {move("<matrix value='1 1 0  0 1 0  0 0 1'/>", "disk"), "3:1", "must not shear"},
                   {move("<scale x='2'/>", "cylinder"), "3:1", "must scale alike in all directions across its axis"},
                   {move("<matrix value='1 0 1  0 1 0  0 0 1'/>", "cylinder"), "3:1", "not shear"}});
}

TEST(SceneErrors, References) {
    expect_errors({{"<shape type='sphere'><ref id='a'/></shape>", "2:27", "there is no object with the id 'a'"},
                   {ball + "<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>", "3:22",
                    "the id 'a' is given twice, first at t.xml:2:23"},
                   {ball + "\n<emitter type='area' id='e'/>", "3:1", "an area emitter must stand in a shape"},
                   {"<emitter type='area' id='e'><rgb name='radiance'\nvalue='-1'/></emitter><shape "
                    "type='sphere'><ref id='e'/></shape>",
                    "3:1", "'radiance' must not be negative"},
                   {ball + "<alias id='a' as='b'/>", "2:30", "there is no object with the id 'a'"}});
}

std::string sensor_error(const std::string& sensor) {
    return error_of("<scene version='3.0.0'>" + ball + "\n" + sensor + "</scene>");
}

TEST(SceneErrors, Sensors) {
    const auto perspective = [](const std::string& body) {
        return sensor_error("<sensor type='perspective'>\n" + body + "</sensor>");
    };
    const auto film = [&](const std::string& body) {
        return perspective("<film type='hdrfilm'>\n" + body + "</film>");
    };
    EXPECT_THAT(
        sensor_error("<sensor type='fisheye'/>"),
        StartsWith(
            "t.xml:2:9: the sensor 'fisheye' is not supported; supported are: perspective, thinlens, orthographic"));
    for (const char* fov : {"0", "180", "-5"})
        EXPECT_THAT(perspective(std::string("<float name='fov' value='") + fov + "'/>"),
                    StartsWith("t.xml:3:19: 'fov' must be between 0 and 180"));
    EXPECT_THAT(perspective("<float name='fov' value='50'/><string name='fov_axis' value='z'/>"),
                HasSubstr("'fov_axis' cannot be 'z'; it takes: x, y, diagonal, smaller, larger"));
    EXPECT_THAT(perspective("<string name='focal_length' value='5cm'/>"), StartsWith("t.xml:3:29: bad number '5cm'"));
    EXPECT_THAT(perspective("<float name='near_clip' value='0'/>"),
                StartsWith("t.xml:3:25: 'near_clip' must be above 0"));
    EXPECT_THAT(perspective("<float name='near_clip' value='5'/><float name='far_clip' value='4'/>"),
                HasSubstr("must be below 'far_clip'"));
    EXPECT_THAT(perspective("<transform name='to_world'><scale value='2'/></transform>"),
                StartsWith("t.xml:3:1: the to_world of a perspective sensor must not scale"));
    EXPECT_THAT(film("<integer name='width' value='0'/>"), StartsWith("t.xml:4:23: 'width' must be between 1 and"));
    EXPECT_THAT(film("<integer name='width' value='2.5'/>"), StartsWith("t.xml:4:23: bad number '2.5'"));
    EXPECT_THAT(film("<rfilter type='sinc'/>"),
                HasSubstr("the rfilter 'sinc' is not supported; supported are: box, tent, gaussian"));
    EXPECT_THAT(perspective("\n<film type='hdrfilm'>"
                            "<integer name='width' value='40000'/><integer name='height' value='40000'/></film>"),
                StartsWith("t.xml:4:1: an image of 40000 x 40000 pixels is above 1e+09 pixels"));
    EXPECT_THAT(error_of(scene_with(ball), {{}, std::pair(0, 5)}), HasSubstr("0 x 5"));
}

TEST(SceneErrors, Integrators) {
    expect_errors({{ball + "\n<integrator type='path'>\n<boolean name='hide_emitters' value='maybe'/></integrator>",
                    "4:31", "maybe"},
                   {ball + "\n<integrator type='path'>\n<integer name='max_depth' value='-2'/></integrator>", "4:27",
                    "'max_depth' must be between -1 and"}});
}

TEST(SceneErrors, FilesThatAreMissing) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& body) { return error_of(scene_with(body), {}, folder / "main.xml"); };
    folder.write("extra/x", "");
    EXPECT_THAT(error("<path value='extra'/><shape type='obj'>\n<string name='filename' value='no.obj'/></shape>"),
                AllOf(StartsWith((folder / "main.xml") + ":3:1: there is no file 'no.obj'; searched: "),
                      HasSubstr(folder / "extra")));
    EXPECT_THAT(error("<include filename='no.xml'/>"),
                StartsWith((folder / "main.xml") + ":2:1: there is no file 'no.xml'"));
    EXPECT_THAT(error("<path value='no'/>"), HasSubstr("there is no file 'no'"));
    folder.write("sub/part.xml", "<scene>\n<include filename='x.xml'/></scene>");
    folder.write("beside.xml", ball);
    EXPECT_THAT(error("<include filename='sub/part.xml'/><include filename='beside.xml'/>"),
                AllOf(StartsWith((folder / "sub/part.xml") + ":2:1: there is no file 'x.xml'; searched: "),
                      HasSubstr(folder / "sub,")));
    folder.write("sub/x.xml", ball);
    EXPECT_THAT(error("<include filename='sub/part.xml'/><include filename='x.xml'/>"),
                StartsWith((folder / "main.xml") + ":2:35: there is no file 'x.xml'"))
        << "an included file's folder is its own";
    folder.write("old.xml", "<bsdf version='0.2.0' type='diffuse'/>");
    EXPECT_THAT(error("<include filename='old.xml'/>"),
                StartsWith((folder / "old.xml") + ":1:7: version '0.2.0' is not supported"));
    EXPECT_THAT(error("<include filename='sub/part.xml' name='a'/>"),
                StartsWith((folder / "main.xml") + ":2:34: an include of a <scene> cannot have a name"));
    EXPECT_THAT(error("<include filename='beside.xml' id='a'/>"),
                StartsWith((folder / "main.xml") + ":2:32: unknown attribute 'id' of <include>"));
    EXPECT_THAT(error("<shape type='ply'/>"), HasSubstr("'ply' needs 'filename'"));
    EXPECT_THROW(load_scene(folder / "no.xml"), InputError);
}

TEST(SceneErrors, MeshFiles) {
    const auto shape = [](const std::string& type, const std::string& body) {
        return "<shape type='" + type + "'>\n" + body + "</shape>";
    };
    const std::string name = "<string name='filename' value='no.mesh'/>\n";
    for (const std::string type : {"obj", "ply", "serialized", "ms3d"})
        expect_errors(
            {{shape(type, ""), "2:1", "'" + type + "' needs 'filename'"},
             {shape(type, name), "3:1", "there is no file 'no.mesh'; searched: "},
             {shape(type, "<float name='filename' value='1'/>"), "3:1", "'filename' cannot be a <float>"},
             {shape(type, name + "<string name='face_normals' value='true'/>"), "4:1",
              "'face_normals' cannot be a <string>; it takes: <boolean>"},
             {shape(type, name + "<boolean name='flip_normals' value='1'/>"), "4:30", "neither true nor false"},
             {shape(type, name + "<transform name='to_world'><scale x='0'/></transform>"), "4:1", "singular"}});
    const std::string index = name + "<integer name='shape_index' value='";
    expect_errors({{shape("serialized", index + "1.5'/>"), "4:29", "bad number '1.5': expected an integer"},
                   {shape("serialized", index + "-1'/>"), "4:29", "'shape_index' must be between 0 and 2147483647"},
                   {shape("serialized", index + "9999999999'/>"), "4:29", "'shape_index' must be between 0 and"}});
    const TemporaryFolder folder;
    folder.write("text.mesh", "this is no mesh");
    folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto error = [&](const std::string& type, const std::string& body) {
        return error_of(scene_with(shape(type, body)), {}, folder / "t.xml");
    };
    for (const std::string type : {"obj", "ply", "serialized", "ms3d"})
        EXPECT_THAT(error(type, "<string name='filename' value='text.mesh'/>"),
                    StartsWith((folder / "text.mesh") + ":1:"));
    EXPECT_THAT(error("obj", "<string name='filename' value='t.obj'/>\n<float name='radius' value='1'/>"),
                StartsWith((folder / "t.xml") + ":4:1: shape 'obj' does not take a parameter 'radius'; it takes: "));
}

TEST(SceneErrors, StandInTheFileThatCausedThem) {
    const TemporaryFolder folder;
    folder.write("part.xml", "<scene>\n<shape type='sphere'><float name='radius' value='x'/></shape></scene>");
    folder.write("self.xml", "<scene><include filename='self.xml'/></scene>");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 inf\n");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const auto error = [&](const std::string& body) { return error_of(scene_with(body), {}, folder / "main.xml"); };
    EXPECT_THAT(error("<include filename='part.xml'/>"), StartsWith((folder / "part.xml") + ":2:43: bad number 'x'"));
    EXPECT_THAT(error("<include filename='self.xml'/>"),
                AllOf(StartsWith((folder / "self.xml") + ":1:8: "), HasSubstr("circular")));
    EXPECT_THAT(error("<shape type='obj'><string name='filename' value='bad.obj'/></shape>"),
                StartsWith((folder / "bad.obj") + ":2:7: "));
    EXPECT_THAT(error("<shape type='obj'><string name='filename' value='flat.obj'/>\n<emitter type='area'/></shape>"),
                StartsWith((folder / "main.xml") + ":3:1: an area emitter on a shape of area 0"));
    EXPECT_THAT(error("<shape type='sphere'><float name='radius' value='1e30'/></shape>"),
                HasSubstr("coordinates above 1.8e+18"));
}

}  // namespace
}  // namespace gib::test::scene_error_test
