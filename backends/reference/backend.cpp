// SPDX-License-Identifier: Apache-2.0
#include "backends/reference/backend.h"

#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "backends/interpreter/backend.h"
#include "backends/interpreter/stages.h"
#include "backends/reference/evaluator.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::reference {
namespace {

using support::Diagnostics;

class EvaluatingMachine final : public interpreter::Machine {
 public:
  explicit EvaluatingMachine(const driver::Program& program)
      : module_(program.module),
        entry_(program.entry),
        stored_(interpreter::stored_words(program)),
        words_(module_.buffers.size()),
        evaluator_(module_) {}

  void run(const interpreter::BufferView* buffers, std::span<const interpreter::Argument> arguments, int count,
           void* results) override {
    if (!std::exchange(is_bound_, true)) bind(buffers);
    for (int call = 0; call < count; ++call) {
      run_once(arguments, call);
      for (size_t i = 0; i < stored_; ++i)
        std::memcpy(static_cast<std::byte*>(results) + sizeof(uint32_t) * (static_cast<size_t>(call) * stored_ + i),
                    &stored_words_[i], sizeof(uint32_t));
    }
  }

 private:
  void bind(const interpreter::BufferView* buffers) {
    for (uint32_t i = 0; i < words_.size(); ++i) {
      words_[i].resize(static_cast<size_t>(buffers[i].size));
      std::memcpy(words_[i].data(), buffers[i].data, sizeof(uint32_t) * words_[i].size());
      evaluator_.bind(i, words_[i]);
    }
  }

  void run_once(std::span<const interpreter::Argument> arguments, int call) {
    const ir::Function& kernel = module_.functions[entry_];
    arguments_.resize(arguments.size());
    size_t word = 0;
    for (const ir::Parameter& parameter : kernel.parameters)
      for (uint32_t i = 0; i < parameter.type.width; ++i, ++word) {
        arguments_[word].word = arguments[word].of(call);
        if (parameter.type.is_float()) arguments_[word].number = Real(std::bit_cast<float>(arguments_[word].word));
      }
    size_t words = 0;
    for (const ir::Result& result : kernel.results) words += result.type.width;
    results_.resize(words);
    evaluator_.run(entry_, arguments_, results_);
    stored_words_.clear();
    for (const ir::Result& result : kernel.results)
      for (uint32_t i = 0; i < result.type.width; ++i) {
        const Cell& cell = results_[stored_words_.size()];
        stored_words_.push_back(result.type.is_float() ? std::bit_cast<uint32_t>(stored(cell.number)) : cell.word);
      }
  }

  const ir::Module& module_;
  uint32_t entry_;
  size_t stored_;
  std::vector<std::vector<uint32_t>> words_;  ///< of the buffers
  bool is_bound_ = false;
  Evaluator evaluator_;
  std::vector<Cell> arguments_, results_;
  std::vector<uint32_t> stored_words_;
};

/// What decides visibility is computed in floats: otherwise a pixel might show another triangle.
std::unique_ptr<interpreter::Machine> make_machine(const driver::Program& program) {
  if (lower::decides_visibility(program.stage)) return interpreter::make_machine(program);
  return std::make_unique<EvaluatingMachine>(program);
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
