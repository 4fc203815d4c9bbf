// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/reads.h"

#include <algorithm>
#include <array>
#include <map>

#include "compiler/driver/texture_flow.h"
#include "compiler/ir/record_words.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::driver {

namespace {

constexpr auto objects = static_cast<uint32_t>(lower::FrameBuffer::objects);
constexpr auto object_integers = static_cast<uint32_t>(lower::FrameBuffer::object_integers);

/// A kernel that loads from records: the program's, or the one that computes the values of a draw.
struct Kernel {
  const ir::Module& module;
  uint32_t entry;
  std::optional<size_t> record;  ///< the parameter

  std::optional<std::vector<uint32_t>> words() const {
    return ir::loaded_words(module, entry, record, std::array{objects, object_integers});
  }
};

Kernel kernel_of(const Program& program) {
  return {program.module, program.entry, lower::record_parameter(program.stage)};
}
Kernel kernel_of(const passes::DrawValues& draw) {
  const bool has_parameter = !draw.module.functions[draw.entry].parameters.empty();
  return {draw.module, draw.entry, has_parameter ? std::optional<size_t>(0) : std::nullopt};
}

void mark_words(const Kernel& kernel, size_t first, std::vector<bool>& words) {
  const auto loaded = kernel.words();
  if (!loaded) return words.assign(words.size(), true);
  for (const uint32_t word : *loaded)
    if (word >= first && word - first < words.size()) words[word - first] = true;
}

/// Marks the words that a program reads. `first`: of the record, the first one of the block.
void mark_words(const Program& program, size_t first, std::vector<bool>& words) {
  mark_words(kernel_of(program), first, words);
  if (program.draw != nullptr) mark_words(kernel_of(*program.draw), first, words);
}

/// The words of an object's record that hold numbers of textures.
struct ImageWords {
  size_t first, count;
  std::optional<uint32_t> image(uint32_t word) const {
    return word >= first && word - first < count ? std::optional(static_cast<uint32_t>(word - first))
                                                 : std::nullopt;
  }
};

/// By word of a record: the numbers of textures that are stored there as integers.
using StoredNumbers = std::map<uint32_t, TextureNumbers>;

/// Follows the numbers from the words of images, and from those that are `stored`; returns where they go.
TextureReads follow(const Kernel& kernel, const ImageWords& images, const StoredNumbers& stored) {
  const ir::Function& f = kernel.module.functions[kernel.entry];
  const ir::RecordAddresses addresses(f, kernel.record);
  std::vector<std::optional<uint32_t>> image_of(f.values.size());  // by value that is the word, still a float
  std::vector<TextureFlow::Known> known;
  for (const ir::Instruction& made : f.instructions) {
    if (made.op != ir::Opcode::load || (made.imm != objects && made.imm != object_integers)) continue;
    const uint32_t word = *addresses.word(f.operands_of(made)[0]);
    if (made.imm == objects)
      image_of[made.first_result] = images.image(word);
    else if (const auto found = stored.find(word); found != stored.end())
      known.emplace_back(made.first_result, found->second);
  }
  std::vector<bool> unknown(images.count);  // what the word is used for
  for (const ir::Instruction& made : f.instructions)
    for (const ir::ValueId operand : f.operands_of(made)) {
      if (!image_of[operand]) continue;
      if (made.op == ir::Opcode::ftoi)
        known.emplace_back(made.first_result, TextureNumbers{{*image_of[operand]}, {}});
      else
        unknown[*image_of[operand]] = true;
    }
  TextureReads reads = TextureFlow(kernel.module).follow(kernel.entry, images.count, known);
  for (size_t i = 0; i < images.count; ++i)
    if (unknown[i]) reads.levels[i] = true;
  return reads;
}

void add_reads(const Program& program, const ImageWords& images, std::vector<ImageReads>& reads) {
  std::vector<bool> words(images.count);
  mark_words(program, images.first, words);
  if (std::ranges::count(words, true) == 0) return;
  const Kernel kernel = kernel_of(program);
  const bool is_plain = kernel.words() && (program.draw == nullptr || kernel_of(*program.draw).words());
  const auto add = [&](const TextureReads& found) {
    for (size_t i = 0; i < images.count; ++i) reads[i].levels = reads[i].levels || found.levels[i];
  };
  for (size_t i = 0; i < images.count; ++i) {
    reads[i].any = reads[i].any || words[i];
    reads[i].levels = reads[i].levels || !is_plain;
  }
  if (!is_plain) return;
  StoredNumbers stored;
  if (program.draw != nullptr) {
    const TextureReads of_draw = follow(kernel_of(*program.draw), images, {});
    add(of_draw);
    uint32_t word = program.draw->first;
    const auto& results = program.draw->module.functions[program.draw->entry].results;
    for (size_t k = 0; k < results.size(); word += static_cast<uint32_t>(results[k++].type.width))
      if (results[k].type == ir::int_type) stored[word] = of_draw.results[k];
  }
  add(follow(kernel, images, stored));
}

/// The value of a field that is fixed.
std::optional<float> fixed_value(const Effect& effect, std::optional<size_t> field) {
  if (!field || !is_fixed(effect.fixed, effect.parameters, *field)) return std::nullopt;
  return effect.fixed[effect.parameters.word_of(*field)];
}

}  // namespace

std::vector<bool> words_read(const Effect& effect) {
  std::vector<bool> words(effect.parameters.word_count());
  for (const EffectPass& pass : effect.passes)
    for_each_program(
        pass, [&](const Program& program) { mark_words(program, lower::object_word::parameters, words); });
  return words;
}

std::vector<bool> words_read(const Post& post) {
  std::vector<bool> words(post.parameters.word_count());
  mark_words(post.program, 0, words);
  return words;
}

std::vector<ImageReads> images_read(const Effect& effect) {
  const ImageWords images{lower::object_word::parameters + effect.parameters.word_of_image(0),
                          effect.parameters.images.size()};
  std::vector<ImageReads> reads(images.count);
  if (images.count == 0) return reads;
  for (const EffectPass& pass : effect.passes) {
    if (fixed_value(effect, pass.enabled) == 0.0f) continue;
    const auto cutoff = fixed_value(effect, pass.cutoff);
    const bool cuts_out = pass.cutout && !(cutoff && *cutoff <= 0);
    for_each_program(pass, [&](const Program& program) {
      if (&program != (pass.cutout ? &*pass.cutout : nullptr) || cuts_out) add_reads(program, images, reads);
    });
  }
  return reads;
}

}  // namespace isoshade::driver
