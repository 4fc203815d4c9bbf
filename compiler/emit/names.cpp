// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/names.h"

#include <unordered_set>

namespace isoshade::emit {

namespace {

// Keywords and reserved words of GLSL 4.60 and C++20, built-in functions of GLSL, and what generated code
// itself says: names of ops, of lanes and of stages. An id among them gets an underscore behind it.
const std::unordered_set<std::string_view> reserved = {
    // both languages, or either
    "alignas", "alignof", "and", "and_eq", "asm", "atomic_uint", "attribute", "auto", "bitand", "bitor",
    "bool", "break", "buffer", "bvec2", "bvec3", "bvec4", "case", "cast", "catch", "centroid", "char",
    "char8_t", "char16_t", "char32_t", "class", "co_await", "co_return", "co_yield", "coherent", "common",
    "compl", "concept", "const", "const_cast", "consteval", "constexpr", "constinit", "continue", "decltype",
    "default", "delete", "discard", "dmat2", "dmat3", "dmat4", "do", "double", "dvec2", "dvec3", "dvec4",
    "dynamic_cast", "else", "enum", "explicit", "export", "extern", "external", "false", "filter", "fixed",
    "flat", "float", "for", "friend", "fvec2", "fvec3", "fvec4", "goto", "half", "highp", "hvec2", "hvec3",
    "hvec4", "if", "iimage2D", "image2D", "image3D", "image1D", "in", "inline", "inout", "input", "int",
    "interface", "invariant", "isampler2D", "ivec2", "ivec3", "ivec4", "layout", "long", "lowp", "mat2",
    "mat3", "mat4", "mediump", "mutable", "namespace", "new", "noexcept", "noinline", "noperspective", "not",
    "not_eq", "nullptr", "operator", "or", "or_eq", "out", "output", "partition", "patch", "precise",
    "precision", "private", "protected", "public", "readonly", "register", "reinterpret_cast", "requires",
    "resource", "restrict", "return", "sample", "sampler", "sampler1D", "sampler2D", "sampler2DRect",
    "sampler3D", "samplerCube", "shared", "short", "signed", "sizeof", "smooth", "static", "static_assert",
    "static_cast", "struct", "subroutine", "superp", "switch", "template", "texture2D", "this",
    "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "uint", "union", "uniform",
    "unsigned", "using", "uvec2", "uvec3", "uvec4", "varying", "vec2", "vec3", "vec4", "virtual", "void",
    "volatile", "wchar_t", "while", "writeonly", "xor", "xor_eq", "main", "std", "texture", "image",
    // functions that emitted text calls, and names of its surroundings
    "abs", "all", "any", "bits", "bits_nonnan", "branch", "floatBitsToInt", "floor", "from_bits",
    "from_bits_normal", "imulExtended", "intBitsToFloat", "lanes", "load", "mul_hi", "negate", "select",
    "shift_left", "shift_right", "shift_right_signed", "sqrt", "texelFetch", "to_float", "to_int",
    "umulExtended", "unsigned_less", "unsigned_mul_hi", "vec", "F", "I", "B", "buffers", "push", "Push",
    "frame", "inputs", "lights", "objects", "triangles", "vertices", "clip", "ids", "id", "isoshade",
    "int_of", "bool_of", "float_of", "lane_count", "pixel", "vertex", "depth", "eval", "shade", "light_at",
    "texel_at", "texture_size", "texels", "texel_bytes", "textures", "post", "post_process", "layers", "layer_records",
    "edges_at", "attribute2", "attribute3", "Buffers", "NULL", "INFINITY", "NAN", "assert", "errno", "linux",
    "unix", "near", "far", "ISO_ZERO", "iso_zero", "iso_zero_block", "words", "VULKAN", "Lanes", "batch",
    // rarer words of GLSL that glslang takes as keywords
    "active", "devicecoherent", "dmat2x2", "dmat2x3", "dmat2x4", "dmat3x2", "dmat3x3", "dmat3x4", "dmat4x2",
    "dmat4x3", "dmat4x4", "mat2x2", "mat2x3", "mat2x4", "mat3x2", "mat3x3", "mat3x4", "mat4x2", "mat4x3",
    "mat4x4", "nonprivate", "queuefamilycoherent", "shadercallcoherent", "subgroupcoherent",
    "workgroupcoherent"};

// Functions of GLSL: a local may hide them, a function of ours would redefine them.
const std::unordered_set<std::string_view> glsl_functions = {
    // of every stage
    "acos", "acosh", "asin", "asinh", "atan", "atanh", "barrier", "bitCount", "ceil", "clamp", "cos", "cosh",
    "cross", "degrees", "determinant", "dFdx", "dFdy", "distance", "dot", "equal", "exp", "exp2",
    "faceforward", "findLSB", "findMSB", "fma", "fract", "frexp", "ftransform", "fwidth", "greaterThan",
    "inverse", "inversesqrt", "isinf", "isnan", "ldexp", "length", "lessThan", "log", "log2", "max", "min",
    "mix", "mod", "modf", "noise1", "normalize", "notEqual", "outerProduct", "pow", "radians", "reflect",
    "refract", "round", "roundEven", "sign", "sin", "sinh", "smoothstep", "step", "tan", "tanh", "texelFetch",
    "transpose", "trunc",
    // of pixels, but for one
    "dFdxCoarse", "dFdxFine", "dFdyCoarse", "dFdyFine", "floatBitsToUint", "fwidthCoarse", "fwidthFine",
    "interpolateAtCentroid", "interpolateAtOffset", "interpolateAtSample"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Built-in variables, macros in capitals, and what GL_EXT_spirv_intrinsics adds.
bool has_taken_prefix(std::string_view name) {
  for (const std::string_view prefix : {"gl_", "GL_", "ISOSHADE_", "spirv_"})
    if (name.starts_with(prefix)) return true;
  return false;
}

/// Whether the name ends as those of GLSL's extensions do: "pervertexNV", "minInvocationsAMD".
bool is_extension(std::string_view name) {
  for (const std::string_view suffix : {"AMD", "ARB", "EXT", "KHR", "NV"})
    if (name.ends_with(suffix)) return true;
  return false;
}

/// Whether the stages name a buffer or an output so: "inputs_block", "result_0".
bool is_interface(std::string_view name) { return name.ends_with("_block") || name.starts_with("result_"); }

/// Whether the name has the form of an opaque type's: "sampler2DArrayShadow", "uimageBuffer".
bool is_opaque_type(std::string_view name) {
  if (name.starts_with('i') || name.starts_with('u'))
    if (is_opaque_type(name.substr(1))) return true;
  for (const std::string_view stem : {"image", "sampler", "texture", "subpassInput"}) {
    if (!name.starts_with(stem)) continue;
    const char next = name.size() > stem.size() ? name[stem.size()] : 'A';
    return is_digit(next) || (next >= 'A' && next <= 'Z');
  }
  return false;
}

bool is_clean(std::string_view name) {
  if (name.empty() || name.size() > 100 || !is_letter(name.front()) || name.back() == '_') return false;
  for (size_t i = 0; i < name.size(); ++i)
    if (!is_letter(name[i]) && !is_digit(name[i]) && (name[i] != '_' || name[i - 1] == '_')) return false;
  return !has_taken_prefix(name);
}

std::string clean(std::string_view wanted) {
  if (is_clean(wanted)) return std::string(wanted);
  std::string name;
  for (char c : wanted) {
    const char kept = is_letter(c) || is_digit(c) ? c : '_';
    if (kept == '_' && !name.empty() && name.back() == '_') continue;  // both languages reserve "__"
    name += kept;
  }
  if (name.size() > 100) name.resize(100);
  while (!name.empty() && name.front() == '_') name.erase(0, 1);  // C++ reserves "_A" and, globally, "_a"
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || is_digit(name.front()) || has_taken_prefix(name)) name = "n_" + name;
  if (name.back() == '_') name.pop_back();
  return name;
}

}  // namespace

bool Names::taken(const std::string& name) const {
  for (const Names* scope = this; scope != nullptr; scope = scope->outer_)
    if (scope->used_.contains(name)) return true;
  return false;
}

std::string Names::take(std::string_view wanted) { return take(wanted, false); }

std::string Names::take_function(std::string_view wanted) { return take(wanted, true); }

std::string Names::take(std::string_view wanted, bool function) {
  std::string name = clean(wanted);
  const auto [index, is_new] = used_.add(name);
  if (is_new) {
    const bool forbidden = reserved.contains(name) || is_opaque_type(name) || is_extension(name) ||
                           (function && (glsl_functions.contains(name) || is_interface(name)));
    if (!forbidden && (outer_ == nullptr || !outer_->taken(name))) return name;
    if (forbidden && !taken(name + "_")) {
      used_.add(name + "_");
      return name + "_";
    }
  }
  std::string numbered;
  do {
    numbered = name + "_" + std::to_string(++used_.number(index));
  } while ((outer_ != nullptr && outer_->taken(numbered)) || !used_.add(numbered).is_new);
  return numbered;
}

std::string comment_text(std::string_view text) {
  std::string out;
  for (char c : text.substr(0, 200)) {
    if (c < ' ' || c > '~' || c == '\\' || c == '?' || c == '*') c = '_';
    out += c;
  }
  return out;
}

}  // namespace isoshade::emit
