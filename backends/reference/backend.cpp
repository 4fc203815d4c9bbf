// SPDX-License-Identifier: Apache-2.0
#include "backends/reference/backend.h"

#include <array>
#include <bit>
#include <utility>

#include "backends/interpreter/backend.h"
#include "backends/reference/evaluator.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::reference {
namespace {

using support::Diagnostics;

class EvaluatingMachine final : public interpreter::Machine {
 public:
  explicit EvaluatingMachine(const ir::Module& module) : module_(module), evaluator_(module) {}
  void bind(uint32_t buffer, std::span<const uint32_t> words) override { evaluator_.bind(buffer, words); }
  void run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results) override {
    arguments_.resize(arguments.size());
    size_t word = 0;
    for (const ir::Parameter& parameter : module_.functions[function].parameters)
      for (uint32_t i = 0; i < parameter.type.width; ++i, ++word) {
        arguments_[word].word = arguments[word];
        if (parameter.type.is_float()) arguments_[word].number = Real(std::bit_cast<float>(arguments[word]));
      }
    results_.resize(results.size());
    evaluator_.run(function, arguments_, results_);
    size_t next = 0;
    for (const ir::Result& result : module_.functions[function].results)
      for (uint32_t i = 0; i < result.type.width; ++i, ++next)
        results[next] = result.type.is_float() ? std::bit_cast<uint32_t>(stored(results_[next].number))
                                               : results_[next].word;
  }

 private:
  const ir::Module& module_;
  Evaluator evaluator_;
  std::vector<Cell> arguments_, results_;
};

/// What decides visibility is computed in floats: otherwise a pixel might show another triangle.
std::unique_ptr<interpreter::Machine> make_machine(const driver::Program& program) {
  if (lower::decides_visibility(program.stage)) return interpreter::make_machine(program);
  return std::make_unique<EvaluatingMachine>(program.module);
}

class ReferenceBackend final : public backends::Backend {
 public:
  std::string_view name() const override { return inner_->name(); }
  std::string description() const override { return inner_->description(); }

  bool transform(const backends::ViewPass& pass, support::Array<float>& clip,
                 Diagnostics& diagnostics) override {
    const backends::Target& target = pass.view.target;
    if (target.has_color && (target.width > max_size || target.height > max_size)) {
      const std::string most = std::to_string(max_size);
      diagnostics
          .report(support::Id::device_limit,
                  "the reference draws at most " + most + "x" + most + " samples, and this image has " +
                      std::to_string(target.width) + "x" + std::to_string(target.height))
          .suggest("ask for less by --size 128x128, or by --samples 1 if the scene has several a pixel");
      return false;
    }
    return inner_->transform(pass, clip, diagnostics);
  }
  bool reserve(size_t floats, Diagnostics& diagnostics) override { return inner_->reserve(floats, diagnostics); }
  void write(size_t first, std::span<const float> floats) override { inner_->write(first, floats); }
  std::span<const float> read(const backends::Slot& slot) override { return inner_->read(slot); }
  bool is_finite() override { return inner_->is_finite(); }
  bool draw(const backends::Drawing& drawing, Diagnostics& diagnostics) override {
    return inner_->draw(drawing, diagnostics);
  }
  bool post(std::span<const backends::ScreenPass> passes, const backends::Slot& made, Diagnostics& diagnostics) override {
    return inner_->post(passes, made, diagnostics);
  }
  bool evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override {
    return inner_->evaluate(program, inputs, rows, outputs, diagnostics);
  }

 private:
  std::unique_ptr<backends::Backend> inner_ =
      interpreter::create("reference", "reference, numbers of 57 digits, 1 thread", make_machine);
};

}  // namespace

std::unique_ptr<backends::Backend> create() { return std::make_unique<ReferenceBackend>(); }

std::vector<Real> evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows) {
  const std::vector<uint32_t> words(inputs.begin(), inputs.end());
  Evaluator evaluator(program.module);
  evaluator.bind(static_cast<uint32_t>(lower::FrameBuffer::inputs), words);
  std::vector<bool> is_float;
  for (const ir::Result& result : program.module.functions[program.entry].results)
    is_float.insert(is_float.end(), result.type.width, result.type.is_float());
  std::vector<Cell> cells(is_float.size());
  std::vector<Real> out;
  for (size_t row = 0; row < rows; ++row) {
    evaluator.run(program.entry, std::array{Cell{0, static_cast<uint32_t>(row)}}, cells);
    for (size_t i = 0; i < cells.size(); ++i)
      out.push_back(is_float[i] ? cells[i].number : Real(static_cast<int32_t>(cells[i].word)));
  }
  return out;
}

}  // namespace isoshade::reference
