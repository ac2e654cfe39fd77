// Wrong scene files: each is an error that names the place and what would be right.

#include "common/core/error.h"
#include "tests/support/scene_errors.h"

namespace gib::test::scene_error_test {
namespace {

const std::string ball = "<shape type='sphere'/>";

std::string error_of(const std::string& xml) {
    return input_error_of([&] { parse_scene(xml, "t.xml"); });
}
/// The error of an element on line 2, whose content begins on line 3.
std::string error_in(const std::string& tag, const std::string& type, const std::string& content) {
    return scene_error(element(tag, type, "\n", content));
}

TEST(SceneErrors, MalformedXml) {
    expect_errors({{"<scene version='3.0.0'>\n  <shape type='sphere'>\n</scene>", "3:3", "malformed XML"},
                   {"<scene version='3.0.0'>\n<!-- <a> -->\n<shape type='a/>b'>\n<bsdf/>\n</scene>", "5:3",
                    "</scene> stands where <shape> of line 3 has to be closed first"},
                   {"", "1:1", "malformed XML"},
                   {"\xFF\xFE<", "1:1", "the file is UTF-16: it has to be saved as UTF-8"},
                   {"\xFE\xFF<", "1:1", "the file is UTF-16"},
                   {"<scene version='3.0.0'/><scene/>", "1:25", "malformed XML"},
                   {"<scene version='3.0.0'>\n text</scene>", "1:24", "unexpected text in <scene>"},
                   {"<scene\n version='3.0.0' version='3'/>", "2:18", "attribute 'version' is given twice"}},
                  error_of);
}

TEST(SceneErrors, RootAndVersion) {
    expect_errors({{ball, "1:1", "the root element must be <scene>"},
                   {"<scene/>", "1:1", "the scene has no sensor"},
                   {"\n<scene version='3.0.0'>" + ball + "</scene>", "2:1", "the scene has no sensor"},
                   {scene_with(""), "1:1", "the scene is empty"}},
                  error_of);
}

TEST(SceneErrors, Parameters) {
    expect_errors({{"<shape type='sphere'><transform name='to_world'><scale value='$r'/></transform></shape>", "2:56",
                    "no value for $r: --set r=... would give it"},
                   {"<default name='' value='1'/>", "2:10", "needs a name"}});
    EXPECT_THAT(scene_error("<default name='a' value='1'/>" + ball, "t.xml", {{{"b", "1"}}, {}}),
                StartsWith("t.xml:1:1: there is no parameter 'b'; the file has: a"));
}

TEST(SceneErrors, Properties) {
    expect_errors(
        {{"<float name='radios' value='1'/>", "3:1",
          "shape 'sphere' does not take a parameter 'radios'; it takes: <bsdf>, <emitter>"},
         {"<float name='radius' value='1'/><float name='radius' value='2'/>", "3:33",
          "'radius' is given twice, first at line 3"},
         {"<string name='radius' value='1'/>", "3:1", "'radius' cannot be a <string>; it takes: <float>, <integer>"},
         {"<float name='radius' value='1,5'/>", "3:22", "bad number '1,5'"},
         {"<float name='radius' value=''/>", "3:22", "bad number ''"},
         {"<float name='radius' value='0'/>", "3:22", "'radius' must be above 0"},
         {"<integer name='radius' value='1.5'/>", "3:24", "bad number '1.5': expected an integer"},
         {"<float name='radius'/>", "3:1", "<float> needs the attribute 'value'"},
         {"<float value='1'/>", "3:1", "<float> needs the attribute 'name'"},
         {"<float name='radius' value='1' unit='mm'/>", "3:32", "unknown attribute 'unit' of <float>"},
         {"<point name='center' x='1' y='2'/>", "3:1", "<point> needs the attribute 'z'"},
         {"<point name='center' value='1 2'/>", "3:22", "expected one or three numbers, found 2"},
         {"<boolean name='flip_normals' value='yes'/>", "3:30", "'yes' is neither true nor false"},
         {"<bsdf type='diffuse'/><bsdf type='diffuse'/>", "3:23", "<shape> can hold only one <bsdf>"}},
        [](const std::string& body) { return error_in("shape", "sphere", body); });
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
         {instance("<ref id='g'/><ref id='g'/>"), "4:14", "only one <shape>"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='0'/></transform>"), "4:14",
          "the transform is singular"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='1e-30'/></transform>"), "3:1",
          "scales by more than 1e12"},
         {instance("<ref id='g'/><transform name='to_world'><scale value='1e30'/></transform>"), "3:1",
          "coordinates above"},
         {in_group("<shape type='instance'/>"), "3:1", "a shapegroup cannot hold a shape 'instance'"},
         {in_group("<shape type='shapegroup'/>"), "3:1", "a shapegroup cannot hold a shape 'shapegroup'"},
         {in_group("<shape type='sphere'>\n<emitter type='area'/></shape>"), "4:1",
          "an emitter cannot stand in a shapegroup"},
         {group, "1:1", "the scene is empty"},
         {in_group("") + "<shape type='instance'><shape type='shapegroup'/></shape>", "1:1", "the scene is empty"}});
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
                   {ball + "\n<emitter type='area' id='e'/>", "3:1", "an area emitter must stand in a shape"},
                   {"<emitter type='area' id='e'><rgb name='radiance'\nvalue='-1'/></emitter><shape "
                    "type='sphere'><ref id='e'/></shape>",
                    "3:1", "'radiance' must not be negative"},
                   {ball + "<alias id='a' as='b'/>", "2:30", "there is no object with the id 'a'"}});
}

