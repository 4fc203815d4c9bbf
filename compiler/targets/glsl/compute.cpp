// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl/compute.h"

#include <utility>

#include "compiler/lower/kernel.h"
#include "compiler/lower/setup.h"
#include "compiler/lower/stages.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::glsl {

using namespace lower;

namespace {

/// The text with a number in place of each name: "$stride".
std::string filled(std::string text, std::initializer_list<std::pair<std::string_view, int>> numbers) {
  for (const auto& [name, number] : numbers)
    for (size_t at = 0; (at = text.find(name, at)) != std::string::npos;)
      text.replace(at, name.size(), std::to_string(number));
  return text;
}

}  // namespace

std::string binding(size_t after_frame, std::string_view layout) {
  return "layout(" + std::string(layout) +
         "set = 0, binding = " + std::to_string(std::size(frame_buffers) + after_frame) + ") ";
}

std::string binding(FrameBuffer buffer) {
  return "layout(std430, set = 0, binding = " + std::to_string(static_cast<int>(buffer)) + ") ";
}

std::string compute_interface(bool of_pixels) {
  return std::string(push_words) + ", left, top, columns, rows, place, pitch; } push;\n" +
         (of_pixels ? "layout(local_size_x = " + std::to_string(compute_side) +
                          ", local_size_y = " + std::to_string(compute_side) + ") in;\n"
                    : "layout(local_size_x = " + std::to_string(compute_length) + ") in;\n");
}

std::string halving_compute() {
  ir::Module module = frame_module();
  std::vector<ir::Parameter> parameters;
  for (const char* name : {"a", "b", "c", "d"}) parameters.push_back({name, ir::float_type, "", false});
  Kernel k(module, "mean", std::move(parameters), {{"mean", ir::float_type}});
  const auto sample = [&](size_t i) { return Float(k.b, k.b.parameter(i)); };
  k.b.finish(std::array{functions::mean_of_four<Float>(sample(0), sample(1), sample(2), sample(3)).value});
  std::vector<emit::FunctionText> texts;
  return head() + compute_interface(true) + binding(FrameBuffer::layers) +
         "buffer layers_block { int layers[]; };\n" + glsl::functions(module, k.index, texts) +
         std::string(canonical_bits) + R"(
float sample_at(int word) { return intBitsToFloat(layers[word]); }

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.columns || at.y >= push.rows) return;
  at += ivec2(push.left, push.top);
  int upper = 2 * at.y * push.width + 2 * at.x, lower = upper + push.width, pixel = at.y * push.pitch + at.x;
  for (int i = 0; i < 4; ++i) {
    precise float color = mean(sample_at(push.object + 4 * upper + i), sample_at(push.object + 4 * upper + 4 + i),
                               sample_at(push.object + 4 * lower + i), sample_at(push.object + 4 * lower + 4 + i));
    layers[push.place + 4 * pixel + i] = canonical(color);
  }
  precise float depth = mean(sample_at(push.count + upper), sample_at(push.count + upper + 1),
                             sample_at(push.count + lower), sample_at(push.count + lower + 1));
  layers[push.first + pixel] = canonical(depth);
}
)";
}

std::string numbered() {
  return filled(R"(
// The number of the triangle that has this order.
int number_of(int order) {
  int triangle = order >> $bits, left = order & ((1 << $bits) - 1);
  // The record of a triangle that was cut names the first of what is left of it.
  return left == 0 ? triangle : triangles[$stride * triangle] + left - 1;
}
)",
                {{"$bits", order_bits}, {"$stride", triangle_word::stride}});
}

std::string backdrop_compute() {
  return head() + compute_interface(true) + binding(FrameBuffer::layers) +
         "writeonly buffer made_block { int made[]; };\n" + binding(FrameBuffer::triangles) +
         "readonly buffer triangles_block { int triangles[]; };\n" + binding(9) +
         "buffer seen_block { int seen[]; };\n" + numbered() +
         filled(R"(
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.columns || at.y >= push.rows) return;
  int pixel = at.y * push.pitch + at.x, order = seen[pixel];
  seen[pixel] = order == $nothing ? -1 : number_of(order);
  if (order != $nothing) return;
  int word = push.place + 4 * pixel;
  made[word] = push.object;
  made[word + 1] = push.light_count;
  made[word + 2] = push.program;
  made[word + 3] = push.first;
}
)",
                {{"$nothing", nothing_seen}});
}

