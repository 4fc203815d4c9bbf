// SPDX-License-Identifier: Apache-2.0
// The shapes of scene documents, as runtime/scene reads them.
#include "compiler/nodes/schema_json.h"

namespace isoshade::nodes {
namespace {

const SchemaJson vec3 = numbers_schema(3);
const SchemaJson brightness = number_schema(0, 1e6);
const SchemaJson length = number_schema(1e-6, 1e9);
const SchemaJson extent = number_schema(1e-6, 1e6);
constexpr int64_t max_segments = 1024;

SchemaJson camera_schema() {
  const SchemaKey position{"position", vec3, true}, target{"target", vec3, true}, up{"up", vec3};
  const SchemaKey near{"near", described(length, "distance of the near plane")};
  const SchemaKey fov{"fov", described(number_schema(0.01, 179), "the vertical angle of view, in degrees")};
  const SchemaKey height{"height", described(length, "of the view"), true}, far{"far", length};
  return variants_schema("type", false,
                         {{"perspective", {position, target, up, near, fov}},
                          {"orthographic", {position, target, up, near, height, far}}});
}

SchemaJson light_schema() {
  const SchemaKey color{"color", described(vec3, "linear")}, intensity{"intensity", brightness};
  const SchemaKey direction{"direction", described(vec3, "the way the light travels"), true};
  const SchemaKey position{"position", vec3, true};
  const SchemaKey range{"range", described(length, "where the light ends; left out, nowhere")};
  const SchemaKey inner{"inner_angle",
                        described(number_schema(0, 89), "degrees up to which it shines in full")};
  const SchemaKey outer{"outer_angle", described(number_schema(0.01, 90), "degrees where it ends")};
  return variants_schema("type", true,
                         {{"directional", {color, intensity, direction}},
                          {"point", {color, intensity, position, range}},
                          {"spot", {color, intensity, direction, position, range, inner, outer}}});
}

SchemaJson mesh_schema() {
  const SchemaJson around = integer_schema(3, max_segments), along = integer_schema(1, max_segments);
  const SchemaKey radius{"radius", extent}, height{"height", extent}, segments{"segments", around};
  const SchemaKey rings{"rings", described(along, "along the side")};
  const SchemaKey caps{"caps", described(boolean_schema(), "whether its ends are closed")};
  const SchemaKey smooth{"smooth", described(boolean_schema(), "no edge runs along the circle")};
  const SchemaJson at = described(numbers_schema(2), "radius, height");
  const SchemaJson point = any_of({at, object_schema({{"at", at, true}, smooth})});
  const SchemaJson kinds = variants_schema(
      "type", true,
      {{"sphere", {radius, segments, {"rings", integer_schema(2, max_segments)}}},
       {"plane", {{"size", numbers_schema(2)}, {"segments", along}}},
       {"box", {{"size", vec3}}},
       {"icosphere", {radius, {"subdivisions", integer_schema(0, 8)}}},
       {"cylinder", {radius, height, segments, rings, caps}},
       {"cone", {radius, height, segments, rings, caps}},
       {"torus",
        {radius, {"tube", described(extent, "the radius of the tube")}, segments, {"rings", around}}},
       {"lathe",
        {{"profile", described(array_schema(point, 2, 256), "from the bottom up, seen from outside"), true},
         smooth,
         segments}},
       {"gltf",
        {{"file", described(string_schema(), "path of a .gltf or .glb file"), true},
         {"fit", described(boolean_schema(), "centred on the origin, its longest side 1")}}}});
  return any_of({one_of({"sphere", "plane", "box", "icosphere", "cylinder", "cone", "torus"}), kinds});
}

SchemaJson transform_schema() {
  return object_schema({{"translate", vec3},
                        {"rotate", described(array_schema(number_schema(), 3, 4),
                                             "degrees about x, then y, then z; or a quaternion x y z w")},
                        {"scale", any_of({number_schema(), vec3})}});
}

SchemaJson repeat_schema() {
  const SchemaJson list = object_schema(
      {{"values", {{"type", "array"}, {"items", reference("literal")}, {"minItems", 1}}, true}});
  const SchemaJson range =
      object_schema({{"from", reference("literal"), true}, {"to", reference("literal"), true}});
  return object_schema({{"count", integer_schema(1, 65536), true},
                        {"step", described(vec3, "from one copy to the next"), true},
                        {"parameters", map_schema(any_of({list, range}))}});
}

/// The same keys in a scene that extends another: none is needed, and null takes one away. What stands in objects that
/// are told apart by their type is left to the scene that comes of both.
SchemaJson changes_schema(const std::vector<SchemaKey>& keys) {
  const SchemaJson null{{"type", "null"}}, object{{"type", "object"}};
  const SchemaJson object_changes =
      object_schema({{"mesh", any_of({reference("mesh"), object})},
                     {"effect", any_of({string_schema(), null})},
                     {"transform", any_of({object, null})},
                     {"parameters", any_of({map_schema(any_of({reference("literal"), null})), null})},
                     {"repeat", any_of({array_schema(reference("repeat"), 0, 3), null})}});
  std::vector<SchemaKey> changes;
  for (SchemaKey key : keys) {
    if (key.name == "camera" || key.name == "output") key.schema = object;
    if (key.name == "lights") key.schema = map_schema(any_of({object, null}));
    if (key.name == "objects") key.schema = map_schema(any_of({object_changes, null}));
    const bool of_every_document = key.name == "isoshade" || key.name == "scene";
    changes.push_back(of_every_document ? key : SchemaKey{key.name, any_of({key.schema, null})});
  }
  changes.push_back({"extends", described(string_schema(), "path of the scene that this one changes"), true});
  return object_schema(changes);
}

}  // namespace

SchemaJson scene_schema(SchemaJson& definitions) {
  definitions["camera"] = camera_schema();
  definitions["light"] = light_schema();
  definitions["mesh"] = mesh_schema();
  definitions["transform"] = transform_schema();
  definitions["repeat"] = repeat_schema();
  definitions["object"] =
      object_schema({{"mesh", reference("mesh"), true},
                     {"effect", described(string_schema(), "path of the effect's document"), true},
                     {"transform", reference("transform")},
                     {"parameters", map_schema(reference("literal"))},
                     {"repeat", array_schema(reference("repeat"), 0, 3)}});
  definitions["scenepost"] = object_schema(
      {{"name", reference("id"), true},
       {"effect", described(string_schema(), "path of the post's document"), true},
       {"parameters", map_schema(reference("literal"))},
       {"inputs", described(map_schema(reference("id")),
                            "\"scene\" or an earlier post, for each image; \"color\" is "
                            "the one that it goes over, if not that of the post before")},
       {"size", described(number_schema(1.0 / 8192, 1), "of its image, as a fraction of the scene's")}});
  definitions["output"] = object_schema({{"encoding", one_of({"srgb", "linear"})}, {"exposure", brightness}});
  std::vector<SchemaKey> keys = document_keys("scene");
  const std::vector<SchemaKey> rest{
      {"size", described(array_schema(integer_schema(1, 8192), 2, 2), "width and height in pixels")},
      {"samples", described({{"enum", {1, 4, 16}}}, "of each pixel, averaged")},
      {"time", described(number_schema(-1e9, 1e9), "what the node `time` gives, in seconds")},
      {"background", described(numbers_schema(4), "linear RGBA")},
      {"camera", reference("camera"), true},
      {"lights", map_schema(reference("light"))},
      {"objects", map_schema(reference("object"))},
      {"posts", array_schema(reference("scenepost"), 0, 64)},
      {"output", reference("output")}};
  keys.insert(keys.end(), rest.begin(), rest.end());
  return {{"if", {{"required", {"extends"}}}}, {"then", changes_schema(keys)}, {"else", object_schema(keys)}};
}

}  // namespace isoshade::nodes