TEST(SceneErrors, FilesThatAreMissing) {
    const TemporaryFolder folder;
    const std::string main = folder / "main.xml";
    const auto error = [&](const std::string& body) { return scene_error(body, main); };
    folder.write("extra/x", "");
    EXPECT_THAT(error("<path value='extra'/><shape type='obj'>\n<string name='filename' value='no.obj'/></shape>"),
                AllOf(StartsWith(main + ":3:1: there is no file 'no.obj'; searched: "), HasSubstr(folder / "extra")));
    EXPECT_THAT(error("<include filename='no.xml'/>"), StartsWith(main + ":2:1: there is no file 'no.xml'"));
    EXPECT_THAT(error("<path value='no'/>"), HasSubstr("there is no file 'no'"));
    folder.write("sub/part.xml", "<scene>\n<include filename='x.xml'/></scene>");
    folder.write("beside.xml", ball);
    EXPECT_THAT(error("<include filename='sub/part.xml'/><include filename='beside.xml'/>"),
                AllOf(StartsWith((folder / "sub/part.xml") + ":2:1: there is no file 'x.xml'; searched: "),
                      HasSubstr(folder / "sub,")));
    folder.write("sub/x.xml", ball);
    EXPECT_THAT(error("<include filename='sub/part.xml'/><include filename='x.xml'/>"),
                StartsWith(main + ":2:35: there is no file 'x.xml'"))
        << "an included file's folder is its own";
    folder.write("old.xml", "<bsdf version='0.2.0' type='diffuse'/>");
    EXPECT_THAT(error("<include filename='old.xml'/>"),
                StartsWith((folder / "old.xml") + ":1:7: version '0.2.0' is not supported"));
    EXPECT_THAT(error("<include filename='sub/part.xml' name='a'/>"),
                StartsWith(main + ":2:34: an include of a <scene> cannot have a name"));
    EXPECT_THAT(error("<include filename='beside.xml' id='a'/>"),
                StartsWith(main + ":2:32: unknown attribute 'id' of <include>"));
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
             {shape(type, name + "<transform name='to_world'><scale x='0'/></transform>"), "4:1", "singular"}});
    const TemporaryFolder folder;
    folder.write("text.mesh", "this is no mesh");
    const auto error = [&](const std::string& type, const std::string& body) {
        return scene_error(shape(type, body), folder / "t.xml");
    };
    for (const std::string type : {"obj", "ply", "serialized", "ms3d"})
        EXPECT_THAT(error(type, "<string name='filename' value='text.mesh'/>"),
                    StartsWith((folder / "text.mesh") + ":1:"));
}

TEST(SceneErrors, StandInTheFileThatCausedThem) {
    const TemporaryFolder folder;
    folder.write("part.xml", "<scene>\n<shape type='sphere'><float name='radius' value='x'/></shape></scene>");
    folder.write("self.xml", "<scene><include filename='self.xml'/></scene>");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 inf\n");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const auto error = [&](const std::string& body) { return scene_error(body, folder / "main.xml"); };
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