std::string layer_compute() {
  return head() + compute_interface(true) + binding(FrameBuffer::triangles) +
         "readonly buffer triangles_block { int triangles[]; };\n" + binding(9) +
         "buffer seen_block { int seen[]; };\n" + binding(10) +
         "buffer tiles_block { int tile_count; int last_layer; };\n" + binding(11) +
         "buffer orders_block { int orders[]; };\n" + numbered() +
         filled(R"(
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.columns || at.y >= push.rows) return;
  int pixel = at.y * push.pitch + at.x, next = push.count + pixel, order = orders[next];
  seen[pixel] = order == $nothing ? -1 : number_of(order);
  if (order == $nothing) return;
  orders[pixel] = order;
  orders[next] = $nothing;
  if (last_layer != push.first) last_layer = push.first;
}
)",
                {{"$nothing", nothing_seen}});
}

std::string row_of() {
  return filled(R"(
// Where the row of a vertex or a triangle begins in `inputs`.
int row_of(int index) {
  int low = 0, high = push.count;
  while (high - low > 1) {
    int middle = (low + high) / 2;
    if (inputs[push.first + $stride * middle] <= index) low = middle; else high = middle;
  }
  return push.first + $stride * low;
}
)",
                {{"$stride", table_row::stride}});
}

std::string vertex_compute_main() {
  return std::string(canonical_bits) + std::string(canonical_vector) + row_of() + R"(
void main() {
  if (int(gl_GlobalInvocationID.x) >= push.columns) return;
  int index = push.left + int(gl_GlobalInvocationID.x), row = row_of(index);
  index -= inputs[row];
  precise vec4 position = vertex(inputs[row + 1] + index, inputs[row + 3], inputs[row + 4]);
  clip[inputs[row + 2] + index] = uvec4(canonical(position));
}
)";
}

std::string setup_interface() {
  return compute_interface(false) + binding(0) + "writeonly buffer records_block { ivec4 records[]; };\n" +
         binding(6) + "readonly buffer positions_block { vec4 positions[]; };\n" + binding(7) +
         "readonly buffer indices_block { int indices[]; };\n" + binding(8) +
         "buffer cuts_block { int kept_count; int cut_count; int unused[2]; ivec4 cuts[]; };\n";
}

std::string setup_main(const emit::FunctionText& called) {
  std::string text =
      std::string(canonical_bits) + std::string(canonical_vector) + row_of() +
      "\nvoid main() {\n"
      "  if (int(gl_GlobalInvocationID.x) >= push.columns) return;\n"
      "  int triangle = push.left + int(gl_GlobalInvocationID.x), row = row_of(triangle);\n"
      "  int at = inputs[row + 1] + 3 * (triangle - inputs[row]);\n"
      "  ivec3 corner = ivec3(indices[at], indices[at + 1], indices[at + 2]);\n"
      "  ivec3 vertex = corner + ivec3(inputs[row + 3]);\n  corner += ivec3(inputs[row + 2]);\n"
      "  precise vec4 first = positions[corner.x], second = positions[corner.y], third = "
      "positions[corner.z];\n  " +
      called.result_type + " made = " + called.name +
      "(first, second, third, vertex.x, vertex.y, vertex.z, inputs[row + 4]);\n"
      "  int record = " +
      std::to_string(triangle_word::stride / 4) + " * triangle;\n";
  const auto field = [&](int word) { return "made." + called.result_fields[static_cast<size_t>(1 + word)]; };
  for (int i = 0; i < triangle_word::stride; i += 4)
    text += "  records[record + " + std::to_string(i / 4) + "] = ivec4(" + field(i) + ", " + field(i + 1) +
            ", " + field(i + 2) + ", " + field(i + 3) + ");\n";
  const std::string state = "made." + called.result_fields[0];
  return text + "  if (" + state + " == " + std::to_string(setup_state::kept) +
         ") atomicAdd(kept_count, 1);\n  if (" + state + " != " + std::to_string(setup_state::cut) +
         ") return;\n"
         "  int cut = atomicAdd(cut_count, 1);\n"
         "  if (cut >= " +
         std::to_string(cut_room) +
         ") return;\n"
         "  int place = " +
         std::to_string(cut_words / 4) +
         " * cut;\n"
         "  cuts[place] = ivec4(triangle, 0, 0, 0);\n"
         "  cuts[place + 1] = canonical(first);\n"
         "  cuts[place + 2] = canonical(second);\n"
         "  cuts[place + 3] = canonical(third);\n"
         "}\n";
}

