// SPDX-License-Identifier: Apache-2.0
// What a kernel loads: which words of a record, and from which buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// By value: the instruction that makes it, or none for a parameter of a block.
std::vector<InstructionId> made_by(const Function& function);

/// The addresses of words in one record.
class RecordAddresses {
 public:
  /// `record`: the parameter of the kernel that is the record's first word; none: the record begins at word 0.
  RecordAddresses(const Function& kernel, std::optional<size_t> record);
  /// The word at an address that is the first word, or that plus a constant; nothing of other addresses.
  std::optional<uint32_t> word(ValueId address) const;

 private:
  std::optional<uint32_t> constant(ValueId value) const;

  const Function& kernel_;
  std::optional<ValueId> record_;
  std::vector<InstructionId> made_by_;
};

/// The words that a kernel loads from a record in these buffers, ascending. Nothing if that does not show: an address is
/// not one of RecordAddresses, or another function of the module loads from the buffers, too.
std::optional<std::vector<uint32_t>> loaded_words(const Module& module, uint32_t kernel,
                                                  std::optional<size_t> record,
                                                  std::span<const uint32_t> buffers);

/// Whether a function of the module loads from a buffer.
bool loads_from(const Module& module, uint32_t buffer);

}  // namespace isoshade::ir
