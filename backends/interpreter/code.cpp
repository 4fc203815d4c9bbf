// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/code.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>

#include "backends/interpreter/draft.h"
#include "compiler/support/assert.h"
#include "runtime/raster/tile.h"

namespace isoshade::interpreter {

using support::assert_that;

namespace {

constexpr size_t alignment = 64;
/// Lanes that are computed at once: many, so that choosing the next step costs little beside the step, but so few that
/// the registers of a usual program are in the nearest caches.
constexpr int batch = 256;

const LaneCode& lane_code_of(int lanes) {
  switch (lanes) {
    case 4: return lane_code_4;
    case 8: return lane_code_8;
    case 16: return lane_code_16;
    default: break;
  }
  support::bug("the interpreter has no such lanes");
}

size_t align(size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

}  // namespace

int Code::widest_lanes() { return raster::rasterizer_lanes(); }

/// The registers of a thread, which it keeps.
class Registers {
 public:
  static Registers& of_thread() {
    static thread_local Registers registers;
    return registers;
  }

  Context prepare(const Code& code) {
    const size_t words = code.words_ * code.word_bytes_, masks = code.masks_ * code.mask_bytes_;
    const size_t size = words + masks + align(4 * code.scalars_.size());
    if (size > size_) {
      bytes_.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, size)));
      assert_that(bytes_ != nullptr, "no memory for the interpreter's registers");
      std::memset(bytes_.get(), 0, size);
      size_ = size;
      holds_ = 0;
    }
    Context context{bytes_.get(), bytes_.get() + words, nullptr, nullptr, 0, 0};
    context.scalars = reinterpret_cast<uint32_t*>(context.masks + masks);
    // Another program leaves its values where this one has its constants.
    if (holds_ != code.number_) std::memcpy(context.scalars, code.scalars_.data(), 4 * code.scalars_.size());
    holds_ = code.number_;
    return context;
  }

 private:
  struct Free {
    void operator()(std::byte* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<std::byte, Free> bytes_;
  size_t size_ = 0;
  uint64_t holds_ = 0;  ///< the number of the code whose constants are there
};

Code::Code(const ir::Module& module, uint32_t function, size_t results, int lanes) : code_(lane_code_of(lanes)), batch_(batch) {
  static std::atomic<uint64_t> last_number = 0;
  number_ = ++last_number;
  Draft draft = decode(module, function, results);
  simplify(draft);
  assign_registers(draft);
  scalars_ = std::move(draft.scalars);
  words_ = draft.words;
  masks_ = draft.masks;
  parameters_ = std::move(draft.parameters);
  results_ = std::move(draft.results);
  word_bytes_ = sizeof(uint32_t) * static_cast<size_t>(batch_);
  mask_bytes_ = align(code_.mask_bytes * static_cast<size_t>(batch_ / code_.lanes));

  const auto place = [&](Place at) {
    switch (at.pool) {
      case Pool::none: return uint32_t{0};
      case Pool::scalars: return at.index;
      case Pool::words: return static_cast<uint32_t>(at.index * word_bytes_);
      case Pool::masks: break;
    }
    return static_cast<uint32_t>(at.index * mask_bytes_);
  };
  steps_.reserve(draft.steps.size());
  for (uint32_t i = 0; i < draft.steps.size(); ++i) {
    const DraftStep& made = draft.steps[i];
    Step step{nullptr, place(made.to), place(made.a), place(made.b), place(made.c), 0};
    bool in_lanes = made.to.pool != Pool::scalars;
    switch (made.shape.kind) {
      case Kind::load: step.more = made.buffer; break;
      case Kind::primitive:
      case Kind::fused:
      case Kind::copy: break;
      case Kind::jump:
      case Kind::jump_if_not:
      case Kind::jump_unless_less:
        step.b = made.target - i;
        in_lanes = false;
        break;
      case Kind::split:
        step.b = made.target - i;
        step.c = made.end - i;
        break;
    }
    step.run = in_lanes ? code_.find(made.shape) : find_scalar(made.shape);
    assert_that(step.run != nullptr, "the interpreter has no code for a step");
    steps_.push_back(step);
  }
}

void Code::run(const BufferView* buffers, std::span<const Argument> arguments, int count, void* results) const {
  assert_that(arguments.size() == parameters_.size(), "a kernel is given other arguments than it takes");
  Context context = Registers::of_thread().prepare(*this);
  context.buffers = buffers;
  for (size_t k = 0; k < arguments.size(); ++k) {
    if (parameters_[k].pool != Pool::scalars) continue;
    assert_that(arguments[k].words == nullptr && arguments[k].change == 0, "an argument that varies must be uniform");
    context.scalars[parameters_[k].index] = static_cast<uint32_t>(arguments[k].first);
  }
  const Step* const first = steps_.data();
  for (int begin = 0; begin < count; begin += batch_) {
    const int wanted = std::min(batch_, count - begin);
    const int groups = (wanted + code_.lanes - 1) / code_.lanes, filled = groups * code_.lanes;
    for (size_t k = 0; k < arguments.size(); ++k) {
      if (parameters_[k].pool != Pool::words) continue;
      const Argument& argument = arguments[k];
      std::byte* const to = context.words + parameters_[k].index * word_bytes_;
      const auto fill = [&](int first, int end) {
        for (int i = first; i < end; ++i) {
          // A tail is filled up with the last call.
          const uint32_t word = argument.of(begin + std::min(i, wanted - 1));
          std::memcpy(to + sizeof word * static_cast<size_t>(i), &word, sizeof word);
        }
      };
      if (argument.words != nullptr && argument.stride == 1) {
        std::memcpy(to, static_cast<const uint32_t*>(argument.words) + begin, sizeof(uint32_t) * static_cast<size_t>(wanted));
        fill(wanted, filled);
      } else {
        fill(0, filled);
      }
    }
    context.begin = 0;
    context.end = static_cast<uint32_t>(groups);
    code_.execute(first, first + steps_.size(), context);
    store(context, wanted, static_cast<std::byte*>(results) + sizeof(uint32_t) * results_.size() * static_cast<size_t>(begin));
  }
}

void Code::store(const Context& context, int count, void* to) const {
  const size_t stride = sizeof(uint32_t) * results_.size();
  for (size_t k = 0; k < results_.size(); ++k) {
    const bool is_scalar = results_[k].pool == Pool::scalars;
    const std::byte* from = is_scalar ? reinterpret_cast<const std::byte*>(context.scalars + results_[k].index)
                                      : context.words + results_[k].index * word_bytes_;
    std::byte* next = static_cast<std::byte*>(to) + sizeof(uint32_t) * k;
    for (int i = 0; i < count; ++i, next += stride) {
      std::memcpy(next, from, sizeof(uint32_t));
      if (!is_scalar) from += sizeof(uint32_t);
    }
  }
}

}  // namespace isoshade::interpreter
