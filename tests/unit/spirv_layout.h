// SPDX-License-Identifier: Apache-2.0
// The layout of structs in memory, as a SPIR-V module decorates it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace isoshade::testing {

class SpirvLayout {
 public:
  explicit SpirvLayout(const std::vector<uint32_t>& spirv) {
    constexpr uint32_t op_name = 5, op_type_array = 28, op_type_runtime_array = 29, op_decorate = 71,
                       op_member_decorate = 72, array_stride = 6, offset = 35;
    constexpr size_t header_words = 5;
    for (size_t i = header_words; i < spirv.size(); i += spirv[i] >> 16) {
      const uint32_t op = spirv[i] & 0xffff;
      if (op == op_name) names_[spirv[i + 1]] = reinterpret_cast<const char*>(&spirv[i + 2]);
      if (op == op_decorate && spirv[i + 2] == array_stride) strides_[spirv[i + 1]] = spirv[i + 3];
      if (op == op_type_array || op == op_type_runtime_array) elements_[spirv[i + 1]] = spirv[i + 2];
      if (op == op_member_decorate && spirv[i + 3] == offset)
        offsets_[spirv[i + 1]][spirv[i + 2]] = spirv[i + 4];
    }
  }

  /// The offsets of the members of a struct, by number; empty if no block has it.
  std::map<uint32_t, uint32_t> offsets_of(const std::string& name) const {
    for (const auto& [type, offsets] : offsets_)
      if (names_.contains(type) && names_.at(type) == name) return offsets;
    return {};
  }
  /// The stride of an array of a struct that is in a block; 0 if there is none.
  uint32_t stride_of(const std::string& name) const {
    for (const auto& [array, stride] : strides_)
      if (const auto element = elements_.find(array);
          element != elements_.end() && offsets_.contains(element->second) &&
          names_.contains(element->second) && names_.at(element->second) == name)
        return stride;
    return 0;
  }

 private:
  std::map<uint32_t, std::string> names_;
  std::map<uint32_t, uint32_t> strides_, elements_;
  std::map<uint32_t, std::map<uint32_t, uint32_t>> offsets_;
};

}  // namespace isoshade::testing