std::string seen_interface(std::vector<bool>& used) {
  used[static_cast<size_t>(FrameBuffer::inputs)] = true;
  used[static_cast<size_t>(FrameBuffer::triangles)] = true;
  return compute_interface(false) + binding(FrameBuffer::layers) +
         "buffer depths_block { int depths[]; };\n" + binding(9) + "buffer seen_block { int seen[]; };\n" +
         binding(10) + "buffer tiles_block { int tile_count; int last_layer; ivec2 tiles[]; };\n" +
         binding(11) + "buffer orders_block { int orders[]; };\n";
}

std::string seen_main(const emit::FunctionText* called) {
  static constexpr char before[] = R"(
// Whether the pixel's centre lies on the inner side of an edge, or on it if that is a top or a left one.
bool is_within(ivec2 from, ivec2 to, ivec2 centre) {
  ivec2 edge = to - from, towards = centre - from;
  int first_high, first_low, second_high, second_low;
  imulExtended(edge.x, towards.y, first_high, first_low);
  imulExtended(edge.y, towards.x, second_high, second_low);
  int high = first_high - second_high - (uint(first_low) < uint(second_low) ? 1 : 0);
  if (high != 0 || first_low != second_low) return high >= 0;
  return edge.y < 0 || (edge.y == 0 && edge.x > 0);
}

// What a turn does at a pixel. `nearest`: the bits of a depth that the triangle has nowhere.
void visit(ivec2 at, int triangle, ivec2 a, ivec2 b, ivec2 c, int nearest) {
  ivec2 centre = 256 * at + 128;
  if (!is_within(a, b, centre) || !is_within(b, c, centre) || !is_within(c, a, centre)) return;
  int pixel = (at.y - push.origin_y) * push.width + at.x - push.origin_x;
  int order = triangle < push.projected ? triangle << $order_bits : inputs[push.object + triangle - push.projected];
  if (push.first >= $layer_of_triangles ? order <= orders[pixel] : depths[push.place + pixel] > nearest) return;
)";
  static constexpr char after[] = R"(  int z_bits = floatBitsToInt(z);
  if (push.first < $seen_of_triangles) {
    if (z_bits > depths[push.place + pixel]) atomicMax(depths[push.place + pixel], z_bits);
  } else if (push.first < $layer_of_triangles) {
    if (z_bits > 0 && z_bits == depths[push.place + pixel]) atomicMin(seen[pixel], order);
  } else {
    bool is_over = (triangles[triangle * $stride + $object] & $over) != 0;
    if (is_over || z_bits > depths[push.place + pixel]) atomicMin(orders[push.width * push.count + pixel], order);
  }
}

ivec2 corner(int triangle, int i) {
  int word = triangle * $stride + $position + 2 * i;
  return ivec2(triangles[word], triangles[word + 1]);
}

// Interpolation rounds seven times, so that a depth is less than 1 + 2^-21 times the greatest of the corners.
int nearest_of(int triangle) {
  int word = triangle * $stride + $depth;
  float nearest = max(max(intBitsToFloat(triangles[word]), intBitsToFloat(triangles[word + 1])),
                      intBitsToFloat(triangles[word + 2]));
  return floatBitsToInt(max(nearest, 0.0) * 1.000001);
}

// The pixels of the window whose centres lie in the bounds of the triangle, both ends included.
ivec4 box_of(ivec2 a, ivec2 b, ivec2 c) {
  ivec2 first = (min(min(a, b), c) + 127) >> 8, last = (max(max(a, b), c) - 128) >> 8;
  ivec2 origin = ivec2(push.origin_x, push.origin_y);
  return ivec4(max(first, origin), min(last, origin + ivec2(push.width, push.count) - 1));
}

