// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/compute.h"

#include "compiler/lower/kernel.h"
#include "compiler/support/assert.h"

namespace isoshade::bench {

namespace {

using lower::Float;
using lower::Int;
using lower::Vec3;

/// The inputs of one row, from which those of each evaluation are made.
class Inputs {
 public:
  Inputs(lower::Kernel& k, const Subject& subject, const std::vector<driver::Field>& fields) : k_(k) {
    for (const driver::Field& field : fields) {
      Input input{field.words, field.type == "vector3", subject.variant == nullptr, {}, {}};
      const Bounds bounds = bounds_of(subject, field);
      if (input.is_vector && input.is_unit) {
        // Around the z axis; the first one, the normal, is so near to it that the others are in its hemisphere.
        const Float spread(vectors_++ == 0 ? 0.6f : 2.0f);
        const Float x = (fraction() - Float(0.5f)) * spread, y = (fraction() - Float(0.5f)) * spread;
        const Float length = sqrt(x * x + y * y + Float(1.0f));
        input.components = {x / length, y / length, Float(1.0f) / length};
      } else {
        for (int i = 0; i < field.words; ++i) {
          const float low = input.is_vector ? 0.01f : bounds.low, high = input.is_vector ? 100.0f : bounds.high;
          input.low.push_back(low);
          input.components.push_back(fraction() * Float(high - low));
        }
      }
      inputs_.push_back(std::move(input));
    }
  }

  /// Arguments of the evaluation `index`, which is the same for all lanes.
  std::vector<ir::ValueId> at(Int index) {
    const Float factor = Float(1.0f) - to_float(index) * Float(0.5f / evaluations);  // in (0.5, 1]
    std::vector<ir::ValueId> arguments;
    int bit = 0;
    const auto sign = [&] {
      const Int chosen = shift_right(index, Int(bit++ % 6)) & Int(1);
      return select(chosen == Int(0), Float(1.0f), Float(-1.0f));
    };
    for (const Input& input : inputs_) {
      std::vector<ir::ValueId> components;
      for (size_t i = 0; i < input.components.size(); ++i) {
        Float component = input.components[i];
        if (input.is_vector && input.is_unit) {
          if (i < 2) component = component * sign();
        } else {
          component = component * factor;
          if (input.low[i] != 0) component = component + Float(input.low[i]);
        }
        components.push_back(component.id(k_.b));
      }
      arguments.push_back(components.size() == 1 ? components[0] : k_.b.construct(components));
    }
    return arguments;
  }

 private:
  struct Input {
    int words;
    bool is_vector, is_unit;
    std::vector<float> low;
    std::vector<Float> components;
  };

  /// In [0, 1), by a hash of the row's number. The bits of a float tell the optimiser nothing about its range, so that it
  /// compiles the subject as for inputs that it does not know.
  Float fraction() {
    Int h = k_.integer(0) * Int(static_cast<int>(0x9e3779b1u)) + Int(++hashes_ * 0x3c6ef35f);
    h = (h ^ shift_right(h, Int(16))) * Int(0x7feb352d);
    h = (h ^ shift_right(h, Int(15))) * Int(static_cast<int>(0x846ca68bu));
    return from_bits_normal(shift_right(h, Int(9)) | Int(0x3f800000)) - Float(1.0f);
  }

  lower::Kernel& k_;
  std::vector<Input> inputs_;
  int vectors_ = 0;
  uint32_t hashes_ = 0;
};

/// The floats that values consist of.
std::vector<Float> floats_of(lower::Kernel& k, const std::vector<ir::ValueId>& values) {
  std::vector<Float> floats;
  for (const ir::ValueId value : values) {
    const ir::Type type = k.b.type(value);
    support::assert_that(type.scalar == ir::Scalar::floating, "the bench measures functions of floats");
    for (uint32_t i = 0; i < type.width; ++i) floats.emplace_back(k.b, type.width == 1 ? value : k.b.extract(value, i));
  }
  return floats;
}

/// `fold`: makes the new word of the old one and the arguments of an evaluation.
template <class Fold>
driver::Program loop_program(const Subject& subject, const std::vector<driver::Field>& inputs, ir::Module module,
                             functions::Tier tier, const Fold& fold) {
  lower::Kernel k(module, "evaluations", {lower::int_parameter("row_number")}, {{"word", ir::int_type}});
  Inputs made(k, subject, inputs);
  const std::array start{k.b.constant(0)};
  k.b.finish(k.b.loop(k.b.constant(evaluations), start,
                      [&](ir::ValueId index, std::span<const ir::ValueId> carried) {
                        return std::vector{fold(k, Int(k.b, carried[0]), made.at(Int(k.b, index))).value};
                      }));
  return driver::finish_eval(std::move(module), k.index, subject.effect, tier);
}

}  // namespace

driver::Program compute_program(const Subject& subject, const std::vector<driver::Field>& inputs, ir::Module module,
                                uint32_t function, functions::Tier tier) {
  // The sum is one addition a result; the bits are taken once.
  return loop_program(subject, inputs, std::move(module), tier,
                      [&](lower::Kernel& k, Int word, const std::vector<ir::ValueId>& arguments) {
                        const std::vector<Float> results = floats_of(k, k.b.call(function, arguments));
                        Float sum = results[0];
                        for (size_t i = 1; i < results.size(); ++i) sum = sum + results[i];
                        return word ^ bits(sum);
                      });
}

driver::Program making_program(const Subject& subject, const std::vector<driver::Field>& inputs) {
  return loop_program(subject, inputs, lower::frame_module(), functions::Tier::standard,
                      [](lower::Kernel& k, Int word, const std::vector<ir::ValueId>& arguments) {
                        for (const Float& component : floats_of(k, arguments))
                          word = word ^ functions::traced::record<Int>(ir::Opcode::fbits_nonnan, component);
                        return word;
                      });
}

}  // namespace isoshade::bench
