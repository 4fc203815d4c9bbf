// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>

#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

size_t size_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: return 0;
  }
}

/// Elements that lie within their buffer.
struct Elements {
  const unsigned char* first;
  size_t stride, count;
  int type;  ///< of the components
};

template <class T>
T load(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);  // little-endian, as are all machines that this runs on
  return value;
}

template <class T>
const T* at(const std::vector<T>& values, int index) {
  return index >= 0 && static_cast<size_t>(index) < values.size() ? &values[static_cast<size_t>(index)]
                                                                  : nullptr;
}

std::optional<Elements> find(const tinygltf::Model& model, int index, int width, Refusal& refusal) {
  const std::string name = "accessor " + std::to_string(index);
  const auto refuse = [&](const std::string& reason) {
    refusal.refuse(name + " " + reason);
    return std::nullopt;
  };
  const tinygltf::Accessor* accessor = at(model.accessors, index);
  if (accessor == nullptr) return refuse("does not exist");
  if (components_of(model, index) != width) return refuse("has the wrong type");
  if (accessor->sparse.isSparse) return refuse("is sparse, which is not supported");
  const size_t component = size_of_component(accessor->componentType);
  if (component == 0) return refuse("has components of a type that is not supported");
  const tinygltf::BufferView* view = at(model.bufferViews, accessor->bufferView);
  if (view == nullptr) return refuse("has no buffer view");
  const tinygltf::Buffer* buffer = at(model.buffers, view->buffer);
  if (buffer == nullptr) return refuse("has no buffer");

  // Sizes in the order in which none can overflow: each is found to be small before it is used.
  const size_t all = buffer->data.size();
  if (view->byteOffset > all || view->byteLength > all - view->byteOffset) return refuse("extends beyond its buffer");
  const size_t element = component * static_cast<size_t>(width);
  const size_t stride = view->byteStride == 0 ? element : view->byteStride;
  if (stride < element) return refuse("has elements that overlap");
  if (accessor->count == 0) return refuse("is empty");
  if (accessor->byteOffset > view->byteLength || element > view->byteLength - accessor->byteOffset ||
      accessor->count - 1 > (view->byteLength - accessor->byteOffset - element) / stride) {
    return refuse("extends beyond its buffer view");
  }
  if (accessor->count > 3 * static_cast<size_t>(max_gltf_triangles)) return refuse("is too long");
  return Elements{buffer->data.data() + view->byteOffset + accessor->byteOffset, stride, accessor->count,
                  accessor->componentType};
}

}  // namespace

int components_of(const tinygltf::Model& model, int accessor) {
  const tinygltf::Accessor* found = at(model.accessors, accessor);
  if (found == nullptr) return 0;
  switch (found->type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4: return 4;
    default: return 0;
  }
}

std::optional<Numbers> read_numbers(const tinygltf::Model& model, int accessor, int width, bool integers,
                                    Refusal& refusal) {
  const auto elements = find(model, accessor, width, refusal);
  if (!elements) return std::nullopt;
  const bool floats = elements->type == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool bytes = elements->type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  const bool shorts = elements->type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  const bool normalized = model.accessors[static_cast<size_t>(accessor)].normalized;
  if (!floats && !(integers && normalized && (bytes || shorts))) {
    refusal.refuse("accessor " + std::to_string(accessor) + " has components of an unsuitable type");
    return std::nullopt;
  }
  Numbers numbers;
  numbers.count = elements->count;
  numbers.values.reserve(elements->count * static_cast<size_t>(width));
  for (size_t i = 0; i < elements->count; ++i) {
    for (size_t c = 0; c < static_cast<size_t>(width); ++c) {
      const unsigned char* from = elements->first + i * elements->stride;
      float value;
      if (floats) {
        value = canonical(load<float>(from + 4 * c));
      } else if (bytes) {
        value = static_cast<float>(from[c]) / 255.0f;
      } else {
        value = static_cast<float>(load<uint16_t>(from + 2 * c)) / 65535.0f;
      }
      if (!std::isfinite(value)) {
        refusal.refuse("accessor " + std::to_string(accessor) + " has a number that is infinite or NaN");
        return std::nullopt;
      }
      numbers.values.push_back(value);
    }
  }
  return numbers;
}

std::optional<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                  Refusal& refusal) {
  const auto elements = find(model, accessor, 1, refusal);
  if (!elements) return std::nullopt;
  std::vector<uint32_t> indices;
  indices.reserve(elements->count);
  for (size_t i = 0; i < elements->count; ++i) {
    const unsigned char* from = elements->first + i * elements->stride;
    switch (elements->type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: indices.push_back(*from); break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: indices.push_back(load<uint16_t>(from)); break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: indices.push_back(load<uint32_t>(from)); break;
      default: refusal.refuse("indices are not integers"); return std::nullopt;
    }
  }
  return indices;
}

}  // namespace isoshade::scene