void visit_triangle(int triangle) {
  ivec2 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
  ivec4 box = box_of(a, b, c);
  ivec2 size = box.zw - box.xy + 1;
  if (size.x <= 0 || size.y <= 0) return;
  int nearest = nearest_of(triangle);
  if (size.x <= $most_pixels && size.y <= $most_pixels && size.x * size.y <= $most_pixels) {
    for (int y = box.y; y <= box.w; ++y)
      for (int x = box.x; x <= box.z; ++x) visit(ivec2(x, y), triangle, a, b, c, nearest);
    return;
  }
  if (push.first != $depth_of_triangles && push.first != $first_layer) return;
  ivec2 origin = ivec2(push.origin_x, push.origin_y);
  ivec2 first = (box.xy - origin) / $side, last = (box.zw - origin) / $side, across = last - first + 1;
  int place = atomicAdd(tile_count, across.x * across.y), pitch = (push.width + $side - 1) / $side;
  if (place < 0 || place > $room - across.x * across.y) return;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) tiles[place++] = ivec2(triangle, y * pitch + x);
}

void visit_tile(int triangle, int tile) {
  ivec2 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
  ivec4 box = box_of(a, b, c);
  int pitch = (push.width + $side - 1) / $side;
  ivec2 first = ivec2(push.origin_x, push.origin_y) + $side * ivec2(tile % pitch, tile / pitch);
  int nearest = nearest_of(triangle);
  for (int i = int(gl_LocalInvocationID.x); i < $side * $side; i += $length) {
    ivec2 at = first + ivec2(i % $side, i / $side);
    if (all(greaterThanEqual(at, box.xy)) && all(lessThanEqual(at, box.zw))) visit(at, triangle, a, b, c, nearest);
  }
}

void main() {
  if (push.first != $depth_of_tiles && push.first != $seen_of_tiles && push.first != $layer_of_tiles) {
    // The last first: of shells around an object the outer ones hide the inner ones.
    int index = push.columns - 1 - int(gl_GlobalInvocationID.x);
    if (index >= 0) visit_triangle(push.left + index);
    return;
  }
  int count = min(tile_count, $room);
  for (int i = int(gl_WorkGroupID.x); i < count; i += int(gl_NumWorkGroups.x)) {
    ivec2 tile = tiles[i];
    if (tile.x >= push.left && tile.x - push.left < push.columns) visit_tile(tile.x, tile.y);
  }
}
)";
  std::string depth = "  precise float z = depth(at.x, at.y, triangle);\n";
  if (called != nullptr)
    depth = "  int object = triangles[triangle * $stride + $object] >> $flag_bits;\n  " +
            called->result_type + " covered = " + called->name +
            "(at.x, at.y, triangle, object);\n  if (!covered." + called->result_fields[0] +
            ") return;\n  precise float z = covered." + called->result_fields[1] + ";\n";
  return filled(before + depth + after, {{"$depth_of_triangles", static_cast<int>(Turn::depth_of_triangles)},
                                         {"$depth_of_tiles", static_cast<int>(Turn::depth_of_tiles)},
                                         {"$seen_of_tiles", static_cast<int>(Turn::seen_of_tiles)},
                                         {"$layer_of_triangles", static_cast<int>(Turn::layer_of_triangles)},
                                         {"$layer_of_tiles", static_cast<int>(Turn::layer_of_tiles)},
                                         {"$first_layer", static_cast<int>(Turn::first_layer_of_triangles)},
                                         {"$over", triangle_flag::over},
                                         {"$seen_of_triangles", static_cast<int>(Turn::seen_of_triangles)},
                                         {"$order_bits", order_bits},
                                         {"$stride", triangle_word::stride},
                                         {"$position", triangle_word::position},
                                         {"$depth", triangle_word::depth},
                                         {"$object", triangle_word::object},
                                         {"$flag_bits", triangle_flag::bits},
                                         {"$most_pixels", most_pixels},
                                         {"$side", seen_tile},
                                         {"$room", tile_room},
                                         {"$length", compute_length}});
}

}  // namespace isoshade::glsl
